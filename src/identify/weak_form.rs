//! Weak form with the covariance of its own residuals and without the bias of noisy speeds.

use nalgebra::{Cholesky, DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::Deserialize;

use super::identifiability::{inverse_where_known, known_part};
use super::linear_fit::{block_covariance, linear_fit};
use super::regressor::{Regressor, drive_around};
use super::weak::{Window, motion_at, weak_rows, windows};
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, OptionError, Status, Task, from_options,
    options_schema, start,
};
use crate::model::Linearisation;
use crate::recording::Recording;

/// Weak form: moments integrated against test functions, weighted by their covariance.
///
/// ```text
/// r = Y - R θ,  rows ∫ψ M dt = Σ θ_c ∫(ψ torque_c - ψ' mass_c ω) dt,  ψ = (1 - x²)⁴
/// V = cov r = σ_M² T T' + E S E',   E = ∂(Rθ)/∂ω,  S = diag σ_ω²
/// (R~' V⁻¹ R) θ = R~' V⁻¹ Y,   R~_c = R_c + (∂R_c/∂ω) S E' V⁻¹ r
/// ```
/// No acceleration is needed. R~ is the expectation of R given the residual: without it noise of
/// the speeds would pull the inertias.
///
/// Source: Bortz, Messenger and Dukic, "Direct estimation of parameters in ODE models using WENDy",
/// Bull. Math. Biol. 85 (2023). Deviation: the left factor R~ (errors in variables).
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WeakForm {
    /// Half width of the test functions [s].
    pub half_width_s: f64,
    /// Whether rows are weighted by their covariance.
    pub reweighting: bool,
    /// Whether the pull of noisy speeds is taken out; needs `reweighting`.
    pub noise_correction: bool,
}

impl Default for WeakForm {
    fn default() -> Self {
        Self { half_width_s: 0.12, reweighting: true, noise_correction: true }
    }
}

const NAME: &str = "weak_form";
/// Test functions on each half width.
const PER_HALF: usize = 4;
/// Windows whose covariance is inverted together.
const TOGETHER: usize = 30;
/// Most reweighted solutions; a change by this share of the standard errors is the last.
const ITERATIONS: usize = 20;
const SETTLED: f64 = 1e-3;
/// Blocks for standard errors [s], and how many there should be.
const BLOCK: (f64, f64) = (1.0, 5.0);
const BLOCKS: f64 = 20.0;

impl Identifier for WeakForm {
    fn describe(&self) -> MethodDescription {
        let option = |k: &str, d: &str, m: &str| (k.into(), d.into(), m.into());
        MethodDescription {
            name: NAME.into(),
            title: "Weak form (WENDy with errors in variables)".into(),
            equation: "∫ψ M dt = Σ θ ∫(ψ torque - ψ' mass ω) dt by generalised least squares"
                .into(),
            source: "Bortz, Messenger and Dukic 2023".into(),
            use_when: "second, to confirm prediction_error: no acceleration, no start, no filter \
                       to tune; its intervals hold"
                .into(),
            avoid_when: "only angles are measured (it uses speeds); the robot reverses all the \
                         time, since windows that touch rest are dropped"
                .into(),
            options: vec![
                option("half_width_s", "0.12", "half width of the test functions [s]"),
                option("reweighting", "true", "weight rows by their covariance"),
                option("noise_correction", "true", "take out the pull of noisy speeds"),
            ],
        }
    }

