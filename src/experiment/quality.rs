//! Findings of the quality check as sentences.

use crate::recording::Recording;
use crate::robot::Robot;

/// What the quality check says of a recording, worst first.
pub(super) fn findings(recording: &Recording, _robot: &Robot) -> Vec<String> {
    let wheels = [(0, "1 (right)"), (1, "2 (left)")];
    let still = wheels.iter().filter(|(i, _)| recording.omega().iter().all(|w| w[*i] == 0.0)).map(
        |(_, wheel)| format!("wheel {wheel} never moves: its friction and inertia cannot be seen"),
    );
    let idle = wheels.iter().filter(|(i, _)| is_zero(recording, *i)).map(|(i, wheel)| {
        format!(
            "M{} is zero throughout: wheel {wheel} coasts, or its drive was not recorded",
            i + 1
        )
    });
    still.chain(idle).collect()
}

fn is_zero(recording: &Recording, wheel: usize) -> bool {
    recording.moment().iter().all(|m| m[wheel] == 0.0)
}

/// Whether no recording has any drive: then all parameters are only known up to a common factor.
pub(super) fn without_drive<'a>(mut recordings: impl Iterator<Item = &'a Recording>) -> bool {
    recordings.all(|r| is_zero(r, 0) && is_zero(r, 1))
}
