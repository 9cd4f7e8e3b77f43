//! Options that all fuzzy methods share.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::Problem;
use crate::identify::prediction_error::PredictionError;
use crate::identify::{Identifier, IdentifyError, NoStart, OptionError, Task};
use crate::model::base;
use crate::recording::DriveUnit;
use crate::robot::BaseParameters;
use crate::simulate::TakagiSugeno;
use crate::simulate::{Consequents, Defuzzification, Gain, MOST_MEMBERSHIPS, Structure};

/// Over which speeds the membership functions are spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(
    untagged,
    expecting = "`range` must be \"data\", \"paper\" or two speeds [low, high] in rad/s"
)]
pub enum Range {
    /// `"data"`: from the smallest to the largest measured speed of each wheel, and a tenth of
    /// that length beyond, so that rules at the friction level hold the emulator at the edges.
    Named(NamedRange),
    /// `[low, high]` for both wheels [rad/s]; the paper's is `[0, 30]`.
    Given([f64; 2]),
}

/// Ranges with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NamedRange {
    /// That of the training recordings.
    Data,
    /// [0, 30] rad/s.
    Paper,
}

/// Where G of eq. (18) and the friction level come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum InputGain {
    /// From a1, a2 of the construction data.
    Construction,
    /// From a1, a2 of a prediction-error fit.
    Fitted,
}

/// Where a search starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// At the friction level or at the closed form, whichever has the lower cost.
    Best,
    /// All consequents at the friction level, -a4/(a1 + a2) where both wheels run forward.
    Friction,
    /// At the least squares of the serial-parallel structure.
    ClosedForm,
    /// All consequents zero.
    Zero,
}

/// Options of a `[[method]]` block that every fuzzy method understands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Membership functions of each input; 6 make 36 rules.
    #[schemars(range(min = 2, max = MOST_MEMBERSHIPS))]
    pub memberships: usize,
    /// Speeds over which they are spread: "data" (measured speeds and a tenth beyond), "paper" (0
    /// to 30 rad/s) or [low, high] in rad/s; beyond, the output is that of the edge.
    pub range: Range,
    /// Consequent of a rule.
    pub consequents: Consequents,
    /// Weighting of the rules.
    pub defuzzification: Defuzzification,
    /// Speeds at which fhat is evaluated, eq. (19): simulated (parallel) or measured.
    pub structure: Structure,
    /// K on both wheel speeds [1/s]; 0 is pure simulation. Unless given, that of `[emulator]` where it
    /// is above 0.
    pub gain: f64,
    /// Source of a1, a2 in G: construction data, or a prediction-error fit (always the fit where
    /// the input is not in N m).
    pub input_gain: InputGain,
    /// Weight of the penalty on the distance from the friction level, relative to the mean square
    /// sensitivity of an emulator held at the data (serial-parallel).
    #[schemars(range(min = 0.0))]
    pub ridge: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            memberships: 6,
            range: Range::Named(NamedRange::Data),
            consequents: Consequents::Constant,
            defuzzification: Defuzzification::WeightedAverage,
            structure: Structure::Parallel,
            gain: 1.0,
            input_gain: InputGain::Construction,
            ridge: 1e-5,
        }
    }
}

impl Settings {
    /// What ranges alone do not say.
    ///
    /// # Errors
    /// A range of speeds that is none, and a gain that is unstable.
    pub(super) fn check(&self, method: &str) -> Result<(), OptionError> {
        let refuse = |message: String| Err(OptionError { method: method.into(), message });
        if let Range::Given([low, high]) = self.range
            && !(low < high && low.is_finite() && high.is_finite())
        {
            return refuse(format!(
                "range = [{low}, {high}]; expected [low, high] with low < high"
            ));
        }
        Gain::speed(self.gain).check().or_else(|e| refuse(e.to_string()))
    }

    /// The problem of a task, and the friction level of all consequents.
    ///
    /// # Errors
    /// If the parameters of G are to be fitted and cannot be.
    pub fn problem(
        &self,
        task: &Task,
        method: &str,
    ) -> Result<(Problem, DVector<f64>), IdentifyError> {
        let parameters = self.parameters(task)?;
        if parameters.a1 <= 0.0 || parameters.determinant() <= 0.0 {
            return Err(IdentifyError::NoStart {
                method: method.into(),
                reason: NoStart::Mass { a1: parameters.a1, a2: parameters.a2 },
            });
        }
        let system = TakagiSugeno::uniform(
            self.memberships,
            self.ranges(task),
            self.consequents,
            self.defuzzification,
        );
        let problem = Problem::new(task, system, parameters, self.structure, self.gain);
        let level = problem.friction_level(parameters);
        Ok((problem, level))
    }

    fn ranges(&self, task: &Task) -> [(f64, f64); 2] {
        match self.range {
            Range::Given([low, high]) => [(low, high); 2],
            Range::Named(NamedRange::Paper) => [(0.0, 30.0); 2],
            Range::Named(NamedRange::Data) => [0, 1].map(|i| {
                let speeds = task.train.iter().flat_map(|r| r.omega()).map(|w| w[i]);
                let ends = |(low, high): (f64, f64), w: f64| (low.min(w), high.max(w));
                let (low, high) = speeds.fold((f64::INFINITY, f64::NEG_INFINITY), ends);
                // a wheel that hardly moves still needs a range
                let widen = (0.1 * (high - low)).max(0.5 - 0.5 * (high - low));
                (low - widen, high + widen)
            }),
        }
    }

    fn parameters(&self, task: &Task) -> Result<BaseParameters, IdentifyError> {
        let newton = task.train.iter().all(|r| r.drive_unit() == DriveUnit::NewtonMetre);
        if self.input_gain == InputGain::Construction && newton {
            return Ok(task.model.robot().parameters());
        }
        let fit = PredictionError::default().identify(task)?;
        let values: Vec<f64> = fit.estimates.iter().map(|e| e.value).collect();
        let found = base::of(&values);
        Ok(BaseParameters { a4: found.a4.max(0.0), a5: found.a5.max(0.0), ..found })
    }
}

impl Start {
    /// The consequents where a search starts.
    ///
    /// # Errors
    /// See [`Problem::closed_form`].
    pub fn of(
        self,
        problem: &Problem,
        level: &DVector<f64>,
        ridge: f64,
        method: &str,
    ) -> Result<DVector<f64>, IdentifyError> {
        match self {
            Self::Friction => Ok(level.clone()),
            Self::Zero => Ok(DVector::zeros(level.len())),
            Self::ClosedForm => problem.closed_form(level, ridge, method),
            Self::Best => {
                let solved = problem.closed_form(level, ridge, method)?;
                let worse = problem.cost(solved.as_slice()) > problem.cost(level.as_slice());
                Ok(if worse { level.clone() } else { solved })
            }
        }
    }
}
