//! Back-EMF of the motor that is contained in the recorded torque.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;
use crate::recording::DriveUnit;

/// The recorded torque exceeds the real one by k_e w: it was computed from the motor voltage without the
/// back-EMF.
///
/// ```text
/// k_e w1   on wheel 1
/// k_e w2   on wheel 2
/// ```
/// Source: DC motor without inductance, M = n k (U - k n w)/R for gear ratio n and motor
/// constant k, so that k_e = n^2 k^2/R if n k U/R was recorded. The same regressors as
/// viscous friction: no recording of the wheels can distinguish the two.
#[derive(Clone, Debug, Default)]
pub struct BackEmf;

impl Physics for BackEmf {
    fn description(&self) -> Description {
        Description {
            id: "back_emf".into(),
            title: "Back-EMF".into(),
            equation: "k_e w1 on wheel 1, k_e w2 on wheel 2".into(),
            cause: "the torque was recorded as if proportional to the motor voltage".into(),
            signature: "as viscous friction: residual torque in proportion to wheel speed".into(),
            excitation:
                "different steady speeds; only a measured motor current distinguishes it from \
                         viscous friction"
                    .into(),
            equivalent: vec!["viscous_friction".into()],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("k_e", "back-EMF constant", "N m s/rad", (0.0, 1e3), 0.003)]
    }

    /// With an input in volts, back-EMF is part of every model.
    fn belongs_to(&self, input: DriveUnit) -> bool {
        input == DriveUnit::Volt
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: x.omega.map(|w| p[0] * w), ..Terms::zero() }
    }
}