    fn schema(&self) -> schemars::Schema {
        options_schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let method: Self = from_options(NAME, options)?;
        if !(method.half_width_s > 0.0 && method.half_width_s.is_finite()) {
            let message = "`half_width_s` must be a positive number".to_string();
            return Err(OptionError { method: NAME.into(), message });
        }
        Ok(Box::new(method))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let p = start::start(task, NAME)?;
        let regressor = Regressor::new(task.model, &task.model.initial());
        let width = regressor.width();
        let groups = self.groups(task, &regressor);
        let rows: usize = groups.iter().map(|g| g.y.len()).sum();
        if width == 0 || rows <= 2 * width + 2 {
            let samples = task.train.iter().map(Recording::len).sum();
            return Err(IdentifyError::TooFewSamples {
                method: NAME.into(),
                usable: rows,
                samples,
            });
        }
        let mut values = DVector::from_fn(width, |c, _| p[regressor.linear[c]]);
        let mut sums = self.sums(&groups, &values, None);
        let projection = known_part(&sums.information, &sums.noise);
        let mut status = Status::IterationLimit;
        let mut iterations = 0;
        while iterations < ITERATIONS {
            sums = self.sums(&groups, &values, projection.as_ref());
            let next = sums.solve();
            let error = inverse_where_known(&sums.information).map_diagonal(|v| v.sqrt());
            let moved = (0..width).any(|c| (next[c] - values[c]).abs() > SETTLED * error[c]);
            values = next;
            iterations += 1;
            if !moved {
                status = Status::Converged;
                break;
            }
        }
        sums = self.sums(&groups, &values, projection.as_ref());
        let covariance = self.covariance(&sums, rows);
        let (linear, information) = (&regressor.linear, &sums.information);
        let mut fit = linear_fit(NAME, task, linear, &values, information, &covariance)?;
        fit.status = status;
        fit.work.iterations = iterations;
        fit.work.evaluations = iterations + 2;
        Ok(fit)
    }
}

/// Consecutive windows of a recording, with derivatives of their rows by the speeds.
struct Group {
    x: DMatrix<f64>,
    y: DVector<f64>,
    /// What noise added once more changes of `x`.
    change: DMatrix<f64>,
    windows: Vec<Window>,
    /// Derivatives of row `2 window + wheel` by the speeds, `[row][column][sample of window]`;
    /// the last column is what is not linear.
    slopes: Vec<Vec<Vec<[f64; 2]>>>,
    /// Variances of the speeds, and of the drive of each wheel.
    variance: [f64; 2],
    drive_variance: [f64; 2],
    block: usize,
}

/// Sums over all groups.
struct Sums {
    /// `R~' V⁻¹ R`.
    left: DMatrix<f64>,
    /// `R~' V⁻¹ Y`.
    right: DVector<f64>,
    /// `R' V⁻¹ R`.
    information: DMatrix<f64>,
    /// The part of it that is noise.
    noise: DMatrix<f64>,
    /// `R~' V⁻¹ r` of each group, and its block.
    scores: Vec<(usize, DVector<f64>)>,
    /// `r' V⁻¹ r`.
    square: f64,
}

impl Sums {
    fn solve(&self) -> DVector<f64> {
        // directions without information stay at zero
        let half = inverse_where_known(&self.information);
        let inside = &half * &self.left;
        let right = &half * &self.right;
        inside.pseudo_inverse(1e-9).map_or(right.clone(), |inverse| inverse * &right)
    }
}

