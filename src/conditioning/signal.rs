//! Small measures of a signal that several steps use.

pub(super) use crate::math::{median, quantile};
pub(super) use crate::recording::{FEW_LEVELS, pieces};

/// One wheel of a pair of columns.
pub(super) fn column(rows: &[[f64; 2]], i: usize) -> Vec<f64> {
    rows.iter().map(|v| v[i]).collect()
}

/// Number of values that a channel takes.
pub(super) fn levels(rows: &[[f64; 2]], i: usize) -> usize {
    let mut values = column(rows, i);
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.len()
}

/// Rows of a channel that differ from the row before, with the first one: what a sensor that is
/// slower than the rows has measured.
pub(super) fn changes(values: &[f64]) -> Vec<usize> {
    (0..values.len()).filter(|&k| k == 0 || values[k] != values[k - 1]).collect()
}

/// Variance of white noise from fourth differences, the median over blocks: smooth motion leaves
/// nothing, and starts and steps touch few blocks.
pub(super) fn noise_variance(values: &[f64]) -> f64 {
    let differences: Vec<f64> = values
        .windows(5)
        .map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2) / 70.0)
        .collect();
    median(differences.chunks(BLOCK).map(|b| b.iter().sum::<f64>() / b.len() as f64))
}

/// Differences of a block.
const BLOCK: usize = 32;
