//! The size of the signals of recordings: the unit in which shapes of effects are tried.

use crate::math::quantile_of_sorted;

/// Share of the rows whose speed lies below [`Scale::speed`].
pub const FAST: f64 = 0.98;

/// The size of the signals that an effect is looked for in.
///
/// Every effect gives the shapes worth trying as multiples of these ([`super::Physics::shapes`]), so that
/// a robot of 100 g and one of 100 kg are treated alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Wheel speed that 98 % of the rows stay below [rad/s].
    pub speed: f64,
    /// Longest median time step \[s\].
    pub step: f64,
    /// Shift of the input against the motion that logging explains at most \[s\].
    pub logging: f64,
    /// Longest recording \[s\].
    pub duration: f64,
    /// Largest angle that a wheel goes through \[rad\].
    pub angle: f64,
    /// Share of the moving rows in which a wheel runs against its main direction.
    pub backward: f64,
    /// Absolute input torques of both wheels, ascending [N m].
    pub torque: Vec<f64>,
    /// Smaller eigenvalue of the mass matrix [kg m^2].
    pub inertia: f64,
    /// Cut-off of the motion that the sensors resolve \[Hz\].
    pub bandwidth: f64,
    /// Whether an inertia (a1, a2) or a3 is held at a value, such as that of the construction.
    pub inertia_held: bool,
    /// Whether two wheels were measured, with inputs in N m: what a second body needs.
    pub two_bodies: bool,
}

impl Scale {
    /// The torque that a share of the rows stays below [N m].
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

/// `count` values from `first` to `last` at equal ratios.
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
