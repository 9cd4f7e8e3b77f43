//! Scales of the signals of recordings, in whose units shape parameters are tried.

use crate::math::quantile_of_sorted;

/// Share of the rows with speeds below [`Scale::speed`].
pub const FAST: f64 = 0.98;

/// Scales of the signals of recordings.
///
/// Every effect gives its shape parameters as multiples of these ([`super::Physics::shapes`]), so that a
/// robot of 100 g and one of 100 kg are treated alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Wheel speed that 98 % of the rows do not exceed [rad/s].
    pub speed: f64,
    /// Longest median time step \[s\].
    pub step: f64,
    /// Largest shift between input and motion that logging explains \[s\].
    pub logging: f64,
    /// Longest recording \[s\].
    pub duration: f64,
    /// Largest range of a wheel angle \[rad\].
    pub angle: f64,
    /// Share of the moving rows in which a wheel turns against its main direction.
    pub backward: f64,
    /// Absolute input torques of both wheels, ascending [N m].
    pub torque: Vec<f64>,
    /// Smaller eigenvalue of the mass matrix [kg m^2].
    pub inertia: f64,
    /// Cut-off up to which the sensors resolve the motion \[Hz\].
    pub bandwidth: f64,
    /// Whether an inertia (a1, a2) or a3 is fixed, for example at its construction value.
    pub inertia_held: bool,
    /// Whether two wheels were measured with torques or currents, as a second body requires: a back-EMF acts on the
    /// motor alone.
    pub two_bodies: bool,
}

impl Scale {
    /// Quantile of the absolute input torque [N m].
    #[must_use]
    pub fn torque_quantile(&self, share: f64) -> f64 {
        quantile_of_sorted(&self.torque, share)
    }

    /// Root mean square input torque [N m].
    #[must_use]
    pub fn torque_rms(&self) -> f64 {
        let sum: f64 = self.torque.iter().map(|m| m * m).sum();
        (sum / self.torque.len().max(1) as f64).sqrt()
    }
}

/// `count` values from `first` to `last` in geometric progression.
#[must_use]
pub fn geometric(first: f64, last: f64, count: usize) -> Vec<f64> {
    let ratio = last / first;
    let share = |k: usize| k as f64 / (count.max(2) - 1) as f64;
    (0..count).map(|k| first * ratio.powf(share(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_equal_ratios_include_both_ends() {
        let values = geometric(2.0, 16.0, 4);
        for (found, expected) in values.iter().zip([2.0, 4.0, 8.0, 16.0]) {
            assert!((found - expected).abs() < 1e-12, "rounding of powers: {values:?}");
        }
    }
}
