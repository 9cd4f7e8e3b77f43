//! One run of the filter over a recording.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::ProcessNoise;
use super::correction::CHANNELS;
use super::coupled::Coupled;
use super::dynamics::Dynamics;
use super::friction::between;
use super::input_noise::InputNoise;
use super::prepare::Prepared;
use super::rigid::Rigid;
use super::run::{Drive, EXACT, Innovation, InputSlopes, Run, Start};
use super::sample::{Predicted, Sample, lag_of_angle};
use crate::effects::Motion;
use crate::model::{Model, ModelError};

/// Standard deviations of its noise between which a second difference of the input is attributed to
/// a jump.
const JUMP: (f64, f64) = (3.0, 5.0);

/// Additional torque columns of a pass, whose coefficients are zero in the model.
pub trait Columns: Sync {
    /// How many.
    fn count(&self) -> usize;
    /// How many successive ones are tested together; the information of columns of different groups about each other
    /// may be left at zero.
    fn together(&self) -> usize {
        self.count()
    }
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

/// Noise of a pass, and what it computes besides the likelihood.
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
    /// Standard deviation of the time at which the input changes in its row, relative to that of a uniformly
    /// distributed one; 0 for changes at the rows.
    pub step_scatter: f64,
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
    /// In the order of the measurements, where kept.
    pub innovations: Vec<Innovation>,
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
    let recording = prepared.recording;
    let (input, by_parameter) = model.input_derivatives_of(recording, recording.torque(), p);
    let acts = by_parameter.iter().any(|d| !d.is_empty());
    let over = Recorded { model, prepared, settings, columns, input, by_parameter, acts };
    let noise = settings.noise;
    if model.is_coupled() {
        over.pass(Coupled::step(model, p, noise))
    } else if noise.sigma_d == 0.0 {
        // without the states of the slow torques, which would stay at zero
        over.pass::<_, 4>(Rigid::step(model, p, noise))
    } else {
        over.pass::<_, 6>(Rigid::step(model, p, noise))
    }
}

/// A recording with its acting input.
struct Recorded<'a> {
    model: &'a Model,
    prepared: &'a Prepared<'a>,
    settings: &'a PassSettings,
    columns: &'a dyn Columns,
    input: Vec<[f64; 2]>,
    by_parameter: Vec<Vec<[f64; 2]>>,
    /// Whether a parameter acts through the input.
    acts: bool,
}

/// A piece of it between gaps.
struct Piece<'a> {
    of: &'a Recorded<'a>,
    rows: Range<usize>,
}

impl Recorded<'_> {
    fn pass<D: Dynamics<N>, const N: usize>(&self, dynamics: D) -> Result<Pass, ModelError> {
        let (prepared, settings) = (self.prepared, self.settings);
        let single = prepared.recording.is_single_axis();
        let widths = (self.by_parameter.len(), self.columns.count());
        let derivatives = settings.derivatives.then_some(widths);
        let mut run = Run::new(dynamics, prepared, &prepared.variance, single, derivatives);
        run.test_in_groups(widths.0, self.columns.together());
        let values = CHANNELS * prepared.recording.len();
        run.innovations = settings.keep_innovations.then(|| Vec::with_capacity(values));
        // a single axis is a motor with an encoder of its own, whose noise is small
        if settings.derivatives && settings.input_noise && !single {
            // if the recorded roughness of the input is real, the process noise is small
            let sigma = settings.noise.sigma_m.min(prepared.torque_noise);
            run.input_noise = Some(InputNoise::new(sigma * sigma, widths.0));
        }
        for rows in prepared.recording.pieces() {
            let piece = Piece { of: self, rows: rows.clone() };
            run.start(rows.start, &self.start(rows.start));
            for k in rows.start + 1..rows.end {
                run.row(k, &piece)?;
            }
        }
        let (sums, input_noise, innovations) = run.finish();
        let constant = sums.count * (2.0 * std::f64::consts::PI).ln();
        Ok(Pass {
            log_likelihood: -0.5 * (sums.square + sums.log_variance + constant),
            information: sums.information,
            score: sums.score,
            score_of_input_noise: input_noise.map_or(DVector::zeros(0), InputNoise::finish),
            innovations: innovations.unwrap_or_default(),
        })
    }

    /// The measured row `k`. The variance of a channel that is computed from the other follows from that one.
    fn start(&self, k: usize) -> Start {
        let (recording, used) = (self.prepared.recording, &self.prepared.used);
        let step = recording.step();
        let measured = &self.prepared.variance;
        let variance = |i: usize| match i {
            _ if used[i] => measured[i],
            0 | 1 => EXACT,
            _ => 2.0 * measured[i - 2] / (step * step),
        };
        Start {
            alpha: recording.alpha()[k],
            omega: recording.omega()[k],
            variance: [0, 1, 2, 3].map(variance),
            input: self.input[k],
        }
    }
}

