//! One run of the filter over a recording.

use nalgebra::{DMatrix, DVector};

use super::ProcessNoise;
use super::accumulate::Information;
use super::correction::{Covariance, Mean, correct};
use super::coupled::Coupled;
use super::dynamics::{Dynamics, Rigid};
use super::friction::between;
use super::input_noise::InputNoise;
use super::prepare::Prepared;
use super::step::{Predicted, Sample, lag_of_angle};
use crate::effects::Motion;
use crate::math::LogProduct;
use crate::model::{Model, ModelError};

/// Length of the blocks whose scores are kept apart, for standard errors that are valid with a
/// wrong noise model \[s\].
const BLOCK: f64 = 5.0;

/// Standard deviations of its noise between which a second difference of the input is attributed to
/// a jump.
const JUMP: (f64, f64) = (3.0, 5.0);

/// Additional torque columns of a pass, whose coefficients are zero in the model.
pub trait Columns: Sync {
    /// How many.
    fn count(&self) -> usize;
    /// Writes the torque each column would add to the input side for a coefficient of one [N m].
    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]);
}

/// A pass for the likelihood alone, without derivatives.
pub struct NoColumns;

impl Columns for NoColumns {
    fn count(&self) -> usize {
        0
    }
    fn torque(&self, _: &Instant, _: &mut [[f64; 2]]) {}
}

/// Where a column is evaluated: the filter's state at one step.
pub struct Instant<'a> {
    /// Number of the sample at the start of the step.
    pub sample: usize,
    /// Filtered motion with its variance.
    pub motion: Motion<'a, f64>,
    /// Mean acceleration over the step [rad/s^2].
    pub acceleration: [f64; 2],
    /// Statistically linearised sgn along each friction direction, less where its direction is unclear
    /// (zero where the model has no friction along it).
    pub sign: [f64; 4],
    /// Variance of w1 - w2 and of w1 + w2 [rad^2/s^2].
    pub spread: [f64; 2],
    /// Variance of either due to sensor noise alone, for any process noise [rad^2/s^2].
    pub speed_variance: f64,
    /// Acting input over the step [N m].
    pub input: [f64; 2],
}

/// Settings of a pass.
#[derive(Clone, Copy, Debug)]
pub struct PassSettings {
    /// Process noise.
    pub noise: ProcessNoise,
    /// Whether derivatives are carried (else only the likelihood).
    pub derivatives: bool,
    /// Whether innovations and their variances are kept.
    pub keep_innovations: bool,
    /// Whether the mean score due to noise of the input is computed; requires derivatives.
    pub input_noise: bool,
}

/// Result of a pass.
#[derive(Clone, Debug)]
pub struct Pass {
    /// Log-likelihood of the innovations.
    pub log_likelihood: f64,
    /// Information of parameters and columns.
    pub information: DMatrix<f64>,
    /// Score of parameters and columns.
    pub score: DVector<f64>,
    /// Mean contribution of noise of the recorded input to the score, if requested.
    pub score_of_input_noise: DVector<f64>,
    /// Scores of blocks of 5 s.
    pub blocks: Vec<DVector<f64>>,
    /// In the order of the measurements, where kept.
    pub innovations: Vec<Innovation>,
}

/// A measured value less its prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// Row of the recording.
    pub row: usize,
    /// Channel: alpha1, alpha2, omega1, omega2.
    pub channel: usize,
    /// Innovation [rad, rad/s].
    pub value: f64,
    /// Its predicted variance [rad², rad²/s²].
    pub variance: f64,
}

impl Pass {
    fn new(columns: usize) -> Self {
        Self {
            log_likelihood: 0.0,
            information: DMatrix::zeros(columns, columns),
            score: DVector::zeros(columns),
            score_of_input_noise: DVector::zeros(0),
            blocks: vec![],
            innovations: vec![],
        }
    }
}

/// Runs the filter over a recording, piece by piece.
///
/// # Errors
/// If the mass matrix is not positive definite.
pub fn filter_pass(
    model: &Model,
    p: &[f64],
    prepared: &Prepared,
    settings: &PassSettings,
    columns: &dyn Columns,
) -> Result<Pass, ModelError> {
    let noise = settings.noise;
    if model.is_coupled() {
        return run(Coupled::new(model, p, noise), model, p, prepared, settings, columns);
    }
    run(Rigid::new(model, p, noise), model, p, prepared, settings, columns)
}

