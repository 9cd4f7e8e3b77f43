//! All results of one experiment: plain data, serialisable.
//!
//! A study contains no files, models or texts, only results; the report renders it and converts it into the
//! JSON for other programs.

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

pub use dependence::{DependenceStudy, Events, is_most_of_it, is_plain, most_pointing};
pub use diagnosis::{
    Advice, CandidateStudy, DiagnosisStudy, Logging, MethodAtFloor, StepStudy, Verdict, Withheld,
};
pub use formula::{Coefficient, FormulaStudy};
pub use grouped::grouped;
pub use invocation::{Invocation, shell_word};
pub use judged::Judged;
pub use method::{Combination, FuzzyStudy, MethodStudy, Performance};
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

/// Use of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Parameters are estimated from it.
    Train,
    /// The error is computed on it.
    Validation,
}

impl Role {
    /// Name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
        }
    }
}

/// A recording of the experiment.
#[derive(Clone, Debug)]
pub struct RecordingStudy {
    /// Its use.
    pub role: Role,
    /// File, or the name of a simulated recording.
    pub file: String,
    /// SHA-256 of the file; `None` for synthetic data.
    pub sha256: Option<String>,
    /// Number of rows; for a recording too long for memory those of its file.
    pub samples: usize,
    /// First to last sample \[s\].
    pub duration_s: f64,
    /// Median rate \[Hz\].
    pub rate_hz: f64,
    /// Which channels were measured.
    pub measured: Measured,
    /// Noise of the channels.
    pub noise: Noise,
    /// Findings of conditioning and their corrections.
    pub conditioning: Vec<Finding>,
    /// Findings of the quality check, the most severe first.
    pub findings: Vec<recording::Finding>,
    /// Its notes, which do not affect the results.
    pub notes: Vec<recording::Finding>,
    /// Error of the correct model.
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

/// Ratio of the quality index that noise causes to the part of the speed sensors above which the rest, the drift of a
/// free simulation by noise of the input, is most of it. The floor is then the mean of a random drift that one run may
/// miss by far (judgement).
const DRIFTING: f64 = 10.0;

impl RecordingStudy {
    /// Quality index due to the noise of the measured speeds alone [rad^2/s].
    #[must_use]
    pub fn ise_of_sensors(&self) -> f64 {
        self.noise.omega.iter().map(|s| s * s).sum::<f64>() * self.duration_s
    }

    /// Whether the noise floor of the quality index is mostly drift of the free simulation.
    #[must_use]
    pub fn drifts(&self) -> bool {
        self.floor.ise.iter().sum::<f64>() > DRIFTING * self.ise_of_sensors()
    }
}

/// A version of the model from an earlier run of the file.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Version {
    /// Effects of the model beyond the base.
    pub effects: Vec<String>,
    /// Checksum of the data on which it was fitted and judged.
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
    /// Its command line.
    pub invocation: Invocation,
    /// Title of the report.
    pub title: String,
    /// Version of the program.
    pub version: String,
    /// Seed of all random numbers in the experiment.
    pub seed: u64,
    /// The experiment file as run.
    pub file: String,
    /// Name of the preset, or a substitute.
    pub robot: String,
    /// Whether the experiment specifies the robot.
    pub robot_is_given: bool,
    /// Whether the track of the robot is known; otherwise that of another robot is used.
    pub track_is_known: bool,
    /// Effects of the model beyond the base.
    pub effects: Vec<String>,
    /// Unit of the input.
    pub drive_unit: DriveUnit,
    /// Training and validation recordings, in the order of the file.
    pub recordings: Vec<RecordingStudy>,
    /// One entry per `[[method]]` block, including failed ones.
    pub methods: Vec<MethodStudy>,
    /// The method whose fit is shown in detail.
    pub reference: Option<usize>,
    /// Gain K of the emulator on the wheel speeds [1/s].
    pub emulator_gain: f64,
    /// The model as given: fitted by the diagnosis if there is one, otherwise the reference fit. Verdict,
    /// error, regimes, residual torque and figures are those of this fit and of `completed`.
    pub given: Option<ModelStudy>,
    /// The model with the effects found by the diagnosis; `None` if there are none.
    pub completed: Option<ModelStudy>,
    /// Residual torque of both models over the variables, for all recordings.
    pub curves: Vec<Curve>,
    /// Diagnosis, if requested.
    pub diagnosis: Option<DiagnosisStudy>,
    /// Whether the experiment uses the emulator: `[emulator]` or a method that fits one.
    pub emulated: bool,
    /// Whether it is the paper's movement.
    pub of_paper: bool,
    /// Earlier versions of the model, oldest first, this one last.
    pub versions: Vec<Version>,
    /// Shift in time between input and motion by the last model, or why it is not reported. A dead time that logging does
    /// not explain is a delay in the fits of the methods.
    pub timing: Result<crate::diagnose::Timing, crate::diagnose::Untimed>,
    /// The same by the model as given, where `timing` is that by the model with the effects found.
    pub timing_as_given: Option<Result<crate::diagnose::Timing, crate::diagnose::Untimed>>,
    /// True parameters of synthetic data.
    pub truth: Vec<(String, f64)>,
    /// The files of the exported model; `None` if no method identified one.
    pub model_out: Option<ModelFiles>,
    /// The last model as a function for the page of the report; `None` without a physical fit.
    pub what_if: Option<WhatIfStudy>,
}

