//! The measured recordings of an experiment: read, conditioned, checked.

use std::path::Path;

use super::error::{Meaning, words};
use super::file::RecordingsEntry;
use super::no_motion::NoMotion;
use super::reading::Reading;
use super::source::MeasuredRecording;
use super::together::{Unread, read_together};
use crate::conditioning::{Action, Settings, stated};
use crate::robot::Robot;
use crate::study::Role;

/// The recordings of an experiment file at `path`, each read and conditioned.
pub(super) fn read(
    path: &Path,
    entry: &RecordingsEntry,
    settings: &Settings,
    robot: &Robot,
) -> Result<Vec<MeasuredRecording>, Meaning> {
    if entry.hold_rows < 1000 {
        let found = entry.hold_rows;
        return Err(words(format!("recordings.hold_rows = {found} must be 1000 or more")));
    }
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    let mut reading = Reading::new(robot.clone(), entry.drive_unit);
    for (key, column) in &entry.columns {
        reading.columns.put(key, column.clone().into())?;
    }
    (reading.hold_rows, reading.conditioning) = (entry.hold_rows, *settings);
    let of = |role: Role, files: &[String]| -> Vec<(Role, Unread)> {
        let one = |file: &String| (role, Unread::file(reading.clone(), &folder.join(file)));
        files.iter().map(one).collect()
    };
    let all = [of(Role::Train, &entry.train), of(Role::Validation, &entry.validation)].concat();
    let measured = read_together(&all)?;
    let train = || measured.iter().filter(|m| m.role == Role::Train).map(|m| &m.recording);
    if super::quality::without_input(train()) {
        return Err(words(format!(
            "recordings.train: M1 and M2 are zero throughout ({}); without an input the parameters \
             have no scale, so record the torques, or name their columns",
            entry.train.join(", ")
        )));
    }
    if let Some(none) = NoMotion::of(train()) {
        let files = entry.train.join(", ");
        return Err(words(format!("recordings.train: {none} ({files}){}", corrected(&measured))));
    }
    Ok(measured)
}

/// What was corrected in the training recordings, of which a refusal prints nothing else.
fn corrected(measured: &[MeasuredRecording]) -> String {
    let train = measured.iter().filter(|m| m.role == Role::Train);
    let signals = train.flat_map(|m| {
        let found = stated(&m.conditioning).into_iter();
        let corrected = found.filter(|s| matches!(s.action, Action::Corrected(_)));
        corrected.map(|s| format!(". {}: {s}", m.recording.name()))
    });
    signals.collect()
}
