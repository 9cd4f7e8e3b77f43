//! Wheels that slip lengthwise under traction.

use super::{Coupling, Description, Energy, Motion, ParameterSpec, Physics};
use crate::math::Real;

/// Longitudinal slip in proportion to traction.
///
/// ```text
/// Iz1 dw_i + friction = M_i - cs (w_i - u_i)
/// body (a1 - Iz1, a2, a3) at u = cs (w - u)
/// ```
/// u_i is the speed that wheel i would have without slip, cs the slip stiffness at the wheel
/// (force per slip speed times r^2). Iz1 is the construction's inertia of wheel and gear.
///
/// Source: linear creep law of a rolling tyre (small slip at one speed); two-inertia form derived
/// here. The simulation keeps Iz1 below the robot's smallest inertia where the two disagree.
#[derive(Clone, Debug, Default)]
pub struct WheelSlip;

impl Physics for WheelSlip {
    fn description(&self) -> Description {
        Description {
            id: "wheel_slip".into(),
            title: "Wheel slip".into(),
            equation: "traction cs (w - u), u the slip-free wheel speed of the body".into(),
            cause: "soft tyre or slippery floor: the contact creeps under traction".into(),
            signature: "the wheel runs ahead of the body when speeding up and lags in braking"
                .into(),
            excitation: "hard starts and brakes, 35 rad/s^2 and more".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (0.01, 20.0);
        vec![ParameterSpec::shape("cs", "slip stiffness at the wheel", "N m s/rad", range, 0.3)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn coupling<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Option<Coupling<T>> {
        let rotor = T::from(x.robot.construction.iz1_kg_m2);
        Some(Coupling { rotor, stiffness: T::from(0.0), damping: p[0] })
    }
}
