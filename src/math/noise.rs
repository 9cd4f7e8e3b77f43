//! Noise of a sampled signal, estimated from the signal alone.

use super::distribution::chi2_quantile;
use super::order::median;

/// C(8, 4): fourth differences of white noise have this many times its variance.
const GAIN: f64 = 70.0;
/// Autocorrelation of fourth differences of white noise at lags 1 to 4.
const CORRELATION: [f64; 4] = [-56.0 / 70.0, 28.0 / 70.0, -8.0 / 70.0, 1.0 / 70.0];
/// Number of samples in a fourth difference.
const SPAN: usize = 5;
/// A signal is quantised if this share of its neighbours are equal; continuous noise has none.
const EQUAL_SHARE: f64 = 0.05;
/// Share of the changes that must be whole multiples of the quantum; the rest may be outliers.
const MULTIPLE_SHARE: f64 = 0.95;
/// How far a change may be from a multiple, as a share of itself: numbers printed with few digits.
const PRINTED: f64 = 0.02;
/// How far a value may be from a multiple, in steps: a continuous signal has one value in five within it.
const ROUNDED: f64 = 0.1;

/// Variance of the white noise on smooth signals, from their fourth differences.
///
/// ```text
/// s_b^2 = mean over block b of (v_k - 4 v_(k-1) + 6 v_(k-2) - 4 v_(k-3) + v_(k-4))^2 / 70
/// sigma^2 = median_b s_b^2 / m,   m = median(chi2_n)/n,   n = B / (1 + 2 sum_j (1 - j/B) rho_j^2)
/// ```
///
/// Fourth differences of a cubic are zero, so smooth motion does not contribute; the median over blocks is
/// insensitive to starts and reversals, and m corrects its bias (-3 % of sigma² at 20 degrees of freedom).
/// `runs` are stretches of equidistant samples without gaps, divided into blocks of `block` samples; a last
/// block of at least `least` samples is used too. `keep` decides from the variance of a block whether it is
/// used. `None` if no block is used.
///
/// Source: J. von Neumann et al., Ann. Math. Statist. 12 (1941) for differences; the median of blocks and its
/// correction are derived here.
pub fn white_noise_variance(
    runs: &[Vec<f64>],
    block: usize,
    least: usize,
    keep: impl Fn(f64) -> bool,
) -> Option<f64> {
    let least = least.max(SPAN);
    let mut lengths = Vec::new();
    let mut variances = Vec::new();
    for part in runs.iter().flat_map(|run| run.chunks(block.max(least))) {
        if part.len() < least {
            continue;
        }
        let d = fourth_differences(part);
        let variance = sum_of_squares(&d) / (GAIN * d.len() as f64);
        if keep(variance) {
            lengths.push(d.len() as f64);
            variances.push(variance);
        }
    }
    let bias = median_bias(median(lengths), variances.len());
    (!variances.is_empty()).then(|| median(variances) / bias)
}

/// Correlation of neighbouring fourth differences: -0.8 for white noise, larger if a logger has filtered the
/// signal. `None` if the signal is constant.
#[must_use]
pub fn fourth_difference_correlation(runs: &[Vec<f64>]) -> Option<f64> {
    let (mut product, mut square) = (0.0, 0.0);
    for run in runs {
        let d = fourth_differences(run);
        product += d.windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        square += sum_of_squares(&d);
    }
    (square > 0.0).then(|| product / square)
}

/// The smallest non-zero change between neighbours, or `None` if the signal is constant.
#[must_use]
pub fn smallest_change(signal: &[f64]) -> Option<f64> {
    let changes = signal.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0);
    changes.min_by(f64::total_cmp)
}

/// The step of a quantised signal: one neighbour in 20 is equal or more, and 19 changes in 20 are
/// whole multiples of the smallest one. None if the signal is not quantised.
///
/// A rounding error of uniform distribution has the standard deviation q / sqrt 12.
///
/// # Examples
/// ```
/// use amigo_ident::math::noise::quantum;
/// let tick = 0.02;
/// let counts = [3, 3, 4, 4, 6, 7, 7, 4].repeat(10);
/// let encoder: Vec<f64> = counts.into_iter().map(|n| 0.5 + tick * f64::from(n)).collect();
/// assert!((quantum(&encoder).unwrap() - tick).abs() < 1e-12);
/// assert_eq!(quantum(&[0.1, 0.25, 0.31, 0.7]), None);
/// ```
#[must_use]
pub fn quantum(signal: &[f64]) -> Option<f64> {
    let equal = signal.windows(2).filter(|w| w[1] == w[0]).count();
    if (equal as f64) < EQUAL_SHARE * signal.len() as f64 { None } else { grid(signal) }
}

