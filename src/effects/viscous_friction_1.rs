//! Viscous friction on wheel 1 only.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Viscous friction on wheel 1 (right) alone.
///
/// ```text
/// b1 w1   on wheel 1
/// ```
/// Source: the classical law of Newtonian lubrication; Armstrong-Hélouvry, Dupont, Canudas de
/// Wit, "A survey of models, analysis tools and compensation methods for the control of machines
/// with friction", Automatica 30 (1994), section 2.
#[derive(Clone, Debug, Default)]
pub struct ViscousFriction1;

impl Physics for ViscousFriction1 {
    fn description(&self) -> Description {
        Description {
            id: "viscous_friction_1".into(),
            title: "Viscous friction of wheel 1".into(),
            equation: "b1 w1 on wheel 1".into(),
            cause: "grease, a rubbing seal or a failing bearing on the right side".into(),
            signature: "residual torque on wheel 1 grows in proportion to its speed".into(),
            excitation: "different steady speeds, slow and fast".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (0.0, 1e3);
        vec![ParameterSpec::linear("b1", "viscous constant, wheel 1", "N m s/rad", range, 0.003)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: [p[0] * x.omega[0], T::from(0.0)], ..Terms::zero() }
    }
}
