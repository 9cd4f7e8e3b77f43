//! Fuzzy emulator by the simplex of Nelder and Mead.

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::neldermead::NelderMead;
use serde::Deserialize;

use super::fuzzy::{Journal, Problem, Settings, Start, described, finish};
use super::{Fit, Identifier, IdentifyError, MethodDescription, OptionError, Status, Task};

/// The simplex of Nelder and Mead over the consequents of the rules that the recordings reach.
///
/// ```text
/// minimise ISE(theta) by reflecting, stretching and shrinking a simplex of n + 1 points
/// ```
///
/// Source: Nelder and Mead, Computer Journal 7 (1965), as MATLAB's fminsearch.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FuzzyNelderMead {
    /// Options of all fuzzy methods.
    #[serde(skip)]
    pub settings: Settings,
    /// Moves of the simplex at the most.
    pub iterations: u64,
    /// Edge of the first simplex [rad/s²].
    pub edge: f64,
    /// Where it starts.
    pub start: Start,
}

impl Default for FuzzyNelderMead {
    fn default() -> Self {
        let settings = Settings::default();
        Self { settings, iterations: 4000, edge: 0.5, start: Start::Best }
    }
}

/// Name in experiment files.
const NAME: &str = "fuzzy_nelder_mead";
const OPTIONS: [(&str, &str, &str); 3] = [
    ("iterations", "4000", "moves of the simplex at the most"),
    ("edge", "0.5", "edge of the first simplex in rad/s^2"),
    (
        "start",
        "\"best\"",
        "\"friction\" level, \"closed_form\", the \"best\" of the two, or \"zero\"",
    ),
];

impl Identifier for FuzzyNelderMead {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Fuzzy emulator: Nelder-Mead simplex".into(),
            equation: "minimise ISE(theta) without derivatives by a simplex of n + 1 points".into(),
            source: "Nelder and Mead 1965".into(),
            use_when: "optimisers are compared".into(),
            avoid_when: "more than a dozen rules are fitted: the simplex stagnates in many \
                         dimensions"
                .into(),
            options: described(&OPTIONS),
        }
    }

    fn schema(&self) -> schemars::Schema {
        Settings::schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let (settings, own) = Settings::split::<Self>(NAME, options, &OPTIONS)?;
        if !(own.edge > 0.0 && own.edge.is_finite()) {
            let message = format!("edge = {}; expected a number above 0", own.edge);
            return Err(OptionError { method: NAME.into(), message });
        }
        Ok(Box::new(Self { settings, ..own }))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        let (problem, level) = self.settings.problem(task, NAME)?;
        let journal = Journal::default();
        let start = self.start.of(&problem, &level, self.settings.ridge, NAME)?;
        let simplex = Simplex {
            problem: &problem,
            start: start.as_slice().to_vec(),
            free: problem.reached(),
            journal: &journal,
        };
        let (theta, iterations, status) = simplex.descend(self.edge, self.iterations)?;
        Ok(finish(NAME, &problem, &theta, status, iterations, &journal))
    }
}

/// The cost over the consequents in `free`, as steps from `start`.
struct Simplex<'a> {
    problem: &'a Problem,
    start: Vec<f64>,
    free: Vec<usize>,
    journal: &'a Journal,
}

impl CostFunction for Simplex<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, steps: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        let cost = self.problem.cost(&self.theta(steps));
        self.journal.note(cost);
        Ok(cost)
    }
}

impl Simplex<'_> {
    fn theta(&self, steps: &[f64]) -> Vec<f64> {
        let mut theta = self.start.clone();
        for (&j, step) in self.free.iter().zip(steps) {
            theta[j] += step;
        }
        theta
    }

    fn descend(
        self,
        edge: f64,
        iterations: u64,
    ) -> Result<(Vec<f64>, usize, Status), IdentifyError> {
        let n = self.free.len();
        let corner = |i: usize| (0..n).map(|j| if i == j { edge } else { 0.0 }).collect();
        let points: Vec<Vec<f64>> = (0..=n).map(corner).rev().collect();
        let refuse = |e: argmin::core::Error| IdentifyError::NoStart {
            method: NAME.into(),
            reason: e.to_string(),
        };
        let solver = NelderMead::new(points).with_sd_tolerance(1e-9).map_err(refuse)?;
        let run = Executor::new(self, solver).configure(|s| s.max_iters(iterations)).run();
        let run = run.map_err(refuse)?;
        let state = run.state();
        let steps = state.get_best_param().cloned().unwrap_or_default();
        let done = state.get_iter();
        let status = if done < iterations { Status::Converged } else { Status::IterationLimit };
        let problem = run.problem.problem.as_ref();
        let theta = problem.map_or_else(Vec::new, |simplex| simplex.theta(&steps));
        Ok((theta, done as usize, status))
    }
}
