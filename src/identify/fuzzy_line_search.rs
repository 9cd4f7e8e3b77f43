//! Fuzzy emulator fitted as in the paper, by one bounded search after the other.

use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Journal, Problem, Search, Start};
use super::{IdentifyError, MethodDescription, Status};

/// Cyclic bounded searches over one consequent at a time, as MATLAB's fminbnd does them.
///
/// ```text
/// for every consequent in turn:  theta_j = arg min ISE(theta),  |theta_j - start_j| <= reach
/// ```
/// The minimum is where the slope along theta_j, from a sensitivity of its own, changes sign: Newton
/// steps within a bracket, bisection where they leave it. That is the minimum of fminbnd, to the same
/// 1e-4, in a quarter of the simulations. A search that ends above the value it found keeps
/// the old one, so the cost never rises. Consequents of rules that the recordings do not reach
/// (strength below 0.01 everywhere) are left at the start, since the cost does not depend on them.
///
/// Source: the paper, section 3 (fminbnd); Press et al., Numerical Recipes (2007), section 9.4 for Newton
/// within a bracket.
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LineSearch {
    /// Rounds through all consequents.
    pub sweeps: usize,
    /// Half the interval of every search, about the start [rad/s²].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reach: f64,
    /// Largest number of evaluations of a search.
    pub evaluations: u64,
    /// Initial values.
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
            source: "Giergiel and Buratowski 2010, section 3; Press et al. 2007, section 9.4"
                .into(),
            use_when: "the paper's own procedure is to be repeated".into(),
            avoid_when: "a low ISE is needed: neighbouring consequents are correlated, so a search along one at a time converges slowly; fuzzy_levenberg_marquardt reaches a lower ISE in less time"
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

/// Width of the bracket at which a search ends [rad/s²]; fminbnd: TolX = 1e-4.
const CLOSE: f64 = 1e-4;

impl Line<'_> {
    /// The minimum within `bounds` and its cost, if below `cost`.
    fn minimum(self, bounds: (f64, f64), evaluations: u64, cost: f64) -> Option<(f64, f64)> {
        let (mut low, mut high) = bounds;
        let (mut ends_known, mut best) = ((false, false), (self.theta[self.j], cost));
        let mut value = best.0.clamp(low, high);
        for _ in 0..evaluations {
            let step = self.newton(value, &mut best);
            // a trial that diverges lies beyond the minimum, seen from the best value
            let step =
                step.unwrap_or(if value > best.0 { f64::NEG_INFINITY } else { f64::INFINITY });
            if step < 0.0 {
                (high, ends_known.1) = (value, true);
            } else {
                (low, ends_known.0) = (value, true);
            }
            let mut next = (value + step).clamp(low, high);
            if (next == low && ends_known.0) || (next == high && ends_known.1) {
                next = 0.5 * (low + high);
            }
            if step.abs() < CLOSE || (next - value).abs() < CLOSE {
                break;
            }
            value = next;
        }
        (best.1 < cost).then_some(best)
    }

    /// The Newton step from `value`, `None` where the emulator diverges; lowers `best`.
    fn newton(&self, value: f64, best: &mut (f64, f64)) -> Option<f64> {
        let mut theta = self.theta.to_vec();
        theta[self.j] = value;
        let [cost, slope, curvature] = self.problem.along(&theta, self.j)?;
        self.journal.note(cost);
        if cost < best.1 {
            *best = (value, cost);
        }
        Some(if curvature > 0.0 { -slope / curvature } else { 0.0 })
    }
}
