//! A recording as straight lines over short windows: what the checks of motion look at.

use std::ops::Range;

use super::super::Recording;

/// Means and slopes of the channels over a short window, right wheel first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Mean wheel speed [rad/s].
    pub(super) speed: [f64; 2],
    /// Slope of the wheel speed [rad/s^2].
    pub(super) acceleration: [f64; 2],
    /// Slope of the wheel angle [rad/s].
    pub(super) angle_rate: [f64; 2],
    /// Mean drive.
    pub(super) moment: [f64; 2],
}

/// Length of a window [s].
const LENGTH: f64 = 0.1;
/// Fewest samples of a window.
const SAMPLES: usize = 8;

/// The windows of all pieces, one behind the other.
pub(super) fn windows(r: &Recording) -> Vec<Window> {
    let length = ((LENGTH / r.step()).round() as usize).max(SAMPLES);
    let mut out = Vec::with_capacity(r.len() / length);
    for piece in r.pieces() {
        let mut start = piece.start;
        while start + length <= piece.end {
            out.push(window(r, start..start + length));
            start += length;
        }
    }
    out
}

fn window(r: &Recording, range: Range<usize>) -> Window {
    let t = &r.t()[range.clone()];
    let middle = t.iter().sum::<f64>() / t.len() as f64;
    let mean =
        |v: &[[f64; 2]]| [0, 1].map(|i| v.iter().map(|v| v[i]).sum::<f64>() / t.len() as f64);
    let square: f64 = t.iter().map(|t| (t - middle).powi(2)).sum();
    let slope = |v: &[[f64; 2]]| {
        // from the first value, so that large angles lose no digits
        [0, 1].map(|i| {
            t.iter().zip(v).map(|(t, x)| (t - middle) * (x[i] - v[0][i])).sum::<f64>() / square
        })
    };
    let omega = &r.omega()[range.clone()];
    Window {
        speed: mean(omega),
        acceleration: slope(omega),
        angle_rate: slope(&r.alpha()[range.clone()]),
        moment: mean(&r.moment()[range]),
    }
}
