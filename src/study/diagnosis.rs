//! What a diagnosis found, as plain data.

use serde::Serialize;

use super::undetermined::Undetermined;
use super::{DependenceStudy, FormulaStudy, FoundEffect, ParameterStudy, UnprovenEffect};
use crate::diagnose::{Difference, Errors, Judgement, Proposal};
use crate::identify::Estimate;
use crate::recording::DriveUnit;

/// An effect tried by the diagnosis.
#[derive(Clone, Debug)]
pub struct CandidateStudy {
    /// Id.
    pub effect: String,
    /// Posterior probability among the candidates.
    pub probability: f64,
    /// Effects indistinguishable from it by these data.
    pub indistinguishable: Vec<String>,
    /// Of the score test.
    pub p_value: f64,
    /// -ln of it, where it underflows.
    pub log_significance: f64,
    /// Log-evidence over the model without it.
    pub evidence: f64,
    /// Fall of the Bayesian information criterion.
    pub delta_bic: f64,
    /// Errors on the judged recordings without it.
    pub before: Judgement,
    /// Errors with it added and all parameters fitted again; `None` where it was not fitted, or is not among the first.
    pub after: Option<Judgement>,
    /// Likelihood ratio of the screening by regression.
    pub by_regression: f64,
    /// Likelihood ratio of the screening over the windows.
    pub by_windows: f64,
    /// Estimates of what it adds to the model.
    pub parameters: Vec<Estimate>,
    /// Root mean square torque of it [N m].
    pub torque_rms: f64,
}

/// The verdict of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing is missing at the stated false-alarm rate.
    ModelSufficient,
    /// Effects of the catalogue are missing.
    EffectsMissing,
    /// An effect is likely, but not proven.
    EffectLikely,
    /// Something is missing that no candidate explains.
    UnknownEffect,
}

impl Verdict {
    /// As in `results.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ModelSufficient => "model_sufficient",
            Self::EffectsMissing => "effects_missing",
            Self::EffectLikely => "effect_likely",
            Self::UnknownEffect => "unknown_effect",
        }
    }
}

/// The error of one model version: the model with one more effect.
#[derive(Clone, Debug, Serialize)]
pub struct StepStudy {
    /// Effect added; `None` for the first.
    pub added: Option<String>,
    /// Quality index on validation [rad^2/s].
    pub ise_validation: f64,
    /// 2 s simulation error on validation [rad/s].
    pub window_rms_validation: f64,
}

/// What the diagnosis says.
#[derive(Clone, Debug)]
pub struct DiagnosisStudy {
    /// Which of the four conclusions holds.
    pub verdict: Verdict,
    /// Errors of the first and of the last model on the judged recordings, beside the noise floor of the last.
    pub errors: Errors,
    /// Effects found, first found first.
    pub found: Vec<String>,
    /// An effect that lowers the held-out error beside what was found, without being proven.
    pub unproven: Option<UnprovenEffect>,
    /// An effect that lowers the held-out error where nothing is proven to be missing, and why it is not accepted.
    pub withheld: Option<(UnprovenEffect, Withheld)>,
    /// How the recordings were logged.
    pub logging: Logging,
    /// A parameter of the last model that differs between the recordings.
    pub differs: Option<Difference>,
    /// What the residual torque depends on, where the verdict states it.
    pub dependence: Option<DependenceStudy>,
    /// Parameters of the last model: that of the experiment with all effects found.
    pub parameters: Vec<ParameterStudy>,
    /// Candidates of the first step, best first.
    pub ranking: Vec<CandidateStudy>,
    /// Error with each effect found.
    pub staircase: Vec<StepStudy>,
    /// What to do or to record next.
    pub next: Vec<Advice>,
    /// The manoeuvre that distinguishes the best two, where one can.
    pub proposal: Option<Proposal>,
    /// Stated false-alarm rate.
    pub false_alarm: f64,
    /// The effects found, with names and causes.
    pub effects: Vec<FoundEffect>,
    /// What the residual torque depends on as a formula, where that lowers the error.
    pub formula: Option<FormulaStudy>,
    /// Why the recordings do not determine the model, so that nothing else here holds; `None` where they do.
    pub undetermined: Option<Undetermined>,
}

impl DiagnosisStudy {
    /// The effect that is likely: that of a verdict which says so, and otherwise one beside it. Beside a formula none of
    /// the catalogue is, and none where the recordings do not determine the model.
    #[must_use]
    pub fn likely(&self) -> Option<&UnprovenEffect> {
        let open = self.formula.is_none() && self.undetermined.is_none();
        self.unproven.as_ref().filter(|_| open || self.verdict == Verdict::EffectLikely)
    }
}

/// Why an effect that lowers the held-out error is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Withheld {
    /// The 2 s simulation error rises.
    Raises,
    /// The sampling of the input leaves as much open.
    BetweenRows,
    /// Its size is within its uncertainty.
    Small,
    /// The recordings have no more windows than the model has parameters, so that no size has an uncertainty.
    Short {
        /// Windows of the training recordings.
        windows: usize,
        /// Parameters that are estimated.
        parameters: usize,
    },
}

/// How inputs and speeds were recorded, as far as sizes of effects depend on it.
#[derive(Clone, Copy, Debug)]
pub struct Logging {
    /// Unit of the input.
    pub unit: DriveUnit,
    /// How much less late the input is if it is held through the rows, which the model draws a line between \[s\]: half a
    /// row; `None` where it is known to be held.
    pub if_held: Option<f64>,
    /// Whether speeds were recorded without angles, whose sensor may then be late.
    pub speeds_alone: bool,
}

/// A step towards what the data leave open. Effects are given by their ids, motions as the catalogue describes them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Advice {
    /// The columns do not determine the model: names and units of the columns are to be checked.
    CheckColumns,
    /// The rows are too slow for the inertias.
    RecordFaster {
        /// Rows a second that would do.
        rate: usize,
    },
    /// A recording that would prove an effect.
    Prove {
        /// That which is likely or withheld.
        effect: String,
        /// The motion that shows it.
        excitation: String,
        /// Whether the input must be recorded at a higher rate.
        faster: bool,
    },
    /// Nothing recorded at the wheels distinguishes an effect from others.
    Equivalent {
        /// That which was found first.
        effect: String,
        /// Those of the same equations.
        others: Vec<String>,
    },
    /// The two effects that come closest where none is proven.
    Closest([String; 2]),
    /// A recording that would distinguish two effects.
    Distinguish {
        /// The best candidate and one that these data do not distinguish from it.
        effects: [String; 2],
        /// The motion that shows each.
        excitations: [String; 2],
    },
}
