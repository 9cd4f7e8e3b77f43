//! A window of a recording, and how recordings are cut into windows.

use std::ops::Range;
use std::sync::Arc;

use crate::diagnose::thresholds::THRESHOLDS;
use crate::recording::Recording;
use crate::robot::State;

/// Smallest number of rows of a window.
const FEWEST: usize = 5;

/// One window of a recording.
#[derive(Clone, Debug)]
pub struct Window {
    /// Index among the recordings.
    pub recording: usize,
    /// Rows of that recording, from the start of the window.
    pub rows: Range<usize>,
    /// Smoothed state at the first row.
    pub start: State,
    /// Variance of its speeds [rad^2/s^2].
    pub(super) variance: [f64; 2],
    /// Factor on the weight of each wheel, one if the input between the rows has little effect.
    pub(super) share: [f64; 2],
    /// Where an error of the start grows, the response of the speed of each wheel to the initial speeds, by row and
    /// wheel; `None` where it persists.
    pub(super) growing: Option<Arc<[[[f64; 2]; 2]]>>,
}

impl Window {
    /// Response of the simulated speed of a wheel in row `k` to the initial speeds of both; an error of the start that
    /// persists does so until the wheel `rests`.
    pub(super) fn response(&self, k: usize, wheel: usize, rests: bool) -> [f64; 2] {
        match &self.growing {
            Some(rows) => rows[k][wheel],
            None if rests => [0.0; 2],
            None => std::array::from_fn(|i| f64::from(u8::from(i == wheel))),
        }
    }
}

/// The windows of a piece: equal parts of about 1 s, or longer at low rates, with at least twice the smallest
/// number of rows.
pub(super) fn cut(
    recording: &Recording,
    piece: &Range<usize>,
) -> impl Iterator<Item = Range<usize>> {
    let t = recording.t();
    let length = t[piece.end - 1] - t[piece.start];
    let slow = 2.0 * FEWEST as f64 * recording.step();
    let count = (length / THRESHOLDS.window_s.max(slow)).round().max(1.0) as usize;
    let edge = {
        let (start, t) = (t[piece.start], t[piece.clone()].to_vec());
        let first = piece.start;
        move |n: usize| {
            first + t.partition_point(|now| now - start < length * n as f64 / count as f64)
        }
    };
    let end = piece.end;
    let ranges = (0..count).map(move |n| edge(n)..if n + 1 == count { end } else { edge(n + 1) });
    ranges.filter(|rows| rows.len() >= FEWEST)
}

/// Called with a row of a window: its number, the wheel, the error, its derivatives and whether the
/// simulated wheel rests.
pub(super) type See<'a> = &'a mut dyn FnMut(usize, usize, f64, &[f64], bool);
