//! Fuzzy emulator as the paper fits it: one bounded search after the other.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::brent::BrentOpt;
use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Journal, Problem, Search, Start};
use super::{IdentifyError, MethodDescription, Status};

/// Cyclic bounded searches over one consequent at a time, as MATLAB's fminbnd does them.
///
/// ```text
/// for every consequent in turn:  theta_j = arg min ISE(theta),  |theta_j - start_j| <= reach
/// ```
/// Golden section with parabolic steps (Brent). A search that ends above the value it found keeps
/// the old one, so the cost never rises. Consequents of rules that the recordings do not reach
/// (strength below 0.01 everywhere) are left at the start, since the cost does not depend on them.
///
/// Source: the paper, section 3 (fminbnd); Brent, Algorithms for Minimization without Derivatives
/// (1973), ch. 5.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LineSearch {
    /// Rounds through all consequents.
    pub sweeps: usize,
    /// Half the interval of every search, about the start [rad/s²].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: f64,
    /// Length of a search, in evaluations at the most.
    pub evaluations: u64,
    /// Where it starts.
    pub start: Start,
}

impl Default for LineSearch {
    fn default() -> Self {
        Self { sweeps: 6, reach: 10.0, evaluations: 20, start: Start::Friction }
    }
}

/// Relative fall over a sweep below which it has converged.
const TOLERANCE: f64 = 1e-4;

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyLineSearch = Fuzzy<LineSearch>;

impl Search for LineSearch {
    const NAME: &'static str = "fuzzy_line_search";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: cyclic bounded line searches (the paper's fminbnd)".into(),
            equation: "theta_j = arg min ISE within start_j ± reach, for every j in turn".into(),
            source: "Giergiel and Buratowski 2010, section 3; Brent 1973, ch. 5".into(),
            use_when: "the paper's own procedure is to be repeated".into(),
            avoid_when: "a low ISE is wanted: neighbouring rules depend on each other, so moving \
                         one at a time creeps; fuzzy_levenberg_marquardt gets lower and faster"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let start = job.start(self.start)?;
        let (problem, journal) = (&job.problem, &job.journal);
        let mut theta = start.as_slice().to_vec();
        let mut cost = problem.cost(&theta);
        journal.note(cost);
        let (mut status, mut iterations) = (Status::IterationLimit, 0);
        while iterations < self.sweeps && status == Status::IterationLimit {
            let before = cost;
            for j in problem.reached() {
                let line = Line { problem, theta: &theta, j, journal };
                let bounds = (start[j] - self.reach, start[j] + self.reach);
                if let Some((value, lower)) = line.minimum(bounds, self.evaluations, cost) {
                    (theta[j], cost) = (value, lower);
                }
            }
            iterations += 1;
            if before - cost <= TOLERANCE * before {
                status = Status::Converged;
            }
        }
        Ok(Found { theta, iterations, status })
    }
}

/// The cost along one consequent.
struct Line<'a> {
    problem: &'a Problem,
    theta: &'a [f64],
    j: usize,
    journal: &'a Journal,
}

impl CostFunction for Line<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, value: &f64) -> Result<f64, argmin::core::Error> {
        let mut theta = self.theta.to_vec();
        theta[self.j] = *value;
        let cost = self.problem.cost(&theta);
        self.journal.note(cost);
        Ok(cost)
    }
}

impl Line<'_> {
    /// The minimum within `bounds` and its cost, where that is below `cost`.
    fn minimum(self, bounds: (f64, f64), evaluations: u64, cost: f64) -> Option<(f64, f64)> {
        // fminbnd: TolX = 1e-4
        let solver = BrentOpt::new(bounds.0, bounds.1).set_tolerance(1e-8, 1e-4);
        let run = Executor::new(self, solver).configure(|s| s.max_iters(evaluations)).run().ok()?;
        let state = run.state();
        let (value, lower) = (*state.get_best_param()?, state.get_best_cost());
        (lower < cost).then_some((value, lower))
    }
}
