//! Saturation of the motor torque.

use super::{Description, Energy, ParameterSpec, Physics, Scale};
use crate::math::Real;

/// The real torque is limited, the recorded one is not.
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
            title: "Torque saturation".into(),
            equation: "M = clip(recorded M, -limit, limit)".into(),
            cause: "current limit of the amplifier, supply voltage, slipping clutch".into(),
            signature: "torque is missing only where the recorded torque is large".into(),
            excitation: "torques above the limit: hard starts and brakes".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("limit", "largest torque", "N m", (1e-6, 1e6), 0.3)]
    }

    /// Limits from below the median of the torques, where the controller of a saturated motor asks for far more than it
    /// gets, to nearly the largest ones.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let quantiles = [0.25, 0.4, 0.55, 0.65, 0.8, 0.9, 0.95, 0.98, 0.994];
        quantiles.into_iter().map(|share| vec![scale.torque_quantile(share)]).collect()
    }

    /// From the torque that a fifth of the rows do not reach: below it a limit replaces nearly all of the input by a
    /// constant of either sign, which, with all parameters in proportion to it, is no more than an input without its
    /// noise. Taste.
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        vec![(scale.torque_quantile(0.2).max(1e-6), 1e6)]
    }

    fn several_starts(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn input<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let clip = |m: T| m.max(-p[0]).min(p[0]);
        Some(m.iter().map(|row| row.map(clip)).collect())
    }
}