impl WeakForm {
    fn groups(&self, task: &Task, regressor: &Regressor) -> Vec<Group> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(task.seed);
        let total: f64 = task.train.iter().map(Recording::duration).sum();
        let length = (total / BLOCKS).clamp(BLOCK.0, BLOCK.1);
        let (mut out, mut first) = (Vec::new(), 0);
        for recording in task.train {
            let windows = windows(recording, self.half_width_s, PER_HALF);
            let noise = recording.noise();
            let drive = drive_around(task, recording, recording.moment());
            let mut noisy = recording.omega().to_vec();
            for row in &mut noisy {
                for i in 0..2 {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    row[i] += noise.omega[i] * draw;
                }
            }
            let scale = drive.iter().flatten().map(|m| m.abs()).fold(1e-9, f64::max);
            let speed = recording.top_speed();
            for part in windows.chunks(TOGETHER) {
                let rows =
                    |omega: &[[f64; 2]]| weak_rows(task, regressor, recording, part, omega, &drive);
                let (x, y) = rows(recording.omega());
                let time = recording.t()[part[0].samples.start] - recording.t()[0];
                out.push(Group {
                    change: rows(&noisy).0 - &x,
                    slopes: slopes(task, regressor, recording, part),
                    windows: part.to_vec(),
                    variance: noise.omega.map(|s| s.max(1e-6 * speed).powi(2)),
                    drive_variance: noise.moment.map(|s| s.max(1e-6 * scale).powi(2)),
                    block: first + (time / length) as usize,
                    x,
                    y,
                });
            }
            first = out.last().map_or(first, |g| g.block + 1);
        }
        out
    }

    fn sums(
        &self,
        groups: &[Group],
        values: &DVector<f64>,
        projection: Option<&DMatrix<f64>>,
    ) -> Sums {
        let width = values.len();
        let zero = DMatrix::zeros(width, width);
        let mut out = Sums {
            left: zero.clone(),
            right: DVector::zeros(width),
            information: zero.clone(),
            noise: zero,
            scores: vec![],
            square: 0.0,
        };
        let values = projection.map_or_else(|| values.clone(), |p| p * values);
        for group in groups {
            let Some(v) = self.covariance_of_rows(group, &values) else { continue };
            let r = &group.y - &group.x * &values;
            let weighed = v.solve(&r);
            let mut left = group.x.clone();
            if self.reweighting && self.noise_correction {
                group.correct(&values, &weighed, &mut left);
            }
            let mut x = group.x.clone();
            if let Some(p) = projection {
                (left, x) = (left * p, x * p);
            }
            let solved = v.solve(&x);
            out.left += left.tr_mul(&solved);
            out.right += left.tr_mul(&v.solve(&group.y));
            out.information += x.tr_mul(&solved);
            out.noise += group.change.tr_mul(&v.solve(&group.change));
            out.scores.push((group.block, left.tr_mul(&weighed)));
            out.square += r.dot(&weighed);
        }
        out
    }

    fn covariance_of_rows(
        &self,
        group: &Group,
        values: &DVector<f64>,
    ) -> Option<Cholesky<f64, nalgebra::Dyn>> {
        let n = group.y.len();
        let mut v = DMatrix::identity(n, n);
        if self.reweighting {
            v = group.covariance(values);
            let ridge = 1e-10 * v.trace() / n as f64;
            (0..n).for_each(|i| v[(i, i)] += ridge);
        }
        v.cholesky()
    }

    /// The larger of what the noise explains and what blocks of residuals show.
    fn covariance(&self, sums: &Sums, rows: usize) -> DMatrix<f64> {
        let width = sums.right.len();
        let excess = (sums.square / (rows - width) as f64).max(f64::MIN_POSITIVE);
        let excess = if self.reweighting { excess.max(1.0) } else { excess };
        let model = inverse_where_known(&sums.information) * excess;
        let z = DMatrix::from_fn(sums.scores.len(), width, |i, c| sums.scores[i].1[c]);
        let block: Vec<usize> = sums.scores.iter().map(|s| s.0).collect();
        let bread = inverse_where_known(&sums.information);
        let robust = block_covariance(&bread, &z, &DVector::repeat(z.nrows(), 1.0), &block);
        let enough = block.last().is_some_and(|b| *b >= 5);
        let stretch = DVector::from_fn(width, |c, _| {
            let ratio = robust[(c, c)] / model[(c, c)].max(f64::MIN_POSITIVE);
            if enough && ratio.is_finite() { ratio.max(1.0).sqrt() } else { 1.0 }
        });
        DMatrix::from_fn(width, width, |i, k| model[(i, k)] * stretch[i] * stretch[k])
    }
}

