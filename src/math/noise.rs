//! How noisy a recorded signal is, told from the signal alone.

use super::distribution::chi2_quantile;
use super::error::{MathError, check_finite};

/// C(8, 4): fourth differences of white noise have this many times its variance.
const GAIN: f64 = 70.0;
/// Autocorrelation of fourth differences of white noise at lags 1 to 4.
const CORRELATION: [f64; 4] = [-56.0 / 70.0, 28.0 / 70.0, -8.0 / 70.0, 1.0 / 70.0];
/// Length of a block [s].
const BLOCK_DURATION: f64 = 0.5;
/// Fewest differences a block may hold.
const MIN_BLOCK: usize = 12;
/// A range of more quanta than this is no quantisation worth naming.
const MAX_QUANTA: f64 = 1e7;

/// The noise of a signal, in the unit of the signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseEstimate {
    /// Standard deviation: `from_differences`, but at least `quantum / sqrt 12`.
    pub std_dev: f64,
    /// Standard deviation from fourth differences alone.
    pub from_differences: f64,
    /// Lag-1 correlation of the fourth differences: -0.8 if the noise is white.
    pub lag_one_correlation: f64,
    /// Whether that correlation agrees with white noise. If not, the logger has filtered the
    /// signal (or it moves too fast for its sample rate) and the noise is underestimated.
    pub is_white: bool,
    /// Step between neighbouring levels if the signal is quantised.
    pub quantum: Option<f64>,
}

/// Standard deviation of the white noise on a smooth signal, from its fourth differences.
///
/// ```text
/// s_b^2 = mean over block b of (v_k - 4 v_(k-1) + 6 v_(k-2) - 4 v_(k-3) + v_(k-4))^2 / 70
/// sigma^2 = median_b s_b^2 / m,   m = median(chi2_n)/n,   n = B / (1 + 2 sum_j (1 - j/B) rho_j^2)
/// ```
///
/// A cubic vanishes in fourth differences, so smooth motion leaves nothing; the median over blocks
/// of 0.5 s forgets starts and reversals, m corrects its bias. Blocks in which nothing changes are
/// left out unless all are so.
///
/// Source: J. von Neumann et al., Ann. Math. Statist. 12 (1941) for differences; the median of
/// blocks and its correction are derived here.
///
/// `sample_rate` in [Hz].
///
/// # Errors
/// If the signal holds a value that is not finite, is shorter than one block, or the sample rate
/// is not positive.
pub fn white_noise(signal: &[f64], sample_rate: f64) -> Result<NoiseEstimate, MathError> {
    check_finite("the signal", signal)?;
    if !(sample_rate > 0.0 && sample_rate.is_finite()) {
        let (setting, expected) = ("sample rate [Hz]", "positive");
        return Err(MathError::OutOfRange { setting, found: sample_rate, expected });
    }
    let block = ((BLOCK_DURATION * sample_rate).round() as usize).max(MIN_BLOCK);
    let (method, found, required) = ("the noise estimate", signal.len(), block + 4);
    if found < required {
        return Err(MathError::TooFewSamples { method, found, required });
    }
    let differences = fourth_differences(signal);
    let blocks: Vec<&[f64]> =
        differences.chunks_exact(block).filter(|b| b.iter().any(|&d| d != 0.0)).collect();
    let quantum = quantum(signal);
    let floor = quantum.map_or(0.0, |q| q / 12.0_f64.sqrt());
    if blocks.is_empty() {
        return Ok(NoiseEstimate {
            std_dev: floor,
            from_differences: 0.0,
            lag_one_correlation: 0.0,
            is_white: false,
            quantum,
        });
    }
    let variance = median(blocks.iter().map(|b| sum_of_squares(b) / (GAIN * block as f64)));
    let from_differences = (variance / median_bias(block, blocks.len())).sqrt();
    let lag_one_correlation = median(blocks.iter().map(|b| lag_one(b)));
    let tolerance = 0.05 + 3.0 / ((block * blocks.len()) as f64).sqrt();
    Ok(NoiseEstimate {
        std_dev: from_differences.max(floor),
        from_differences,
        lag_one_correlation,
        is_white: (lag_one_correlation - CORRELATION[0]).abs() < tolerance,
        quantum,
    })
}

/// The common step of all values of a signal, or none if there is no such step.
///
/// The approximate greatest common divisor of the gaps between the values that occur; a signal
/// with more than 1e7 steps in its range counts as continuous. A rounding error of uniform
/// distribution has the standard deviation q / sqrt 12.
///
/// # Examples
/// ```
/// use amigo_ident::math::noise::quantum;
/// let tick = 0.02;
/// let encoder = [3, 7, 12, 4, 9].map(|n| 0.5 + tick * f64::from(n));
/// assert!((quantum(&encoder).unwrap() - tick).abs() < 1e-12);
/// ```
#[must_use]
pub fn quantum(signal: &[f64]) -> Option<f64> {
    let mut levels: Vec<f64> = signal.iter().copied().filter(|v| v.is_finite()).collect();
    levels.sort_by(f64::total_cmp);
    let range = levels.last()? - levels.first()?;
    let size = levels.last()?.abs().max(levels.first()?.abs());
    // gaps below this are rounding of one and the same level
    let same = (range / MAX_QUANTA).max(64.0 * f64::EPSILON * size);
    let mut step = 0.0;
    for pair in levels.windows(2) {
        let gap = pair[1] - pair[0];
        if gap > 1e-3 * same {
            step = common_divisor(gap, step, same);
            if step <= same {
                return None;
            }
        }
    }
    let lowest = *levels.first()?;
    let misfit = |v: f64| ((v - lowest) / step - ((v - lowest) / step).round()).abs();
    let regular = step > 0.0 && levels.iter().all(|&v| misfit(v) < 0.05);
    // with as many levels as samples every set of numbers would have a "common" step
    (regular && levels.len() > 3).then_some(step)
}

