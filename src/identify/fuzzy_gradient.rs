//! Fuzzy emulator by a quasi-Newton method with the exact gradient.

use argmin::core::{CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::fuzzy::{DIVERGED, Found, Fuzzy, Job, Search, Start};
use super::{IdentifyError, MethodDescription, Status};

/// Limited-memory BFGS over all consequents, with the exact gradient of the simulated cost.
///
/// ```text
/// gradient = -2 ∫ S'e dt,   S' = (∂fhat/∂what - K) S + Phi(what)
/// theta = start + L⁻ᵀ z,   L Lᵀ = H + ridge at the start:  curvature alike in all directions of z
/// ```
/// Neighbouring rules depend on each other, so that a scale of its own for each leaves directions with
/// curvatures a thousand apart; the factor of the whole matrix takes a tenth of the steps.
///
/// Source: Liu and Nocedal, Mathematical Programming 45 (1989); preconditioning: Nocedal and Wright,
/// Numerical Optimization (2006), section 5.1; line search: Moré and Thuente,
/// ACM TOMS 20 (1994).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct QuasiNewton {
    /// Iterations at the most.
    pub iterations: u64,
    /// Where it starts.
    pub start: Start,
}

impl Default for QuasiNewton {
    fn default() -> Self {
        Self { iterations: 300, start: Start::Best }
    }
}

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyGradient = Fuzzy<QuasiNewton>;

impl Search for QuasiNewton {
    const NAME: &'static str = "fuzzy_gradient";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: L-BFGS with the exact gradient".into(),
            equation: "minimise ISE + ridge |theta - level|² with gradient -2 ∫ S'e dt".into(),
            source: "Liu and Nocedal 1989; Moré and Thuente 1994".into(),
            use_when:
                "there are so many rules that the matrix of Levenberg-Marquardt takes most of \
                       the time: here it is computed once"
                    .into(),
            avoid_when: "the start is far: fuzzy_levenberg_marquardt lowers the gain step by step"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let start = job.start(self.start)?;
        let Some(normal) = job.problem.normal(start.as_slice(), false) else {
            return Err(job.no_start("the emulator diverges from the start; raise `gain`"));
        };
        job.journal.note(normal.cost);
        let mean = normal.h.trace() / start.len() as f64;
        let weight = job.ridge * mean;
        let n = start.len();
        // without a ridge, rules that are never reached have no curvature
        let curvature = normal.h + DMatrix::identity(n, n) * weight.max(1e-9 * mean);
        let Some(factor) = curvature.cholesky() else {
            return Err(job.no_start("the sensitivities at the start are not finite"));
        };
        Slope { job, start, factor: factor.l(), weight }.descend(self.iterations)
    }
}

/// Cost and gradient over scaled steps z from the start.
struct Slope<'a> {
    job: &'a Job,
    start: DVector<f64>,
    /// L.
    factor: DMatrix<f64>,
    weight: f64,
}

impl Slope<'_> {
    fn theta(&self, z: &DVector<f64>) -> DVector<f64> {
        let mut step = z.clone();
        self.factor.tr_solve_lower_triangular_mut(&mut step);
        &self.start + step
    }

    fn descend(self, iterations: u64) -> Result<Found, IdentifyError> {
        let first = DVector::zeros(self.start.len());
        let refuse = |e: argmin::core::Error| self.job.no_start(e);
        let solver = LBFGS::new(MoreThuenteLineSearch::new(), 12)
            .with_tolerance_cost(1e-9)
            .map_err(refuse)?;
        let run = Executor::new(&self, solver)
            .configure(|s| s.param(first.clone()).max_iters(iterations))
            .run();
        let run = run.map_err(refuse)?;
        let state = run.state();
        let best = state.get_best_param().cloned().unwrap_or(first);
        let done = state.get_iter();
        let status = if done < iterations { Status::Converged } else { Status::IterationLimit };
        let theta = self.theta(&best).as_slice().to_vec();
        Ok(Found { theta, iterations: done as usize, status })
    }
}

impl CostFunction for &Slope<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    /// Always finite: the line search does not end on a cost that is not.
    fn cost(&self, z: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        let theta = self.theta(z);
        if !theta.iter().all(|x| x.is_finite()) {
            return Ok(DIVERGED);
        }
        let ise = self.job.problem.cost(theta.as_slice());
        self.job.journal.note(ise);
        Ok(ise + self.weight * (theta - &self.job.level).norm_squared())
    }
}

impl Gradient for &Slope<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, z: &DVector<f64>) -> Result<DVector<f64>, argmin::core::Error> {
        let theta = self.theta(z);
        let Some((ise, slope)) = self.job.problem.gradient(theta.as_slice()) else {
            // uphill away from the start, along the way that diverges
            return Ok(z * (DIVERGED / z.norm_squared().max(1.0)));
        };
        self.job.journal.note(ise);
        let mut slope = slope + (theta - &self.job.level) * (2.0 * self.weight);
        self.factor.solve_lower_triangular_mut(&mut slope);
        Ok(slope)
    }
}
