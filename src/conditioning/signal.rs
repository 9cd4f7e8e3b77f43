//! Statistics of a signal that several steps use.

use crate::math::noise::white_noise_variance;
pub(super) use crate::math::{median_high, median_step, quantile};
pub(super) use crate::recording::{FEW_LEVELS, pieces};

/// One wheel of a pair of columns.
pub(super) fn column(rows: &[[f64; 2]], i: usize) -> Vec<f64> {
    rows.iter().map(|v| v[i]).collect()
}

/// Whether every row is later than that before.
pub(super) fn is_increasing(t: &[f64]) -> bool {
    t.windows(2).all(|w| w[0] < w[1])
}

/// Number of values that a channel takes.
pub(super) fn levels(rows: &[[f64; 2]], i: usize) -> usize {
    let mut values = column(rows, i);
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.len()
}

/// Rows of a channel that differ from the row before, and the first one: the measurements of a
/// sensor slower than the rows.
pub(super) fn changes(values: &[f64]) -> Vec<usize> {
    (0..values.len()).filter(|&k| k == 0 || values[k] != values[k - 1]).collect()
}

/// Variance of the white noise on a channel; NaN for fewer than five samples.
pub(super) fn noise_variance(values: &[f64]) -> f64 {
    white_noise_variance(&[values.to_vec()], BLOCK, 1, |_| true).unwrap_or(f64::NAN)
}

/// Samples per block: few compared with a run, so that starts and steps affect few blocks (chosen by
/// judgement).
const BLOCK: usize = 36;
