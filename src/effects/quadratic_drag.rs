//! Resistance proportional to the square of the speed.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Drag of each wheel in proportion to the square of its speed.
///
/// ```text
/// c w1 |w1|   on wheel 1
/// c w2 |w2|   on wheel 2
/// ```
/// Source: drag at high Reynolds number, F = c_D A rho v |v|/2, for what turns or moves with each
/// wheel (fans, churned oil, air).
#[derive(Clone, Debug, Default)]
pub struct QuadraticDrag;

impl Physics for QuadraticDrag {
    fn description(&self) -> Description {
        Description {
            id: "quadratic_drag".into(),
            title: "Quadratic drag".into(),
            equation: "c w1 |w1| on wheel 1, c w2 |w2| on wheel 2".into(),
            cause: "air resistance or oil churning losses (turbulent flow)".into(),
            signature: "residual torque grows with the square of the wheel speed".into(),
            excitation:
                "several steady speeds over a wide range distinguish it from viscous friction"
                    .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("c", "drag constant", "N m s^2/rad^2", (0.0, 1e2), 2e-4)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: x.omega.map(|w| p[0] * w * w.abs()), ..Terms::zero() }
    }
}
