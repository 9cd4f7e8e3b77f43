//! Fuzzy emulator by the simplex of Nelder and Mead.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Search, Start};
use super::{IdentifyError, MethodDescription, Status};

/// The simplex of Nelder and Mead over the consequents of the rules that the recordings reach.
///
/// ```text
/// minimise ISE(theta) by reflecting, stretching and shrinking a simplex of n + 1 points
/// ```
///
/// Source: Nelder and Mead, Computer Journal 7 (1965), as MATLAB's fminsearch.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Simplex {
    /// Moves of the simplex at the most.
    pub iterations: u64,
    /// Edge of the first simplex [rad/s²].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub edge: f64,
    /// Where it starts.
    pub start: Start,
}

impl Default for Simplex {
    fn default() -> Self {
        Self { iterations: 4000, edge: 0.5, start: Start::Best }
    }
}

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyNelderMead = Fuzzy<Simplex>;

impl Search for Simplex {
    const NAME: &'static str = "fuzzy_nelder_mead";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: Nelder-Mead simplex".into(),
            equation: "minimise ISE(theta) without derivatives by a simplex of n + 1 points".into(),
            source: "Nelder and Mead 1965".into(),
            use_when: "optimisers are compared".into(),
            avoid_when: "more than a dozen rules are fitted: the simplex stagnates in many \
                         dimensions"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let start = job.start(self.start)?.as_slice().to_vec();
        let simplex = Corners { job, start, free: job.problem.reached() };
        simplex.descend(self.edge, self.iterations)
    }
}

/// The cost over the consequents in `free`, as steps from `start`.
struct Corners<'a> {
    job: &'a Job,
    start: Vec<f64>,
    free: Vec<usize>,
}

impl CostFunction for Corners<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, steps: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let cost = self.job.problem.cost(&self.theta(steps));
        self.job.journal.note(cost);
        Ok(cost)
    }
}

impl Corners<'_> {
    fn theta(&self, steps: &[f64]) -> Vec<f64> {
        let mut theta = self.start.clone();
        for (&j, step) in self.free.iter().zip(steps) {
            theta[j] += step;
        }
        theta
    }

    fn descend(self, edge: f64, iterations: u64) -> Result<Found, IdentifyError> {
        let (n, job) = (self.free.len(), self.job);
        let corner = |i: usize| (0..n).map(|j| if i == j { edge } else { 0.0 }).collect();
        let points: Vec<Vec<f64>> = (0..=n).map(corner).rev().collect();
        let refuse = |e: argmin::core::Error| job.no_start(e);
        let solver = NelderMead::new(points).with_sd_tolerance(1e-9).map_err(refuse)?;
        let run = Executor::new(self, solver).configure(|s| s.max_iters(iterations)).run();
        let run = run.map_err(refuse)?;
        let state = run.state();
        let steps = state.get_best_param().cloned().unwrap_or_default();
        let done = state.get_iter();
        let status = if done < iterations { Status::Converged } else { Status::IterationLimit };
        let corners = run.problem.problem.as_ref();
        let theta = corners.map_or_else(Vec::new, |corners| corners.theta(&steps));
        Ok(Found { theta, iterations: done as usize, status })
    }
}
