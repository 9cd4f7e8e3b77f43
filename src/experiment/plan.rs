//! An experiment ready to run, with all names resolved.

mod options;

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

pub use self::options::{DiagnosisPlan, MethodPlan, PlanOptions};
use super::combinations::GridPlan;
use super::custom::Own;
use super::remark::Remark;
pub use super::source::MeasuredRecording;
use crate::conditioning::{Stated, stated};
use crate::diagnose::{Timing, Untimed};
use crate::effects;
use crate::model::Model;
use crate::recording::{DriveUnit, LongRecording, Recording, StatedIssue};
use crate::report::{dead_time, dead_time_advice};
use crate::simulate::{Gain, Hold};
use crate::study::{Role, grouped};

/// An input that is the sum of several columns; printed as `M1 = front_right + rear_right`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputSum {
    /// `M1` or `M2`.
    pub input: String,
    /// Names of the columns.
    pub columns: Vec<String>,
}

impl fmt::Display for InputSum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.input, self.columns.join(" + "))
    }
}

/// An experiment ready to run.
pub struct Plan {
    /// Name of the result folder.
    pub name: String,
    /// Heading.
    pub title: String,
    /// The experiment file as run; empty where there is none.
    pub file: String,
    /// Its path; empty where there is none.
    pub source: PathBuf,
    /// The recordings of a run without an experiment file, as typed; `source` then does not exist.
    pub typed: Vec<PathBuf>,
    /// Whether the robot is specified; otherwise that of the model is a substitute.
    pub robot_is_given: bool,
    /// Model to fit.
    pub model: Model,
    /// User-defined effects, in the model or not: formulas of the file, effects added by the library.
    pub own: Vec<Own>,
    /// Inputs that are the sum of several columns.
    pub sums: Vec<InputSum>,
    /// Units that neither the file nor the names of the columns state, in a sentence.
    pub assumed: Option<String>,
    /// Remarks on settings with unexpected consequences.
    pub remarks: Vec<Remark>,
    /// Recordings, at least one for training.
    pub recordings: Vec<MeasuredRecording>,
    /// The input between samples.
    pub hold: Hold,
    /// Shift in time between input and motion, or why it is not reported.
    pub timing: Result<Timing, Untimed>,
    /// Methods to compare.
    pub methods: Vec<MethodPlan>,
    /// Gain of the emulator.
    pub gain: Gain,
    /// Whether the emulator is requested, by `[emulator]` or by a method that fits one.
    pub emulated: bool,
    /// Whether the paper's movement is simulated.
    pub of_paper: bool,
    /// Diagnosis, if asked for.
    pub diagnosis: Option<DiagnosisPlan>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// True parameters of synthetic data.
    pub truth: Vec<(String, f64)>,
    /// The combinations of a grid; the other fields are then those of the first one.
    pub grid: Option<GridPlan>,
}

impl MeasuredRecording {
    fn name(&self) -> &str {
        self.recording.name()
    }

    /// Rows of the whole recording.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.long.as_ref().map_or(self.recording.len(), |long| long.samples)
    }

    /// From the first to the last row of the whole recording \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.long.as_ref().map_or(self.recording.duration(), |long| long.duration)
    }
}

impl Plan {
    /// Warnings before a run: remarks on the file, corrections, and findings of the quality check.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let corrected = |m: &MeasuredRecording| {
            let remarkable = m.conditioning.iter().filter(|f| f.is_remarkable());
            stated(&remarkable.copied().collect::<Vec<_>>())
        };
        let stated = self.grouped(corrected, Stated::join);
        let stated = stated.into_iter().map(|(names, corrected)| format!("{names}: {corrected}"));
        // a diagnosis reports it as an effect
        let late = self.late().filter(|_| self.diagnosis.is_none());
        let late = late.map(|t| format!("dead time {}: {}", dead_time(&t), dead_time_advice()));
        stated.chain(self.remarks_and_findings()).chain(late).collect()
    }

    /// The dead time, if it exceeds what logging explains and the model has none.
    pub(super) fn late(&self) -> Option<Timing> {
        self.timing.ok().filter(Timing::is_late)
    }

    /// The model that the methods fit: that of the file, with a delay of the input where the recordings have a dead
    /// time that logging does not explain. Without it the inertias and frictions would take a part of that time.
    #[must_use]
    pub fn fitted_model(&self) -> Model {
        self.model_with(self.late())
    }

    /// The model of the file with a delay of the input for a dead time that is too late for logging.
    pub(super) fn model_with(&self, late: Option<Timing>) -> Model {
        let with_delay = |timing: Timing| {
            let model = self.model.add(&effects::delay()?.id()).ok()?;
            Some(model.starting_at(self.model.parameters().len(), timing.dead_time_s))
        };
        late.and_then(with_delay).unwrap_or_else(|| self.model.clone())
    }

    /// The same without corrections.
    pub(super) fn remarks_and_findings(&self) -> Vec<String> {
        let issues = |m: &MeasuredRecording| m.findings.iter().map(|f| f.issue.stated()).collect();
        let found = self.grouped(issues, StatedIssue::join);
        let found = found.into_iter().map(|(names, issue)| format!("{names}: {issue}"));
        self.remarks.iter().map(ToString::to_string).chain(found).collect()
    }

    /// Findings of `of` in the recordings, each with the names of these.
    pub(super) fn grouped<T>(
        &self,
        of: impl Fn(&MeasuredRecording) -> Vec<T>,
        join: impl Fn(&mut T, &T) -> bool,
    ) -> Vec<(String, T)> {
        let named = |m| of(m).into_iter().map(|finding| (MeasuredRecording::name(m), finding));
        grouped(self.recordings.iter().flat_map(named), self.recordings.len(), join)
    }

    /// Unit of the recorded input.
    #[must_use]
    pub fn drive_unit(&self) -> DriveUnit {
        self.recordings.first().map_or(DriveUnit::NewtonMetre, |m| m.recording.drive_unit())
    }

    /// The recordings of a role.
    #[must_use]
    pub fn of(&self, role: Role) -> Vec<Recording> {
        self.recordings.iter().filter(|m| m.role == role).map(|m| m.recording.clone()).collect()
    }

    /// For each training recording all rows, if it is too long for memory.
    #[must_use]
    pub fn long(&self) -> Vec<Option<Arc<LongRecording>>> {
        let train = self.recordings.iter().filter(|m| m.role == Role::Train);
        train.map(|m| m.long.clone()).collect()
    }
}