impl Group {
    /// Derivative of row `row` of R θ by the speeds of its window.
    fn slope(&self, row: usize, values: &DVector<f64>) -> Vec<[f64; 2]> {
        let columns = &self.slopes[row];
        let mut out = columns[values.len()].clone();
        for (c, value) in values.iter().enumerate() {
            for (sum, slope) in out.iter_mut().zip(&columns[c]) {
                sum[0] += value * slope[0];
                sum[1] += value * slope[1];
            }
        }
        out
    }

    /// Covariance of the residuals.
    fn covariance(&self, values: &DVector<f64>) -> DMatrix<f64> {
        let n = self.y.len();
        let slopes: Vec<_> = (0..n).map(|row| self.slope(row, values)).collect();
        let mut v = DMatrix::zeros(n, n);
        for i in 0..n {
            for k in 0..=i {
                let (a, b) = (&self.windows[i / 2], &self.windows[k / 2]);
                let from = a.samples.start.max(b.samples.start);
                let to = a.samples.end.min(b.samples.end);
                let mut sum = 0.0;
                for s in from..to {
                    let (sa, sb) = (s - a.samples.start, s - b.samples.start);
                    let (ei, ek) = (slopes[i][sa], slopes[k][sb]);
                    sum += self.variance[0] * ei[0] * ek[0] + self.variance[1] * ei[1] * ek[1];
                    if i % 2 == k % 2 {
                        sum += self.drive_variance[i % 2] * a.weight[sa] * b.weight[sb];
                    }
                }
                v[(i, k)] = sum;
                v[(k, i)] = sum;
            }
        }
        v
    }

    /// Adds to the columns what the residual tells of their noise, `(∂R_c/∂ω) S E' V⁻¹ r`.
    fn correct(&self, values: &DVector<f64>, weighed: &DVector<f64>, left: &mut DMatrix<f64>) {
        let first = self.windows[0].samples.start;
        let last = self.windows.iter().map(|w| w.samples.end).max().unwrap_or(first);
        let mut told = vec![[0.0; 2]; last - first];
        for (row, weight) in weighed.iter().enumerate() {
            let start = self.windows[row / 2].samples.start - first;
            for (s, e) in self.slope(row, values).iter().enumerate() {
                for l in 0..2 {
                    told[start + s][l] += self.variance[l] * e[l] * weight;
                }
            }
        }
        for row in 0..weighed.len() {
            let start = self.windows[row / 2].samples.start - first;
            for c in 0..values.len() {
                let slopes = self.slopes[row][c].iter().zip(&told[start..]);
                left[(row, c)] += slopes.map(|(d, z)| d[0] * z[0] + d[1] * z[1]).sum::<f64>();
            }
        }
    }
}

/// Derivatives of the rows of consecutive windows by the speeds.
fn slopes(
    task: &Task,
    regressor: &Regressor,
    recording: &Recording,
    windows: &[Window],
) -> Vec<Vec<Vec<[f64; 2]>>> {
    let width = regressor.width();
    let first = windows[0].samples.start;
    let last = windows.iter().map(|w| w.samples.end).max().unwrap_or(first);
    let mut work = Linearisation::new(task.model.parameters().len());
    let instants: Vec<_> = (first..last)
        .map(|k| {
            let motion = motion_at(task, recording, k, recording.omega()[k]);
            (regressor.at(&motion).mass, regressor.slopes(&motion, &mut work))
        })
        .collect();
    let mut out = Vec::with_capacity(2 * windows.len());
    for window in windows {
        for wheel in 0..2 {
            let column = |c: usize| -> Vec<[f64; 2]> {
                let along = window.weight.iter().zip(&window.slope);
                let at = window.samples.clone().zip(along);
                at.map(|(k, (weight, slope))| {
                    let (mass, torque) = &instants[k - first];
                    let [m11, m12, m22] = mass[c];
                    let mass = if wheel == 0 { [m11, m12] } else { [m12, m22] };
                    [0, 1].map(|l| weight * torque[c][wheel][l] - slope * mass[l])
                })
                .collect()
            };
            out.push((0..=width).map(column).collect());
        }
    }
    out
}
