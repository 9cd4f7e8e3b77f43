//! Friction proportional to the wheel load, which is transferred outward in fast curves.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Coulomb friction levels that depend on the wheel loads in curves.
///
/// ```text
/// level of wheel 1:  + cl (w1^2 - w2^2)
/// level of wheel 2:  - cl (w1^2 - w2^2)
/// cl = f m h r^2/(8 l1^2),   h height of the centre of mass, f arm of rolling friction
/// ```
/// Derived here: the force m v_A β_dot = m r^2/(4 l1) (w1^2 - w2^2) at height h transfers the load
/// m h v_A β_dot/(2 l1) from the inner to the outer wheel. The dissipated power,
/// cl (w1^2 - w2^2)(|w1| - |w2|), is never negative. A single level may be negative; with the
/// base level it is positive as long as the wheel stays on the floor.
#[derive(Clone, Debug, Default)]
pub struct LoadTransferFriction;

impl Physics for LoadTransferFriction {
    fn description(&self) -> Description {
        Description {
            id: "load_transfer_friction".into(),
            title: "Load-transfer friction".into(),
            equation: "level + cl (w1^2 - w2^2) on wheel 1, - cl (w1^2 - w2^2) on wheel 2".into(),
            cause: "centrifugal force loads the outer wheel and unloads the inner one".into(),
            signature: "friction increases on the outer wheel and decreases on the inner one in proportion \
                        to v_A times beta_dot"
                .into(),
            excitation: "fast curves to both sides, forward and backward".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let unit = "N m s^2/rad^2";
        vec![ParameterSpec::linear("cl", "load-transfer constant", unit, (0.0, 1e2), 2e-4)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let moved = p[0] * (x.omega[0].squared() - x.omega[1].squared());
        let zero = T::from(0.0);
        Terms { level: [moved, -moved, zero, zero], ..Terms::zero() }
    }
}
