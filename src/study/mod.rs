//! All results of one experiment: plain data, serialisable.
//!
//! A study holds no files, no models and no texts, only what was found; the report draws it and turns it into the JSON
//! that other programs read.

mod dependence;
mod diagnosis;
mod formula;
mod grouped;
mod invocation;
mod judged;
mod method;
mod model;
mod undetermined;
mod what_if;

pub use dependence::{DependenceStudy, is_most_of_it, is_plain, most_pointing};
pub use diagnosis::{
    Advice, CandidateStudy, DiagnosisStudy, Logging, StepStudy, Verdict, Withheld,
};
pub use formula::{Coefficient, FormulaStudy};
pub use grouped::grouped;
pub use invocation::{Invocation, shell_word};
pub use judged::Judged;
pub use method::{FuzzyStudy, MethodStudy, Performance};
pub use model::{
    FAR_BELOW_FLOOR, FoundEffect, Grade, ModelStudy, ParameterStudy, UnprovenEffect, parameters_of,
};
pub use undetermined::Undetermined;
pub use what_if::{Start, WhatIfStudy};

use serde::Serialize;

use crate::compare::{Curve, Floor};
use crate::conditioning::Finding;
use crate::export::ModelFiles;
use crate::recording::{self, DriveUnit, Measured, Noise, Regime, StatedIssue};

/// What a recording is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Parameters are fitted to it.
    Train,
    /// The error is judged on it.
    Validation,
}

impl Role {
    /// As in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
        }
    }
}

/// A recording of the experiment, with what was measured.
#[derive(Clone, Debug)]
pub struct RecordingStudy {
    /// Its use.
    pub role: Role,
    /// File, or the name of a simulated recording.
    pub file: String,
    /// SHA-256 of the file; `None` for synthetic data.
    pub sha256: Option<String>,
    /// Rows, of a recording too long to be held those of its file.
    pub samples: usize,
    /// First to last sample \[s\].
    pub duration_s: f64,
    /// Median rate \[Hz\].
    pub rate_hz: f64,
    /// Which channels were measured.
    pub measured: Measured,
    /// Noise of the channels.
    pub noise: Noise,
    /// What sensors and logger did to it, and what was done about it.
    pub conditioning: Vec<Finding>,
    /// What the quality check says, worst first.
    pub findings: Vec<recording::Finding>,
    /// Error of the right model.
    pub floor: Floor,
    /// Time \[s\].
    pub t: Vec<f64>,
    /// Angles \[rad\].
    pub alpha: Vec<[f64; 2]>,
    /// Speeds [rad/s].
    pub omega: Vec<[f64; 2]>,
    /// Recorded input.
    pub torque: Vec<[f64; 2]>,
    /// Regime of driving.
    pub regimes: Vec<Regime>,
    /// Path of the axle's centre: x \[m\], y \[m\], heading \[rad\].
    pub path: Vec<[f64; 3]>,
}

/// A version of the model that was run before: the error by the user's own versions.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Version {
    /// Effects of the model beyond the base.
    pub effects: Vec<String>,
    /// Checksum of the data that it was fitted to and judged on.
    #[serde(default)]
    pub data: String,
    /// 2 s simulation error on the judged recordings [rad/s].
    pub window_rms: f64,
    /// Quality index on the judged recordings [rad^2/s].
    pub ise: f64,
    /// 2 s simulation error of the noise floor [rad/s].
    pub floor: f64,
}

/// One experiment.
#[derive(Clone, Debug)]
pub struct Study {
    /// Name of the folder.
    pub experiment: String,
    /// How the command line names it.
    pub invocation: Invocation,
    /// Heading.
    pub title: String,
    /// Version of the program.
    pub version: String,
    /// Of everything random in the experiment.
    pub seed: u64,
    /// The experiment file as run.
    pub file: String,
    /// Name of the preset, or what stands for it.
    pub robot: String,
    /// Whether the experiment says which robot it is.
    pub robot_is_given: bool,
    /// Whether the track of the robot is known; that of another robot stands in where it is not.
    pub track_is_known: bool,
    /// Effects of the model beyond the base.
    pub effects: Vec<String>,
    /// Unit of the input.
    pub drive_unit: DriveUnit,
    /// What the methods were fitted to and judged on, in the order of the file.
    pub recordings: Vec<RecordingStudy>,
    /// One a `[[method]]` block, whether it found a fit or not.
    pub methods: Vec<MethodStudy>,
    /// The method whose fit is shown in detail.
    pub reference: Option<usize>,
    /// Gain K of the emulator on the wheel speeds [1/s].
    pub emulator_gain: f64,
    /// The model as given: fitted by the diagnosis where there is one, else the reference fit. Verdict, error,
    /// regimes, residual torque and figures are of this fit and of `completed`.
    pub given: Option<ModelStudy>,
    /// The model with the effects that the diagnosis found; `None` where there are none.
    pub completed: Option<ModelStudy>,
    /// How the residual torque of both depends on anything, over all recordings.
    pub curves: Vec<Curve>,
    /// Diagnosis, where asked for.
    pub diagnosis: Option<DiagnosisStudy>,
    /// Whether the experiment asks for the emulator: `[emulator]` or a method that fits one.
    pub emulated: bool,
    /// Whether it is the paper's movement.
    pub of_paper: bool,
    /// Earlier versions of the model, oldest first, this one last.
    pub versions: Vec<Version>,
    /// When the recorded input acts, where the data show it.
    pub timing: Option<crate::diagnose::Timing>,
    /// True parameters of synthetic data.
    pub truth: Vec<(String, f64)>,
    /// The files that hold the identified model; `None` where no method found one.
    pub model_out: Option<ModelFiles>,
    /// The last model as a function that the page of the report runs; `None` without a physical fit.
    pub what_if: Option<WhatIfStudy>,
}

