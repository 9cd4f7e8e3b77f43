//! The error of open-loop simulations over 2 s, piece by piece: the error in the report, here on
//! held-out pieces.

use std::ops::Range;

use rayon::prelude::*;

use crate::math::{self, Moments};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{Hold, Input, WINDOW, simulate_windows};

/// Rows before a window that effects on the input look back at \[s\].
const BEFORE: f64 = 2.0;

/// Paired standard errors by which another error must be smaller than the first: one, the usual
/// rule of cross-validation (Breiman et al. 1984, section 3.4.3).
const STANDARD_ERRORS: f64 = 1.0;

/// Windows of recordings, by pieces.
pub(super) struct OpenLoop<'a> {
    pub(super) train: &'a [Recording],
    pub(super) hold: Hold,
    /// Recording and rows of each piece.
    pub(super) pieces: Vec<(usize, Range<usize>)>,
}

impl OpenLoop<'_> {
    /// Mean square error of the speeds [rad²/s²] (of the angles [rad²] where only they are
    /// measured) over the windows of every piece, each with its own parameters; infinite where the
    /// simulation diverges.
    pub(super) fn errors(&self, model: &Model, p: &[Vec<f64>]) -> Vec<f64> {
        let each = self.pieces.par_iter().zip(p);
        each.map(|(piece, p)| self.error(model, p, piece).unwrap_or(f64::INFINITY)).collect()
    }

    /// The mean over all pieces with the same parameters.
    pub(super) fn mean(&self, model: &Model, p: &[f64]) -> f64 {
        mean(&self.errors(model, &vec![p.to_vec(); self.pieces.len()]))
    }

    /// Unit of the error: of the angles where no recording has measured speeds.
    pub(super) fn unit(&self) -> &'static str {
        if self.train.iter().any(|r| r.measured().omega) { "rad/s" } else { "rad" }
    }

    fn error(&self, model: &Model, p: &[f64], (r, rows): &(usize, Range<usize>)) -> Option<f64> {
        let recording = &self.train[*r];
        let t = recording.t();
        let whole = recording.piece_of(rows.start)?;
        // the body state of a two-mass drivetrain is initialised by simulating the windows before
        let first = if model.is_coupled() { whole.start } else { rows.start };
        let from = whole.start + t[whole.start..].partition_point(|s| *s < t[first] - BEFORE);
        let acting = model.input(&t[from..rows.end], &recording.torque()[from..rows.end], p);
        let (mut sum, mut count) = (0.0, 0.0);
        let before = if first < rows.start { windows(t, &(first..rows.start)) } else { vec![] };
        let own = windows(t, rows);
        let with_start = |window: &Range<usize>| {
            (window.start - from..window.end - from, recording.start_at(window.start).state)
        };
        let all: Vec<_> = before.iter().chain(&own).map(with_start).collect();
        let input = Input { t: &t[from..rows.end], torque: &acting, hold: self.hold };
        let states = simulate_windows(model, p, &input, t[0], &all).ok()?;
        for (window, states) in own.into_iter().zip(&states[before.len()..]) {
            // a row without a new value repeats an older one
            for (k, state) in window.zip(states).filter(|(k, _)| recording.is_reading(*k)) {
                let (measured, simulated) = if recording.measured().omega {
                    (recording.omega()[k], state.omega)
                } else {
                    (recording.alpha()[k], state.alpha)
                };
                sum += (0..2).map(|i| (measured[i] - simulated[i]).powi(2)).sum::<f64>();
                count += 2.0;
            }
        }
        let mean = sum / f64::max(count, 1.0);
        mean.is_finite().then_some(mean)
    }
}

/// Windows of 2 s; a rest of less than half of it joins the last one.
fn windows(t: &[f64], rows: &Range<usize>) -> Vec<Range<usize>> {
    let seconds = t[rows.end - 1] - t[rows.start];
    let count = ((seconds / WINDOW + 0.5).floor() as usize).max(1);
    let edge = |n: usize| {
        let at = t[rows.start] + WINDOW * n as f64;
        if n == count {
            rows.end
        } else {
            rows.start + t[rows.clone()].partition_point(|s| *s < at)
        }
    };
    (0..count).map(|n| edge(n)..edge(n + 1)).filter(|window| !window.is_empty()).collect()
}

/// Mean of some errors; zero without any.
pub(super) fn mean(errors: &[f64]) -> f64 {
    if errors.is_empty() { 0.0 } else { math::mean(errors.iter().copied()) }
}

/// Whether errors are smaller than others by more than a paired standard error; any finite error is
/// smaller than an infinite one.
pub(super) fn clearly_smaller(errors: &[f64], than: &[f64]) -> bool {
    smaller_by(STANDARD_ERRORS, errors, than)
}

/// The same by a number of paired standard errors.
pub(super) fn smaller_by(standard_errors: f64, errors: &[f64], than: &[f64]) -> bool {
    if !mean(than).is_finite() {
        return mean(errors).is_finite();
    }
    let gains = Moments::of(than.iter().zip(errors).map(|(a, b)| a - b));
    // of a single piece the error is not a number
    gains.mean > standard_errors * gains.std_error()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_counts_beyond_one_paired_standard_error() {
        // gains 1, 1, 1, 5: mean 2, standard error sqrt(12/(4·3)) = 1
        let than = [5.0, 6.0, 7.0, 8.0];
        assert!(clearly_smaller(&[4.0, 5.0, 6.0, 3.0], &than));
        // gains 0, 0, 0, 4: mean 1, standard error 1
        assert!(!clearly_smaller(&[5.0, 6.0, 7.0, 4.0], &than));
        assert!(clearly_smaller(&[9.0; 4], &[1.0, f64::INFINITY, 1.0, 1.0]));
        assert!(!clearly_smaller(&[f64::INFINITY; 4], &[f64::INFINITY; 4]));
    }
}