/// Euclid's algorithm on numbers known to within `tolerance`.
fn common_divisor(mut a: f64, mut b: f64, tolerance: f64) -> f64 {
    while b > tolerance {
        let remainder = a % b;
        // a remainder just below b is a rounding error, not a remainder
        (a, b) = (b, if b - remainder < tolerance { 0.0 } else { remainder });
    }
    a
}

fn fourth_differences(v: &[f64]) -> Vec<f64> {
    v.windows(5).map(|w| w[4] - 4.0 * w[3] + 6.0 * w[2] - 4.0 * w[1] + w[0]).collect()
}

/// What the median of block variances is expected to be for unit variance.
fn median_bias(block: usize, blocks: usize) -> f64 {
    if blocks < 3 {
        return 1.0; // the median of one or two is the mean, which has no bias
    }
    let length = block as f64;
    let overlap: f64 =
        CORRELATION.iter().zip(1..).map(|(r, j)| (1.0 - f64::from(j) / length) * r * r).sum();
    let freedom = length / (1.0 + 2.0 * overlap);
    chi2_quantile(0.5, freedom) / freedom
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

fn lag_one(values: &[f64]) -> f64 {
    values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / sum_of_squares(values)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[half] } else { 0.5 * (sorted[half - 1] + sorted[half]) }
}

#[cfg(test)]
mod tests {
    use super::super::filter::low_pass;
    use super::super::least_squares::tests::{assert_close, lcg};
    use super::*;

    /// Sums of twelve uniform numbers: nearly normal, standard deviation one.
    fn noise(count: usize, seed: u32) -> Vec<f64> {
        lcg(12 * count, seed).chunks(12).map(|c| c.iter().sum()).collect()
    }

    /// 12 s at 100 Hz: 3 sin 2t + 0.05 noise and a jump of 2 in the middle.
    fn noisy_drive() -> Vec<f64> {
        let motion = |k: usize| 3.0 * (0.02 * k as f64).sin() + if k < 600 { 0.0 } else { 2.0 };
        noise(1200, 11).iter().enumerate().map(|(k, e)| motion(k) + 0.05 * e).collect()
    }

    #[test]
    fn noise_on_a_moving_signal_with_a_jump_equals_numpy() {
        let found = white_noise(&noisy_drive(), 100.0).unwrap();
        // numpy.diff(v, 4) in blocks of 50, scipy chi2.ppf(.5, nu)/nu
        assert_close(found.from_differences, 0.05289396033334664, 1e-9);
        assert_close(found.lag_one_correlation, -0.8016101078064304, 1e-9);
        // 23 blocks of 20 effective degrees of freedom: 4 % standard error
        assert_close(found.std_dev, 0.05, 0.12);
        assert!(found.is_white && found.quantum.is_none());
    }

    #[test]
    fn the_estimate_has_no_bias_over_many_recordings() {
        let runs = 200;
        let sigma = |seed| white_noise(&noise(1000, seed), 100.0).unwrap().from_differences;
        let mean: f64 = (0..runs).map(|i| sigma(1000 + 77 * i)).sum::<f64>() / f64::from(runs);
        // one estimate scatters by 4 %, the mean of 200 by 0.3 %
        assert_close(mean, 1.0, 0.01);
    }

    #[test]
    fn a_logger_that_filters_is_noticed() {
        let filtered = low_pass(&noisy_drive(), 2, 15.0, 100.0).unwrap();
        let found = white_noise(&filtered, 100.0).unwrap();
        assert!(!found.is_white, "lag one {}", found.lag_one_correlation);
        assert!(found.std_dev < 0.02);
    }

    #[test]
    fn a_coarse_encoder_shows_its_quantum_and_sets_the_floor() {
        let tick = std::f64::consts::TAU / 500.0;
        let round = |v: &f64| (v / tick).round() * tick + 0.1;
        let still: Vec<f64> = (0..400).map(|k| 0.03 * f64::from(k) / 100.0).collect();
        let creeping = white_noise(&still.iter().map(round).collect::<Vec<_>>(), 100.0).unwrap();
        // by hand: one tick in a block of 50 gives q/sqrt(50), less than q/sqrt(12)
        assert!(creeping.from_differences < tick / 5.0);
        assert_close(creeping.std_dev, tick / 12.0_f64.sqrt(), 1e-9);
        let coarse: Vec<f64> = noisy_drive().iter().map(round).collect();
        assert_close(white_noise(&coarse, 100.0).unwrap().quantum.unwrap(), tick, 1e-9);
        assert_eq!(quantum(&noise(500, 3)), None);
        assert_eq!(quantum(&[1.0; 9]), None);
        assert_eq!(quantum(&[]), None);
    }

    #[test]
    fn a_still_signal_has_no_noise_and_a_short_one_no_estimate() {
        let still = white_noise(&[2.0; 300], 100.0).unwrap();
        assert_eq!((still.std_dev, still.is_white), (0.0, false));
        assert!(matches!(
            white_noise(&[0.0; 53], 100.0),
            Err(MathError::TooFewSamples { found: 53, required: 54, .. })
        ));
    }
}