/// The step of a quantised signal, which may change in every row: one on which 19 of 20 values lie, or the smallest
/// change if 19 of 20 changes are multiples of it. Values printed with few digits have changes on both sides of the
/// step (2.0 and 2.1 for 2.08).
pub(crate) fn grid(signal: &[f64]) -> Option<f64> {
    let least = smallest_change(signal)?;
    of_values(signal, least).or_else(|| of_changes(signal, least).then_some(least))
}

/// Whether 19 of 20 changes are multiples of the smallest one.
fn of_changes(signal: &[f64], least: f64) -> bool {
    let multiple = |w: &&[f64]| {
        let ratio = (w[1] - w[0]).abs() / least;
        (ratio - whole(ratio)).abs() < PRINTED * ratio.max(1.0)
    };
    let multiples = signal.windows(2).filter(multiple).count();
    multiples as f64 > MULTIPLE_SHARE * signal.len() as f64
}

/// The step, near the smallest change `least`, on which 19 of 20 values lie, counted from the first.
fn of_values(signal: &[f64], least: f64) -> Option<f64> {
    let mut changes: Vec<f64> = signal.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let mut ways: Vec<f64> = signal.iter().map(|v| (v - signal[0]).abs()).collect();
    for sizes in [&mut changes, &mut ways] {
        sizes.retain(|size| *size > 0.0);
        sizes.sort_unstable_by(f64::total_cmp);
    }
    let step = step_of_grid(&ways, step_of_grid(&changes, least));
    let on = |way: &&f64| {
        let ratio = *way / step;
        (ratio - whole(ratio)).abs() < ROUNDED
    };
    let share = ways.iter().filter(on).count() as f64 / ways.len() as f64;
    (share > MULTIPLE_SHARE).then_some(step)
}

/// The step, near `step`, of a grid on which `sizes`, ascending, lie: larger multiples determine it more accurately.
pub(crate) fn step_of_grid(sizes: &[f64], mut step: f64) -> f64 {
    let mut reach = 4.0;
    let largest = sizes.last().copied().unwrap_or(0.0);
    while reach < 2.0 * largest / step {
        let near = sizes.iter().take_while(|d| **d < (reach + 0.5) * step);
        let (size, square) = near.fold((0.0, 0.0), |(size, square), d| {
            let n = whole(d / step);
            (size + n * d, square + n * n)
        });
        if square > 0.0 {
            step = size / square;
        }
        reach *= 2.0;
    }
    step
}

/// [`f64::round`] of a number that is not negative, without the call that this is where the processor may have no
/// instruction for it: there is no fraction beyond 2^52.
fn whole(x: f64) -> f64 {
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    if !(x < WHOLE) {
        return x;
    }
    // halves are rounded to even numbers
    let near = (x + WHOLE) - WHOLE;
    if x - near == 0.5 { near + 1.0 } else { near }
}

fn fourth_differences(v: &[f64]) -> Vec<f64> {
    v.windows(SPAN).map(|w| w[4] - 4.0 * w[3] + 6.0 * w[2] - 4.0 * w[1] + w[0]).collect()
}

