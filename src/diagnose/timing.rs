//! When the recorded input acts: one signed shift against the motion.
//!
//! A logger that averages the input over a row, holds it, or differences an encoder moves the input
//! against the motion by up to half a row. That is timing, not physics; what is later than that is a delay
//! of the actuator.

use super::input_timing::later;
use super::regression::{Regression, cutoff};
use super::scale::scale_of;
use super::windows::mobility;
use crate::model::Model;
use crate::recording::Recording;

/// Largest delay that logging explains, in rows: the mean over a row, a value that is held through it, and a
/// difference of angles all lie half a row off.
pub(super) const LOGGING: f64 = 0.5;
/// Range of the search, in rows, and its resolution.
pub(super) const EARLIEST: f64 = -1.5;
const RESOLUTION: f64 = 0.1;
/// Longest delay that is searched [s], that of slow motor controllers on a bus.
const LONGEST: f64 = 0.15;
/// Shift that does not matter, in rows: a tenth of what logging explains.
const NEGLIGIBLE: f64 = 0.05;
/// Standard errors within which a delay may still be none, or one that logging explains.
pub(super) const UNCERTAIN: f64 = 2.0;

/// How much later the recorded input acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Timing {
    /// Time from the recorded input to the motion, dead time of actuator and sensors together [s].
    pub dead_time_s: f64,
    /// Its standard error [s].
    pub std_error_s: f64,
    /// The part of it that logging explains and that is taken out of the recordings [s].
    pub correction_s: f64,
}

/// Estimates the shift of the input of `recordings` against the motion, with a model at `p`: the minimum of
/// the residual of a low-passed regression of the input on the free parameters.
///
/// ```text
/// minimise RSS(T),   se² = 2 RSS/(n RSS''),   n = 2 fc (time of motion)
/// ```
/// `None` where the motion does not carry it.
#[must_use]
pub fn timing(model: &Model, p: &[f64], recordings: &[&Recording]) -> Option<Timing> {
    let step = recordings.iter().map(|r| r.step()).fold(0.0, f64::max);
    let mobility = mobility(model, p);
    let cutoff = cutoff(recordings, mobility);
    let scale = scale_of(model, p, recordings, cutoff);
    let regression = Regression::new(model, p, recordings, cutoff, scale.speed)?;
    let at = |shift: f64| regression.square_at_shift(shift);
    let latest = (LONGEST / step).ceil().max(-EARLIEST);
    // coarse over the whole range, fine around the lowest
    let coarse = |k: usize| (EARLIEST + 0.5 * k as f64) * step;
    let count = ((latest - EARLIEST) / 0.5).ceil() as usize + 1;
    let squares: Vec<f64> = (0..count).map(|k| at(coarse(k))).collect();
    let lowest = (0..count).min_by(|a, b| squares[*a].total_cmp(&squares[*b]))?;
    let (middle, h) = (coarse(lowest), RESOLUTION * step);
    let fine = |k: i32| middle + f64::from(k) * h;
    let (mut best, mut least) = (middle, squares[lowest]);
    for k in -4..=4 {
        let square = at(fine(k));
        if square < least {
            (best, least) = (fine(k), square);
        }
    }
    let (before, after) = (at(best - h), at(best + h));
    let bend = (before - 2.0 * least + after) / (h * h);
    if !(bend > 0.0 && least > 0.0) {
        return None;
    }
    let dead_time_s =
        best + 0.5 * h * (before - after) / (before - 2.0 * least + after).max(1e-300);
    let std_error_s = (2.0 * least / (regression.degrees * bend)).sqrt();
    let late = dead_time_s - UNCERTAIN * std_error_s > LOGGING * step;
    let nothing = dead_time_s.abs() < (NEGLIGIBLE * step).max(UNCERTAIN * std_error_s);
    let correction_s =
        if late || nothing { 0.0 } else { dead_time_s.clamp(EARLIEST * step, LOGGING * step) };
    Some(Timing { dead_time_s, std_error_s, correction_s })
}

/// A signal of a recording `shift` seconds later, by cubic interpolation between its rows; the ends of every
/// piece are held.
#[must_use]
pub fn shifted(recording: &Recording, signal: &[[f64; 2]], shift: f64) -> Vec<[f64; 2]> {
    let pieces = recording.pieces().iter();
    pieces.flat_map(|p| later(&recording.t()[p.clone()], &signal[p.clone()], shift)).collect()
}
