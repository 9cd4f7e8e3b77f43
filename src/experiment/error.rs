//! Errors of experiments.

use std::path::PathBuf;

use super::file::FileError;
use crate::catalogue;
use crate::identify::{IdentifyError, OptionError};
use crate::io::IoError;
use crate::model::ModelError;
use crate::report::ReportError;
use crate::robot::RobotError;
use crate::simulate::{GainError, SimulateError};

/// Why an experiment has no results.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RunError {
    /// Every method failed; with the reasons.
    #[error("no method has a fit: {}", joined(.0))]
    NoFit(Vec<IdentifyError>),
    /// The mass matrix is not positive definite, or the motion diverges.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The model is not valid.
    #[error(transparent)]
    Model(#[from] ModelError),
}

fn joined(reasons: &[IdentifyError]) -> String {
    reasons.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Why an experiment did not run.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// The experiment file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file on disk.
    #[error(transparent)]
    Io(#[from] IoError),
    /// A wrong value in the experiment file, found when it was used.
    #[error("{file}: {message}")]
    Meaning {
        /// Experiment file, or its substitute.
        file: String,
        /// Place, value, expected value and remedy.
        message: String,
    },
    /// Running failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// No method has a fit that can be simulated; the report states the reason of each.
    #[error("{reason}; report: {}", report.display())]
    Unfitted {
        /// Why each method has no fit, or why the fits cannot be simulated.
        reason: RunError,
        /// Path of the report.
        report: PathBuf,
    },
    /// Drawing failed.
    #[error("the report cannot be drawn: {0}")]
    Report(#[from] ReportError),
}

impl ExperimentError {
    /// Whether usage, file or data are wrong (exit code 2), as opposed to the run (exit code 1).
    #[must_use]
    pub fn is_wrong_input(&self) -> bool {
        matches!(self, Self::File(_) | Self::Io(_) | Self::Meaning { .. })
    }

    /// Its text without the name of the experiment file.
    #[must_use]
    pub fn without_file(&self) -> String {
        match self {
            Self::Meaning { message, .. } | Self::File(FileError::Syntax { message, .. }) => {
                message.clone()
            }
            Self::File(FileError::Value { key, message, .. }) => format!("{key} {message}"),
            other => other.to_string(),
        }
    }

    /// The same about `other` where it is about this experiment file.
    pub(super) fn about(self, file: &str, other: &str) -> Self {
        match self {
            Self::Meaning { file: of, message } if of == file => {
                Self::Meaning { file: other.into(), message }
            }
            error => error,
        }
    }

    /// Whether a recording lacks a column that its column names require.
    #[must_use]
    pub fn is_missing_column(&self) -> bool {
        matches!(self, Self::Io(IoError::MissingColumn { .. }))
    }
}

/// Errors in the content of a file, without the name of the file.
#[derive(Debug, thiserror::Error)]
pub(super) enum Meaning {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Option(#[from] OptionError),
    #[error("[emulator]: {0}")]
    Gain(#[from] GainError),
    #[error("[robot]: {0}")]
    Robot(#[from] RobotError),
    #[error("[simulation]: {0}")]
    Simulate(#[from] SimulateError),
    #[error("{0}")]
    Words(String),
    #[error(transparent)]
    Io(#[from] IoError),
}

impl Meaning {
    /// The same with the name of the experiment file or its substitute; errors of files on disk already
    /// contain their name.
    pub(super) fn of(self, file: &str) -> ExperimentError {
        match self {
            Self::Io(e) => e.into(),
            other => ExperimentError::Meaning { file: file.into(), message: other.to_string() },
        }
    }
}

/// An error in a file as text.
pub(super) fn words(message: String) -> Meaning {
    Meaning::Words(message)
}

/// The most similar known name, as the end of a sentence.
pub(super) fn nearest(name: &str, known: &[&str]) -> String {
    catalogue::nearest(name, known.iter().copied())
        .map_or(String::new(), |near| format!("; did you mean `{near}`?"))
}
