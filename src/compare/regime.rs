//! The driving regimes in which the model fails significantly.

use super::mean::clustered_mean;
use crate::math::distribution::{holm, t_survival};
use crate::recording::{Recording, Regime};

/// Probability that any regime is called significant if the model is correct.
pub(crate) const REGIME_RATE: f64 = 0.05;
/// Ratio of error to noise floor up to which a model or a regime is at the floor; the floor is uncertain by
/// about as much. A residual torque that does not increase the error is not a failure.
pub(crate) const AT_FLOOR: f64 = 1.2;
/// Smallest number of rows in a regime.
const FEWEST: usize = 5;
/// Smallest number of blocks of 1 s in a regime for a test.
const FEWEST_BLOCKS: usize = 4;

/// The error in one regime for one wheel.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Failure {
    /// The regime of driving.
    pub regime: Regime,
    /// Wheel, 1 (right) or 2 (left).
    pub wheel: usize,
    /// Share of the summed squared 2 s simulation error of both wheels in this regime.
    pub share_of_ise: f64,
    /// Ratio of the RMS 2 s simulation error in this regime to that of the noise floor.
    pub ratio_to_noise: f64,
    /// p-value of the mean residual torque, by a t test over blocks of 1 s.
    pub p_value: f64,
    /// Mean residual torque in this regime [N m].
    #[serde(rename = "moment")]
    pub torque: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Number of rows of the judged recordings in this regime.
    pub samples: usize,
    /// Whether the residual torque is significant at 5 % after Holm's correction for all regimes, and the
    /// error is above 1.2 times the noise floor.
    pub significant: bool,
}

/// Sums over the rows of one regime and wheel.
#[derive(Default)]
struct Sums {
    /// Squared errors over windows [rad^2/s^2].
    square: f64,
    /// Squared noise floors [rad^2/s^2].
    expected: f64,
    samples: usize,
    /// Residual torques [N m], each with the number of its block of 1 s.
    torques: Vec<(usize, f64)>,
}

impl Sums {
    /// The error in the regime, with a t test of its mean residual torque; `None` if it has too few rows. `total`:
    /// summed squared error of both wheels in all regimes.
    fn failure(mut self, regime: Regime, wheel: usize, total: f64) -> Option<Failure> {
        if self.samples < FEWEST {
            return None;
        }
        self.torques.retain(|(_, torque)| torque.is_finite());
        let mean = clustered_mean(&self.torques);
        let t = mean.value.abs() / mean.std_error;
        let p_value = match mean.blocks {
            ..FEWEST_BLOCKS => 1.0,
            blocks => 2.0 * t_survival(t, blocks as f64 - 1.0),
        };
        Some(Failure {
            regime,
            wheel: wheel + 1,
            share_of_ise: self.square / total,
            ratio_to_noise: (self.square / self.expected.max(1e-300)).sqrt(),
            p_value: if p_value.is_finite() { p_value } else { 1.0 },
            torque: mean.value,
            std_error: mean.std_error,
            samples: self.samples,
            significant: false,
        })
    }
}

/// Regimes sorted by the ratio of error to noise. `regimes`, `torque` (the
/// [`residual_torque()`](super::residual_torque())) and `errors` (over windows of 2 s [rad/s]) contain one
/// list per recording with one value per row, `floors` the noise floors [rad/s].
///
/// ```text
/// p = P(|t| > |mean|/se),   mean and standard error of the residual torque over blocks of 1 s
/// ```
#[must_use]
pub fn failures(
    recordings: &[&Recording],
    regimes: &[Vec<Regime>],
    torque: &[Vec<[f64; 2]>],
    errors: &[Vec<[f64; 2]>],
    floors: &[f64],
) -> Vec<Failure> {
    let total: f64 = errors
        .iter()
        .flatten()
        .map(|e| e[0] * e[0] + e[1] * e[1])
        .filter(|e| e.is_finite())
        .sum::<f64>()
        .max(1e-300);
    let mut out = Vec::new();
    for regime in Regime::ALL {
        for wheel in 0..2 {
            let mut sums = Sums::default();
            for (r, recording) in recordings.iter().enumerate() {
                let block = |k: usize| (r << 32) + recording.t()[k].max(0.0) as usize;
                for k in (0..regimes[r].len()).filter(|k| regimes[r][*k] == regime) {
                    sums.square += errors[r][k][wheel].powi(2);
                    sums.expected += floors[r] * floors[r];
                    sums.samples += 1;
                    sums.torques.push((block(k), torque[r][k][wheel]));
                }
            }
            out.extend(sums.failure(regime, wheel, total));
        }
    }
    let p_values: Vec<f64> = out.iter().map(|f| f.p_value).collect();
    for (failure, p) in out.iter_mut().zip(holm(&p_values)) {
        failure.significant = p <= REGIME_RATE && failure.ratio_to_noise > AT_FLOOR;
    }
    out.sort_by(|a, b| {
        b.significant.cmp(&a.significant).then(b.ratio_to_noise.total_cmp(&a.ratio_to_noise))
    });
    out
}
