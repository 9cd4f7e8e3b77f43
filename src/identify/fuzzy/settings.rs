//! Options that all fuzzy methods share.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::Problem;
use crate::identify::prediction_error::PredictionError;
use crate::identify::{Identifier, IdentifyError, OptionError, Task, from_options, options_schema};
use crate::recording::DriveUnit;
use crate::robot::BaseParameters;
use crate::simulate::TakagiSugeno;
use crate::simulate::{Consequents, Defuzzification, Gain, MOST_MEMBERSHIPS, Structure};

/// Over which speeds the membership functions are spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(untagged)]
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
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Membership functions of each input.
    pub memberships: usize,
    /// Over which speeds they are spread.
    pub range: Range,
    /// What a rule concludes.
    pub consequents: Consequents,
    /// How rules are weighed.
    pub defuzzification: Defuzzification,
    /// Where fhat takes its argument from.
    pub structure: Structure,
    /// K on both wheel speeds [1/s].
    pub gain: f64,
    /// Where G comes from.
    pub input_gain: InputGain,
    /// Weight of the pull to the friction level, relative to the mean square sensitivity.
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

/// Keys of [`Settings`], default, meaning.
const SHARED: [(&str, &str, &str); 8] = [
    ("memberships", "6", "membership functions of each input (2 to 16); 6 make 36 rules"),
    (
        "range",
        "\"data\"",
        "over which speeds they are spread: \"data\" (measured speeds and a tenth beyond), \
         \"paper\" (0 to 30 rad/s) or [low, high] in rad/s; beyond, the output is that of the edge",
    ),
    ("consequents", "\"constant\"", "\"constant\" or \"affine\""),
    ("defuzzification", "\"weighted_average\"", "\"weighted_average\" or \"weighted_sum\""),
    ("structure", "\"parallel\"", "\"parallel\" or \"serial_parallel\", eq. (19)"),
    ("gain", "1.0", "K on both wheel speeds in 1/s; 0 is pure simulation"),
    (
        "input_gain",
        "\"construction\"",
        "G from a1, a2 of the \"construction\" data, or \"fitted\" by prediction error first \
         (always so where the drive is not in N m)",
    ),
    ("ridge", "1e-5", "pull to the friction level, relative to the mean square sensitivity"),
];

/// The rows of a description: those every fuzzy method has, then its own.
#[must_use]
pub fn described(own: &[(&str, &str, &str)]) -> Vec<(String, String, String)> {
    let row = |r: &(&str, &str, &str)| (r.0.into(), r.1.into(), r.2.into());
    SHARED.iter().chain(own).map(row).collect()
}

impl Settings {
    /// Splits the options of a block into those shared by all fuzzy methods and the method's own.
    ///
    /// # Errors
    /// Unknown keys, wrong types and values out of range, in words.
    pub fn split<M: serde::de::DeserializeOwned>(
        method: &str,
        options: &toml::Table,
        own: &[(&str, &str, &str)],
    ) -> Result<(Self, M), OptionError> {
        let (mut shared, mut rest) = (toml::Table::new(), toml::Table::new());
        for (key, value) in options {
            let known = |list: &[(&str, &str, &str)]| list.iter().any(|o| o.0 == key.as_str());
            if known(&SHARED) {
                shared.insert(key.clone(), value.clone());
            } else if known(own) {
                rest.insert(key.clone(), value.clone());
            } else {
                let all: Vec<String> = described(own).into_iter().map(|o| o.0).collect();
                let message = format!("unknown option `{key}`; expected {}", all.join(", "));
                return Err(OptionError { method: method.into(), message });
            }
        }
        let settings: Self = from_options(method, &shared)?;
        settings.check(method)?;
        Ok((settings, from_options(method, &rest)?))
    }

    /// The JSON schema of what [`Settings::split`] reads.
    #[must_use]
    pub fn schema<M: schemars::JsonSchema>() -> schemars::Schema {
        let (shared, mut own) = (options_schema::<Self>(), options_schema::<M>());
        let keys = |schema: &schemars::Schema| {
            schema.get("properties").and_then(|p| p.as_object().cloned()).unwrap_or_default()
        };
        let all: serde_json::Map<_, _> = keys(&own).into_iter().chain(keys(&shared)).collect();
        own.insert("properties".into(), all.into());
        own
    }

    fn check(&self, method: &str) -> Result<(), OptionError> {
        let refuse = |message: String| Err(OptionError { method: method.into(), message });
        if !(2..=MOST_MEMBERSHIPS).contains(&self.memberships) {
            let found = self.memberships;
            return refuse(format!("memberships = {found}; expected 2 to {MOST_MEMBERSHIPS}"));
        }
        if let Range::Given([low, high]) = self.range
            && !(low < high && low.is_finite() && high.is_finite())
        {
            return refuse(format!(
                "range = [{low}, {high}]; expected [low, high] with low < high"
            ));
        }
        if !(self.ridge >= 0.0 && self.ridge.is_finite()) {
            return refuse(format!("ridge = {}; expected 0 or more", self.ridge));
        }
        if !self.gain.is_finite() {
            return refuse(format!("gain = {}; expected a number of 1/s", self.gain));
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
                reason: format!(
                    "a1 = {:.3e} does not exceed |a2| = {:.3e}",
                    parameters.a1,
                    parameters.a2.abs()
                ),
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
        let value = |symbol: &str| fit.estimate(symbol).map_or(0.0, |e| e.value);
        Ok(BaseParameters {
            a1: value("a1"),
            a2: value("a2"),
            a3: value("a3"),
            a4: value("a4").max(0.0),
            a5: value("a5").max(0.0),
        })
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
