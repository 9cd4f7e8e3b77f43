//! Rows of the inverse dynamics: filtered columns and torques, away from rest, and how much of
//! the columns is noise. The regressions share them.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::identifiability::{inverse_where_known, known_part};
use super::linear_fit::linear_fit;
use super::regressor::{Regressor, input_around};
pub(super) use super::stretch::Source;
use super::stretch::{Signals, Stretch, Treatment};
use super::weak::longest_motion;
use super::{Fit, IdentifyError, Note, Task, Unsupported};
use crate::math::clustered_covariance;
use crate::recording::Recording;

/// Length of the blocks within which residuals may be correlated \[s\]: the longest that leaves enough
/// blocks.
const BLOCK: (f64, f64) = (1.0, 5.0);
const BLOCKS: f64 = 20.0;
/// Noise of the acceleration as a share of its rms that regressions without errors-in-variables allow: the
/// attenuation of the inertias, its square, is then about the standard error.
pub(super) const NOISE_SHARE: f64 = 0.035;

/// A piece of a recording with the rows that are used of it.
struct Part {
    recording: usize,
    piece: Range<usize>,
    /// Stretches of the piece without rest or reversal.
    movements: Vec<Range<usize>>,
    kept: Vec<usize>,
}

/// The regression `y = x θ + e` of the torque balance over all recordings.
pub(super) struct Regression<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) regressor: Regressor<'a>,
    parts: Vec<Part>,
    /// Number of rows of the data; larger than that of `x` if its rows are blocks of them.
    pub(super) count: usize,
    /// Columns; directions in which there is nothing but noise are projected out.
    pub(super) x: DMatrix<f64>,
    /// Torques minus the part that does not depend on linear parameters [unit of the input].
    pub(super) y: DVector<f64>,
    /// Wheel of each row.
    pub(super) wheel: Vec<usize>,
    /// Block of each row.
    pub(super) block: Vec<usize>,
    /// Time of each row \[s\], recordings one after the other.
    pub(super) time: Vec<f64>,
    /// `Σ_rows cov(columns, y)` due to noise of the channels.
    pub(super) noise: DMatrix<f64>,
    /// The projection, where one was needed.
    pub(super) projection: Option<DMatrix<f64>>,
    pub(super) treatments: Vec<Treatment>,
}

impl<'a> Regression<'a> {
    /// Rows from the recordings of a task.
    ///
    /// Speeds and torques pass a zero-phase Butterworth filter of order 4, the speeds are
    /// differentiated; columns and torques pass the same filter again, so that the relation
    /// stays linear; every row that the filter makes redundant is left out. Each movement between
    /// two stops or reversals is filtered on its own ([`Stretch::signals`]).
    ///
    /// A cut-off that is not given lets noise into the acceleration of `noise_share` times its
    /// rms.
    ///
    /// # Errors
    /// If too few rows are left.
    pub(super) fn new(
        task: &'a Task<'a>,
        cutoff_hz: Option<f64>,
        noise_share: f64,
        method: &str,
    ) -> Result<Self, IdentifyError> {
        Self::with_rest(task, cutoff_hz, None, noise_share, method)
    }

    /// As [`Self::new`], with the speed below which a wheel counts as near rest [rad/s]; at 0
    /// every sample is kept, reversals too.
    pub(super) fn with_rest(
        task: &'a Task<'a>,
        cutoff_hz: Option<f64>,
        rest: Option<f64>,
        noise_share: f64,
        method: &str,
    ) -> Result<Self, IdentifyError> {
        let mut out = Self::empty(task, cutoff_hz, rest, noise_share, method)?;
        out.choose_rows();
        out.count = out.wheel.len();
        let samples: usize = task.train.iter().map(Recording::len).sum();
        out.check_count(samples, method)?;
        let sources: Vec<Source> = task.train.iter().map(Source::measured).collect();
        (out.x, out.y) = out.rows_of(&sources);
        out.measure_noise();
        Ok(out)
    }

    /// No rows yet.
    pub(super) fn empty(
        task: &'a Task<'a>,
        cutoff_hz: Option<f64>,
        rest: Option<f64>,
        noise_share: f64,
        method: &str,
    ) -> Result<Self, IdentifyError> {
        let regressor = Regressor::new(task.model, &task.model.initial());
        let width = regressor.width();
        if width == 0 {
            let reason = Unsupported::NoLinearParameter;
            return Err(IdentifyError::Unsupported { method: method.into(), reason });
        }
        let treatment = |r| Treatment::new(r, cutoff_hz, rest, noise_share);
        Ok(Self {
            task,
            regressor,
            parts: vec![],
            count: 0,
            x: DMatrix::zeros(0, width),
            y: DVector::zeros(0),
            wheel: vec![],
            block: vec![],
            time: vec![],
            noise: DMatrix::zeros(width + 1, width + 1),
            projection: None,
            treatments: task.train.iter().map(treatment).collect(),
        })
    }

