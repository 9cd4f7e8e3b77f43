//! Weak form with the covariance of its own residuals and without the bias of noisy speeds.

mod group;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use self::group::{Group, slopes};
use super::identifiability::{inverse_where_known, known_part};
use super::linear_fit::linear_fit;
use super::regressor::{Regressor, input_around};
use super::weak::{Window, longest_motion, weak_rows, windows};
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, Status, Task, Unsupported,
    fields_as_options, start,
};
use crate::math::{BandedCholesky, clustered_covariance, pseudo_inverse, raise_errors};
use crate::recording::Recording;

/// Weak form: torques integrated against test functions, weighted by their covariance.
///
/// ```text
/// r = Y - R θ,  rows ∫ψ M dt = Σ θ_c ∫(ψ torque_c - ψ' mass_c ω) dt,  ψ = (1 - x²)⁴
/// V = cov r = σ_M² T T' + E S E',   E = ∂(Rθ)/∂ω,  S = diag σ_ω²
/// (R~' V⁻¹ R) θ = R~' V⁻¹ Y,   R~_c = R_c + (∂R_c/∂ω) S E' V⁻¹ r
/// ```
/// No acceleration is needed. R~ is the expectation of R given the residual: without it noise of
/// the speeds would bias the inertias.
///
/// Source: Bortz, Messenger and Dukic, "Direct estimation of parameters in ODE models using WENDy",
/// Bull. Math. Biol. 85 (2023). Deviation: the left factor R~ (errors in variables).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WeakForm {
    /// Half width of the test functions \[s\]; default: the most informative of 0.12, 0.24, 0.48 and 0.96.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub half_width_s: Option<f64>,
    /// Whether rows are weighted by their covariance.
    pub reweighting: bool,
    /// Whether the bias from noisy speeds is removed; needs `reweighting`.
    pub noise_correction: bool,
}

impl Default for WeakForm {
    fn default() -> Self {
        Self { half_width_s: None, reweighting: true, noise_correction: true }
    }
}

const NAME: &str = "weak_form";
/// Half widths that are compared \[s\].
const HALF_WIDTHS: [f64; 4] = [0.12, 0.24, 0.48, 0.96];
/// Information of a direction, scaled, below which it is rounding.
const NOTHING: f64 = 1e-12;
/// Test functions on each half width.
const PER_HALF: usize = 4;
/// Most reweighted solutions; a change by this share of the standard errors is the last.
const ITERATIONS: usize = 20;
const SETTLED: f64 = 1e-3;
/// Blocks for standard errors \[s\], and how many there should be.
const BLOCK: (f64, f64) = (1.0, 5.0);
const BLOCKS: f64 = 20.0;
/// Number of the last block below which they are too few to show anything.
const FEWEST_BLOCKS: usize = 5;

