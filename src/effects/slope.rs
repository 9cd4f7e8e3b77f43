//! An inclined floor.

use super::{Cycle, Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, Wave};
use crate::math::Real;

/// Weight on an inclined floor: a torque that varies with the heading.
///
/// ```text
/// G (cos(β - β_u) (1, 1) + k_g sin(β - β_u) (1, -1)),   g_c = G cos β_u,  g_s = G sin β_u
/// = g_c (cos β (1, 1) + k_g sin β (1, -1)) + g_s (sin β (1, 1) - k_g cos β (1, -1))
/// G = m g sin(inclination) r/2,  m = m4 + 2 m1,  k_g = (l2/l1) m4/m,  β_u uphill heading
/// ```
/// Derived here: the height of the centre of mass along the uphill direction u is
/// u·(A - l (cos β, sin β)) with l = l2 m4/m behind the axle (the wheels' mass sits on it). Its
/// rate times m g sin(inclination) is the required power; with v_A = r/2 (w1 + w2) and
/// β_dot = r/(2 l1) (w1 - w2) the factors of w1 and w2 are the torques above.
///
/// k_g is the distance of the centre of mass behind the axle in half tracks. It is a parameter because the
/// mass and its centre are the least known data of a robot, and a3 determines it only together with the mass.
/// The heading is computed from the wheel angles; its initial value is absorbed by β_u.
#[derive(Clone, Debug, Default)]
pub struct Slope;

/// Values of k_g that are tried: a centre of mass on the axle, and half a half track ahead of and behind it.
/// For values in between the torque differs from the nearest by at most a quarter, and a fit converges from
/// there.
const LEVERS: [f64; 3] = [-0.5, 0.0, 0.5];

impl Physics for Slope {
    fn description(&self) -> Description {
        Description {
            id: "slope".into(),
            title: "Inclined floor".into(),
            equation: "g_c (cos(beta) (1,1) + k_g sin(beta) (1,-1)) + g_s (sin(beta) (1,1) \
                       - k_g cos(beta) (1,-1)), k_g = l2 m4/(l1 (m4 + 2 m1))"
                .into(),
            cause: "the floor is not level: weight pulls downhill".into(),
            signature: "residual torque varies sinusoidally with heading".into(),
            excitation: "driving in several headings, full turns; one heading alone shows only an \
                         offset"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (-1e3, 1e3);
        vec![
            ParameterSpec::linear("g_c", "weight torque at heading 0", "N m", range, 0.02),
            ParameterSpec::linear("g_s", "weight torque at heading 90 degrees", "N m", range, 0.02),
            ParameterSpec::shape(
                "k_g",
                "centre of mass behind the axle, in half tracks",
                "",
                (-2.0, 2.0),
                0.3,
            ),
        ]
    }

    fn shapes(&self, _scale: &Scale) -> Vec<Vec<f64>> {
        LEVERS.map(|lever| vec![lever]).to_vec()
    }

    fn energy(&self) -> Energy {
        Energy::Stores
    }

    fn needs_track(&self) -> bool {
        true
    }

    fn waves(&self, _p: &[f64]) -> Vec<Wave> {
        vec![Wave { of: Cycle::Heading, order: 1.0, sine: 1, cosine: 0 }]
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let (sin, cos) = x.heading().sin_cos();
        let both = p[0] * cos + p[1] * sin;
        let turning = (p[0] * sin - p[1] * cos) * p[2];
        Terms { torque: [both + turning, both - turning], ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn the_power_of_the_torques_is_the_rate_of_the_potential_energy() {
        let robot = Robot::amigobot();
        let body = &robot.construction;
        let (gravity, uphill) = (1.7_f64, 0.6_f64); // N a kg of mass along the floor, rad
        let weight = |mass: f64| gravity * mass;
        let total = body.m4_kg + 2.0 * body.m1_kg;
        let g = weight(total) * robot.r() / 2.0;
        let (alpha, omega) = ([2.0, -1.5], [7.0, 3.0]);
        let x = Motion { t: 0.0, alpha, omega, variance: [0.0; 4], robot: &robot };
        let lever = body.l2_m / body.l1_m * body.m4_kg / total;
        let torque = Slope.terms(&x, &[g * uphill.cos(), g * uphill.sin(), lever]).torque;
        // height of frame and wheels after a short time, A moving along the heading
        let potential = |dt: f64| {
            let beta = x.heading() + x.turn_rate() * dt;
            let middle = x.heading() + 0.5 * x.turn_rate() * dt;
            let along = x.forward_speed() * dt * (middle - uphill).cos();
            weight(total) * along - weight(body.m4_kg) * body.l2_m * (beta - uphill).cos()
        };
        let power = (potential(1e-5) - potential(-1e-5)) / 2e-5;
        let found = torque[0] * omega[0] + torque[1] * omega[1];
        assert!((found - power).abs() < 1e-8, "{found} {power}"); // differences: eps/h
    }
}
