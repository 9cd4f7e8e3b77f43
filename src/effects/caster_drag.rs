//! Dry resistance of the caster to forward motion.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Coulomb resistance of the caster to forward motion, shared by both wheels.
///
/// ```text
/// f_c sgn(v_A)   on wheel 1 and on wheel 2      (set-valued while v_A = 0)
/// ```
/// Derived here: a force F against v_A = r/2 (w1 + w2) dissipates the power F |v_A|, so f_c = F r/2
/// (for the caster of the paper F = N3 f3/r3).
///
/// Deviation: the friction of a caster away from the axle opposes its own velocity (v_A, -l5 β_dot);
/// here only the forward component is modelled, the other is similar to `turning_scrub`.
#[derive(Clone, Debug, Default)]
pub struct CasterDrag;

impl Physics for CasterDrag {
    fn description(&self) -> Description {
        Description {
            id: "caster_drag".into(),
            title: "Caster drag".into(),
            equation: "f_c sgn(v_A) on both wheels".into(),
            cause: "rolling resistance and bearing friction of the caster".into(),
            signature: "residual torque, the same on both wheels, that flips with v_A".into(),
            excitation: "wheels turning in opposite directions while v_A is not zero; otherwise \
                         a4 and a5 absorb it"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("f_c", "drag level at each wheel", "N m", (0.0, 1e3), 0.02)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        let zero = T::from(0.0);
        Terms { level: [zero, zero, zero, p[0]], ..Terms::zero() }
    }
}
