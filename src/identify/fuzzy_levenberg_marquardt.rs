//! Fuzzy emulator by Levenberg-Marquardt with exact sensitivities.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::fuzzy::{
    Found, Fuzzy, Job, Limits, Penalty, Problem, Search, Start, continuation, levenberg_marquardt,
};
use super::{IdentifyError, MethodDescription};

/// Levenberg-Marquardt over the consequents, with the gain lowered step by step.
///
/// ```text
/// S' = (∂fhat/∂what - K) S + Phi(what)
/// minimise ∫ |w - what|² dt for K = 20, 10, 5, 2, 1, 0.5, 0.2, 0, each from the one before,
/// down to the gain asked for
/// ```
/// A high gain holds the emulator at the data, so that the first cost is almost quadratic; without
/// this continuation pure simulation (K = 0) ends a fifth above its minimum or far from it.
///
/// Source: the paper, eq. (19); Marquardt, SIAM J. 11 (1963); continuation: Allgower and Georg,
/// Numerical Continuation Methods (1990).
#[derive(Clone, Debug, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LevenbergMarquardt {
    /// Largest number of steps at each gain.
    pub iterations: usize,
    /// Whether the gain is lowered step by step from 20 1/s (parallel structure).
    pub continuation: bool,
    /// Initial values without continuation.
    pub start: Start,
}

impl Default for LevenbergMarquardt {
    fn default() -> Self {
        Self { iterations: 60, continuation: true, start: Start::Best }
    }
}

/// Relative decrease of the cost at convergence: a thousandth of the effect of a recording's noise on the
/// ISE.
const TOLERANCE: f64 = 1e-4;

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyLevenbergMarquardt = Fuzzy<LevenbergMarquardt>;

impl Search for LevenbergMarquardt {
    const NAME: &'static str = "fuzzy_levenberg_marquardt";

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: Levenberg-Marquardt with continuation in the gain".into(),
            equation: "S' = (dfhat/dwhat - K) S + Phi; minimise the ISE for K = 20, 10, 5, ... \
                       down to `gain`"
                .into(),
            source: "Marquardt 1963; Giergiel and Buratowski 2010, eq. (19)".into(),
            use_when: "a fuzzy emulator in the parallel structure is needed: the lowest ISE of \
                       all fuzzy methods, in well under a second for a run of 25 s"
                .into(),
            avoid_when: "physical parameters are needed, or motion outside the training data"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let limits = Limits { iterations: self.iterations, tolerance: TOLERANCE };
        let (problem, level, journal) = (&job.problem.over_reached(), &job.level, &job.journal);
        let penalty = Penalty { about: level, weight: problem.penalty(job.ridge) };
        let descend = |problem: &Problem, theta: &DVector<f64>, limits| {
            Ok(levenberg_marquardt(problem, theta, penalty, limits, journal))
        };
        let (theta, iterations, status) = if self.continuation {
            continuation(problem, level, job.ridge, limits, journal, Self::NAME, descend)?
        } else {
            descend(problem, &job.start(self.start)?, limits)?
        };
        Ok(Found { theta: theta.as_slice().to_vec(), iterations, status })
    }
}
