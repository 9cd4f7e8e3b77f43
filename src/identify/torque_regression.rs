//! Inverse-dynamic least squares: the method of the textbooks.

use nalgebra::{DMatrix, DVector};
use serde::Deserialize;

use super::identifiability::identified;
use super::regressor::balance_rows;
use super::{Fit, Identifier, IdentifyError, MethodDescription, OptionError, Task, from_options};
use crate::effects::Motion;
use crate::math::filter::{central_difference, low_pass};
use crate::math::{least_squares, robust};
use crate::recording::Recording;

/// Inverse-dynamic identification by least squares (IDIM-LS).
///
/// ```text
/// W θ = M,   W = [dw1, dw2, w2(w2-w1), sgn(w1), …] per effect, θ = (W'W)⁻¹ W'M
/// ```
/// Speeds pass a zero-phase Butterworth filter of order 4, are differentiated, and the columns
/// and the moments pass the same filter again, so that the relation stays linear; then every row
/// that the filter makes redundant is left out. Samples near rest, and the filter's length around
/// them, are dropped: what friction does there is not sgn(w).
///
/// Source: Gautier, "Dynamic identification of robots with power model", ICRA 1997; Janot,
/// Vandanjon, Gautier, Control Engineering Practice 2014.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueRegression {
    /// Cut-off of the filter [Hz]; chosen from noise and motion unless given.
    pub cutoff_hz: Option<f64>,
    /// How rows are weighted.
    pub weighting: Weighting,
}

/// How rows are weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Weighting {
    /// All alike.
    #[default]
    Ordinary,
    /// By the residual variance of their wheel.
    Weighted,
    /// Huber's loss: large residuals count less.
    Huber,
}

const NAME: &str = "torque_regression";
/// Noise that the chosen cut-off lets into the acceleration, as a share of its rms.
const NOISE_SHARE: f64 = 0.02;
/// Near rest: below this share of the top speed, or three standard deviations of the filtered
/// speed's noise.
const REST: f64 = 0.002;
/// Length of the filter's answer [s Hz]: seconds times cut-off.
const REACH: f64 = 0.35;
/// Blocks within which residuals may be correlated [s].
const BLOCK: f64 = 1.0;

impl Identifier for TorqueRegression {
    fn describe(&self) -> MethodDescription {
        let option = |k: &str, d: &str, m: &str| (k.into(), d.into(), m.into());
        MethodDescription {
            name: NAME.into(),
            title: "Inverse-dynamic least squares (IDIM-LS)".into(),
            equation: "W θ = M by least squares, W of filtered speeds and accelerations".into(),
            source: "Gautier 1997; Janot, Vandanjon and Gautier 2014".into(),
            use_when: "a quick look, clean data, very long recordings; the literature's reference"
                .into(),
            avoid_when: "speeds are noisy: accelerations are attenuated and inertias come out too \
                         small, and the best cut-off depends on the noise"
                .into(),
            options: vec![
                option("cutoff_hz", "from noise and motion", "cut-off of the filter [Hz]"),
                option("weighting", "ordinary", "ordinary, weighted or huber"),
            ],
        }
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let method: Self = from_options(NAME, options)?;
        if method.cutoff_hz.is_some_and(|f| !(f > 0.0 && f.is_finite())) {
            let message = "cutoff_hz must be a positive number".to_string();
            return Err(OptionError { method: NAME.into(), message });
        }
        Ok(Box::new(method))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let linear = task.model.linear();
        let mut rows = Rows::default();
        for recording in task.train {
            self.add_rows(task, &linear, recording, &mut rows);
        }
        let samples: usize = task.train.iter().map(Recording::len).sum();
        if rows.right.len() <= linear.len() + 2 {
            let usable = rows.right.len();
            return Err(IdentifyError::TooFewSamples { method: NAME.into(), usable, samples });
        }
        self.solve(task, &linear, &rows)
    }
}

#[derive(Default)]
struct Rows {
    columns: Vec<Vec<f64>>,
    right: Vec<f64>,
    wheel: Vec<usize>,
    block: Vec<usize>,
}

