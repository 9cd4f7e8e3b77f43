//! The filter with a memory of a given length: from one-step prediction (no memory beyond the noise
//! of the channels) towards free simulation.

mod between_rows;
mod reading;
mod recorded_input;
#[cfg(test)]
mod tests;

use std::ops::Range;

use rayon::prelude::*;

use self::between_rows::{crossing, whole_noise};
pub(crate) use self::reading::Reading;
use self::recorded_input::RecordedInput;
use super::ProcessNoise;
use super::coupled::Coupled;
use super::dynamics::Dynamics;
use super::exact::Exact;
use super::prepare::Prepared;
use super::run::{Drive, EXACT, InputSlopes, Run, Start, Sums};
use super::sample::{Predicted, Sample, lag_of_angle};
use crate::model::base::{A1, A2};
use crate::model::{Model, ModelError};
use crate::recording::{LocalMotion, Recording};
use crate::simulate::{Ends, Hold};

/// Length of a piece, which the filter starts anew \[s\]: long against any horizon, short enough
/// for several of them in every recording.
const PIECE: f64 = 5.0;
/// Length of the blocks whose scores are kept apart \[s\], and how many there should be: long
/// against the memory of the filter, so that scores of different blocks are independent.
const BLOCK: (f64, f64) = (2.0, 5.0);
const BLOCKS: f64 = 20.0;

/// A stretch of rows over which the filter runs on its own.
pub(crate) struct Piece {
    /// Number of the recording.
    pub(crate) recording: usize,
    pub(crate) rows: Range<usize>,
    start: LocalMotion,
    blocks: usize,
}

/// The filter over recordings with the noise levels of the channels.
///
/// ```text
/// R_angle = s_a² + q T⁴/(4 D),   R_speed = s_w² + q T²/D,   q = s_M² D / a1²
/// ```
/// D is the interval between new measured values, T the horizon: the time over which noise of the
/// input causes an error equal to the assumed measurement error. T = 0 is maximum likelihood.
/// The noise levels are not estimated, so they cannot absorb missing effects.
///
/// The unknown input between its rows is noise of each row; a held input is known there. With `alike` and a horizon its
/// mean over all rows of all recordings is used in every row, in s_M: if the model is known to be incomplete, rows with
/// a changing input (starts, reversals) must not have a lower weight.
pub(crate) struct HorizonFilter<'a> {
    pub(crate) prepared: &'a [Prepared<'a>],
    /// The input between rows.
    pub(crate) hold: Hold,
    pub(crate) pieces: Vec<Piece>,
    /// Variance of friction that may reverse within the row, of every row [N^2 m^2].
    crossing: Vec<Vec<[f64; 4]>>,
    /// Inertia of a wheel for which the horizon is converted to noise.
    inertia: f64,
    /// Standard deviation of the input, including its unknown values between rows [N m].
    whole_noise: f64,
    /// Whether the noise of the input is the same in all rows, if there is a horizon.
    pub(crate) alike: bool,
}

