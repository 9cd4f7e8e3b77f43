//! Findings of the quality check, by severity.

use super::source::MeasuredRecording;
use crate::conditioning::{self, Channel, Kind};
use crate::recording::{Finding, Issue, Recording, Severity, lacking, quality};
use crate::robot::Robot;
use crate::study::Role;

/// The warnings and problems of a recording, the most severe first, without what its conditioning states.
pub(super) fn findings(
    recording: &Recording,
    robot: &Robot,
    conditioning: &[conditioning::Finding],
) -> Vec<Finding> {
    let found = quality(recording, robot).at_least(Severity::Warning).copied().collect();
    without_stated(found, conditioning)
}

/// The notes on a recording; the gaps between the windows of a long one are none.
pub(super) fn notes(measured: &MeasuredRecording, robot: &Robot) -> Vec<Finding> {
    let between = |f: &Finding| measured.long.is_some() && matches!(f.issue, Issue::Gaps(..));
    let notes = quality(&measured.recording, robot).findings.into_iter();
    notes.filter(|f| f.severity == Severity::Note && !between(f)).collect()
}

/// Recordings whose findings are those of the set: that one contains straights or turns alone is none if the training
/// recordings together contain both.
pub(super) fn of_the_set(mut recordings: Vec<MeasuredRecording>) -> Vec<MeasuredRecording> {
    let train: Vec<Recording> =
        recordings.iter().filter(|m| m.role == Role::Train).map(|m| m.recording.clone()).collect();
    if lacking(&train).is_none() {
        let is_kind = |f: &Finding| matches!(f.issue, Issue::StraightOnly | Issue::SpotOnly);
        recordings.iter_mut().for_each(|m| m.findings.retain(|f| !is_kind(f)));
    }
    recordings
}

/// Leaves out the ratio of a speed to the slope of its angle where conditioning states it: that is the more accurate
/// estimate, with a standard error.
fn without_stated(found: Vec<Finding>, conditioning: &[conditioning::Finding]) -> Vec<Finding> {
    let is_stated = |issue: &Issue| {
        conditioning.iter().any(|f| match (f.channel, f.kind, issue) {
            (
                Channel::Speed(i),
                Kind::Gain { .. } | Kind::Gear { .. },
                Issue::Ratio { wheel, .. },
            ) => i == *wheel,
            _ => false,
        })
    };
    found.into_iter().filter(|f| !is_stated(&f.issue)).collect()
}

