//! Output error: maximum likelihood of the free simulation.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::Deserialize;

use super::identifiability::{identified, inverse_where_known};
use super::kalman::{Prepared, prepare};
use super::linear_fit::{block_covariance, schur};
use super::screening::lowest;
use super::{
    Fit, Identifier, IdentifyError, MethodDescription, OptionError, Status, Task, from_options,
    options_schema, start,
};
use crate::effects::ParameterKind;
use crate::math::descent::{MinimiseOptions, Minimum, MinimumStatus, Quadratic, minimise};
use crate::model::Model;
use crate::robot::State;
use crate::simulate::{Hold, Input, simulate, simulate_with_sensitivities};

/// Simulation-error maximum likelihood (output error).
///
/// ```text
/// minimise ½ Σ_k Σ_i (y_i(k) - x_i(k; θ, x0))² / σ_i²,   i = alpha1, alpha2, omega1, omega2
/// ```
/// The whole recording is simulated freely from its moments; the initial state of every piece is
/// estimated too. Levenberg-Marquardt with exact sensitivities through stops and reversals, from
/// the weak form (from a guess with too much friction the robot would never move).
///
/// Source: Ljung, System Identification (1999), ch. 4; Janot et al. 2014.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputError {
    /// Most steps.
    pub iterations: usize,
    /// Descents, the first from the weak form, the others from the best of values scattered around
    /// it.
    pub starts: usize,
}

impl Default for OutputError {
    fn default() -> Self {
        Self { iterations: 60, starts: 1 }
    }
}

const NAME: &str = "output_error";
/// Standard deviation of the logarithm of scattered starts.
const SCATTER: f64 = 0.3;
/// Scattered values that are simulated for each one from which a descent starts.
const SCREENED: usize = 8;
/// Blocks within which residuals may be correlated [s].
const BLOCK: f64 = 5.0;

impl Identifier for OutputError {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Output error (simulation-error maximum likelihood)".into(),
            equation: "minimise Σ (measured - simulated)²/σ² over angles and speeds of the free \
                       simulation"
                .into(),
            source: "Ljung, System Identification, 1999, ch. 4".into(),
            use_when:
                "the moments are exact (noise only in angles and speeds); models with a body \
                       behind the wheels"
                    .into(),
            avoid_when: "the moments are noisy: the simulation wanders, estimates scatter, and \
                         the intervals are far too narrow"
                .into(),
            options: vec![
                ("iterations".into(), "60".into(), "most steps".into()),
                (
                    "starts".into(),
                    "1".into(),
                    "descents, the others from the best of scattered values".into(),
                ),
            ],
        }
    }

    fn schema(&self) -> schemars::Schema {
        options_schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let method: Self = from_options(NAME, options)?;
        if method.starts == 0 {
            let message = "`starts` must be 1 or more".to_string();
            return Err(OptionError { method: NAME.into(), message });
        }
        Ok(Box::new(method))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let problem = Problem::new(task, start::start(task, NAME)?);
        let options = MinimiseOptions {
            max_iterations: self.iterations,
            relative_tolerance: 1e-9,
            absolute_tolerance: 1e-6,
            lower: Some(problem.bound(|range| range.0, f64::NEG_INFINITY)),
            upper: Some(problem.bound(|range| range.1, f64::INFINITY)),
            ..MinimiseOptions::default()
        };
        let minima: Vec<Minimum> = problem
            .starts(self.starts)
            .into_par_iter()
            .map(|x| minimise(&x, |x| problem.quadratic(x), |x| problem.cost(x), &options))
            .collect();
        let began = |m: &&Minimum| m.status != MinimumStatus::NoStart;
        let Some(best) = minima.iter().filter(began).min_by(|a, b| a.cost.total_cmp(&b.cost))
        else {
            let reason = "the start cannot be simulated".to_string();
            return Err(IdentifyError::NoStart { method: NAME.into(), reason });
        };
        let mut fit = problem.fit(best);
        fit.work.evaluations = minima.iter().map(|m| m.evaluations).sum();
        if minima.len() > 1 {
            let near = |m: &&Minimum| m.cost < best.cost + 0.5;
            let agreeing = minima.iter().filter(began).filter(near).count();
            fit.notes.push(format!(
                "{agreeing} of {} descents end in the lowest minimum that was found.",
                minima.len()
            ));
        }
        Ok(fit)
    }
}

