//! The step in time, and where rows are missing.

use std::ops::Range;

/// A step in time of more than this many median steps is a gap.
const GAP: f64 = 4.0;

/// Median step in time \[s\].
pub(super) fn median_step(t: &[f64]) -> f64 {
    crate::math::median(t.windows(2).map(|w| w[1] - w[0]))
}

/// Whether rows are missing between two, at that median step.
pub(crate) fn is_gap(before: f64, after: f64, step: f64) -> bool {
    after - before > GAP * step
}

/// Index ranges without a gap, in order.
pub(crate) fn pieces(t: &[f64]) -> Vec<Range<usize>> {
    let step = median_step(t);
    let mut out = Vec::new();
    let mut start = 0;
    for k in 1..t.len() {
        if is_gap(t[k - 1], t[k], step) {
            out.push(start..k);
            start = k;
        }
    }
    out.push(start..t.len());
    out
}
