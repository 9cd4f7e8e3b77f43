//! Fuzzy emulator, serial-parallel structure, in closed form.

use serde::{Deserialize, Serialize};

use super::fuzzy::{Found, Fuzzy, Job, Search};
use super::{IdentifyError, MethodDescription, Status};
use crate::simulate::Structure;

/// Least squares of the consequents in the serial-parallel structure: the exact minimum.
///
/// ```text
/// what' = fhat(w) + G u + K (w - what) is linear in the consequents theta:
/// what = what0 + Psi theta,   Psi' = -K Psi + Phi(w),   Phi: strengths of the rules
/// minimise ∫ |w - what|² dt + ridge |theta - friction level|²
/// ```
///
/// Source: the paper, eq. (19) and its serial-parallel structure.
#[derive(Clone, Debug, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct LeastSquares {}

/// The method: this search with the options of all fuzzy methods.
pub type FuzzyLeastSquares = Fuzzy<LeastSquares>;

impl Search for LeastSquares {
    const NAME: &'static str = "fuzzy_least_squares";
    const STRUCTURE: Option<Structure> = Some(Structure::SerialParallel);

    fn describe() -> MethodDescription {
        MethodDescription {
            name: Self::NAME.into(),
            title: "Fuzzy emulator: closed-form least squares (serial-parallel)".into(),
            equation: "minimise the integral of |w - what|² with what = what0 + Psi theta, \
                       Psi' = -K Psi + Phi(w)"
                .into(),
            source: "Giergiel and Buratowski 2010, eq. (19), serial-parallel structure".into(),
            use_when: "as the start of every other fuzzy fit: exact and done in milliseconds"
                .into(),
            avoid_when: "the emulator runs without the measured state, for which the rules were not fitted; `structure` is ignored"
                .into(),
        }
    }

    fn search(&self, job: &mut Job) -> Result<Found, IdentifyError> {
        let theta = job.problem.closed_form(&job.level, job.ridge, Self::NAME)?;
        job.journal.note(job.problem.cost(theta.as_slice()));
        Ok(Found { theta: theta.as_slice().to_vec(), iterations: 1, status: Status::Converged })
    }
}
