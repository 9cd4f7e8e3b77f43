//! The time step, and gaps.

use std::ops::Range;

use crate::math::{median_step, quantile};

/// A time step longer than this many usual steps is a gap.
const GAP: f64 = 4.0;
/// Share of the steps that are usual: regular pauses, such as one after every eight rows, are not gaps.
const USUAL: f64 = 0.95;

/// Whether rows are missing between two times, for this usual step.
pub(crate) fn is_gap(before: f64, after: f64, step: f64) -> bool {
    after - before > GAP * step
}

/// Usual step of a logger \[s\]: the median, or longer if longer steps occur regularly.
fn usual_step(t: &[f64]) -> f64 {
    quantile(t.windows(2).map(|w| w[1] - w[0]), USUAL).max(median_step(t))
}

/// Index ranges without a gap, in order.
pub(crate) fn pieces(t: &[f64]) -> Vec<Range<usize>> {
    let step = usual_step(t);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_that_return_all_the_time_are_the_rhythm_of_the_logger() {
        // eight rows at 2 ms, then 14 ms without, and one stop of a second
        let mut t: Vec<f64> =
            (0..400).map(|k| 0.028 * f64::from(k / 8) + 0.002 * f64::from(k % 8)).collect();
        assert_eq!(pieces(&t).len(), 1);
        t[200..].iter_mut().for_each(|t| *t += 1.0);
        assert_eq!(pieces(&t), [0..200, 200..400]);
        // single rows that are missing now and then are gaps from five steps on
        let t: Vec<f64> = (0..400).filter(|k| !(200..204).contains(k)).map(f64::from).collect();
        assert_eq!(pieces(&t), [0..200, 200..396]);
    }
}