    /// Whether enough rows remain of `samples`.
    pub(super) fn check_count(&self, samples: usize, method: &str) -> Result<(), IdentifyError> {
        let usable = self.count;
        if usable <= 2 * self.regressor.width() + 2 {
            let moving_s = longest_motion(self.task.train);
            let method = method.into();
            return Err(IdentifyError::TooFewSamples { method, usable, samples, moving_s });
        }
        Ok(())
    }

    /// Which samples become rows.
    fn choose_rows(&mut self) {
        let length = block_length(self.task.train.iter().map(Recording::covered).sum());
        let mut before = 0.0;
        for (r, recording) in self.task.train.iter().enumerate() {
            let (t, treatment) = (recording.t(), self.treatments[r]);
            for piece in recording.pieces() {
                if treatment.is_too_short(piece.len()) {
                    continue;
                }
                let movements = treatment.movements(&recording.omega()[piece.clone()]);
                let usable = treatment.usable(&movements, piece.len());
                let rows = (0..piece.len()).step_by(treatment.every);
                let kept: Vec<usize> = rows.filter(|&k| usable[k]).collect();
                let first = self.block.last().map_or(0, |b| b + 1);
                for &k in &kept {
                    let since = t[piece.start + k] - t[piece.start];
                    for wheel in 0..2 {
                        self.wheel.push(wheel);
                        self.block.push(first + (since / length) as usize);
                        self.time.push(before + t[piece.start + k] - t[0]);
                    }
                }
                self.parts.push(Part { recording: r, piece: piece.clone(), movements, kept });
            }
            before += recording.duration();
        }
    }

    /// Columns and right-hand side at the selected rows, computed from another motion or input.
    pub(super) fn rows_of(&self, sources: &[Source]) -> (DMatrix<f64>, DVector<f64>) {
        let width = self.regressor.width();
        let mut x = DMatrix::zeros(self.wheel.len(), width);
        let mut y = DVector::zeros(self.wheel.len());
        let mut row = 0;
        let mut input = (usize::MAX, vec![]);
        for part in &self.parts {
            let (r, source) = (part.recording, &sources[part.recording]);
            if input.0 != r {
                input = (r, input_around(self.task, &self.task.train[r], &source.input));
            }
            let signals = self.signals(part, source, &input.1);
            for &k in &part.kept {
                for wheel in 0..2 {
                    for c in 0..width {
                        x[(row, c)] = signals.at(wheel, c, k);
                    }
                    y[row] = signals.at(wheel, width, k);
                    row += 1;
                }
            }
        }
        (x, y)
    }

    /// Filtered columns and right-hand side over a piece.
    fn signals(&self, part: &Part, source: &Source, input: &[[f64; 2]]) -> Signals {
        let recording = &self.task.train[part.recording];
        let piece = part.piece.clone();
        let stretch = Stretch {
            t: &recording.t()[piece.clone()],
            start: recording.t()[0],
            alpha: &source.alpha[piece.clone()],
            omega: &source.omega[piece.clone()],
            input: &input[piece],
        };
        let treatment = &self.treatments[part.recording];
        stretch.signals(&self.regressor, self.task.model, treatment, &part.movements)
    }

    /// How much of columns and right-hand side is noise: what the same amount of noise, added
    /// once more, changes. Directions in which it is more than half of all are projected out.
    fn measure_noise(&mut self) {
        let mut rng = ChaCha8Rng::seed_from_u64(self.task.seed);
        let noisy = |r: &Recording| {
            Source::measured(r).with_noise(&r.noise(), r.is_single_axis(), &mut rng)
        };
        let sources: Vec<Source> = self.task.train.iter().map(noisy).collect();
        let (x, y) = self.rows_of(&sources);
        let width = self.x.ncols();
        let mut change = (&x - &self.x).insert_column(width, 0.0);
        change.set_column(width, &(&y - &self.y));
        self.noise = change.tr_mul(&change);
        self.project();
    }

    /// Leaves out directions in which there is nothing but noise.
    pub(super) fn project(&mut self) {
        let width = self.x.ncols();
        let of_columns = self.noise.view((0, 0), (width, width)).into_owned();
        self.projection = known_part(&self.x.tr_mul(&self.x), &of_columns);
        if let Some(projection) = &self.projection {
            self.x = &self.x * projection;
            let mut both = DMatrix::identity(width + 1, width + 1);
            both.view_mut((0, 0), (width, width)).copy_from(projection);
            self.noise = both.transpose() * &self.noise * both;
        }
    }

