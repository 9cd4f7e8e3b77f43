//! The recorded input as a pass reads it.

use super::reading::Reading;
use crate::effects::Change;
use crate::filter::prepare::Prepared;
use crate::math::mean;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{Ends, Hold, held_later};

/// Half width of the average of the input in derivatives \[s\], and its smallest number of rows: longer than
/// the response of a wheel's speed controller.
const SMOOTH: f64 = 0.06;
const FEWEST: usize = 3;
/// Largest difference of two rows that may be noise, in standard deviations of one: three of the difference.
const ALIKE: f64 = 3.0 * std::f64::consts::SQRT_2;

/// The acting input of a recording, row by row.
pub(super) struct RecordedInput {
    pub(super) acting: Vec<[f64; 2]>,
    /// The same without most of its noise.
    pub(super) smooth: Vec<[f64; 2]>,
    pub(super) by_parameter: Vec<Vec<[f64; 2]>>,
    pub(super) acts: bool,
    hold: Hold,
    shift: f64,
}

impl RecordedInput {
    pub(super) fn new(
        model: &Model,
        p: &[f64],
        prepared: &Prepared,
        hold: Hold,
        shift: f64,
        reading: Reading,
        noise: f64,
    ) -> Self {
        let r = prepared.recording;
        let (whole, mut by_parameter) = model.input_derivatives_of(r, r.torque(), p);
        if reading != Reading::Noisy {
            along_smooth_input(model, p, (r, noise), &mut by_parameter);
        }
        let acts = by_parameter.iter().any(|d| !d.is_empty());
        let acting = match reading {
            Reading::HalfRate(phase) => model.input_of(r, &r.half_rate_input(phase), p),
            Reading::Later => held_later(r, &whole, r.input_time_error()),
            _ => whole,
        };
        let smooth =
            if reading == Reading::Noisy { acting.clone() } else { smoothed(&acting, r, noise) };
        Self { acting, smooth, by_parameter, acts, hold, shift }
    }

    /// A signal at both ends of the row that ends with sample `k`, moved along its own line.
    pub(super) fn ends(&self, signal: &[[f64; 2]], k: usize) -> Ends {
        let (from, to) = (signal[k - 1], signal[k]);
        match self.hold {
            Hold::Constant => [from, from],
            Hold::Linear => {
                let moved = |x: [f64; 2]| [0, 1].map(|i| x[i] + self.shift * (to[i] - from[i]));
                [moved(from), moved(to)]
            }
        }
    }

    /// Change of the input, `signal`, over the row that ends with sample `k`: zero for a held one.
    pub(super) fn change(&self, signal: &[[f64; 2]], k: usize) -> [f64; 2] {
        match self.hold {
            Hold::Constant => [0.0; 2],
            Hold::Linear => [0, 1].map(|i| signal[k][i] - signal[k - 1][i]),
        }
    }

    /// Derivative of the input over the row by the shift.
    pub(super) fn by_shift(&self, k: usize) -> [f64; 2] {
        self.change(&self.smooth, k)
    }
}

/// Replaces derivatives by the times of shifts by those along the smoothed input.
///
/// Between two rows the noise of both is averaged, so that innovations are smallest half a row from the true shift.
/// Along the smoothed input derivatives do not follow that noise: they are instruments (Söderström and Stoica,
/// Instrumental Variable Methods for System Identification, 1983).
fn along_smooth_input(
    model: &Model,
    p: &[f64],
    (recording, noise): (&Recording, f64),
    by_parameter: &mut [Vec<[f64; 2]>],
) {
    let shifts = |e: &usize| model.effects()[*e].change() == Change::TimeShift;
    let places: Vec<usize> =
        (0..model.effects().len()).filter(shifts).flat_map(|e| model.slots(e)).collect();
    if places.is_empty() {
        return;
    }
    let smooth = smoothed(recording.torque(), recording, noise);
    let (_, mut along) = model.input_derivatives_of(recording, &smooth, p);
    places.into_iter().for_each(|j| by_parameter[j] = std::mem::take(&mut along[j]));
}

/// An input averaged over [`SMOOTH`] to either side, as far as its piece reaches. In a slow log, of which [`FEWEST`]
/// rows last longer, only rows that differ from it by no more than [`ALIKE`] standard deviations of its `noise`, as the
/// pass assumes it, and of its slow noise are averaged: steps of a command remain, and so does an input without noise.
/// Along smoothed steps the derivatives would be weak instruments.
///
/// Source: Lee, Digital image smoothing and the sigma filter, CVGIP 24 (1983).
fn smoothed(signal: &[[f64; 2]], recording: &Recording, noise: f64) -> Vec<[f64; 2]> {
    let half = ((SMOOTH / recording.step()).round() as usize).max(FEWEST);
    let slow = recording.slow_input_noise();
    let is_slow = FEWEST as f64 * recording.step() > 1.01 * SMOOTH;
    let limit = |i: usize| if is_slow { ALIKE * noise.hypot(slow[i].sigma) } else { f64::INFINITY };
    let most = [0, 1].map(limit);
    let mut out = signal.to_vec();
    for piece in recording.pieces() {
        for k in piece.clone() {
            // the same width on both sides, since the average would otherwise be shifted in time
            let reach = half.min(k - piece.start).min(piece.end - 1 - k);
            let around = &signal[k - reach..k + reach + 1];
            out[k] = [0, 1].map(|i| {
                let values = around.iter().map(|m| m[i]);
                mean(values.filter(|m| (m - signal[k][i]).abs() <= most[i]))
            });
        }
    }
    out
}
