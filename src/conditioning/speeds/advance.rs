//! Speeds that are read later by their lag.

use super::super::Conditioned;
use super::super::cells::keep;
use super::super::signal::{median_step, pieces};
use crate::math::Line;

/// Reads each wheel's speed later by its lag \[s\]: whole rows by moving it, the rest by the acceleration around, so that the
/// noise of each speed stays its own.
pub(super) fn advance(work: &mut Conditioned, lags: [f64; 2], full_rate: bool) {
    let t = work.channels.t.clone();
    let step = median_step(&t);
    let rows = lags.map(|lag| (lag / step).round() as isize);
    // between the values of a slow sensor there is no slope
    let rest = |i: usize| if full_rate { lags[i] - rows[i] as f64 * step } else { 0.0 };
    let Some(omega) = &work.channels.omega else { return };
    let mut out = omega.clone();
    let mut there = vec![true; t.len()];
    for piece in pieces(&t) {
        for (k, i) in piece.clone().flat_map(|k| [(k, 0), (k, 1)]) {
            let source = k.checked_add_signed(rows[i]).filter(|source| piece.contains(source));
            let Some(source) = source else {
                there[k] = false;
                continue;
            };
            let near = source.saturating_sub(AROUND).max(piece.start)
                ..(source + AROUND + 1).min(piece.end);
            out[k][i] = omega[source][i] + rest(i) * slope(&t, omega, near, i);
        }
    }
    work.channels.omega = Some(out);
    // the ends of pieces have no speed of their time
    if rows != [0; 2] {
        keep(&mut work.channels, &there);
    }
}

/// Samples to either side of the acceleration: its noise adds less than a fiftieth to that of the
/// speed.
const AROUND: usize = 3;

/// Slope of a line through the speeds.
fn slope(t: &[f64], omega: &[[f64; 2]], rows: std::ops::Range<usize>, i: usize) -> f64 {
    let slope = Line::through(rows.map(|k| (t[k], omega[k][i]))).slope;
    if slope.is_finite() { slope } else { 0.0 }
}
