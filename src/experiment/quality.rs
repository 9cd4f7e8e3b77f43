//! Findings of the quality check as sentences.

use crate::recording::Recording;
use crate::robot::Robot;

/// What the quality check says of a recording, worst first.
pub(super) fn findings(recording: &Recording, robot: &Robot) -> Vec<String> {
    let _ = (recording, robot);
    vec![]
}
