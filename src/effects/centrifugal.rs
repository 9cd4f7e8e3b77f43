//! Centre of mass off the axle: centrifugal torques.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms};
use crate::math::Real;
use crate::robot::centrifugal_torques;

/// Centrifugal torques of a centre of mass at distance l2 behind the axle.
///
/// ```text
/// a3 w2 (w2 - w1)   on wheel 1
/// a3 w1 (w1 - w2)   on wheel 2
/// ```
/// Source: paper, eq. (14). The two do no work together: w1 w2 (w2 - w1) + w2 w1 (w1 - w2) = 0.
#[derive(Clone, Debug, Default)]
pub struct Centrifugal;

impl Physics for Centrifugal {
    fn description(&self) -> Description {
        Description {
            id: "centrifugal".into(),
            title: "Centrifugal torques".into(),
            equation: "a3 w2 (w2 - w1) on wheel 1, a3 w1 (w1 - w2) on wheel 2".into(),
            cause: "the centre of mass lies behind (a3 > 0) or ahead of (a3 < 0) the axle".into(),
            signature: "torque in proportion to turn rate times speed".into(),
            excitation: "fast curves; nothing of it shows when driving straight".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("a3", "centrifugal constant", "kg m^2", (-1e4, 1e4), 3e-4)]
    }

    /// a3 does not exceed a1: a3/a1 <= r l2/(l1² + l2²) <= r/(2 l1).
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        vec![(-scale.inertia, scale.inertia)]
    }

    fn energy(&self) -> Energy {
        Energy::DoesNoWork
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: centrifugal_torques(p[0], x.omega), ..Terms::zero() }
    }
}