/// Parameters that are estimated, then four initial states of every piece.
struct Problem<'a> {
    task: &'a Task<'a>,
    p: Vec<f64>,
    free: Vec<usize>,
    pieces: Vec<(usize, std::ops::Range<usize>)>,
    prepared: Vec<Prepared<'a>>,
}

impl<'a> Problem<'a> {
    fn new(task: &'a Task<'a>, p: Vec<f64>) -> Self {
        let pieces = task
            .train
            .iter()
            .enumerate()
            .flat_map(|(r, recording)| {
                recording.pieces().iter().filter(|p| p.len() > 4).map(move |p| (r, p.clone()))
            })
            .collect();
        let prepared = task.train.iter().map(prepare).collect();
        Self { task, free: task.model.free(), p, pieces, prepared }
    }

    fn model(&self) -> &Model {
        self.task.model
    }

    fn first(&self) -> DVector<f64> {
        let mut x: Vec<f64> = self.free.iter().map(|&j| self.p[j]).collect();
        let motions: Vec<_> = self.task.train.iter().map(|r| r.local_motion()).collect();
        for (r, piece) in &self.pieces {
            let m = motions[*r][piece.start];
            let still = self.prepared[*r].still[piece.start];
            x.extend(m.alpha);
            x.extend([0, 1].map(|i| if still[i] { 0.0 } else { m.omega[i] }));
        }
        DVector::from_vec(x)
    }