/// Median of this many block variances of `length` differences each, for unit variance.
fn median_bias(length: f64, blocks: usize) -> f64 {
    if blocks < 3 {
        return 1.0; // the median of one or two is the mean, which has no bias
    }
    let overlap: f64 =
        CORRELATION.iter().zip(1..).map(|(r, j)| (1.0 - f64::from(j) / length) * r * r).sum();
    let freedom = length / (1.0 + 2.0 * overlap);
    chi2_quantile(0.5, freedom) / freedom
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

#[cfg(test)]
mod tests {
    use super::super::filter::tests::low_pass;
    use super::super::least_squares::tests::{assert_close, lcg};
    use super::*;

    /// Sums of twelve uniform numbers: nearly normal, standard deviation one.
    fn noise(count: usize, seed: u32) -> Vec<f64> {
        lcg(12 * count, seed).chunks(12).map(|c| c.iter().sum()).collect()
    }

    /// 12 s at 100 Hz: 3 sin 2t + 0.05 noise and a jump of 2 in the middle.
    fn noisy_input() -> Vec<f64> {
        let motion = |k: usize| 3.0 * (0.02 * k as f64).sin() + if k < 600 { 0.0 } else { 2.0 };
        noise(1200, 11).iter().enumerate().map(|(k, e)| motion(k) + 0.05 * e).collect()
    }

    fn sigma(signal: Vec<f64>) -> f64 {
        white_noise_variance(&[signal], 50, 12, |_| true).unwrap().sqrt()
    }

    #[test]
    fn noise_on_a_moving_signal_with_a_jump_equals_numpy() {
        let runs = [noisy_input()];
        // numpy: v in blocks of 50, numpy.diff(block, 4), median, scipy chi2.ppf(.5, nu)/nu
        assert_close(sigma(runs[0].clone()), 0.05241119178992415, 1e-9);
        // the same over the whole run: d[1:] @ d[:-1] / (d @ d)
        assert_close(fourth_difference_correlation(&runs).unwrap(), -0.8021611982981154, 1e-9);
        // 24 blocks of 18 effective degrees of freedom: 4 % standard error
        assert_close(sigma(runs[0].clone()), 0.05, 0.12);
    }

    #[test]
    fn the_estimate_has_no_bias_over_many_recordings() {
        let runs = 200;
        let mean: f64 =
            (0..runs).map(|i| sigma(noise(1000, 1000 + 77 * i))).sum::<f64>() / f64::from(runs);
        // one estimate scatters by 4 %, the mean of 200 by 0.3 %
        assert_close(mean, 1.0, 0.01);
    }

    #[test]
    fn a_logger_that_filters_raises_the_correlation_and_hides_noise() {
        let filtered = low_pass(&noisy_input(), 2, 15.0, 100.0);
        assert!(fourth_difference_correlation(std::slice::from_ref(&filtered)).unwrap() > -0.6);
        assert!(sigma(filtered) < 0.02);
    }

    #[test]
    fn an_encoder_has_its_quantum_also_when_printed_with_three_digits() {
        let tick = std::f64::consts::TAU / 500.0;
        let angle: Vec<f64> = (0..400).map(|k| (0.004 * f64::from(k)).sin()).collect();
        let ticks: Vec<f64> = angle.iter().map(|a| (a / tick).round() * tick + 0.1).collect();
        assert_close(quantum(&ticks).unwrap(), tick, 1e-9);
        let printed: Vec<f64> = ticks.iter().map(|a| (a * 1e4).round() * 1e-4).collect();
        // 12.6e-3 appears as 12.5 to 12.6e-3
        assert_close(quantum(&printed).unwrap(), tick, 0.01);
        // steps of 2.083 printed with one digit: changes of 2.0, 2.1, 4.1, 4.2, ...
        let speed = |k: u32| (40.0 * (0.02 * f64::from(k)).sin() / 2.083).round() * 2.083;
        let coarse: Vec<f64> = (0..600).map(|k| (speed(k) * 10.0).round() / 10.0).collect();
        assert_close(quantum(&coarse).unwrap(), 2.083, 1e-3);
        assert_eq!(quantum(&noise(500, 3)), None);
        assert_eq!(quantum(&[1.0; 9]), None);
        assert_eq!(quantum(&[]), None);
    }

    #[test]
    fn numbers_are_rounded_as_by_the_standard_library() {
        let below = 0.5_f64.next_down();
        let some = [0.0, below, 0.5, 0.5_f64.next_up(), 1.0, 1.5, 2.5, 3.499, 1e15 + 0.5];
        for x in some.into_iter().chain([4_503_599_627_370_495.5, 1e16, 1e300, f64::INFINITY]) {
            assert_eq!(whole(x), x.round(), "{x}");
        }
        assert!(whole(f64::NAN).is_nan());
    }

    #[test]
    fn a_signal_too_short_or_still_has_no_estimate() {
        assert_eq!(white_noise_variance(&[vec![0.0; 11]], 50, 12, |_| true), None);
        assert_eq!(white_noise_variance(&[vec![2.0; 300]], 50, 12, |v| v > 0.0), None);
        assert_eq!(white_noise_variance(&[vec![2.0; 300]], 50, 12, |_| true), Some(0.0));
        assert_eq!(fourth_difference_correlation(&[vec![2.0; 300]]), None);
    }
}