impl<'a> HorizonFilter<'a> {
    /// `p`: parameters near those sought, for the size of friction and inertia.
    pub(crate) fn new(prepared: &'a [Prepared<'a>], hold: Hold, model: &Model, p: &[f64]) -> Self {
        let total: f64 = prepared.iter().map(|p| p.recording.covered()).sum();
        let length = (total / BLOCKS).clamp(BLOCK.0, BLOCK.1);
        let piece = |(recording, rows): (usize, Range<usize>)| {
            let r = prepared[recording].recording;
            let (t, start) = (r.t(), r.local_motion()[rows.start]);
            let seconds = t[rows.end - 1] - t[rows.start];
            let blocks = (seconds / length).round().max(1.0) as usize;
            Piece { recording, start, blocks, rows }
        };
        let recordings: Vec<&Recording> = prepared.iter().map(|p| p.recording).collect();
        let pieces = pieces(&recordings).into_iter().map(piece).collect();
        let crossing = prepared.iter().map(|r| crossing(r, hold, model, p)).collect();
        // both inputs of a single axis move it together
        let single = recordings.iter().all(|r| r.is_single_axis());
        let inertia = if single { p[A1] + p[A2] } else { p[A1] };
        let whole_noise = whole_noise(prepared, hold);
        Self { prepared, hold, pieces, crossing, inertia, whole_noise, alike: false }
    }

    /// Whether the input has noise, without which every horizon is the same.
    pub(crate) fn has_memory(&self) -> bool {
        (0..self.prepared.len()).any(|r| self.input_noise(r, self.alike) > 0.0)
    }

    /// Standard deviation of the input of a recording [N m]: its own, or, if rows count `alike`, that of all
    /// recordings including the unknown input between rows.
    fn input_noise(&self, r: usize, alike: bool) -> f64 {
        if alike { self.whole_noise } else { self.prepared[r].torque_noise }
    }

    /// Variances of (alpha1, alpha2, omega1, omega2) at a horizon \[s\].
    fn variance(&self, r: usize, horizon: f64) -> [f64; 4] {
        let (prepared, recording) = (&self.prepared[r], self.prepared[r].recording);
        let refresh = recording.reading_interval();
        let q = (self.input_noise(r, self.alike) / self.inertia).powi(2) * refresh;
        let more = [q * horizon.powi(4) / (4.0 * refresh), q * horizon.powi(2) / refresh];
        std::array::from_fn(|i| prepared.variance[i] + more[i / 2])
    }

    /// One pass over every piece, side by side: parameters `p`, input `shift` rows early.
    ///
    /// # Errors
    /// If the mass matrix is not positive definite.
    pub(crate) fn pass(
        &self,
        model: &Model,
        p: &[f64],
        shift: f64,
        horizon: f64,
        reading: Reading,
    ) -> Result<Vec<Sums>, ModelError> {
        let alike = self.alike && horizon > 0.0;
        let input = |(r, prepared): (usize, &Prepared)| {
            let noise = self.input_noise(r, alike);
            RecordedInput::new(model, p, prepared, self.hold, shift, reading, noise)
        };
        let inputs: Vec<RecordedInput> = self.prepared.iter().enumerate().map(input).collect();
        let variances: Vec<[f64; 4]> =
            (0..self.prepared.len()).map(|r| self.variance(r, horizon)).collect();
        let singles: Vec<bool> =
            self.prepared.iter().map(|p| p.recording.is_single_axis()).collect();
        let of_piece = |piece: &Piece| {
            let r = piece.recording;
            let of = Stretch {
                piece,
                prepared: &self.prepared[r],
                input: &inputs[r],
                variance: variances[r],
                crossing: &self.crossing[r],
                single: singles[r],
                alike,
            };
            let sigma_m = self.input_noise(r, alike);
            if model.is_coupled() {
                let noise = ProcessNoise { sigma_m, sigma_d: 0.0, tau_d: 1.0, later: 0.5 };
                of.pass(Coupled::step(model, p, noise), p.len())
            } else {
                of.pass(Exact::new(model, p, sigma_m), p.len())
            }
        };
        self.pieces.par_iter().map(of_piece).collect()
    }
}

/// Pieces of about 5 s, equal parts of the rows between gaps: recording and rows.
pub(crate) fn pieces(recordings: &[&Recording]) -> Vec<(usize, Range<usize>)> {
    let mut out = vec![];
    for (r, recording) in recordings.iter().enumerate() {
        for whole in recording.pieces().iter().filter(|piece| piece.len() > 4) {
            let t = recording.t();
            let seconds = t[whole.end - 1] - t[whole.start];
            let parts = ((seconds / PIECE).round() as usize).clamp(1, whole.len() / 4);
            let edge = |k: usize| whole.start + k * whole.len() / parts;
            out.extend((0..parts).map(|k| (r, edge(k)..edge(k + 1))));
        }
    }
    out
}