/// Least root mean square difference of the wheel speeds over that of their sum for runs that turn (taste).
const TURNS: f64 = 0.1;

impl Study {
    /// The recordings on which errors are judged: validation, or train where there is none.
    #[must_use]
    pub fn judged(&self) -> Vec<usize> {
        Judged::of(&self.recordings).numbers()
    }

    /// What the check of the recordings found, what differs in its numbers alone once, with the names of its
    /// recordings.
    #[must_use]
    pub fn findings(&self) -> Vec<(String, StatedIssue)> {
        let found = self
            .recordings
            .iter()
            .flat_map(|r| r.findings.iter().map(|f| (r.file.as_str(), f.issue.stated())));
        grouped(found, self.recordings.len(), StatedIssue::join)
    }

    /// Root mean square 2 s simulation error of a method over the judged recordings [rad/s].
    #[must_use]
    pub fn judged_window_rms(&self, method: &MethodStudy) -> f64 {
        Judged::of(&self.recordings).window_rms(&method.performance)
    }

    /// Root mean square 2 s simulation error of the noise floor over the judged recordings [rad/s].
    #[must_use]
    pub fn judged_floor(&self) -> f64 {
        Judged::of(&self.recordings).floor()
    }

    /// The model that the report ends with: with what was found, or as given.
    #[must_use]
    pub fn last_model(&self) -> Option<&ModelStudy> {
        self.completed.as_ref().or(self.given.as_ref())
    }

    /// Root mean square 2 s simulation error of a model over the judged recordings [rad/s].
    #[must_use]
    pub fn error_of(&self, model: &ModelStudy) -> f64 {
        Judged::of(&self.recordings).window_rms(&model.performance)
    }

    /// Largest measured wheel speed of the judged recordings [rad/s].
    #[must_use]
    pub fn top_speed(&self) -> f64 {
        Judged::of(&self.recordings).top_speed()
    }

    /// How good the last model is; `None` without a fit. A model that the recordings do not determine is not usable,
    /// whatever its error.
    #[must_use]
    pub fn grade(&self) -> Option<Grade> {
        let model = self.last_model()?;
        if self.undetermined().is_some() {
            return Some(Grade::NotUsable);
        }
        Some(Grade::of(self.error_of(model), self.judged_floor(), self.top_speed()))
    }

    /// Why the recordings do not determine the model; `None` where they do.
    #[must_use]
    pub fn undetermined(&self) -> Option<Undetermined> {
        match &self.diagnosis {
            Some(diagnosis) => diagnosis.undetermined,
            None => undetermined(&self.recordings, self.reference_method()),
        }
    }

    /// The method shown in detail.
    #[must_use]
    pub fn reference_method(&self) -> Option<&MethodStudy> {
        self.methods.get(self.reference?)
    }
}

/// Why `recordings` do not determine the model that the `reference` method fitted: its inertias may be those of the input
/// between the rows; or the columns are others, where the descent stalled without a1 though the wheels turn against each
/// other, or nothing of the base model is identifiable. On runs straight ahead, as those of a single axis, a1 + a2 is found
/// and a1 is not; of a single axis sums alone are.
#[must_use]
pub fn undetermined(
    recordings: &[RecordingStudy],
    reference: Option<&MethodStudy>,
) -> Option<Undetermined> {
    let method = reference?;
    if let Some(between_rows) = method.undetermined_between_rows() {
        return Some(between_rows);
    }
    let rows = || recordings.iter().flat_map(|r| &r.omega);
    let is_single_axis = rows().all(|w| w[0] == w[1]);
    let of_columns =
        turns(rows()) && method.is_undetermined() || !is_single_axis && method.identifies_nothing();
    of_columns.then_some(Undetermined::Columns)
}

/// Whether wheels turn against each other, of whose speeds these are the rows.
fn turns<'a>(rows: impl Iterator<Item = &'a [f64; 2]>) -> bool {
    let add =
        |(d, s): (f64, f64), w: &[f64; 2]| (d + (w[0] - w[1]).powi(2), s + (w[0] + w[1]).powi(2));
    let (difference, sum) = rows.fold((0.0, 0.0), add);
    difference > TURNS * TURNS * sum
}

#[cfg(test)]
mod tests {
    use super::turns;

    #[test]
    fn an_axis_written_down_twice_does_not_turn() {
        let axis: Vec<[f64; 2]> = (0..100).map(|k| [f64::from(k).sin(); 2]).collect();
        assert!(!turns(axis.iter()));
        let straight: Vec<[f64; 2]> = axis.iter().map(|w| [w[0] + 0.02, w[1] - 0.02]).collect();
        assert!(!turns(straight.iter()));
        let curve: Vec<[f64; 2]> = axis.iter().map(|w| [w[0], 0.7 * w[1]]).collect();
        assert!(turns(curve.iter()));
    }
}
