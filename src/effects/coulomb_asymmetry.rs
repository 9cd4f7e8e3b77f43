//! Dry friction that differs between forward and backward.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Coulomb friction with different levels forward and backward.
///
/// ```text
/// level of wheel 1:  a4 + c1 forward, a4 - c1 backward
/// level of wheel 2:  a5 + c2 forward, a5 - c2 backward
/// ```
/// Derived here: (a4 + c1 sgn(w1)) sgn(w1) = a4 sgn(w1) + c1 for a moving wheel, and a wheel at
/// rest breaks away at a4 + c1 forward and -(a4 - c1) backward, which is the interval [-a4, a4]
/// shifted by c1. So the asymmetry is the constant torque c1, also at rest: the same regressors as
/// `torque_offset`.
#[derive(Clone, Debug, Default)]
pub struct CoulombAsymmetry;

impl Physics for CoulombAsymmetry {
    fn description(&self) -> Description {
        Description {
            id: "coulomb_asymmetry".into(),
            title: "Direction-dependent Coulomb friction".into(),
            equation: "level a4 +- c1 forward/backward on wheel 1, a5 +- c2 on wheel 2".into(),
            cause: "gears or brushes that run harder in one direction".into(),
            signature: "constant residual torque, the same at every speed and at breakaway".into(),
            excitation: "driving forward and backward; without reversals a4 and a5 absorb it"
                .into(),
            equivalent: vec!["torque_offset".into()],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (-1e3, 1e3);
        vec![
            ParameterSpec::linear("c1", "half the difference, wheel 1", "N m", range, 0.01),
            ParameterSpec::linear("c2", "half the difference, wheel 2", "N m", range, 0.01),
        ]
    }

    /// Alone it is a constant torque; it is dissipative only together with levels above |c1|, |c2|.
    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: [p[0], p[1]], ..Terms::zero() }
    }
}
