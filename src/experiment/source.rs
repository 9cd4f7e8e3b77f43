//! Recordings with what was found in them, as they are before a model is there.

use std::sync::Arc;

use crate::conditioning::Finding;
use crate::recording::{self, LongRecording, Recording};
use crate::simulate::Hold;
use crate::study::Role;

/// A recording with its use and provenance.
#[derive(Clone)]
pub struct MeasuredRecording {
    /// Use.
    pub role: Role,
    /// The recording; windows of it, if it is too long to be held.
    pub recording: Recording,
    /// All of its rows, if it is too long to be held.
    pub long: Option<Arc<LongRecording>>,
    /// SHA-256 of its file.
    pub sha256: Option<String>,
    /// What conditioning found, and did.
    pub conditioning: Vec<Finding>,
    /// What the quality check says.
    pub findings: Vec<recording::Finding>,
}

/// Recordings as they are before a model is there: of a file, or simulated.
#[derive(Clone)]
pub(super) struct Source {
    pub(super) recordings: Vec<MeasuredRecording>,
    /// The input between the rows, if it is said.
    pub(super) hold: Option<Hold>,
    pub(super) seed: u64,
    /// The true parameters of simulated ones.
    pub(super) truth: Vec<(String, f64)>,
}

impl Source {
    /// Recordings that are there already.
    pub(super) fn given(recordings: Vec<MeasuredRecording>) -> Self {
        Self { recordings, hold: None, seed: 1, truth: vec![] }
    }
}
