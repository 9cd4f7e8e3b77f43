//! Fuzzy emulator, serial-parallel structure, in closed form.

use serde::Deserialize;

use super::fuzzy::{Journal, Settings, described, finish};
use super::{Fit, Identifier, IdentifyError, MethodDescription, OptionError, Status, Task};
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
#[derive(Clone, Debug, Default, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FuzzyLeastSquares {
    /// Options of all fuzzy methods; the structure is serial-parallel whatever they say.
    #[serde(skip)]
    pub settings: Settings,
}

/// Name in experiment files.
const NAME: &str = "fuzzy_least_squares";
const OPTIONS: [(&str, &str, &str); 0] = [];

impl Identifier for FuzzyLeastSquares {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Fuzzy emulator: closed-form least squares (serial-parallel)".into(),
            equation: "minimise the integral of |w - what|² with what = what0 + Psi theta, \
                       Psi' = -K Psi + Phi(w)"
                .into(),
            source: "Giergiel and Buratowski 2010, eq. (19), serial-parallel structure".into(),
            use_when: "as the start of every other fuzzy fit: exact and done in milliseconds"
                .into(),
            avoid_when: "the emulator is to run without the measured state: the rules were never \
                         asked to; `structure` is ignored"
                .into(),
            options: described(&OPTIONS).into_iter().filter(|o| o.0 != "structure").collect(),
        }
    }

    fn schema(&self) -> schemars::Schema {
        Settings::schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        if options.contains_key("structure") {
            let message = "unknown option `structure`; this method is always serial-parallel, use \
                           fuzzy_levenberg_marquardt for the parallel one";
            return Err(OptionError { method: NAME.into(), message: message.into() });
        }
        let (settings, _) = Settings::split::<Self>(NAME, options, &OPTIONS)?;
        Ok(Box::new(Self { settings }))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let (problem, level) = self.settings.problem(task, NAME)?;
        let problem = problem.with_structure(Structure::SerialParallel);
        let theta = problem.closed_form(&level, self.settings.ridge, NAME)?;
        let journal = Journal::default();
        journal.note(problem.cost(theta.as_slice()));
        Ok(finish(NAME, &problem, theta.as_slice(), Status::Converged, 1, &journal))
    }
}