impl Drive for Piece<'_> {
    /// The step from sample k - 1 to k.
    ///
    /// ```text
    /// mean input = (1 - c) M0 + c M1 - c (1 - c)/3 h^2 M'',   h^2 M'' = (M_-1 - M0 - M1 + M2)/2
    /// ```
    /// exact to second order for an input held over each of m parts of a row, c = (m - 1)/(2 m); a
    /// second difference beyond noise is a jump, for which no curvature is assumed.
    #[inline]
    fn sample<'s>(&self, k: usize, slopes: Option<&'s mut InputSlopes>) -> Sample<'s> {
        let Recorded { prepared, input: m, .. } = self.of;
        let (t, raw) = (prepared.recording.t(), prepared.recording.torque());
        let PassSettings {
            noise: ProcessNoise { later: c, sigma_m, .. },
            step_scatter: scatter,
            ..
        } = *self.of.settings;
        let inside = k >= self.rows.start + 2 && k + 1 < self.rows.end;
        let mut input = [0.0; 2];
        for i in 0..2 {
            input[i] = (1.0 - c) * m[k - 1][i] + c * m[k][i];
            if inside {
                let bend = 0.5 * (m[k - 2][i] - m[k - 1][i] - m[k][i] + m[k + 1][i]);
                let curved = 1.0 - between(JUMP, bend.abs() / sigma_m.max(f64::MIN_POSITIVE));
                input[i] -= curved * c * (1.0 - c) / 3.0 * bend;
            }
        }
        let mut by_parameter: &[[f64; 2]] = &[];
        if let Some(slopes) = slopes.filter(|_| self.of.acts) {
            let acting = slopes.mean.iter_mut().zip(&self.of.by_parameter);
            for (slope, d) in acting.filter(|(_, d)| !d.is_empty()) {
                *slope = [0, 1].map(|i| (1.0 - c) * d[k - 1][i] + c * d[k][i]);
            }
            by_parameter = &slopes.mean;
        }
        Sample {
            t: t[k - 1] - t[0],
            step: t[k] - t[k - 1],
            input,
            ends: [m[k - 1], m[k]],
            tilt: lag_of_angle(c, &m[k - 1], &m[k]),
            smoother: [0.0; 2],
            crossing: [0.0; 4],
            change: [0, 1].map(|i| scatter * (raw[k][i] - raw[k - 1][i])),
            by_parameter,
            ends_by_parameter: &[],
            speed_variance: prepared.speed_variance,
            still: [0, 1].map(|i| prepared.still[k - 1][i] && prepared.still[k][i]),
        }
    }

    #[inline]
    fn columns(&self, k: usize, sample: &Sample, predicted: &Predicted, extra: &mut [[f64; 2]]) {
        if extra.is_empty() {
            return;
        }
        let Predicted { acceleration, sign, alpha, omega, variance, spread } = *predicted;
        let t = sample.t + 0.5 * sample.step;
        let robot = self.of.model.robot();
        let at = Instant {
            sample: k - 1,
            motion: Motion { t, alpha, omega, variance, robot },
            acceleration,
            sign,
            spread,
            speed_variance: sample.speed_variance,
            input: sample.input,
        };
        self.of.columns.torque(&at, extra);
    }
}
