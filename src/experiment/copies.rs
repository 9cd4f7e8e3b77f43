//! Recordings that are copies of one another.

use super::error::{Meaning, words};
use super::remarks::repeated;
use super::source::MeasuredRecording;
use crate::recording::Recording;
use crate::study::Role;

/// The recordings of files that have the samples of an earlier one: the places of both. Simulated recordings
/// without noise may be equal.
pub(super) fn copies(recordings: &[MeasuredRecording]) -> Vec<(usize, usize)> {
    let is_read = |place: usize| recordings[place].sha256.is_some();
    let all: Vec<&Recording> = recordings.iter().map(|m| &m.recording).collect();
    repeated(&all).into_iter().filter(|(j, k)| is_read(*j) && is_read(*k)).collect()
}

/// Checks that no recording of validation has the samples of one of training.
///
/// # Errors
/// The first that has, with both names.
pub(super) fn check_copies(recordings: &[MeasuredRecording]) -> Result<(), Meaning> {
    let mut copies = copies(recordings).into_iter().map(|(j, k)| [&recordings[j], &recordings[k]]);
    let Some(pair) = copies.find(|[a, b]| a.role != b.role) else { return Ok(()) };
    let name = |role: Role| {
        pair.iter().find(|m| m.role == role).map_or("", |m| m.recording.name()).to_owned()
    };
    Err(words(format!(
        "recordings.validation: {} has the same samples as {} of training, so that errors on it are no validation; \
         name another recording, or leave it out",
        name(Role::Validation),
        name(Role::Train)
    )))
}
