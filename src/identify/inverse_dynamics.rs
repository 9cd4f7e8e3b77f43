//! Rows of the inverse dynamics: filtered columns and moments, away from rest, and how much of
//! the columns is noise. The regressions share them.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::identifiability::known_part;
use super::linear_fit::linear_fit;
use super::regressor::{Regressor, drive_around};
use super::{Fit, IdentifyError, OptionError, Task};
use crate::effects::Motion;
use crate::math::filter::{central_difference, low_pass};
use crate::recording::Recording;

/// Near rest: below this share of the top speed, or three standard deviations of the filtered
/// speed's noise.
const REST: f64 = 0.002;
/// Length of the filter's answer [s Hz]: seconds times cut-off.
const REACH: f64 = 0.35;
/// Blocks within which residuals may be correlated [s]: as long as leaves enough of them.
const BLOCK: (f64, f64) = (1.0, 5.0);
const BLOCKS: f64 = 20.0;

/// The motion and the drive that columns are made of, one of each recording.
pub(super) struct Source {
    pub(super) alpha: Vec<[f64; 2]>,
    pub(super) omega: Vec<[f64; 2]>,
    pub(super) drive: Vec<[f64; 2]>,
}

impl Source {
    fn measured(recording: &Recording) -> Self {
        Self {
            alpha: recording.alpha().to_vec(),
            omega: recording.omega().to_vec(),
            drive: recording.moment().to_vec(),
        }
    }

    /// The measured one with as much noise again, drawn anew.
    fn with_noise(recording: &Recording, rng: &mut ChaCha8Rng) -> Self {
        let noise = recording.noise();
        let mut out = Self::measured(recording);
        let same = recording.is_single_axis();
        let mut normal = || -> f64 { StandardNormal.sample(&mut *rng) };
        for (rows, sigma) in [
            (&mut out.alpha, noise.alpha),
            (&mut out.omega, noise.omega),
            (&mut out.drive, noise.moment),
        ] {
            for row in rows.iter_mut() {
                let first = normal();
                let second = if same { first } else { normal() };
                row[0] += sigma[0] * first;
                row[1] += sigma[1] * second;
            }
        }
        out
    }
}

/// A piece of a recording with the rows that are used of it.
struct Part {
    recording: usize,
    piece: Range<usize>,
    cutoff: f64,
    kept: Vec<usize>,
}

/// The regression `y = x θ + e` of the moment balance over all recordings.
pub(super) struct Regression<'a> {
    task: &'a Task<'a>,
    regressor: Regressor<'a>,
    parts: Vec<Part>,
    /// Columns; directions in which there is nothing but noise are projected out.
    pub(super) x: DMatrix<f64>,
    /// Moments less what does not depend on linear parameters [drive unit].
    pub(super) y: DVector<f64>,
    /// Wheel of each row.
    pub(super) wheel: Vec<usize>,
    /// Block of each row.
    pub(super) block: Vec<usize>,
    /// Time of each row [s], recordings one behind the other.
    pub(super) time: Vec<f64>,
    /// `Σ_rows cov(columns, y)` that the noise of the channels makes.
    pub(super) noise: DMatrix<f64>,
    /// The projection, where one was needed.
    pub(super) projection: Option<DMatrix<f64>>,
    cutoffs: Vec<f64>,
}

/// Checks a cut-off given by the user.
pub(super) fn check_cutoff(method: &str, cutoff_hz: Option<f64>) -> Result<(), OptionError> {
    if cutoff_hz.is_some_and(|f| !(f > 0.0 && f.is_finite())) {
        let message = "`cutoff_hz` must be a positive number".to_string();
        return Err(OptionError { method: method.into(), message });
    }
    Ok(())
}

/// What the catalogue says of the option.
pub(super) fn cutoff_option() -> (String, String, String) {
    let (key, default) = ("cutoff_hz", "from noise and motion");
    (key.into(), default.into(), "cut-off of the zero-phase filter [Hz]".into())
}

