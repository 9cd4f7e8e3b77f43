//! Fuzzy emulator by Levenberg-Marquardt with exact sensitivities.

use serde::Deserialize;

use super::fuzzy::{
    Journal, Limits, Settings, Start, continuation, described, finish, levenberg_marquardt,
};
use super::{Fit, Identifier, IdentifyError, MethodDescription, OptionError, Task};

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
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FuzzyLevenbergMarquardt {
    /// Options of all fuzzy methods.
    #[serde(skip)]
    pub settings: Settings,
    /// Steps tried at each gain, at the most.
    pub iterations: usize,
    /// Whether the gain is lowered step by step.
    pub continuation: bool,
    /// Where it starts without continuation.
    pub start: Start,
}

impl Default for FuzzyLevenbergMarquardt {
    fn default() -> Self {
        let settings = Settings::default();
        Self { settings, iterations: 60, continuation: true, start: Start::Best }
    }
}

/// Name in experiment files.
const NAME: &str = "fuzzy_levenberg_marquardt";
const OPTIONS: [(&str, &str, &str); 3] = [
    ("iterations", "60", "steps tried at each gain, at the most"),
    ("continuation", "true", "lower the gain step by step from 20 1/s (parallel structure)"),
    (
        "start",
        "\"best\"",
        "without continuation: \"friction\" level, \"closed_form\", the \"best\" of the two, or \
         \"zero\"",
    ),
];

impl Identifier for FuzzyLevenbergMarquardt {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Fuzzy emulator: Levenberg-Marquardt with continuation in the gain".into(),
            equation: "S' = (dfhat/dwhat - K) S + Phi; minimise the ISE for K = 20, 10, 5, ... \
                       down to `gain`"
                .into(),
            source: "Marquardt 1963; Giergiel and Buratowski 2010, eq. (19)".into(),
            use_when: "a fuzzy emulator in the parallel structure is wanted: the lowest ISE of \
                       all fuzzy methods, in well under a second for a run of 25 s"
                .into(),
            avoid_when: "parameters with a meaning are wanted, or motion outside the training data"
                .into(),
            options: described(&OPTIONS),
        }
    }

    fn schema(&self) -> schemars::Schema {
        Settings::schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let (settings, own) = Settings::split::<Self>(NAME, options, &OPTIONS)?;
        Ok(Box::new(Self { settings, ..own }))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let (problem, level) = self.settings.problem(task, NAME)?;
        let journal = Journal::default();
        let (ridge, limits) =
            (self.settings.ridge, Limits { iterations: self.iterations, tolerance: 1e-6 });
        let (theta, iterations, status) = if self.continuation {
            continuation(&problem, &level, ridge, limits, &journal, NAME)?
        } else {
            let start = self.start.of(&problem, &level, ridge, NAME)?;
            levenberg_marquardt(&problem, &start, &level, ridge, limits, &journal)
        };
        Ok(finish(NAME, &problem, theta.as_slice(), status, iterations, &journal))
    }
}
