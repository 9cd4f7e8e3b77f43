//! Dry friction on each wheel.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms};
use crate::math::Real;

/// Coulomb (dry) friction, one level per wheel; at rest it takes any value up to the level.
///
/// ```text
/// a4 sgn(w1)   on wheel 1
/// a5 sgn(w2)   on wheel 2
/// ```
/// Source: paper, eq. (14). Deviation: with sgn(0) = 0 of the paper a wheel at rest would creep under
/// any torque; here friction at rest balances torques up to its level.
#[derive(Clone, Debug, Default)]
pub struct CoulombFriction;

impl Physics for CoulombFriction {
    fn description(&self) -> Description {
        Description {
            id: "coulomb_friction".into(),
            title: "Coulomb friction".into(),
            equation: "a4 sgn(w1) on wheel 1, a5 sgn(w2) on wheel 2".into(),
            cause: "dry friction in bearings and gears, rolling resistance N f".into(),
            signature:
                "a torque that steps when the wheel reverses; standstill under small torques".into(),
            excitation: "any motion; reversals separate it from an offset".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (0.0, 1e4);
        vec![
            ParameterSpec::linear("a4", "Coulomb level, wheel 1", "N m", range, 0.1),
            ParameterSpec::linear("a5", "Coulomb level, wheel 2", "N m", range, 0.1),
        ]
    }

    /// With friction above every recorded torque the wheel would never start.
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        vec![(0.0, scale.torque_quantile(1.0)); 2]
    }

    /// A simulation cannot start from rest with negative friction.
    fn start(&self, p: &mut [f64], _free: &[bool]) {
        p.iter_mut().for_each(|level| *level = level.max(0.0));
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        let zero = T::from(0.0);
        Terms { level: [p[0], p[1], zero, zero], ..Terms::zero() } // eq. (14)
    }
}
