//! How experiments are run, and what is said when one is done.

use std::path::PathBuf;

use super::shard::Shard;
use crate::study::Grade;

/// How experiments are run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Folder of the result folders.
    pub out: PathBuf,
    /// Overrides, `key=value`.
    pub set: Vec<String>,
    /// Keep finished cells of an interrupted grid.
    pub resume: bool,
    /// Run only this part of the combinations of a grid.
    pub shard: Option<Shard>,
    /// Show progress.
    pub progress: bool,
}

/// A finished experiment.
#[derive(Clone, Debug)]
pub struct Done {
    /// Its verdict in a sentence, with the errors.
    pub verdict: String,
    /// What was found, without the errors.
    pub finding: String,
    /// Path of its report; of its journal, if it is a part of a grid.
    pub report: PathBuf,
    /// 2 s simulation error of the model as given on the judged recordings [rad/s]; not a number for a grid.
    pub error: f64,
    /// The same with what was found [rad/s].
    pub error_completed: f64,
    /// Its noise floor [rad/s].
    pub floor: f64,
    /// How good the model with what was found is.
    pub grade: Option<Grade>,
    /// Ids of the effects found.
    pub found: Vec<String>,
    /// Measured and simulated speeds as PNG.
    pub thumbnail: Option<Vec<u8>>,
}

impl Done {
    /// Of a grid, which has no model of its own.
    pub(super) fn of_grid(verdict: String, report: PathBuf) -> Self {
        let (error, error_completed, floor) = (f64::NAN, f64::NAN, f64::NAN);
        let (grade, found, thumbnail) = (None, vec![], None);
        Self {
            finding: verdict.clone(),
            verdict,
            report,
            error,
            error_completed,
            floor,
            grade,
            found,
            thumbnail,
        }
    }
}
