//! The values of a column: their range and their kind.

use crate::io::PreviewColumn;

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

pub(super) fn whole(values: &[f64]) -> bool {
    values.iter().all(|v| !v.is_finite() || v.fract() == 0.0)
}
