//! The values of a column: their range and their kind.

use crate::io::PreviewColumn;
use crate::math::quantile;

/// Share of the rows that stay below the top of a signal; isolated wrong samples and the wraps of a counter are above.
const NEARLY_ALL: f64 = 0.98;

/// The values of a column; none where no column has that name.
pub(super) fn values_of<'a>(columns: &'a [PreviewColumn], name: &str) -> &'a [f64] {
    columns.iter().find(|c| c.name == name).map_or(&[], |c| &c.values)
}

/// Whether no value is negative.
pub(super) fn is_never_negative(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_nan() || *v >= 0.0)
}

pub(super) fn is_constant(values: &[f64]) -> bool {
    let mut held = values.iter().filter(|v| v.is_finite());
    let first = held.next();
    held.all(|v| Some(v) == first)
}

/// Whether a column holds one value and no other, in all recordings.
pub(super) fn never_varies(column: &PreviewColumn) -> bool {
    !column.varies && is_constant(&column.values)
}

/// Marks the columns that hold one value in the first recording, and another one in that with the columns `others`.
pub(in crate::experiment) fn mark_varying(columns: &mut [PreviewColumn], others: &[PreviewColumn]) {
    let first = |values: &[f64]| values.iter().copied().find(|v| v.is_finite());
    for column in columns.iter_mut().filter(|c| is_constant(&c.values)) {
        let other = others.iter().find(|c| c.name == column.name);
        column.varies |= other.is_some_and(|other| {
            !is_constant(&other.values) || first(&other.values) != first(&column.values)
        });
    }
}

/// Adds values and words of a further recording with the columns `others` to the columns of the same names. All get the
/// same number of rows, so that the values of a row stay together.
pub(in crate::experiment) fn add_recording(
    columns: &mut [PreviewColumn],
    others: &[PreviewColumn],
) {
    let rows = others.iter().map(|c| c.values.len()).max().unwrap_or_default();
    for column in columns {
        let end = column.elsewhere.len() + rows;
        if let Some(other) = others.iter().find(|c| c.name == column.name) {
            column.elsewhere.extend(&other.values);
            column.words_elsewhere.extend(other.words.iter().cloned());
        }
        column.elsewhere.resize(end, f64::NAN);
    }
}

/// The values of a column in all recordings, one after the other.
pub(super) fn all_values(column: &PreviewColumn) -> Vec<f64> {
    [&column.values[..], &column.elsewhere].concat()
}

/// The different words of a column in all recordings.
pub(super) fn all_words(column: &PreviewColumn) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    for word in column.words.iter().chain(&column.words_elsewhere) {
        if !out.contains(word) {
            out.push(word.clone());
        }
    }
    out
}

/// Whether a column increases in nearly all rows.
pub(super) fn increases(values: &[f64]) -> bool {
    let up = values.windows(2).filter(|w| w[1] > w[0]).count();
    values.len() > 2 && 20 * up > 19 * (values.len() - 1)
}

/// The smallest and the largest of the values and zero.
pub(super) fn extent(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().copied().filter(|v| v.is_finite());
    finite.fold((0.0, 0.0), |(a, b): (f64, f64), v| (a.min(v), b.max(v)))
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|v| v.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()))
}

/// The magnitude that nearly all values stay below.
pub(super) fn top_of(values: &[f64]) -> f64 {
    quantile(values.iter().map(|v| v.abs()).filter(|v| v.is_finite()), NEARLY_ALL)
}

/// Numbers from here on are shown with an exponent.
const LONG: f64 = 1e7;

/// A number with so many decimals, or with an exponent where its digits would fill the line.
pub(super) fn short(value: f64, decimals: usize) -> String {
    if value.abs() < LONG { format!("{value:.decimals$}") } else { format!("{value:.3e}") }
}

pub(super) fn whole(values: &[f64]) -> bool {
    values.iter().all(|v| !v.is_finite() || v.fract() == 0.0)
}

/// Whether values rise and never fall.
pub(super) fn never_falls(values: &[f64]) -> bool {
    let held: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    held.first() < held.last() && held.windows(2).all(|w| w[0] <= w[1])
}
