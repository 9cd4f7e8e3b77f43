//! Fuzzy emulator fitted by a quasi-Newton method with the exact gradient.

use std::cell::RefCell;

use argmin::core::{CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::fuzzy::{
    DIVERGED, Descent, Found, Fuzzy, Job, Limits, Penalty, Problem, Scaled, Search, Start,
    continuation,
};
use super::{IdentifyError, MethodDescription, NoStart, Status};

/// Limited-memory BFGS over the consequents that the recordings reach, with the exact gradient of the
/// simulated cost and the gain lowered step by step.
///
/// ```text
/// gradient = -2 ∫ S'e dt,   S' = (∂fhat/∂what - K) S + Phi(what)
/// theta = start + L⁻ᵀ z,   L Lᵀ = H + ridge at the start:  curvature alike in all directions of z
/// ```
/// Neighbouring rules depend on each other, so that a scale of its own for each leaves directions with
/// curvatures a thousand apart; the factor of the whole matrix, computed once at every gain, takes a tenth
/// of the steps.
///
/// Source: Liu and Nocedal, Mathematical Programming 45 (1989); preconditioning: Nocedal and Wright,
/// Numerical Optimization (2006), section 5.1; line search: Moré and Thuente,
/// ACM TOMS 20 (1994); continuation: Allgower and Georg, Numerical Continuation Methods (1990).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct QuasiNewton {
    /// Largest number of iterations at each gain.
    pub iterations: u64,
    /// Whether the gain is lowered step by step from 20 1/s (parallel structure).
    pub continuation: bool,
    /// Initial values without continuation.
    pub start: Start,
}

impl Default for QuasiNewton {
    fn default() -> Self {
        Self { iterations: 300, continuation: true, start: Start::Best }
    }
}

/// Decrease of the cost per step below which the search has converged, relative to the noise floor.
const TOLERANCE: f64 = 5e-4;
/// Number of steps stored for the approximation of the curvature.
const MEMORY: usize = 12;

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
                       the time: here it is computed once at every gain"
                    .into(),
            avoid_when: "there are few rules: fuzzy_levenberg_marquardt needs fewer simulations"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let job: &Job = job;
        let limits = Limits { iterations: self.iterations as usize, tolerance: TOLERANCE };
        let (problem, level) = (&job.problem.over_reached(), &job.level);
        let penalty = Penalty { about: level, weight: problem.penalty(job.ridge) };
        let descend = |problem: &Problem, start: &DVector<f64>, limits| {
            Slope::new(job, problem, penalty, start)?.descend(limits)
        };
        let (theta, iterations, status) = if self.continuation {
            continuation(problem, level, job.ridge, limits, &job.journal, Self::NAME, descend)?
        } else {
            descend(problem, &job.start(self.start)?, limits)?
        };
        Ok(Found { theta: theta.as_slice().to_vec(), iterations, status })
    }
}

/// Cost and gradient as functions of the scaled step z from the start.
struct Slope<'a> {
    job: &'a Job,
    problem: &'a Problem,
    penalty: Penalty<'a>,
    scaled: Scaled,
    /// The last evaluation: the line search requests cost and gradient one after the other.
    last: RefCell<Option<Evaluation>>,
}

/// z with its cost and gradient.
type Evaluation = (DVector<f64>, f64, DVector<f64>);

impl<'a> Slope<'a> {
    fn new(
        job: &'a Job,
        problem: &'a Problem,
        penalty: Penalty<'a>,
        start: &DVector<f64>,
    ) -> Result<Self, IdentifyError> {
        let Some(normal) = problem.normal(start.as_slice(), false) else {
            return Err(job.no_start(NoStart::Emulator));
        };
        job.journal.note(normal.cost);
        let free = problem.free();
        let n = free.len();
        // without a ridge, consequents that hardly matter have no curvature
        let least = 1e-9 * normal.h.trace() / n as f64;
        let curvature = normal.h + DMatrix::identity(n, n) * penalty.weight.max(least);
        let Some(factor) = curvature.cholesky() else {
            return Err(job.no_start(NoStart::Sensitivities));
        };
        let scaled = Scaled { start: start.clone(), free, factor: factor.l() };
        Ok(Self { job, problem, penalty, scaled, last: RefCell::default() })
    }

    fn descend(self, limits: Limits) -> Result<Descent, IdentifyError> {
        let first = DVector::zeros(self.scaled.free.len());
        let refuse = |e: argmin::core::Error| self.job.no_start(NoStart::Optimiser(e.to_string()));
        let tolerance = (limits.tolerance * self.problem.noise_floor).max(1e-9);
        let solver = LBFGS::new(MoreThuenteLineSearch::new(), MEMORY)
            .with_tolerance_cost(tolerance)
            .map_err(refuse)?;
        let most = limits.iterations as u64;
        let run = Executor::new(&self, solver)
            .configure(|s| s.param(first.clone()).max_iters(most))
            .run();
        let run = run.map_err(refuse)?;
        let state = run.state();
        let best = state.get_best_param().cloned().unwrap_or(first);
        let done = state.get_iter();
        let status = if done < most { Status::Converged } else { Status::IterationLimit };
        Ok((self.scaled.theta(&best), done as usize, status))
    }

    /// Cost and gradient at z. The cost is always finite: the line search would not end otherwise.
    fn at(&self, z: &DVector<f64>) -> (f64, DVector<f64>) {
        if let Some((at, cost, gradient)) = &*self.last.borrow()
            && at == z
        {
            return (*cost, gradient.clone());
        }
        let theta = self.scaled.theta(z);
        let sound = theta.iter().all(|x| x.is_finite());
        let found = sound.then(|| self.problem.gradient(theta.as_slice())).flatten();
        let (cost, gradient) = match found {
            Some((ise, slope)) => {
                self.job.journal.note(ise);
                let mut slope = slope + self.penalty.slope(&theta, &self.scaled.free);
                self.scaled.factor.solve_lower_triangular_mut(&mut slope);
                (ise + self.penalty.of(&theta), slope)
            }
            // a gradient that points away from the start, along the diverging direction
            None => {
                self.job.journal.note(DIVERGED);
                (DIVERGED, z * (DIVERGED / z.norm_squared().max(1.0)))
            }
        };
        self.last.replace(Some((z.clone(), cost, gradient.clone())));
        (cost, gradient)
    }
}

impl CostFunction for &Slope<'_> {
    type Param = DVector<f64>;
    type Output = f64;

    fn cost(&self, z: &DVector<f64>) -> Result<f64, argmin::core::Error> {
        Ok(self.at(z).0)
    }
}

impl Gradient for &Slope<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, z: &DVector<f64>) -> Result<DVector<f64>, argmin::core::Error> {
        Ok(self.at(z).1)
    }
}