impl<'a> Regression<'a> {
    /// Rows from the recordings of a task.
    ///
    /// Speeds and moments pass a zero-phase Butterworth filter of order 4, the speeds are
    /// differentiated; columns and moments pass the same filter again, so that the relation
    /// stays linear; every row
    /// that the filter makes redundant is left out. Samples near rest, and the filter's length
    /// around them, are dropped: what friction does there is not sgn(w).
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
        let regressor = Regressor::new(task.model, &task.model.initial());
        let width = regressor.width();
        let mut out = Self {
            task,
            regressor,
            parts: vec![],
            x: DMatrix::zeros(0, width),
            y: DVector::zeros(0),
            wheel: vec![],
            block: vec![],
            time: vec![],
            noise: DMatrix::zeros(width + 1, width + 1),
            projection: None,
            cutoffs: task.train.iter().map(|r| cutoff(r, cutoff_hz, noise_share)).collect(),
        };
        out.choose_rows(rest);
        let samples: usize = task.train.iter().map(Recording::len).sum();
        if width == 0 {
            let reason = "the model has no free parameter that enters linearly".to_string();
            return Err(IdentifyError::Unsupported { method: method.into(), reason });
        }
        if out.wheel.len() <= 2 * width + 2 {
            let usable = out.wheel.len();
            return Err(IdentifyError::TooFewSamples { method: method.into(), usable, samples });
        }
        let sources: Vec<Source> = task.train.iter().map(Source::measured).collect();
        (out.x, out.y) = out.rows_of(&sources);
        out.measure_noise();
        Ok(out)
    }

    /// Which samples become rows.
    fn choose_rows(&mut self, rest: Option<f64>) {
        let total: f64 = self.task.train.iter().map(Recording::duration).sum();
        let length = (total / BLOCKS).clamp(BLOCK.0, BLOCK.1);
        let mut before = 0.0;
        for (r, recording) in self.task.train.iter().enumerate() {
            let (t, cutoff) = (recording.t(), self.cutoffs[r]);
            let every = ((1.0 / (4.0 * cutoff * recording.step())) as usize).max(1);
            for piece in recording.pieces() {
                // a piece shorter than the filter's answer holds nothing the filter leaves intact
                if (piece.len() as f64) * recording.step() <= 4.0 * REACH / cutoff {
                    continue;
                }
                let omega = filtered(recording.omega(), piece, cutoff, recording);
                let usable = usable(&omega, recording, cutoff, rest);
                let kept: Vec<usize> =
                    (0..piece.len()).step_by(every).filter(|&k| usable[k]).collect();
                let first = self.block.last().map_or(0, |b| b + 1);
                for &k in &kept {
                    let since = t[piece.start + k] - t[piece.start];
                    for wheel in 0..2 {
                        self.wheel.push(wheel);
                        self.block.push(first + (since / length) as usize);
                        self.time.push(before + t[piece.start + k] - t[0]);
                    }
                }
                self.parts.push(Part { recording: r, piece: piece.clone(), cutoff, kept });
            }
            before += recording.duration();
        }
    }

    /// Columns and right-hand side at the chosen rows, made of another motion or drive.
    pub(super) fn rows_of(&self, sources: &[Source]) -> (DMatrix<f64>, DVector<f64>) {
        let width = self.regressor.width();
        let mut x = DMatrix::zeros(self.wheel.len(), width);
        let mut y = DVector::zeros(self.wheel.len());
        let mut row = 0;
        for part in &self.parts {
            let signals = self.signals(part, &sources[part.recording]);
            for &k in &part.kept {
                for wheel in 0..2 {
                    for c in 0..width {
                        x[(row, c)] = signals[wheel * (width + 1) + c][k];
                    }
                    y[row] = signals[wheel * (width + 1) + width][k];
                    row += 1;
                }
            }
        }
        (x, y)
    }

    /// Filtered columns and right-hand side over a piece, `[wheel * (width + 1) + column]`.
    fn signals(&self, part: &Part, source: &Source) -> Vec<Vec<f64>> {
        let recording = &self.task.train[part.recording];
        let (piece, cutoff) = (&part.piece, part.cutoff);
        let model = self.task.model;
        // the moments pass the filter as often as the accelerations do
        let drive = drive_around(self.task, recording, &source.drive);
        let drive = filtered(&drive, piece, cutoff, recording);
        let t = &recording.t()[piece.clone()];
        let omega = filtered(&source.omega, piece, cutoff, recording);
        let acceleration =
            [0, 1].map(|i| central_difference(t, &omega[i]).unwrap_or(vec![0.0; t.len()]));
        let width = self.regressor.width();
        let mut signals = vec![vec![0.0; t.len()]; 2 * (width + 1)];
        for k in 0..t.len() {
            let motion = Motion {
                t: t[k] - recording.t()[0],
                alpha: source.alpha[piece.start + k],
                omega: [omega[0][k], omega[1][k]],
                variance: [0.0; 4],
                robot: model.robot(),
            };
            let balance = self.regressor.at(&motion);
            let a = [acceleration[0][k], acceleration[1][k]];
            for c in 0..=width {
                let moment = balance.moment(c, &a);
                for wheel in 0..2 {
                    signals[wheel * (width + 1) + c][k] =
                        if c < width { moment[wheel] } else { drive[wheel][k] - moment[wheel] };
                }
            }
        }
        let rate = 1.0 / recording.step();
        signals.into_iter().map(|v| low_pass(&v, 4, cutoff, rate).unwrap_or(v)).collect()
    }

    /// How much of columns and right-hand side is noise: what the same amount of noise, added
    /// once more, changes. Directions in which it is more than half of all are projected out.
    fn measure_noise(&mut self) {
        let mut rng = ChaCha8Rng::seed_from_u64(self.task.seed);
        let sources: Vec<Source> =
            self.task.train.iter().map(|r| Source::with_noise(r, &mut rng)).collect();
        let (x, y) = self.rows_of(&sources);
        let width = self.x.ncols();
        let mut change = (&x - &self.x).insert_column(width, 0.0);
        change.set_column(width, &(&y - &self.y));
        self.noise = change.tr_mul(&change);
        let of_columns = self.noise.view((0, 0), (width, width)).into_owned();
        self.projection = known_part(&self.x.tr_mul(&self.x), &of_columns);
        if let Some(projection) = &self.projection {
            self.x = &self.x * projection;
            let mut both = DMatrix::identity(width + 1, width + 1);
            both.view_mut((0, 0), (width, width)).copy_from(projection);
            self.noise = both.transpose() * &self.noise * both;
        }
    }

    /// Places of the columns in the parameters of the model.
    pub(super) fn linear(&self) -> &[usize] {
        &self.regressor.linear
    }

    /// Share by which noise in the columns pulls each value of an ordinary least-squares
    /// estimate, `-(x'x)⁻¹ (C_xx θ - C_xy)`.
    pub(super) fn pull(&self, values: &DVector<f64>, inverse: &DMatrix<f64>) -> DVector<f64> {
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
        let cutoffs: Vec<String> = self.cutoffs.iter().map(|f| format!("{f:.2}")).collect();
        out.notes.push(format!("Cut-off of the filter: {} Hz.", cutoffs.join(", ")));
        out.work.evaluations = 1;
        Ok(out)
    }

    /// A warning where noise in the columns pulls an estimate by more than its standard error.
    pub(super) fn note_of_pull(&self, fit: &mut Fit, pull: &DVector<f64>) {
        let mut pulled = Vec::new();
        for (&j, pull) in self.linear().iter().zip(pull.iter()) {
            let e = &fit.estimates[j];
            if e.std_error.is_finite() && pull.abs() > e.std_error {
                pulled.push(format!("{} by about {pull:+.2e}", e.symbol));
            }
        }
        if !pulled.is_empty() {
            fit.notes.push(format!(
                "Noise of the speeds pulls {}, more than the standard errors say: use \
                 prediction_error, or a lower cut-off.",
                pulled.join(", ")
            ));
        }
    }
}

