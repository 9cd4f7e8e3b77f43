//! Gain error of one torque.

use super::{Description, Energy, ParameterSpec, Physics};
use crate::math::Real;

/// The recorded torque of wheel 1 has a gain error.
///
/// ```text
/// M1 = (1 + g) M1_recorded,   M2 = M2_recorded
/// ```
/// Source: definition. A factor common to both wheels is not identifiable: it scales a1..a5 together.
/// The gain of wheel 1 is therefore relative to that of wheel 2; a gain error of wheel 2 gives
/// the opposite sign and scaled a1..a5.
#[derive(Clone, Debug, Default)]
pub struct TorqueGain;

impl Physics for TorqueGain {
    fn description(&self) -> Description {
        Description {
            id: "torque_gain".into(),
            title: "Torque gain".into(),
            equation: "M1 = (1 + g) recorded M1".into(),
            cause: "wrong torque constant, gear ratio or amplifier gain on one wheel".into(),
            signature: "residual torque on wheel 1 in proportion to its torque".into(),
            excitation: "large torques of either sign, hard starts and brakes".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("g", "relative error of the gain", "", (-0.9, 2.0), 0.05)]
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn input<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        Some(m.iter().map(|&[m1, m2]| [(p[0] + 1.0) * m1, m2]).collect())
    }
}
