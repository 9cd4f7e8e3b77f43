//! A stretch of rows without a gap: which of them are used, and the filtered columns of the moment
//! balance over it. Recordings that are held are cut into stretches at their gaps; those that are
//! read block by block at the blocks too.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::regressor::Regressor;
use crate::effects::Motion;
use crate::math::filter::{central_difference, low_pass};
use crate::model::Model;
use crate::recording::{Noise, Recording};

/// Near rest: below this share of the top speed, or three standard deviations of the filtered
/// speed's noise.
const REST: f64 = 0.002;
/// Length of the filter's answer [s Hz]: seconds times cut-off.
const REACH: f64 = 0.35;

/// What the rows of a recording are treated with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Treatment {
    /// Median step in time [s].
    pub(super) step: f64,
    /// Cut-off of the filter [Hz].
    pub(super) cutoff: f64,
    /// Speed below which a wheel counts as near rest [rad/s].
    slow: f64,
    /// Every how many rows one is kept.
    pub(super) every: usize,
}

impl Treatment {
    /// Cut-off and speed near rest as given, or from noise and motion of the recording.
    pub(super) fn new(
        recording: &Recording,
        cutoff_hz: Option<f64>,
        rest: Option<f64>,
        noise_share: f64,
    ) -> Self {
        let step = recording.step();
        let cutoff = cutoff(recording, cutoff_hz, noise_share);
        let ordinary = || {
            let sigma = recording.noise().omega;
            let left = (2.0 * cutoff * step).sqrt();
            (REST * recording.top_speed()).max(3.0 * left * sigma[0].max(sigma[1]))
        };
        let every = ((1.0 / (4.0 * cutoff * step)) as usize).max(1);
        Self { step, cutoff, slow: rest.unwrap_or_else(ordinary), every }
    }

    /// Whether a piece of that many rows is shorter than the filter's answer: it then holds
    /// nothing that the filter leaves intact.
    pub(super) fn is_too_short(&self, rows: usize) -> bool {
        (rows as f64) * self.step <= 4.0 * REACH / self.cutoff
    }

    /// Rows around a disturbance within which the filter's answer to it lies.
    pub(super) fn reach(&self) -> usize {
        ((REACH / self.cutoff / self.step).ceil() as usize).max(1)
    }

    /// Both wheels through the filter.
    pub(super) fn filtered(&self, rows: &[[f64; 2]]) -> [Vec<f64>; 2] {
        [0, 1].map(|i| self.low_pass(rows.iter().map(|r| r[i]).collect()))
    }

    fn low_pass(&self, signal: Vec<f64>) -> Vec<f64> {
        low_pass(&signal, 4, self.cutoff, 1.0 / self.step).unwrap_or(signal)
    }

    /// Samples with both wheels moving, away from rest and from the ends by the filter's length.
    pub(super) fn usable(&self, omega: &[Vec<f64>; 2]) -> Vec<bool> {
        let (samples, reach, slow) = (omega[0].len(), self.reach(), self.slow);
        let mut good = vec![true; samples];
        let mut until = 0; // up to here all is marked already
        for k in 0..samples {
            if k < reach || k + reach >= samples {
                good[k] = false;
            }
            let reversed =
                slow > 0.0 && k > 0 && (0..2).any(|i| omega[i][k] * omega[i][k - 1] <= 0.0);
            if reversed || omega.iter().any(|w| w[k].abs() < slow) {
                let (from, to) = (k.saturating_sub(reach).max(until), (k + reach + 1).min(samples));
                good[from..to].iter_mut().for_each(|g| *g = false);
                until = to;
            }
        }
        good
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

/// The motion and the drive that columns are made of.
#[derive(Clone)]
pub(super) struct Source {
    pub(super) alpha: Vec<[f64; 2]>,
    pub(super) omega: Vec<[f64; 2]>,
    pub(super) drive: Vec<[f64; 2]>,
}

impl Source {
    pub(super) fn measured(recording: &Recording) -> Self {
        Self {
            alpha: recording.alpha().to_vec(),
            omega: recording.omega().to_vec(),
            drive: recording.moment().to_vec(),
        }
    }

    /// The same with noise added; one draw for both wheels where they carry the `same` numbers.
    pub(super) fn with_noise(mut self, noise: &Noise, same: bool, rng: &mut ChaCha8Rng) -> Self {
        let mut normal = || -> f64 { StandardNormal.sample(&mut *rng) };
        for (rows, sigma) in [
            (&mut self.alpha, noise.alpha),
            (&mut self.omega, noise.omega),
            (&mut self.drive, noise.moment),
        ] {
            for row in rows.iter_mut() {
                let first = normal();
                let second = if same { first } else { normal() };
                row[0] += sigma[0] * first;
                row[1] += sigma[1] * second;
            }
        }
        self
    }
}

/// Rows without a gap between them.
pub(super) struct Stretch<'a> {
    /// Time [s].
    pub(super) t: &'a [f64],
    /// Time of the first row of the recording [s].
    pub(super) start: f64,
    /// Angles [rad].
    pub(super) alpha: &'a [[f64; 2]],
    /// Speeds [rad/s].
    pub(super) omega: &'a [[f64; 2]],
    /// The acting drive around each row.
    pub(super) drive: &'a [[f64; 2]],
}

impl Stretch<'_> {
    /// Filtered columns and right-hand side, `[wheel * (width + 1) + column]`.
    pub(super) fn signals(
        &self,
        regressor: &Regressor,
        model: &Model,
        treatment: &Treatment,
    ) -> Vec<Vec<f64>> {
        let t = self.t;
        // the moments pass the filter as often as the accelerations do
        let drive = treatment.filtered(self.drive);
        let omega = treatment.filtered(self.omega);
        let acceleration =
            [0, 1].map(|i| central_difference(t, &omega[i]).unwrap_or(vec![0.0; t.len()]));
        let width = regressor.width();
        let mut signals = vec![vec![0.0; t.len()]; 2 * (width + 1)];
        for k in 0..t.len() {
            let motion = Motion {
                t: t[k] - self.start,
                alpha: self.alpha[k],
                omega: [omega[0][k], omega[1][k]],
                variance: [0.0; 4],
                robot: model.robot(),
            };
            let balance = regressor.at(&motion);
            let a = [acceleration[0][k], acceleration[1][k]];
            for c in 0..=width {
                let moment = balance.moment(c, &a);
                for wheel in 0..2 {
                    signals[wheel * (width + 1) + c][k] =
                        if c < width { moment[wheel] } else { drive[wheel][k] - moment[wheel] };
                }
            }
        }
        signals.into_iter().map(|v| treatment.low_pass(v)).collect()
    }
}