/// The given cut-off, or the one that lets little noise into the acceleration [Hz]:
///
/// ```text
/// var(noise of dw after the filter) = (2π)² σ² 2 fc³ / (3 rate) = (noise_share rms dw)²
/// ```
fn cutoff(recording: &Recording, given: Option<f64>, noise_share: f64) -> f64 {
    let rate = 1.0 / recording.step();
    let automatic = || {
        let motion = recording.local_motion();
        let square: f64 =
            motion.iter().map(|m| m.acceleration[0].powi(2) + m.acceleration[1].powi(2)).sum();
        let rms = (square / (2.0 * motion.len() as f64)).sqrt();
        let noise = recording.noise();
        let sigma = noise.omega[0].max(noise.omega[1]).max(1e-12);
        let turn = std::f64::consts::TAU;
        let allowed = (noise_share * rms).powi(2);
        (3.0 * rate * allowed / (2.0 * turn * turn * sigma * sigma)).cbrt()
    };
    given.unwrap_or_else(automatic).clamp(0.5_f64.min(0.1 * rate), 0.1 * rate)
}

fn filtered(
    rows: &[[f64; 2]],
    piece: &Range<usize>,
    cutoff: f64,
    recording: &Recording,
) -> [Vec<f64>; 2] {
    let rate = 1.0 / recording.step();
    [0, 1].map(|i| {
        let column: Vec<f64> = rows[piece.clone()].iter().map(|r| r[i]).collect();
        low_pass(&column, 4, cutoff, rate).unwrap_or(column)
    })
}

/// Samples with both wheels moving, away from rest and from the ends by the filter's length.
fn usable(
    omega: &[Vec<f64>; 2],
    recording: &Recording,
    cutoff: f64,
    rest: Option<f64>,
) -> Vec<bool> {
    let samples = omega[0].len();
    let reach = ((REACH / cutoff / recording.step()).ceil() as usize).max(1);
    let sigma = recording.noise().omega;
    let left = (2.0 * cutoff * recording.step()).sqrt();
    let ordinary = (REST * recording.top_speed()).max(3.0 * left * sigma[0].max(sigma[1]));
    let slow = rest.unwrap_or(ordinary);
    let mut good = vec![true; samples];
    for k in 0..samples {
        if k < reach || k + reach >= samples {
            good[k] = false;
        }
        let reversed = slow > 0.0 && k > 0 && (0..2).any(|i| omega[i][k] * omega[i][k - 1] <= 0.0);
        if reversed || omega.iter().any(|w| w[k].abs() < slow) {
            let (from, to) = (k.saturating_sub(reach), (k + reach + 1).min(samples));
            good[from..to].iter_mut().for_each(|g| *g = false);
        }
    }
    good
}