fn run<D: Dynamics<N>, const N: usize>(
    dynamics: D,
    model: &Model,
    p: &[f64],
    prepared: &Prepared,
    settings: &PassSettings,
    columns: &dyn Columns,
) -> Result<Pass, ModelError> {
    let recording = prepared.recording;
    let single = recording.is_single_axis();
    let (input, by_parameter) = model.input_derivatives_of(recording, recording.torque(), p);
    let width = if settings.derivatives { p.len() + columns.count() } else { 0 };
    let mut run = Run {
        dynamics,
        model,
        prepared,
        settings,
        columns,
        input: &input,
        by_parameter: &by_parameter,
        acts: by_parameter.iter().any(|d| !d.is_empty()),
        psi: vec![[0.0; N]; width],
        extra: vec![[0.0; 2]; if width > 0 { columns.count() } else { 0 }],
        input_row: vec![[0.0; 2]; p.len()],
        information: Information::new(width),
        block_end: recording.t()[0] + BLOCK,
        log_variance: LogProduct::new(),
        single,
        // a single axis is a motor with an encoder of its own, whose noise is small
        input_noise: (settings.derivatives && settings.input_noise && !single).then(|| {
            // if the recorded roughness of the input is real, the process noise is small
            let sigma = settings.noise.sigma_m.min(prepared.torque_noise);
            InputNoise::new(sigma * sigma, p.len())
        }),
        out: Pass::new(width),
    };
    for piece in recording.pieces() {
        run.piece(piece.clone())?;
    }
    run.out.log_likelihood -= 0.5 * run.log_variance.finish();
    run.out.blocks.push(run.information.take_score());
    (run.out.information, run.out.score) = run.information.finish();
    if let Some(input_noise) = run.input_noise {
        run.out.score_of_input_noise = input_noise.finish();
    }
    Ok(run.out)
}

struct Run<'a, D, const N: usize> {
    dynamics: D,
    model: &'a Model,
    prepared: &'a Prepared<'a>,
    settings: &'a PassSettings,
    columns: &'a dyn Columns,
    input: &'a [[f64; 2]],
    by_parameter: &'a [Vec<[f64; 2]>],
    acts: bool,
    psi: Vec<[f64; N]>,
    extra: Vec<[f64; 2]>,
    input_row: Vec<[f64; 2]>,
    information: Information,
    block_end: f64,
    input_noise: Option<InputNoise<N>>,
    /// Sum of ln 2 pi S over the measurements.
    log_variance: LogProduct,
    single: bool,
    out: Pass,
}