    /// The first start, and the best by their ISE of many with parameters scattered around it.
    fn starts(&self, count: usize) -> Vec<DVector<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.task.seed);
        let first = self.first();
        let scattered: Vec<DVector<f64>> = (0..SCREENED * (count - 1))
            .map(|_| {
                let mut x = first.clone();
                for i in 0..self.free.len() {
                    let draw: f64 = StandardNormal.sample(&mut rng);
                    x[i] *= (SCATTER * draw).exp();
                }
                x
            })
            .collect();
        let vectors: Vec<Vec<f64>> = scattered.iter().map(|x| self.parameters(x)).collect();
        let stretches = self.pieces.iter().enumerate().map(|(n, (r, piece))| {
            let measured = &self.task.train[*r].omega()[piece.clone()];
            (self.input(*r, piece), self.start(&first, n), measured)
        });
        let best = lowest(self.model(), &vectors, count - 1, stretches);
        std::iter::once(first.clone())
            .chain(best.into_iter().map(|n| scattered[n].clone()))
            .collect()
    }

    /// Bounds of shape parameters; the others and the initial states are free.
    fn bound(&self, side: impl Fn((f64, f64)) -> f64, none: f64) -> DVector<f64> {
        let count = self.free.len() + 4 * self.pieces.len();
        DVector::from_fn(count, |i, _| {
            let parameter = self.free.get(i).map(|&j| &self.model().parameters()[j]);
            match parameter {
                Some(p) if p.spec.kind == ParameterKind::Shape => side(p.spec.range),
                _ => none,
            }
        })
    }

    fn parameters(&self, x: &DVector<f64>) -> Vec<f64> {
        let mut p = self.p.clone();
        for (i, &j) in self.free.iter().enumerate() {
            p[j] = x[i];
        }
        p
    }

    fn start(&self, x: &DVector<f64>, piece: usize) -> State {
        let at = |i: usize| x[self.free.len() + 4 * piece + i];
        State { alpha: [at(0), at(1)], omega: [at(2), at(3)] }
    }

    fn input(&self, r: usize, piece: &std::ops::Range<usize>) -> Input<'a> {
        let recording = &self.task.train[r];
        let hold: Hold = self.task.hold;
        Input { t: &recording.t()[piece.clone()], moment: &recording.moment()[piece.clone()], hold }
    }

    /// Residuals of one sample over their standard deviations; zero for channels not measured.
    fn residual(&self, r: usize, k: usize, state: &State) -> [f64; 4] {
        let recording = &self.task.train[r];
        let (a, w) = (recording.alpha()[k], recording.omega()[k]);
        let measured = [a[0], a[1], w[0], w[1]];
        let simulated = [state.alpha[0], state.alpha[1], state.omega[0], state.omega[1]];
        let prepared = &self.prepared[r];
        std::array::from_fn(|i| {
            if prepared.used[i] && recording.fresh()[k] {
                (measured[i] - simulated[i]) / prepared.variance[i].sqrt()
            } else {
                0.0
            }
        })
    }

    fn cost(&self, x: &DVector<f64>) -> Option<f64> {
        let p = self.parameters(x);
        let mut sum = 0.0;
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            let motion =
                simulate(self.model(), &p, &self.input(*r, piece), self.start(x, n)).ok()?;
            for (k, state) in piece.clone().zip(&motion) {
                sum += self.residual(*r, k, state).iter().map(|e| 0.5 * e * e).sum::<f64>();
            }
        }
        sum.is_finite().then_some(sum)
    }

    fn quadratic(&self, x: &DVector<f64>) -> Option<Quadratic> {
        let p = self.parameters(x);
        let size = x.len();
        let (mut cost, mut gradient) = (0.0, DVector::zeros(size));
        let mut hessian = DMatrix::zeros(size, size);
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            let input = self.input(*r, piece);
            let (motion, s) =
                simulate_with_sensitivities(self.model(), &p, &input, self.start(x, n)).ok()?;
            let initial = p.len();
            let columns: Vec<usize> =
                self.free.iter().copied().chain(initial..initial + 4).collect();
            let places: Vec<usize> = (0..self.free.len())
                .chain(self.free.len() + 4 * n..self.free.len() + 4 * n + 4)
                .collect();
            let width = columns.len();
            let mut block = super::kalman::Information::new(width);
            let mut row = vec![0.0; width];
            for (k, (sample, state)) in piece.clone().zip(&motion).enumerate() {
                let residual = self.residual(*r, sample, state);
                for (i, e) in residual.into_iter().enumerate() {
                    if e == 0.0 && !self.prepared[*r].used[i] {
                        continue;
                    }
                    let sigma = self.prepared[*r].variance[i].sqrt();
                    let sensitivities = s.row(k, i);
                    for (out, &c) in row.iter_mut().zip(&columns) {
                        *out = sensitivities[c] / sigma;
                    }
                    cost += 0.5 * e * e;
                    block.add(&row, e, 1.0);
                }
            }
            let (h, g) = block.finish();
            for (i, &a) in places.iter().enumerate() {
                gradient[a] -= g[i];
                for (k, &b) in places.iter().enumerate() {
                    hessian[(a, b)] += h[(i, k)];
                }
            }
        }
        cost.is_finite().then_some(Quadratic { cost, gradient, hessian })
    }

    fn fit(&self, minimum: &Minimum) -> Fit {
        let p = self.parameters(&minimum.x);
        let samples: usize = self
            .pieces
            .iter()
            .map(|(r, piece)| piece.len() * self.prepared[*r].used.iter().filter(|u| **u).count())
            .sum();
        let degrees = samples.saturating_sub(minimum.x.len()).max(1) as f64;
        let excess = (2.0 * minimum.cost / degrees).max(1.0);
        // the initial states are nuisance: what they could take up is projected out
        let count = self.free.len();
        let nuisance: Vec<usize> = (count..minimum.x.len()).collect();
        let own: Vec<usize> = (0..count).collect();
        let information = schur(&minimum.hessian, &nuisance, &own) / excess;
        let total = self.p.len();
        let mut full = DMatrix::zeros(total, total);
        for (i, &a) in self.free.iter().enumerate() {
            for (k, &b) in self.free.iter().enumerate() {
                full[(a, b)] = information[(i, k)];
            }
        }
        let covariance = self.covariance(minimum, &information);
        let known = identified(self.model(), &p, &full, Some(&covariance), self.task.train);
        let unit = self.task.train[0].drive_unit();
        let mut fit = Fit::physical(NAME, self.model(), p, known.covariance, unit);
        fit.notes = known.notes;
        if excess > 2.0 {
            fit.notes.push(format!(
                "The simulation misses the data by {:.1} times the noise of the sensors: the \
                 moments are noisy or an effect is missing, and these intervals are too narrow.",
                excess.sqrt()
            ));
        }
        fit.status = match minimum.status {
            MinimumStatus::Converged => Status::Converged,
            MinimumStatus::MaxIterations => Status::IterationLimit,
            _ => Status::Stalled,
        };
        fit.work.iterations = minimum.iterations;
        fit.work.evaluations = minimum.evaluations;
        fit
    }

    /// Covariance of all parameters: the larger of the inverse information and what blocks of
    /// residuals of 5 s show, since a simulation that wanders misses whole stretches alike.
    fn covariance(&self, minimum: &Minimum, information: &DMatrix<f64>) -> DMatrix<f64> {
        let (count, total) = (self.free.len(), self.p.len());
        let model = inverse_where_known(information);
        let all = inverse_where_known(&minimum.hessian);
        let (z, block) = self.scores(&minimum.x);
        let ones = DVector::repeat(z.nrows(), 1.0);
        let robust = block_covariance(&all, &z, &ones, &block);
        let stretch = DVector::from_fn(count, |i, _| {
            let ratio = robust[(i, i)] / model[(i, i)].max(f64::MIN_POSITIVE);
            if z.nrows() > count && ratio.is_finite() { ratio.max(1.0).sqrt() } else { 1.0 }
        });
        let mut out = DMatrix::zeros(total, total);
        for (i, &a) in self.free.iter().enumerate() {
            for (k, &b) in self.free.iter().enumerate() {
                out[(a, b)] = model[(i, k)] * stretch[i] * stretch[k];
            }
        }
        out
    }

    /// Gradients of the cost over blocks of 5 s, one a row.
    fn scores(&self, x: &DVector<f64>) -> (DMatrix<f64>, Vec<usize>) {
        let p = self.parameters(x);
        let mut rows: Vec<DVector<f64>> = Vec::new();
        for (n, (r, piece)) in self.pieces.iter().enumerate() {
            let input = self.input(*r, piece);
            let Ok((motion, s)) =
                simulate_with_sensitivities(self.model(), &p, &input, self.start(x, n))
            else {
                continue;
            };
            let t = self.task.train[*r].t();
            let first = rows.len();
            for (k, (sample, state)) in piece.clone().zip(&motion).enumerate() {
                let block = first + ((t[sample] - t[piece.start]) / BLOCK) as usize;
                rows.resize_with(rows.len().max(block + 1), || DVector::zeros(x.len()));
                for (i, e) in self.residual(*r, sample, state).into_iter().enumerate() {
                    let scaled = e / self.prepared[*r].variance[i].sqrt();
                    let sensitivities = s.row(k, i);
                    for (place, &j) in self.free.iter().enumerate() {
                        rows[block][place] += scaled * sensitivities[j];
                    }
                    for j in 0..4 {
                        let place = self.free.len() + 4 * n + j;
                        rows[block][place] += scaled * sensitivities[p.len() + j];
                    }
                }
            }
        }
        let z = DMatrix::from_fn(rows.len(), x.len(), |b, j| rows[b][j]);
        (z, (0..rows.len()).collect())
    }
}