impl Study {
    /// The recordings on which errors are judged: validation, or training if there is none.
    #[must_use]
    pub fn judged(&self) -> Vec<usize> {
        Judged::of(&self.recordings).numbers()
    }

    /// Findings of the quality check, with those that differ only in numbers combined, and the names of their
    /// recordings.
    #[must_use]
    pub fn findings(&self) -> Vec<(String, StatedIssue)> {
        let found = self
            .recordings
            .iter()
            .flat_map(|r| r.findings.iter().map(|f| (r.file.as_str(), f.issue.stated())));
        grouped(found, self.recordings.len(), StatedIssue::join)
    }

    /// RMS 2 s simulation error of a method over the judged recordings [rad/s].
    #[must_use]
    pub fn judged_window_rms(&self, method: &MethodStudy) -> f64 {
        Judged::of(&self.recordings).window_rms(&method.performance)
    }

    /// RMS 2 s simulation error of the noise floor over the judged recordings [rad/s].
    #[must_use]
    pub fn judged_floor(&self) -> f64 {
        Judged::of(&self.recordings).floor()
    }

    /// The last model of the report: with the effects found, or as given.
    #[must_use]
    pub fn last_model(&self) -> Option<&ModelStudy> {
        self.completed.as_ref().or(self.given.as_ref())
    }

    /// RMS 2 s simulation error of a model over the judged recordings [rad/s].
    #[must_use]
    pub fn error_of(&self, model: &ModelStudy) -> f64 {
        Judged::of(&self.recordings).window_rms(&model.performance)
    }

    /// Largest measured wheel speed of the judged recordings [rad/s].
    #[must_use]
    pub fn top_speed(&self) -> f64 {
        Judged::of(&self.recordings).top_speed()
    }

    /// Grade of the last model; `None` without a fit. If the recordings do not determine the model, it is not
    /// usable, whatever its error.
    #[must_use]
    pub fn grade(&self) -> Option<Grade> {
        let model = self.last_model()?;
        if self.undetermined().is_some_and(|why| !why.is_of_tests()) {
            return Some(Grade::NotUsable);
        }
        Some(Grade::of(self.error_of(model), self.judged_floor(), self.top_speed()))
    }

    /// Why the recordings do not determine the model; `None` where they do.
    #[must_use]
    pub fn undetermined(&self) -> Option<Undetermined> {
        match &self.diagnosis {
            Some(diagnosis) => diagnosis.undetermined,
            None => self.reference_method().and_then(|m| m.undetermined_among(&self.methods)),
        }
    }

    /// The method shown in detail.
    #[must_use]
    pub fn reference_method(&self) -> Option<&MethodStudy> {
        self.methods.get(self.reference?)
    }
}
