//! Findings of the quality check as sentences.

use crate::recording::{Recording, Severity, quality};
use crate::robot::Robot;

/// The warnings and problems of a recording, worst first.
pub(super) fn findings(recording: &Recording, robot: &Robot) -> Vec<String> {
    quality(recording, robot).at_least(Severity::Warning).map(ToString::to_string).collect()
}

/// What else is worth knowing of a recording.
pub(super) fn notes(recording: &Recording, robot: &Robot) -> Vec<String> {
    let notes = quality(recording, robot).findings.into_iter();
    notes.filter(|f| f.severity == Severity::Note).map(|f| f.to_string()).collect()
}

/// Whether no recording has any drive: then all parameters are only known up to a common factor.
pub(super) fn without_drive<'a>(mut recordings: impl Iterator<Item = &'a Recording>) -> bool {
    recordings.all(|r| r.moment().iter().all(|m| *m == [0.0; 2]))
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::*;
    use crate::io::{ColumnMap, read_recording};
    use crate::recording::DriveUnit;

    /// Measured recordings that cannot be part of the project; `None` where they are absent.
    fn recordings(folder: &str) -> Option<Vec<PathBuf>> {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings").join(folder);
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(folder).ok()?.map(|e| e.unwrap().path()).collect();
        files.retain(|f| f.extension().is_some_and(|e| e == "csv"));
        files.sort();
        Some(files)
    }

    fn said(folder: &str, columns: &[(&str, &str)], unit: DriveUnit) -> Option<Vec<String>> {
        let mut map = ColumnMap::default();
        for (key, name) in columns {
            map.set(key, name, None, 1.0).unwrap();
        }
        let files = recordings(folder)?;
        let read = |f: &PathBuf| read_recording(f, &map, unit).unwrap().0;
        let said = |r: Recording| findings(&r, &Robot::amigobot()).join("\n");
        Some(files.iter().map(read).map(said).collect())
    }

    #[test]
    fn recordings_of_the_physics_engine_raise_no_warning_but_for_single_samples_of_the_drive() {
        for case in ["nothing", "viscous_friction", "turning_scrub", "slope", "actuator_lag"] {
            let Some(said) = said(&format!("simulated_3d/{case}"), &[], DriveUnit::NewtonMetre)
            else {
                return; // not present here
            };
            // their drive does drop out for single samples, by a newton metre and more
            let lines = said.iter().flat_map(|s| s.lines());
            let other: Vec<&str> = lines.filter(|l| !l.contains("spike")).collect();
            assert!(other.is_empty(), "{case}: {other:?}");
        }
    }
}
