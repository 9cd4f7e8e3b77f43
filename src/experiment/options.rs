//! How experiments are run, and what is said when one is done.

use std::path::PathBuf;

use super::grid::Shard;

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
    /// Its verdict in a sentence.
    pub verdict: String,
    /// Path of its report; of its journal, if it is a part of a grid.
    pub report: PathBuf,
    /// Window error and floor on the judged recordings [rad/s].
    pub window_rms: (f64, f64),
}
