//! A recording approximated by straight lines over short windows, for the checks of the motion.

use std::ops::Range;

use super::super::Recording;
use crate::math::{Line, mean, rms};

/// Means and slopes of the channels over a short window, right wheel first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    /// Mean wheel speed [rad/s].
    pub(crate) speed: [f64; 2],
    /// RMS wheel speed [rad/s]: a wheel that oscillates moves although its mean speed vanishes.
    pub(crate) size: [f64; 2],
    /// Slope of the wheel speed [rad/s^2].
    pub(crate) acceleration: [f64; 2],
    /// Slope of the wheel angle [rad/s].
    pub(crate) angle_rate: [f64; 2],
    /// Mean input.
    pub(crate) torque: [f64; 2],
}

/// Channels from which windows are computed.
pub(crate) struct View<'a> {
    /// Time \[s\].
    pub(crate) t: &'a [f64],
    /// Angles \[rad\].
    pub(crate) alpha: &'a [[f64; 2]],
    /// Speeds [rad/s].
    pub(crate) omega: &'a [[f64; 2]],
    /// Inputs.
    pub(crate) torque: &'a [[f64; 2]],
    /// Ranges of rows without a gap.
    pub(crate) pieces: &'a [Range<usize>],
    /// Median step \[s\].
    pub(crate) step: f64,
    /// Number of rows per new value of the sensors.
    pub(crate) refresh: usize,
}

/// Length of a window \[s\].
const LENGTH: f64 = 0.1;
/// Number of windows for which those of a short recording are shorter: ten per coefficient of the sign's test.
const COUNT: usize = 30;
/// Smallest number of new values in a window.
const SAMPLES: usize = 8;

/// The windows of all pieces in sequence.
pub(super) fn windows(r: &Recording) -> Vec<Window> {
    windows_of(&view(r))
}

/// The same, shorter ones if the recording lasts only a few of them.
pub(super) fn short_windows(r: &Recording) -> Vec<Window> {
    short_windows_of(&view(r))
}

fn view(r: &Recording) -> View<'_> {
    View {
        t: r.t(),
        alpha: r.alpha(),
        omega: r.omega(),
        torque: r.torque(),
        pieces: r.pieces(),
        step: r.step(),
        refresh: r.rows_per_refresh(),
    }
}

/// The same for channels that are not yet a recording; empty if the time does not increase.
pub(crate) fn windows_of(v: &View) -> Vec<Window> {
    if v.step.is_nan() || v.step <= 0.0 {
        return vec![];
    }
    // the slope of a signal quantised to n steps is too small by 1/n²
    of_length(v, ((LENGTH / v.step).round() as usize).max(SAMPLES * v.refresh))
}

/// The same, shorter ones if the channels last only a few of them.
pub(crate) fn short_windows_of(v: &View) -> Vec<Window> {
    if v.step.is_nan() || v.step <= 0.0 {
        return vec![];
    }
    let rows: usize = v.pieces.iter().map(ExactSizeIterator::len).sum();
    let length = ((LENGTH / v.step).round() as usize).min(rows / COUNT);
    of_length(v, length.max(SAMPLES * v.refresh))
}

fn of_length(v: &View, length: usize) -> Vec<Window> {
    let mut out = Vec::with_capacity(v.t.len() / length);
    for piece in v.pieces {
        let mut start = piece.start;
        while start + length <= piece.end {
            out.push(window(v, start..start + length));
            start += length;
        }
    }
    out
}

fn window(v: &View, range: Range<usize>) -> Window {
    let t = &v.t[range.clone()];
    let mean = |v: &[[f64; 2]]| [0, 1].map(|i| mean(v.iter().map(|v| v[i])));
    let slope = |v: &[[f64; 2]]| {
        [0, 1].map(|i| Line::through(t.iter().zip(v).map(|(t, x)| (*t, x[i]))).slope)
    };
    let omega = &v.omega[range.clone()];
    Window {
        speed: mean(omega),
        size: [0, 1].map(|i| rms(omega.iter().map(|w| w[i]))),
        acceleration: slope(omega),
        angle_rate: slope(&v.alpha[range.clone()]),
        torque: mean(&v.torque[range]),
    }
}
