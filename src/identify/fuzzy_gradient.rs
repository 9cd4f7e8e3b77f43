//! Fuzzy emulator by a quasi-Newton method with the exact gradient.

use argmin::core::{CostFunction, Executor, Gradient, State};
use argmin::solver::linesearch::MoreThuenteLineSearch;
use argmin::solver::quasinewton::LBFGS;
use nalgebra::DVector;
use serde::Deserialize;

use super::fuzzy::{DIVERGED, Journal, Problem, Settings, Start, described, finish};
use super::{Fit, Identifier, IdentifyError, MethodDescription, OptionError, Status, Task};

/// Limited-memory BFGS over all consequents, with the exact gradient of the simulated cost.
///
/// ```text
/// gradient = -2 ∫ S'e dt,   S' = (∂fhat/∂what - K) S + Phi(what)
/// theta = start + z / sqrt(diag H + ridge):  every direction alike at the start
/// ```
///
/// Source: Liu and Nocedal, Mathematical Programming 45 (1989); line search: Moré and Thuente,
/// ACM TOMS 20 (1994).
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FuzzyGradient {
    /// Options of all fuzzy methods.
    #[serde(skip)]
    pub settings: Settings,
    /// Iterations at the most.
    pub iterations: u64,
    /// Where it starts.
    pub start: Start,
}

impl Default for FuzzyGradient {
    fn default() -> Self {
        let settings = Settings::default();
        Self { settings, iterations: 300, start: Start::Best }
    }
}

/// Name in experiment files.
const NAME: &str = "fuzzy_gradient";
const OPTIONS: [(&str, &str, &str); 2] = [
    ("iterations", "300", "iterations at the most"),
    (
        "start",
        "\"best\"",
        "\"friction\" level, \"closed_form\", the \"best\" of the two, or \"zero\"",
    ),
];

impl Identifier for FuzzyGradient {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Fuzzy emulator: L-BFGS with the exact gradient".into(),
            equation: "minimise ISE + ridge |theta - level|² with gradient -2 ∫ S'e dt".into(),
            source: "Liu and Nocedal 1989; Moré and Thuente 1994".into(),
            use_when: "there are so many rules that the matrix of Levenberg-Marquardt is too large"
                .into(),
            avoid_when: "there are 36 rules: fuzzy_levenberg_marquardt needs a twentieth of the \
                         evaluations"
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
        let ridge = self.settings.ridge;
        let start = self.start.of(&problem, &level, ridge, NAME)?;
        let Some(normal) = problem.normal(start.as_slice(), false) else {
            return Err(IdentifyError::NoStart {
                method: NAME.into(),
                reason: "the emulator diverges from the start; raise `gain`".into(),
            });
        };
        journal.note(normal.cost);
        let mean = normal.h.trace() / start.len() as f64;
        let scale = normal.h.diagonal().map(|h| 1.0 / (h + 1e-4 * mean).sqrt());
        let weight = ridge * mean;
        let slope = Slope { problem: &problem, start, level, scale, weight, journal: &journal };
        let (theta, iterations, status) = slope.descend(self.iterations)?;
        Ok(finish(NAME, &problem, &theta, status, iterations, &journal))
    }
}

/// Cost and gradient over scaled steps z from the start.
struct Slope<'a> {
    problem: &'a Problem,
    start: DVector<f64>,
    level: DVector<f64>,
    scale: DVector<f64>,
    weight: f64,
    journal: &'a Journal,
}

impl Slope<'_> {
    fn theta(&self, z: &DVector<f64>) -> DVector<f64> {
        &self.start + z.component_mul(&self.scale)
    }

    fn descend(self, iterations: u64) -> Result<(Vec<f64>, usize, Status), IdentifyError> {
        let first = DVector::zeros(self.start.len());
        let refuse = |e: argmin::core::Error| IdentifyError::NoStart {
            method: NAME.into(),
            reason: e.to_string(),
        };
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
        Ok((self.theta(&best).as_slice().to_vec(), done as usize, status))
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
        let ise = self.problem.cost(theta.as_slice());
        self.journal.note(ise);
        Ok(ise + self.weight * (theta - &self.level).norm_squared())
    }
}

impl Gradient for &Slope<'_> {
    type Param = DVector<f64>;
    type Gradient = DVector<f64>;

    fn gradient(&self, z: &DVector<f64>) -> Result<DVector<f64>, argmin::core::Error> {
        let theta = self.theta(z);
        let Some(normal) = self.problem.normal(theta.as_slice(), false) else {
            // uphill away from the start, along the way that diverges
            return Ok(z * (DIVERGED / z.norm_squared().max(1.0)));
        };
        self.journal.note(normal.cost);
        let slope = (theta - &self.level) * (2.0 * self.weight) - normal.g * 2.0;
        Ok(slope.component_mul(&self.scale))
    }
}
