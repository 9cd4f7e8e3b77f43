//! Results of a diagnosis, as plain data.

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
    /// Whether simulation is no better with it, so that it counts as no more probable than no effect.
    pub no_better: bool,
    /// Effects indistinguishable from it by these data.
    pub indistinguishable: Vec<String>,
    /// p-value of the score test.
    pub p_value: f64,
    /// -ln of the p-value, which may underflow.
    pub log_significance: f64,
    /// Log-evidence relative to the model without it.
    pub evidence: f64,
    /// Reduction of the Bayesian information criterion.
    pub delta_bic: f64,
    /// Errors on the judged recordings without it.
    pub before: Judgement,
    /// Errors with it added and all parameters fitted again; `None` if it was not fitted, or is not among the
    /// first.
    pub after: Option<Judgement>,
    /// Likelihood ratio of the screening by regression.
    pub by_regression: f64,
    /// Likelihood ratio of the screening over the windows.
    pub by_windows: f64,
    /// Estimates of its parameters.
    pub parameters: Vec<Estimate>,
    /// Root mean square of its torque [N m].
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
    /// Something is missing that is not explained by any candidate.
    UnknownEffect,
}

impl Verdict {
    /// Name in `results.json`.
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

/// Result of a diagnosis.
#[derive(Clone, Debug)]
pub struct DiagnosisStudy {
    /// The conclusion, of four kinds.
    pub verdict: Verdict,
    /// Errors of the first and of the last model on the judged recordings, and the noise floor of the last.
    pub errors: Errors,
    /// Effects found, in the order in which they were found.
    pub found: Vec<String>,
    /// An effect that lowers the held-out error in addition to those found, but is not proven.
    pub unproven: Option<UnprovenEffect>,
    /// An effect that lowers the held-out error although nothing is proven to be missing, and the reason why
    /// it is not accepted.
    pub withheld: Option<(UnprovenEffect, Withheld)>,
    /// How the recordings were logged.
    pub logging: Logging,
    /// A method whose fit of the model as given is at the noise floor, where that of the diagnosis is not although
    /// nothing is missing.
    pub at_floor: Option<MethodAtFloor>,
    /// A parameter of the last model that differs between the recordings.
    pub differs: Option<Difference>,
    /// Dependence of the residual torque, if the verdict states it.
    pub dependence: Option<DependenceStudy>,
    /// Parameters of the last model: that of the experiment with all effects found.
    pub parameters: Vec<ParameterStudy>,
    /// Correlations of these estimates, row by row.
    pub correlations: Vec<Vec<f64>>,
    /// Candidates of the first step, in the order of their ranking.
    pub ranking: Vec<CandidateStudy>,
    /// Error after each effect found.
    pub staircase: Vec<StepStudy>,
    /// Recommended next steps.
    pub next: Vec<Advice>,
    /// The manoeuvre that distinguishes the first two candidates, if there is one.
    pub proposal: Option<Proposal>,
    /// Stated false-alarm rate.
    pub false_alarm: f64,
    /// The effects found, with names and causes.
    pub effects: Vec<FoundEffect>,
    /// Formula for the residual torque, if it lowers the error.
    pub formula: Option<FormulaStudy>,
    /// Why the recordings do not determine the model; then nothing else here is valid. `None` if they do.
    pub undetermined: Option<Undetermined>,
}

/// A method whose fit is at the noise floor of recordings that were not fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodAtFloor {
    /// Its name.
    pub method: String,
    /// Ratio of its 2 s simulation error to the floor.
    pub ratio: f64,
}

impl DiagnosisStudy {
    /// Whether recordings that were not fitted have an error above the noise floor although nothing is proven to be
    /// missing: the data do not decide.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.verdict == Verdict::ModelSufficient
            && self.errors.above_floor()
            && self.at_floor.is_none()
    }

    /// The likely effect: that of the verdict, or an additional one. None if a formula describes the residual
    /// torque, or if the recordings do not determine the model.
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
    /// The unknown input between the rows can cause the same reduction.
    BetweenRows,
    /// It does not differ significantly from zero.
    Small,
    /// It does not act in the held-out recordings.
    Idle,
    /// There are no more windows than parameters, so that no standard errors can be computed.
    Short {
        /// Number of windows of the training recordings.
        windows: usize,
        /// Number of estimated parameters.
        parameters: usize,
    },
}

/// Properties of the log that affect the sizes of effects.
#[derive(Clone, Copy, Debug)]
pub struct Logging {
    /// Unit of the input.
    pub unit: DriveUnit,
    /// Reduction of the estimated delay if the input is held between the rows, where the model interpolates
    /// linearly \[s\]: half a row; `None` if it is known to be held.
    pub if_held: Option<f64>,
    /// Whether speeds were recorded without angles, so that a delay of the speed sensor cannot be excluded.
    pub speeds_alone: bool,
    /// Duration of the longest judged recording \[s\].
    pub longest_s: f64,
}

/// A recommended next step. Effects are given by their ids, motions as described in the catalogue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Advice {
    /// The columns do not determine the model: check names and units of the columns.
    CheckColumns,
    /// The speeds hardly change: movement that determines the inertias.
    ChangeSpeed,
    /// A recording of more windows.
    RecordLonger,
    /// The rows are too slow for the inertias.
    RecordFaster {
        /// Sufficient number of rows per second.
        rate: usize,
    },
    /// Training recordings with the movement of the validation recordings.
    TrainOn {
        /// Names of the latter.
        recordings: Vec<String>,
    },
    /// A recording that can prove an effect.
    Prove {
        /// The likely or withheld effect.
        effect: String,
        /// The motion that excites it.
        excitation: String,
        /// Whether the input should be recorded at a higher rate.
        faster: bool,
    },
    /// An effect cannot be distinguished from others by recordings of the wheels.
    Equivalent {
        /// The effect that was found first.
        effect: String,
        /// The effects with the same equations.
        others: Vec<String>,
    },
    /// The two best candidates if none is proven.
    Closest([String; 2]),
    /// A recording that can distinguish two effects.
    Distinguish {
        /// The best candidate and one that is not distinguishable from it.
        effects: [String; 2],
        /// The motion that excites each.
        excitations: [String; 2],
    },
}
