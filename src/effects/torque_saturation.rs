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

/// Root mean square by which recorded torques exceed a limit, in standard deviations of their noise, above which noise is
/// no explanation (judgement: that of noise alone is one).
const BEYOND: f64 = 2.0;

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

    /// If the torque was limited before it was recorded, the recorded one exceeds the limit by noise alone, whose half
    /// above the limit has the mean square of all noise.
    fn exceeds_noise(&self, m: &[[f64; 2]], noise: [f64; 2], p: &[f64]) -> bool {
        (0..2).any(|i| {
            let beyond = m.iter().map(|row| row[i].abs() - p[0]).filter(|beyond| *beyond > 0.0);
            let (square, count) = beyond.fold((0.0, 0.0), |(s, n), b| (s + b * b, n + 1.0));
            square > count * (BEYOND * noise[i]).powi(2)
        })
    }

    fn input<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let clip = |m: T| m.max(-p[0]).min(p[0]);
        Some(m.iter().map(|row| row.map(clip)).collect())
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn a_torque_that_was_limited_before_it_was_recorded_exceeds_the_limit_by_noise_alone() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let asked = |k: i32| 2.0 * (0.01 * f64::from(k)).sin();
        let mut of = |real: fn(f64) -> f64| -> Vec<[f64; 2]> {
            let mut noisy =
                |m: f64| m + 0.014 * Distribution::<f64>::sample(&StandardNormal, &mut rng);
            (0..4000).map(|k| [noisy(real(asked(k))); 2]).collect()
        };
        let (limited, unlimited) = (of(|m| m.clamp(-1.6, 1.6)), of(|m| m));
        let exceeds = |m: &[[f64; 2]]| TorqueSaturation.exceeds_noise(m, [0.014; 2], &[1.6]);
        assert!(!exceeds(&limited) && exceeds(&unlimited));
    }
}
