//! The drive cannot give more than a certain moment.

use super::{Description, Energy, ParameterSpec, Physics};
use crate::math::Real;

/// The real moment is clipped where the recorded one is not.
///
/// ```text
/// M = min(max(M_recorded, -limit), limit)   on each wheel
/// ```
/// Source: definition.
#[derive(Clone, Debug, Default)]
pub struct TorqueSaturation;

impl Physics for TorqueSaturation {
    fn description(&self) -> Description {
        Description {
            id: "torque_saturation".into(),
            title: "Moment saturation".into(),
            equation: "M = clip(recorded M, -limit, limit)".into(),
            cause: "current limit of the amplifier, supply voltage, slipping clutch".into(),
            signature: "moment is missing only where the recorded moment is large".into(),
            excitation: "moments above the limit: hard starts and brakes".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("limit", "largest moment", "N m", (1e-3, 1e4), 0.3)]
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_drive(&self) -> bool {
        true
    }

    fn drive<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let clip = |m: T| m.max(-p[0]).min(p[0]);
        Some(m.iter().map(|row| row.map(clip)).collect())
    }
}