impl Identifier for WeakForm {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Weak form (WENDy with errors in variables)".into(),
            equation: "∫ψ M dt = Σ θ ∫(ψ torque - ψ' mass ω) dt by generalised least squares"
                .into(),
            source: "Bortz, Messenger and Dukic 2023".into(),
            use_when:
                "second, to confirm prediction_error: no acceleration, start values or filter \
                       needed; its intervals cover the true values"
                    .into(),
            avoid_when: "only angles are measured (it uses speeds); the robot reverses all the \
                         time, since windows that touch rest are dropped"
                .into(),
        }
    }

    fn rank(&self) -> Option<usize> {
        Some(1)
    }

    fields_as_options!(NAME);

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let p = start::start(task, NAME)?;
        let regressor = Regressor::new(task.model, &task.model.initial());
        let width = regressor.width();
        if width == 0 {
            let reason = Unsupported::NoLinearParameter;
            return Err(IdentifyError::Unsupported { method: NAME.into(), reason });
        }
        let groups = self.most_informative(task, &regressor, &p);
        let rows: usize = groups.iter().map(|g| g.y.len()).sum();
        if rows <= 2 * width + 2 {
            let samples = task.train.iter().map(Recording::len).sum();
            return Err(IdentifyError::TooFewSamples {
                method: NAME.into(),
                usable: rows,
                samples,
                moving_s: longest_motion(task.train),
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
        let fit = linear_fit(NAME, task, linear, &values, information, &covariance)?;
        let blocks = sums.scores.iter().map(|s| s.0).collect::<std::collections::BTreeSet<_>>();
        let mut fit = fit.with_degrees((blocks.len() as f64 - width as f64).max(1.0));
        fit.status = status;
        fit.work.iterations = iterations;
        fit.work.evaluations = iterations + 2;
        Ok(fit)
    }
}

/// Sums over all groups.
struct Sums {
    /// `R~' V⁻¹ R`, of the equations for the parameters.
    left: DMatrix<f64>,
    /// `R~' V⁻¹ Y`.
    right: DVector<f64>,
    /// `R' V⁻¹ R`.
    information: DMatrix<f64>,
    /// The part of it that is noise.
    noise: DMatrix<f64>,
    /// `R~' V⁻¹ r` of each window, and its block.
    scores: Vec<(usize, DVector<f64>)>,
    /// `r' V⁻¹ r`, about as many as there are windows where V is right.
    square: f64,
}

impl Sums {
    fn solve(&self) -> DVector<f64> {
        // directions without information stay at zero
        let half = inverse_where_known(&self.information);
        let inside = &half * &self.left;
        let right = &half * &self.right;
        pseudo_inverse(&inside, 1e-9).map_or(right.clone(), |inverse| inverse * &right)
    }
}

impl WeakForm {
    /// The groups of the given half width, or of that whose information at `p` has the largest
    /// determinant: short windows where torques are noisy or the wheels stop often, long ones where
    /// the speeds carry nearly all of the noise.
    fn most_informative(&self, task: &Task, regressor: &Regressor, p: &[f64]) -> Vec<Group> {
        if let Some(given) = self.half_width_s {
            return self.groups(task, regressor, given);
        }
        let values = DVector::from_fn(regressor.width(), |c, _| p[regressor.linear[c]]);
        let mut best = self.groups(task, regressor, HALF_WIDTHS[0]);
        let first = self.sums(&best, &values, None).information;
        // columns without information have none at any width
        let scale = first.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
        let size = |information: &DMatrix<f64>| {
            let n = scale.len();
            let scaled = DMatrix::from_fn(n, n, |i, k| information[(i, k)] * scale[i] * scale[k]);
            let eigen = scaled.symmetric_eigenvalues();
            eigen.iter().map(|v| v.max(NOTHING).ln()).sum::<f64>()
        };
        let mut largest = size(&first);
        for half_width in &HALF_WIDTHS[1..] {
            let groups = self.groups(task, regressor, *half_width);
            if groups.is_empty() {
                break;
            }
            let there = size(&self.sums(&groups, &values, None).information);
            if there > largest {
                (largest, best) = (there, groups);
            }
        }
        best
    }

    fn groups(&self, task: &Task, regressor: &Regressor, half_width: f64) -> Vec<Group> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(task.seed);
        let total: f64 = task.train.iter().map(Recording::covered).sum();
        let length = (total / BLOCKS).clamp(BLOCK.0, BLOCK.1);
        let (mut out, mut first) = (Vec::new(), 0);
        for recording in task.train {
            let windows = windows(recording, half_width, PER_HALF);
            let noise = recording.noise();
            let input = input_around(task, recording, recording.torque());
            let omega = recording.on_lines(recording.omega());
            let mut noisy = omega.to_vec();
            for row in &mut noisy {
                for i in 0..2 {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    row[i] += noise.omega[i] * draw;
                }
            }
            let scale = input.iter().flatten().map(|m| m.abs()).fold(1e-9, f64::max);
            let speed = recording.top_speed();
            if windows.is_empty() {
                continue;
            }
            let rows =
                |omega: &[[f64; 2]]| weak_rows(task, regressor, recording, &windows, omega, &input);
            let (x, y) = rows(&omega);
            let since = |w: &Window| recording.t()[w.samples.start] - recording.t()[0];
            out.push(Group {
                change: rows(&noisy).0 - &x,
                slopes: slopes(task, regressor, recording, &windows),
                variance: noise.omega.map(|s| s.max(1e-6 * speed).powi(2)),
                input_variance: noise.torque.map(|s| s.max(1e-6 * scale).powi(2)),
                block: windows.iter().map(|w| first + (since(w) / length) as usize).collect(),
                windows,
                x,
                y,
            });
            first = out.last().and_then(|g| g.block.last()).map_or(first, |b| b + 1);
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
            let solved = v.solve_columns(&x);
            out.left += left.tr_mul(&solved);
            out.right += left.tr_mul(&v.solve(&group.y));
            out.information += x.tr_mul(&solved);
            out.noise += group.change.tr_mul(&v.solve_columns(&group.change));
            for (n, &block) in group.block.iter().enumerate() {
                let (left, weighed) = (left.rows(2 * n, 2), weighed.rows(2 * n, 2));
                out.scores.push((block, left.tr_mul(&weighed)));
            }
            out.square += r.dot(&weighed);
        }
        out
    }

    fn covariance_of_rows(&self, group: &Group, values: &DVector<f64>) -> Option<BandedCholesky> {
        let n = group.y.len();
        if !self.reweighting {
            return BandedCholesky::new(n, 0, |_, _| 1.0);
        }
        group.covariance(values)
    }

    /// The larger of the covariance due to noise and that from blocks of residuals.
    fn covariance(&self, sums: &Sums, rows: usize) -> DMatrix<f64> {
        let width = sums.right.len();
        let excess = (sums.square / (rows - width) as f64).max(f64::MIN_POSITIVE);
        let excess = if self.reweighting { excess.max(1.0) } else { excess };
        let bread = inverse_where_known(&sums.information);
        let mut covariance = &bread * excess;
        if sums.scores.last().is_none_or(|(block, _)| *block < FEWEST_BLOCKS) {
            return covariance;
        }
        let z = DMatrix::from_fn(sums.scores.len(), width, |i, c| sums.scores[i].1[c]);
        let block: Vec<usize> = sums.scores.iter().map(|s| s.0).collect();
        let ones = DVector::repeat(z.nrows(), 1.0);
        let robust = clustered_covariance(&bread, &z, &ones, &block, z.nrows());
        raise_errors(&mut covariance, &robust.diagonal().map(f64::sqrt));
        covariance
    }
}