impl TorqueRegression {
    /// The chosen or given cut-off [Hz].
    ///
    /// ```text
    /// var(noise of dw after the filter) = (2π)² σ² 2 fc³ / (3 rate) = (0.02 rms dw)²
    /// ```
    fn cutoff(&self, recording: &Recording) -> f64 {
        let rate = 1.0 / recording.step();
        let automatic = || {
            let motion = recording.local_motion();
            let square: f64 =
                motion.iter().map(|m| m.acceleration[0].powi(2) + m.acceleration[1].powi(2)).sum();
            let rms = (square / (2.0 * motion.len() as f64)).sqrt();
            let noise = recording.noise();
            let sigma = noise.omega[0].max(noise.omega[1]).max(1e-12);
            let turn = std::f64::consts::TAU;
            let allowed = (NOISE_SHARE * rms).powi(2);
            (3.0 * rate * allowed / (2.0 * turn * turn * sigma * sigma)).cbrt()
        };
        self.cutoff_hz.unwrap_or_else(automatic).clamp(0.5_f64.min(0.1 * rate), 0.1 * rate)
    }

    fn add_rows(&self, task: &Task, linear: &[usize], recording: &Recording, out: &mut Rows) {
        let cutoff = self.cutoff(recording);
        let drive = task.model.drive(recording.t(), recording.moment(), &task.model.initial());
        for piece in recording.pieces() {
            // a piece shorter than the filter's answer holds nothing the filter leaves intact
            if (piece.len() as f64) * recording.step() > 4.0 * REACH / cutoff {
                self.add_piece(task, linear, recording, &drive, piece.clone(), cutoff, out);
            }
        }
    }

    fn add_piece(
        &self,
        task: &Task,
        linear: &[usize],
        recording: &Recording,
        drive: &[[f64; 2]],
        piece: std::ops::Range<usize>,
        cutoff: f64,
        out: &mut Rows,
    ) {
        let rate = 1.0 / recording.step();
        let t = &recording.t()[piece.clone()];
        let filter = |v: Vec<f64>| low_pass(&v, 4, cutoff, rate).unwrap_or(v);
        let column = |rows: &[[f64; 2]], i: usize| -> Vec<f64> {
            rows[piece.clone()].iter().map(|r| r[i]).collect()
        };
        let omega = [0, 1].map(|i| filter(column(recording.omega(), i)));
        let acceleration =
            [0, 1].map(|i| central_difference(t, &omega[i]).unwrap_or(vec![0.0; t.len()]));
        let width = linear.len();
        let mut signals = vec![vec![0.0; t.len()]; 2 * (width + 1)];
        let mut row = [vec![0.0; width], vec![0.0; width]];
        let p = task.model.initial();
        for k in 0..t.len() {
            let motion = Motion {
                t: t[k] - recording.t()[0],
                alpha: recording.alpha()[piece.start + k],
                omega: [omega[0][k], omega[1][k]],
                variance: [0.0; 4],
                robot: task.model.robot(),
            };
            let a = [acceleration[0][k], acceleration[1][k]];
            let m = drive[piece.start + k];
            let right = balance_rows(task.model, &p, linear, &motion, &a, &m, &mut row);
            for wheel in 0..2 {
                for j in 0..width {
                    signals[wheel * (width + 1) + j][k] = row[wheel][j];
                }
                signals[wheel * (width + 1) + width][k] = right[wheel];
            }
        }
        let signals: Vec<Vec<f64>> = signals.into_iter().map(filter).collect();
        let usable = usable(&omega, recording, cutoff);
        let every = ((rate / (4.0 * cutoff)) as usize).max(1);
        let first_block = out.block.iter().max().map_or(0, |b| b + 1);
        for k in (0..t.len()).step_by(every).filter(|&k| usable[k]) {
            for wheel in 0..2 {
                let start = wheel * (width + 1);
                out.columns.push((0..width).map(|j| signals[start + j][k]).collect());
                out.right.push(signals[start + width][k]);
                out.wheel.push(wheel);
                out.block.push(first_block + ((t[k] - t[0]) / BLOCK) as usize);
            }
        }
    }

