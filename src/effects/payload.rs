//! Mass and inertia above the construction data.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms};
use crate::math::Real;

/// A load: extra mass, extra yaw inertia about the middle of the axle, and its centre of mass.
///
/// ```text
/// mass matrix  + r^2/4 mp (1 1; 1 1) + r^2/(4 l1^2) ip (1 -1; -1 1)
/// a3           + r^3/(4 l1^2) sp,   sp = mp times its distance behind the axle
/// ```
/// Derived here from the kinetic energy mp v_A^2/2 + ip β_dot^2/2 and from a3 = r^3 m4 l2/(4 l1^2). It changes
/// a1, a2 and a3, and is identifiable only if these are fixed at their construction values.
///
/// Deviation: its effect on the Coulomb friction is part of a4 and a5.
#[derive(Clone, Debug, Default)]
pub struct Payload;

impl Physics for Payload {
    fn description(&self) -> Description {
        Description {
            id: "payload".into(),
            title: "Payload".into(),
            equation: "r^2/4 mp (dw1 + dw2) (1,1) + r^2/(4 l1^2) ip (dw1 - dw2) (1,-1), a3 + r^3/(4 l1^2) sp"
                .into(),
            cause: "mass carried beyond the construction data".into(),
            signature: "residual torque in proportion to acceleration".into(),
            excitation: "speeding up and braking, straight (mp) and turning (ip); only identifiable if a1 \
                         and a2 are fixed at their construction values"
                .into(),
            equivalent: vec!["inertia".into()],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (positive, either) = ((0.0, 1e3), (-1e3, 1e3));
        vec![
            ParameterSpec::linear("mp", "extra mass", "kg", positive, 0.5),
            ParameterSpec::linear("ip", "extra yaw inertia", "kg m^2", positive, 0.01),
            ParameterSpec::linear(
                "sp",
                "extra mass times its distance behind the axle",
                "kg m",
                either,
                0.01,
            ),
        ]
    }

    fn admissible(&self, scale: &Scale) -> bool {
        scale.inertia_held
    }

    fn needs_track(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Stores
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let (r, l1) = (x.robot.r(), x.robot.l1());
        let forward = p[0] * (0.25 * r * r);
        let turning = p[1] * (0.25 * r * r / (l1 * l1));
        let mass = [forward + turning, forward - turning, forward + turning];
        // what the centrifugal constant a3 = r³ m l2/(4 l1²) gains
        let a3 = p[2] * (0.25 * r * r * r / (l1 * l1));
        let [w1, w2] = x.omega;
        let torque = [a3 * w2 * (w2 - w1), a3 * w1 * (w1 - w2)];
        Terms { mass, torque, ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Construction, Robot};

    #[test]
    fn a_load_on_the_axle_is_what_a_heavier_robot_built_that_way_has() {
        let robot = Robot::amigobot();
        let plain = &robot.construction;
        let x = Motion::at(0.0, [0.0; 2], [0.0; 2], &robot);
        let mass = Payload.terms(&x, &[0.7, 0.03, 0.0]).mass;
        // 0.7 kg more frame at l2, less the yaw inertia that it has there about the axle
        let yaw = 0.03 - 0.7 * plain.l2_m * plain.l2_m;
        let heavy = Construction {
            m4_kg: plain.m4_kg + 0.7,
            iz4_kg_m2: plain.iz4_kg_m2 + yaw,
            ..plain.clone()
        };
        let (a, b) = (plain.parameters(), heavy.parameters());
        assert!((mass[0] - (b.a1 - a.a1)).abs() < 1e-16, "rounding of terms of 0.03 kg m^2");
        assert!((mass[1] - (b.a2 - a.a2)).abs() < 1e-16);
        assert_eq!(mass[0], mass[2]);
    }
}