/// Whether no recording has any input, so that the parameters are identifiable only up to a common factor.
pub(super) fn without_input<'a>(mut recordings: impl Iterator<Item = &'a Recording>) -> bool {
    recordings.all(|r| r.torque().iter().all(|m| *m == [0.0; 2]))
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use super::*;
    use crate::io::{ColumnMap, read_recording};
    use crate::recording::DriveUnit;

    /// Measured recordings that are not part of the repository; `None` if they are absent.
    fn recordings(folder: &str) -> Option<Vec<PathBuf>> {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings").join(folder);
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(folder).ok()?.map(|e| e.unwrap().path()).collect();
        // the second day of FRC 7028 has other column names
        let second_day = |f: &PathBuf| {
            f.file_name().is_some_and(|name| name.to_string_lossy().starts_with("0317"))
        };
        files.retain(|f| f.extension().is_some_and(|e| e == "csv") && !second_day(f));
        files.sort();
        Some(files)
    }

    fn said(folder: &str, columns: &[(&str, &str)], unit: DriveUnit) -> Option<Vec<String>> {
        let mut map = ColumnMap::new(unit, None);
        for (key, name) in columns {
            map.set(key, name, None, 1.0).unwrap();
        }
        let files = recordings(folder)?;
        let read = |f: &PathBuf| read_recording(f, &map, unit).unwrap().0;
        let said = |r: Recording| {
            let found = findings(&r, &Robot::amigobot(), &[]);
            found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
        };
        Some(files.iter().map(read).map(said).collect())
    }

    #[test]
    fn recordings_of_the_physics_engine_raise_no_warning() {
        for case in ["nothing", "viscous_friction", "turning_scrub", "slope", "actuator_lag"] {
            let Some(said) = said(&format!("simulated_3d/{case}"), &[], DriveUnit::NewtonMetre)
            else {
                return; // not present here
            };
            assert_eq!(said, ["", "", ""], "{case}");
        }
    }

    #[test]
    fn real_robots_raise_no_false_alarm() {
        let voltage = [("M1", "V1"), ("M2", "V2")];
        let Some(tank) = said("frc7028_2022", &voltage, DriveUnit::Volt) else {
            return; // not present here
        };
        // four straight runs, four on the spot, two of these shorter than 4 s
        let kinds = ["straight only"; 4].into_iter().chain(["on the spot"; 4]);
        for (text, kind) in tank.iter().zip(kinds) {
            let lines = 1 + usize::from(text.contains("lasts"));
            assert!(text.contains(kind) && text.lines().count() == lines, "{text}");
        }
        let bot = said("regbot_2016", &[], DriveUnit::NewtonMetre).unwrap();
        // a true one: 38.2, 33.5, 38.2 rad/s within three milliseconds
        assert!(bot[0].contains("dalpha1 has 1 spike (first at t = 0.319 s: 33.4700"), "{bot:?}");
        assert_eq!(bot[2..], ["", "", ""]);
        let axis = [
            ("alpha1", "q"),
            ("alpha2", "q"),
            ("dalpha1", "dq"),
            ("dalpha2", "dq"),
            ("M1", "tau"),
            ("M2", "tau"),
        ];
        assert_eq!(said("emps", &axis, DriveUnit::NewtonMetre).unwrap(), ["", ""]);
    }

    #[test]
    fn straights_and_turns_of_a_set_are_not_asked_for_again() {
        use crate::experiment::Reading;
        let reading = Reading::new(Robot::amigobot(), DriveUnit::NewtonMetre);
        let run = |name: &str, turns: f64| {
            let column = |name: &str, f: &dyn Fn(f64) -> f64| {
                (name.to_owned(), (0..1000).map(|k| f(0.01 * f64::from(k))).collect::<Vec<_>>())
            };
            let columns = [
                column("t", &|t| t),
                column("dalpha1", &|t| 5.0 * t.sin()),
                // two wheels, not one axis
                column("dalpha2", &|t| turns * 5.0 * t.sin() + 0.01 * (7.0 * t).sin()),
                column("M1", &|t| 0.1 * t.sin() + 0.15 * t.cos()),
                column("M2", &|t| turns * (0.1 * t.sin() + 0.15 * t.cos())),
            ];
            reading.table(Role::Train, name, &columns).unwrap()
        };
        let kinds = |recordings| -> Vec<usize> {
            let is_kind = |f: &&Finding| matches!(f.issue, Issue::StraightOnly | Issue::SpotOnly);
            let count = |m: MeasuredRecording| m.findings.iter().filter(is_kind).count();
            of_the_set(recordings).into_iter().map(count).collect()
        };
        let (straight, spot) = (|| run("straight", 1.0), || run("spot", -1.0));
        assert_eq!(kinds(vec![straight(), spot()]), [0, 0]);
        assert_eq!(kinds(vec![straight(), straight()]), [1, 1]);
        assert_eq!(kinds(vec![spot()]), [1]);
    }

    #[test]
    fn a_ratio_is_stated_once() {
        use crate::conditioning::{Action, Finding as Corrected};
        let ratio = |wheel| Finding {
            severity: Severity::Warning,
            issue: Issue::Ratio { wheel, ratio: 1.22, radius: 0.1 },
        };
        let kind = Kind::Gain { ratio: 1.21, std_error: 0.01 };
        let gain = Corrected { channel: Channel::Speed(1), kind, action: Action::Noted };
        assert_eq!(without_stated(vec![ratio(0), ratio(1)], &[gain]), [ratio(0)]);
        assert_eq!(without_stated(vec![ratio(1)], &[]), [ratio(1)]);
    }
}
