//! Options and results of runs.

use std::path::PathBuf;

use super::shard::Shard;

/// Where results are written, which keys are overridden, and which cells of a grid run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Folder of the result folders.
    pub out: PathBuf,
    /// Overrides, `key=value`.
    pub set: Vec<String>,
    /// Keep the completed cells of an interrupted grid.
    pub resume: bool,
    /// Run only this part of the combinations of a grid.
    pub shard: Option<Shard>,
    /// Show progress.
    pub progress: bool,
}

/// Name of the thumbnail in a result folder.
pub(super) const THUMBNAIL: &str = "thumbnail.png";

/// A completed experiment.
#[derive(Clone, Debug)]
pub struct Done {
    /// Its verdict in a sentence, with the errors.
    pub verdict: String,
    /// Estimates of the model that other methods contradict, in sentences.
    pub contradictions: Vec<String>,
    /// Path of its report, or of its journal for a part of a grid.
    pub report: PathBuf,
    /// 2 s simulation error of the model as given on the judged recordings [rad/s]; NaN for a grid.
    pub error: f64,
    /// Its noise floor [rad/s].
    pub floor: f64,
}

impl Done {
    /// Result of a grid, which has no model.
    pub(super) fn of_grid(verdict: String, report: PathBuf) -> Self {
        Self { verdict, contradictions: vec![], report, error: f64::NAN, floor: f64::NAN }
    }
}