    fn solve(&self, task: &Task, linear: &[usize], rows: &Rows) -> Result<Fit, IdentifyError> {
        let width = linear.len();
        let x = DMatrix::from_fn(rows.right.len(), width, |i, j| rows.columns[i][j]);
        let y = DVector::from_column_slice(&rows.right);
        let wrong = |e: crate::math::MathError| IdentifyError::Unsupported {
            method: NAME.into(),
            reason: e.to_string(),
        };
        let (fit, weights) = match self.weighting {
            Weighting::Ordinary => (least_squares::fit(&x, &y, None).map_err(wrong)?, None),
            Weighting::Weighted => {
                let first = least_squares::fit(&x, &y, None).map_err(wrong)?;
                let weights = wheel_weights(&first.residuals, &rows.wheel);
                (least_squares::fit(&x, &y, Some(&weights)).map_err(wrong)?, Some(weights))
            }
            Weighting::Huber => {
                let robust = robust::fit_huber(&x, &y, None).map_err(wrong)?;
                (robust.fit, Some(robust.row_weights))
            }
        };
        // the information that the block-robust covariance stands for, so that directions the
        // data do not give are treated as in every other method
        let total = task.model.parameters().len();
        let mut information = DMatrix::zeros(total, total);
        let variance = fit.residual_variance.max(f64::MIN_POSITIVE);
        for i in 0..width {
            for k in 0..width {
                information[(linear[i], linear[k])] = x.column(i).dot(&x.column(k)) / variance;
            }
        }
        let mut p = task.model.initial();
        for (value, &j) in fit.coefficients.iter().zip(linear) {
            p[j] = *value;
        }
        settle_single_axis(&mut p, task);
        // shapes and drives are not estimated here; they count as held
        let mut held = task.model.clone();
        for j in task.model.free().into_iter().filter(|j| !linear.contains(j)) {
            held = held.fix(&task.model.parameters()[j].spec.symbol, p[j])?;
        }
        let mut known = identified(&held, &p, &information, task.train);
        if let Ok(robust) = fit.sandwich(&x, weights.as_ref(), &rows.block) {
            for i in 0..width {
                for k in 0..width {
                    let entry = &mut known.covariance[(linear[i], linear[k])];
                    if entry.is_finite() {
                        *entry = robust[(i, k)];
                    }
                }
            }
        }
        let unit = task.train[0].drive_unit();
        let mut out = Fit::physical(NAME, task.model, p, known.covariance, unit);
        for estimate in &mut out.estimates {
            let j = task.model.index_of(&estimate.symbol)?;
            estimate.fixed |= !linear.contains(&j);
        }
        out.notes = known.notes;
        let cutoffs: Vec<String> =
            task.train.iter().map(|r| format!("{:.2}", self.cutoff(r))).collect();
        out.notes.push(format!("Cut-off of the filter: {} Hz.", cutoffs.join(", ")));
        out.work.evaluations = 1;
        Ok(out)
    }
}

/// One axis gives a1 + a2 alone; of all that fit, one that can move (a1 above |a2|) is taken.
fn settle_single_axis(p: &mut [f64], task: &Task) {
    let free = |j: usize| task.model.parameters()[j].fixed.is_none();
    if free(0) && free(1) && task.train.iter().all(Recording::is_single_axis) {
        let sum = p[0] + p[1];
        (p[0], p[1]) = (0.525 * sum, 0.475 * sum);
    }
}

/// One over the residual variance of the row's wheel.
fn wheel_weights(residuals: &DVector<f64>, wheel: &[usize]) -> DVector<f64> {
    let (mut sum, mut count) = ([0.0; 2], [0.0; 2]);
    for (r, &w) in residuals.iter().zip(wheel) {
        sum[w] += r * r;
        count[w] += 1.0;
    }
    let variance = [0, 1].map(|w| f64::max(sum[w] / f64::max(count[w], 1.0), 1e-300));
    DVector::from_fn(wheel.len(), |i, _| 1.0 / variance[wheel[i]])
}

/// Samples with both wheels moving, away from rest and from the ends by the filter's length.
fn usable(omega: &[Vec<f64>; 2], recording: &Recording, cutoff: f64) -> Vec<bool> {
    let samples = omega[0].len();
    let reach = ((REACH / cutoff / recording.step()).ceil() as usize).max(1);
    let sigma = recording.noise().omega;
    let left = (2.0 * cutoff * recording.step()).sqrt();
    let slow = (REST * recording.top_speed()).max(3.0 * left * sigma[0].max(sigma[1]));
    let mut good = vec![true; samples];
    for k in 0..samples {
        let end = k < reach || k + reach >= samples;
        let reversed = k > 0 && (0..2).any(|i| omega[i][k] * omega[i][k - 1] <= 0.0);
        if end {
            good[k] = false;
        }
        if reversed || omega.iter().any(|w| w[k].abs() < slow) {
            let (from, to) = (k.saturating_sub(reach), (k + reach + 1).min(samples));
            good[from..to].iter_mut().for_each(|g| *g = false);
        }
    }
    good
}