impl<D: Dynamics<N>, const N: usize> Run<'_, D, N> {
    fn piece(&mut self, piece: std::ops::Range<usize>) -> Result<(), ModelError> {
        let (mut mean, mut covariance) = self.start(piece.start);
        self.psi.iter_mut().for_each(|column| *column = [0.0; N]);
        if let Some(input_noise) = &mut self.input_noise {
            input_noise.restart();
        }
        for k in piece.start + 1..piece.end {
            let sample = self.sample(k, &piece);
            // borrow of the input row ends before psi moves
            let sample = Sample { by_parameter: &[], ..sample };
            let derivatives = self.settings.derivatives;
            let predicted =
                self.dynamics.predict(&sample, &mut mean, &mut covariance, derivatives)?;
            if self.settings.derivatives {
                self.carry(k, &sample, &predicted);
            }
            if let Some(input_noise) = &mut self.input_noise {
                let slopes = self.dynamics.mass_slopes(&predicted);
                let transition = self.dynamics.transition();
                input_noise.carry(&predicted, &transition, slopes, sample.step, sample.still);
            }
            self.measure(k, &mut mean, &mut covariance);
        }
        Ok(())
    }

    fn start(&mut self, k: usize) -> (Mean<N>, Covariance<N>) {
        let (a, w) = (self.prepared.recording.alpha()[k], self.prepared.recording.omega()[k]);
        let still = self.prepared.still[k];
        let mut mean = Mean::<N>::zeros();
        let mut covariance = Covariance::<N>::zeros();
        let step = self.prepared.recording.step();
        for i in 0..2 {
            mean[i] = a[i];
            mean[2 + i] = if still[i] { 0.0 } else { w[i] };
            let [alpha, omega] = [self.prepared.variance[i], self.prepared.variance[2 + i]];
            // the initial variance of a channel computed from the other follows from that one
            covariance[(i, i)] = if self.prepared.used[i] { alpha } else { 1e-12 };
            covariance[(2 + i, 2 + i)] =
                if self.prepared.used[2 + i] { omega } else { 2.0 * alpha / (step * step) };
            covariance[(4 + i, 4 + i)] = self.settings.noise.sigma_d.powi(2);
        }
        self.dynamics.start(&self.input[k], &mut mean, &mut covariance);
        (mean, covariance)
    }

    /// The step from sample k - 1 to k of a piece.
    ///
    /// ```text
    /// mean input = (1 - c) M0 + c M1 - c (1 - c)/3 h^2 M'',   h^2 M'' = (M_-1 - M0 - M1 + M2)/2
    /// ```
    /// exact to second order for an input held over each of m parts of a row, c = (m - 1)/(2 m); a
    /// second difference beyond noise is a jump, for which no curvature is assumed.
    fn sample(&self, k: usize, piece: &std::ops::Range<usize>) -> Sample<'static> {
        let recording = self.prepared.recording;
        let t = recording.t();
        let m = self.input;
        let ProcessNoise { later: c, sigma_m, .. } = self.settings.noise;
        let inside = k >= piece.start + 2 && k + 1 < piece.end;
        let mut input = [0.0; 2];
        for i in 0..2 {
            input[i] = (1.0 - c) * m[k - 1][i] + c * m[k][i];
            if inside {
                let bend = 0.5 * (m[k - 2][i] - m[k - 1][i] - m[k][i] + m[k + 1][i]);
                let curved = 1.0 - between(JUMP, bend.abs() / sigma_m.max(f64::MIN_POSITIVE));
                input[i] -= curved * c * (1.0 - c) / 3.0 * bend;
            }
        }
        let raw = recording.torque();
        let still = [0, 1].map(|i| self.prepared.still[k - 1][i] && self.prepared.still[k][i]);
        Sample {
            t: t[k - 1] - t[0],
            step: t[k] - t[k - 1],
            input,
            ends: [m[k - 1], m[k]],
            tilt: lag_of_angle(c, &m[k - 1], &m[k]),
            smoother: [0.0; 2],
            crossing: [0.0; 4],
            change: [0, 1].map(|i| raw[k][i] - raw[k - 1][i]),
            by_parameter: &[],
            ends_by_parameter: &[],
            speed_variance: self.prepared.speed_variance,
            still,
        }
    }

    fn carry(&mut self, k: usize, sample: &Sample, predicted: &Predicted<N>) {
        if !self.extra.is_empty() {
            let at = Instant {
                sample: k - 1,
                motion: Motion {
                    t: sample.t + 0.5 * sample.step,
                    alpha: predicted.alpha,
                    omega: predicted.omega,
                    variance: predicted.variance,
                    robot: self.model.robot(),
                },
                acceleration: predicted.acceleration,
                sign: predicted.sign,
                spread: predicted.spread,
                speed_variance: self.prepared.speed_variance,
                input: sample.input,
            };
            self.columns.torque(&at, &mut self.extra);
        }
        if self.acts {
            for (row, d) in self.input_row.iter_mut().zip(self.by_parameter) {
                if d.is_empty() {
                    continue;
                }
                let c = self.settings.noise.later;
                *row = [0, 1].map(|i| (1.0 - c) * d[k - 1][i] + c * d[k][i]);
            }
        }
        let by_parameter: &[[f64; 2]] = if self.acts { &self.input_row } else { &[] };
        let sample = Sample { by_parameter, ..*sample };
        self.dynamics.carry(predicted, &sample, &self.extra, &mut self.psi);
    }

    fn measure(&mut self, k: usize, mean: &mut Mean<N>, covariance: &mut Covariance<N>) {
        let recording = self.prepared.recording;
        if !recording.fresh()[k] {
            return;
        }
        let (a, w) = (recording.alpha()[k], recording.omega()[k]);
        if self.single {
            self.measure_axis(k, mean, covariance);
        }
        for (i, value) in [a[0], a[1], w[0], w[1]].into_iter().enumerate() {
            if !self.prepared.used[i] || self.single {
                continue;
            }
            let variance = self.prepared.variance[i];
            if let Some(input_noise) = &mut self.input_noise {
                input_noise.correct(i, covariance[(i, i)] + variance, covariance);
            }
            let observed = [(i, 1.0), (i, 0.0)];
            let (psi, row) = (&mut self.psi, self.information.next_row());
            let (e, s) = correct(observed, value, variance, mean, covariance, psi, row);
            self.count(k, i, e, s);
        }
        if self.settings.derivatives && recording.t()[k] > self.block_end {
            self.out.blocks.push(self.information.take_score());
            self.block_end += BLOCK;
        }
    }

    /// A single axis mapped to both wheels is measured once, by the mean of the wheels. Their difference,
    /// which is always zero, keeps the wheel states together and contains no information.
    fn measure_axis(&mut self, k: usize, mean: &mut Mean<N>, covariance: &mut Covariance<N>) {
        let recording = self.prepared.recording;
        let (a, w) = (recording.alpha()[k], recording.omega()[k]);
        for (i, value) in [(0, a[0]), (2, w[0])] {
            if self.prepared.used[i] {
                let variance = self.prepared.variance[i];
                let observed = [(i, 0.5), (i + 1, 0.5)];
                let (psi, row) = (&mut self.psi, self.information.next_row());
                let (e, s) = correct(observed, value, variance, mean, covariance, psi, row);
                self.count(k, i, e, s);
                let (psi, row) = (&mut self.psi, self.information.next_row());
                let apart = [(i, 1.0), (i + 1, -1.0)];
                correct(apart, 0.0, variance, mean, covariance, psi, row);
            }
        }
    }

    fn count(&mut self, row: usize, i: usize, e: f64, s: f64) {
        self.out.log_likelihood -= 0.5 * (e * (e / s));
        self.log_variance.add(2.0 * std::f64::consts::PI * s);
        if self.settings.keep_innovations {
            self.out.innovations.push(Innovation { row, channel: i, value: e, variance: s });
        }
        if self.settings.derivatives {
            self.information.add(e, s);
        }
    }
}
