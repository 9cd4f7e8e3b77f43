//! Wheels of unequal radius.

use super::effect::SURELY;
use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;
use crate::robot::Robot;

/// Largest error of a3 over I from the construction data: half, because a3 is proportional to the distance of
/// the centre of mass, which is seldom measured (judgement).
const MOST_OFF: f64 = 0.5;

/// Wheels of radius r1 = r (1 + eps) and r2 = r (1 - eps), to first order in eps.
///
/// ```text
/// 2 I eps dw1 - (eps + epd) a3 w2 (w1 + w2)    on wheel 1
/// -2 I eps dw2 + (eps + epd) a3 w1 (w1 + w2)   on wheel 2,     I = a1 - Iz1
/// ```
/// I and a3 are those of construction. epd is zero where these have the right ratio; a centre of mass that is known to
/// a few tenths alone moves it away. Where no construction is known I is a1 and a3 is a3, both as estimated without the
/// effect ([`Robot::estimated`]): eps is then less than the difference of radius by the wheels' share of a1, Iz1/a1,
/// and eps + epd is not.
///
/// Derived here. The body moves as if wheels of radius r turned at q1 = (1 + eps) w1 and
/// q2 = (1 - eps) w2, since v_A = (r1 w1 + r2 w2)/2 and β_dot = (r1 w1 - r2 w2)/(2 l1). Its
/// torques at q are those of eq. (14) without the wheels' own Iz1; by virtual power the wheels
/// feel them times 1 + eps and 1 - eps:
///
/// ```text
/// M1 = Iz1 dw1 + (1 + eps) (I dq1 + a2 dq2 + a3 q2 (q2 - q1)),  M2 likewise
/// ```
/// Subtracting eq. (14) leaves for the masses (1 + eps)^2 - 1, (1 - eps)^2 - 1 and
/// (1 + eps)(1 - eps) - 1, that is +2 eps, -2 eps and 0 to first order, and for the centrifugal
/// torque of wheel 1 a3 w2 ((1 - eps) w2 - (1 + eps) w1 - w2 + w1). What is left out is of order
/// eps^2: 1e-4 of the torques at eps = 0.01.
///
/// Deviation: the heading keeps the mean radius (it matters to `slope` alone).
#[derive(Clone, Debug, Default)]
pub struct WheelRadiusMismatch;

impl Physics for WheelRadiusMismatch {
    fn description(&self) -> Description {
        Description {
            id: "wheel_radius_mismatch".into(),
            title: "Unequal wheel radii".into(),
            equation: "2 I eps dw1 - (eps + epd) a3 w2 (w1 + w2) on wheel 1, -2 I eps dw2 + \
                       (eps + epd) a3 w1 (w1 + w2) on wheel 2, I = a1 - Iz1"
                .into(),
            cause: "tyre wear or pressure: r1 = r (1 + eps), r2 = r (1 - eps)".into(),
            signature: "unequal apparent inertias, and opposite torques on the two wheels in fast straight \
                        driving"
                .into(),
            excitation: "hard starts and brakes, and fast straight driving".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (-0.3, 0.3);
        let deviation = "deviation from eps in the centrifugal torque";
        vec![
            ParameterSpec::linear("eps", "relative difference of radius, halved", "", range, 0.02),
            ParameterSpec::linear("epd", deviation, "", (-1.0, 1.0), 0.0),
        ]
    }

    /// Both torques must be consistent with one difference of radius, within their uncertainty: if the
    /// centrifugal torque is small, its part is not determined. If I is all of a1, which includes the inertia
    /// of the wheel, the inertial part may be smaller than the centrifugal part.
    fn is_itself(&self, p: &[f64], errors: &[f64], robot: &Robot) -> bool {
        let less = robot.estimated.is_some() && p[0] * p[1] >= 0.0;
        less || p[1].abs() - SURELY * errors[1] <= MOST_OFF * p[0].abs()
    }

    fn energy(&self) -> Energy {
        Energy::Stores
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let (inertia, a3) = x.robot.inertia_at_wheel();
        let mass = p[0] * (2.0 * inertia);
        let [w1, w2] = x.omega;
        let turned = (p[0] + p[1]) * (w1 + w2) * a3;
        let torque = [-turned * w2, turned * w1];
        Terms { mass: [mass, T::from(0.0), -mass], torque, ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_centrifugal_torque_that_is_not_seen_refutes_nothing() {
        let robot = Robot::amigobot();
        let is_itself = |p: [f64; 2], error: f64| {
            Physics::is_itself(&WheelRadiusMismatch, &p, &[0.001, error], &robot)
        };
        assert!(is_itself([0.02, 0.009], 0.001) && !is_itself([0.02, 0.02], 0.001));
        assert!(is_itself([0.02, 0.6], 0.5) && is_itself([0.02, 0.0], f64::INFINITY));
    }

    #[test]
    fn the_first_order_form_is_the_derivative_of_the_exact_torques() {
        let robot = Robot::amigobot();
        let a = robot.construction.parameters();
        let iz = robot.construction.iz1_kg_m2;
        let (w, dw) = ([6.0, -2.5], [30.0, 12.0]);
        // torques of body and wheels with the exact radii
        let exact = |eps: f64| {
            let rho = [1.0 + eps, 1.0 - eps];
            let (q, dq) = ([rho[0] * w[0], rho[1] * w[1]], [rho[0] * dw[0], rho[1] * dw[1]]);
            [0, 1].map(|i| {
                let j = 1 - i;
                iz * dw[i]
                    + rho[i] * ((a.a1 - iz) * dq[i] + a.a2 * dq[j] + a.a3 * q[j] * (q[j] - q[i]))
            })
        };
        let x = Motion::at(0.0, [0.0; 2], w, &robot);
        let found = WheelRadiusMismatch.terms(&x, &[1.0, 0.0]).total_torque(&dw, &[0.0; 4]);
        let (up, down) = (exact(1e-5), exact(-1e-5));
        for i in 0..2 {
            let slope = (up[i] - down[i]) / 2e-5;
            assert!((found[i] - slope).abs() < 1e-9, "{} {slope}", found[i]); // h^2 and eps/h
        }
    }
}