    /// Covariance that holds when errors within a block are correlated and of unequal size.
    pub(super) fn covariance(&self, bread: &DMatrix<f64>, psi: &DVector<f64>) -> DMatrix<f64> {
        clustered_covariance(bread, &self.x, psi, &self.block, self.count)
    }

    /// Least squares without the rows of each of some pieces (recording and rows) in turn.
    pub(super) fn left_out(&self, pieces: &[(usize, Range<usize>)]) -> Vec<DVector<f64>> {
        let width = self.x.ncols();
        let nothing = || (DMatrix::zeros(width, width), DVector::zeros(width));
        let (mut all, mut own) = (nothing(), vec![nothing(); pieces.len()]);
        let samples = self
            .parts
            .iter()
            .flat_map(|part| part.kept.iter().map(move |k| (part.recording, part.piece.start + k)));
        for (n, (recording, k)) in samples.enumerate() {
            let piece = pieces.iter().position(|(r, rows)| *r == recording && rows.contains(&k));
            for row in [2 * n, 2 * n + 1] {
                let x = self.x.row(row).transpose();
                let add = |(matrix, vector): &mut (DMatrix<f64>, DVector<f64>)| {
                    matrix.ger(1.0, &x, &x, 1.0);
                    vector.axpy(self.y[row], &x, 1.0);
                };
                add(&mut all);
                piece.into_iter().for_each(|b| add(&mut own[b]));
            }
        }
        own.iter()
            .map(|(matrix, vector)| inverse_where_known(&(&all.0 - matrix)) * (&all.1 - vector))
            .collect()
    }

    /// How the right-hand side changes if every other row of the input is filled in from its neighbours, the mean
    /// of both ways of doing so.
    pub(super) fn halved(&self) -> DVector<f64> {
        let halved = |phase: usize| {
            let source = |r: &Recording| Source {
                input: r.half_rate_input(phase).into_owned(),
                ..Source::measured(r)
            };
            self.rows_of(&self.task.train.iter().map(source).collect::<Vec<_>>()).1
        };
        0.5 * (halved(0) + halved(1)) - &self.y
    }

    /// Places of the columns in the parameters of the model.
    pub(super) fn linear(&self) -> &[usize] {
        &self.regressor.linear
    }

    /// Share by which noise in the columns biases each value of an ordinary least-squares
    /// estimate, `-(x'x)⁻¹ (C_xx θ - C_xy)`.
    pub(super) fn bias(&self, values: &DVector<f64>, inverse: &DMatrix<f64>) -> DVector<f64> {
        let width = values.len();
        let xx = self.noise.view((0, 0), (width, width));
        let xy = self.noise.view((0, width), (width, 1));
        -(inverse * (xx * values - xy)).column(0).into_owned()
    }

    /// The fit from values and covariance of the columns; adds the cut-offs to the notes.
    pub(super) fn fit(
        &self,
        method: &str,
        values: &DVector<f64>,
        covariance: &DMatrix<f64>,
    ) -> Result<Fit, IdentifyError> {
        let information = self.x.tr_mul(&self.x);
        let mut out =
            linear_fit(method, self.task, self.linear(), values, &information, covariance)?;
        let blocks = self.block.iter().collect::<std::collections::BTreeSet<_>>().len();
        // too few blocks for a covariance: that of the rows, with the widest intervals
        out = out.with_degrees(blocks.saturating_sub(self.linear().len()).max(1) as f64);
        out.notes.push(Note::CutOff(self.treatments.iter().map(|t| t.cutoff).collect()));
        out.work.evaluations = 1;
        Ok(out)
    }

    /// A warning where noise in the columns biases an estimate by more than its standard error.
    pub(super) fn note_of_bias(&self, fit: &mut Fit, bias: &DVector<f64>) {
        let mut biased = Vec::new();
        for (&j, bias) in self.linear().iter().zip(bias.iter()) {
            let e = &fit.estimates[j];
            if e.std_error.is_finite() && bias.abs() > e.std_error {
                biased.push((e.symbol.clone(), *bias));
            }
        }
        if !biased.is_empty() {
            fit.notes.push(Note::Biased(biased));
        }
    }
}

/// Length of the blocks within which residuals may be correlated \[s\], for `total` seconds of data.
pub(super) fn block_length(total: f64) -> f64 {
    (total / BLOCKS).clamp(BLOCK.0, BLOCK.1)
}
