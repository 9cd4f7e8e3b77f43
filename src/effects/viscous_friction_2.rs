//! Viscous friction on wheel 2 only.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Viscous friction on wheel 2 (left) alone.
///
/// ```text
/// b2 w2   on wheel 2
/// ```
/// Source: the classical law of Newtonian lubrication; Armstrong-Hélouvry, Dupont, Canudas de
/// Wit, "A survey of models, analysis tools and compensation methods for the control of machines
/// with friction", Automatica 30 (1994), section 2.
#[derive(Clone, Debug, Default)]
pub struct ViscousFriction2;

impl Physics for ViscousFriction2 {
    fn description(&self) -> Description {
        Description {
            id: "viscous_friction_2".into(),
            title: "Viscous friction of wheel 2".into(),
            equation: "b2 w2 on wheel 2".into(),
            cause: "grease, a rubbing seal or a failing bearing on the left side".into(),
            signature: "residual torque on wheel 2 grows in proportion to its speed".into(),
            excitation: "different steady speeds, slow and fast".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (0.0, 1e3);
        vec![ParameterSpec::linear("b2", "viscous constant, wheel 2", "N m s/rad", range, 0.003)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: [T::from(0.0), p[0] * x.omega[1]], ..Terms::zero() }
    }
}