/// A piece with its input and noise.
struct Stretch<'a> {
    piece: &'a Piece,
    prepared: &'a Prepared<'a>,
    input: &'a RecordedInput,
    variance: [f64; 4],
    crossing: &'a [[f64; 4]],
    /// Whether both wheels have identical data.
    single: bool,
    /// Whether noise of the input is the same in all rows.
    alike: bool,
}

impl Stretch<'_> {
    /// A pass with one column behind the parameters, the shift of the input.
    fn pass<D: Dynamics<N>, const N: usize>(
        &self,
        dynamics: D,
        parameters: usize,
    ) -> Result<Sums, ModelError> {
        let (t, rows) = (self.prepared.recording.t(), &self.piece.rows);
        let widths = Some((parameters, 1));
        let mut run = Run::new(dynamics, self.prepared, &self.variance, self.single, widths);
        run.start(rows.start, &self.start());
        let seconds = (t[rows.end - 1] - t[rows.start]) / self.piece.blocks as f64;
        for k in rows.start + 1..rows.end {
            run.row(k, self)?;
            if t[k] - t[rows.start] >= seconds * (run.blocks() + 1) as f64 {
                run.close();
            }
        }
        run.close();
        Ok(run.finish().0)
    }

    /// The motion around the first row, as uncertain as one measurement.
    fn start(&self) -> Start {
        let motion = &self.piece.start;
        let variance = |c: usize| {
            // a computed speed has no smaller variance than a measured one at this horizon
            let memory = self.variance[c] - self.prepared.variance[c];
            match c {
                _ if self.prepared.used[c] => self.variance[c],
                0 | 1 => EXACT + memory,
                _ => motion.omega_variance[c - 2].max(EXACT) + memory,
            }
        };
        Start {
            alpha: motion.alpha,
            omega: motion.omega,
            variance: [0, 1, 2, 3].map(variance),
            input: self.input.acting[self.piece.rows.start],
        }
    }
}

impl Drive for Stretch<'_> {
    fn sample<'s>(&self, k: usize, slopes: Option<&'s mut InputSlopes>) -> Sample<'s> {
        let recording = self.prepared.recording;
        let t = recording.t();
        let ends = self.input.ends(&self.input.acting, k);
        let middle = |e: &Ends| [0, 1].map(|i| 0.5 * (e[0][i] + e[1][i]));
        let (input, smooth) = (middle(&ends), middle(&self.input.ends(&self.input.smooth, k)));
        let mut by_parameter: &[[f64; 2]] = &[];
        let mut ends_by_parameter: &[Option<Ends>] = &[];
        if let Some(slopes) = slopes.filter(|_| self.input.acts) {
            for (j, d) in self.input.by_parameter.iter().enumerate().filter(|(_, d)| !d.is_empty())
            {
                let ends = self.input.ends(d, k);
                slopes.mean[j] = middle(&ends);
                slopes.ends[j] = Some(ends);
            }
            (by_parameter, ends_by_parameter) = (&slopes.mean, &slopes.ends);
        }
        Sample {
            t: t[k - 1] - t[0],
            step: t[k] - t[k - 1],
            input,
            tilt: lag_of_angle(0.5, &ends[0], &ends[1]),
            ends,
            change: if self.alike { [0.0; 2] } else { self.input.change(recording.torque(), k) },
            smoother: [0, 1].map(|i| smooth[i] - input[i]),
            crossing: if self.alike { [0.0; 4] } else { self.crossing[k] },
            by_parameter,
            ends_by_parameter,
            speed_variance: self.prepared.speed_variance,
            still: [0, 1].map(|i| self.prepared.still[k - 1][i] && self.prepared.still[k][i]),
        }
    }

    fn columns(&self, k: usize, _: &Sample, _: &Predicted, extra: &mut [[f64; 2]]) {
        extra.fill(self.input.by_shift(k));
    }
}
