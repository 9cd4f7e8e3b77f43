//! Recordings with their findings, independent of a model.

use std::sync::Arc;

use crate::conditioning::Finding;
use crate::recording::{self, LongRecording, Recording};
use crate::simulate::Hold;
use crate::study::Role;

/// A recording with its role and provenance.
#[derive(Clone)]
pub struct MeasuredRecording {
    /// Use.
    pub role: Role,
    /// The recording; windows of it if it is too long for memory.
    pub recording: Recording,
    /// All of its rows, if it is too long for memory.
    pub long: Option<Arc<LongRecording>>,
    /// SHA-256 of its file.
    pub sha256: Option<String>,
    /// Findings of conditioning and their corrections.
    pub conditioning: Vec<Finding>,
    /// Findings of the quality check.
    pub findings: Vec<recording::Finding>,
}

/// Recordings independent of a model: read from files, or simulated.
#[derive(Clone)]
pub(super) struct Source {
    pub(super) recordings: Vec<MeasuredRecording>,
    /// The input between the rows, if specified.
    pub(super) hold: Option<Hold>,
    pub(super) seed: u64,
    /// The true parameters of simulated recordings.
    pub(super) truth: Vec<(String, f64)>,
}

impl Source {
    /// Recordings that are given directly.
    pub(super) fn given(recordings: Vec<MeasuredRecording>) -> Self {
        Self { recordings, hold: None, seed: 1, truth: vec![] }
    }
}
