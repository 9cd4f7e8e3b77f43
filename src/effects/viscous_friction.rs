//! Viscous friction: friction proportional to the speed.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Viscous friction, the same on both wheels.
///
/// ```text
/// b w1   on wheel 1
/// b w2   on wheel 2
/// ```
#[derive(Clone, Debug, Default)]
pub struct ViscousFriction;

impl Physics for ViscousFriction {
    fn description(&self) -> Description {
        Description {
            id: "viscous_friction".into(),
            title: "Viscous friction".into(),
            equation: "b w1 on wheel 1, b w2 on wheel 2".into(),
            cause: "grease and oil, eddy currents; with an input in volts also back-EMF".into(),
            signature: "residual torque grows in proportion to wheel speed".into(),
            excitation: "different steady speeds, slow and fast".into(),
            equivalent: vec!["back_emf".into()],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("b", "viscous constant", "N m s/rad", (0.0, 1e3), 0.003)]
    }

    /// All bearings and gears have viscous friction.
    fn is_common(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: x.omega.map(|w| p[0] * w), ..Terms::zero() }
    }
}
