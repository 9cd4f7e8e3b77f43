//! How large the columns of a candidate are on recorded motions.

use super::{Candidate, still_instant};
use crate::model::Model;
use crate::recording::Recording;

/// What the two wheels have in common of each column of a candidate: largest value [N m per unit].
pub(super) fn common_size(candidate: &Candidate, model: &Model, recording: &Recording) -> Vec<f64> {
    let mut largest = vec![0.0_f64; candidate.columns()];
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (k, m) in recording.local_motion().iter().enumerate().step_by(7) {
        candidate.torque(0, &still_instant(model, recording, k, m), &mut row);
        for (size, torque) in largest.iter_mut().zip(&row) {
            *size = size.max((torque[0] + torque[1]).abs());
        }
    }
    largest
}

/// The effect of a candidate seen on the local motion of the recordings, for its size: root
/// mean square of each column over them [N m per unit].
#[must_use]
pub(in crate::diagnose) fn column_size(
    candidate: &Candidate,
    model: &Model,
    recordings: &[&Recording],
) -> Vec<f64> {
    let mut sums = vec![0.0; candidate.columns()];
    let mut count = 0.0;
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (r, recording) in recordings.iter().enumerate() {
        for (k, m) in recording.local_motion().iter().enumerate().step_by(7) {
            let at = still_instant(model, recording, k, m);
            candidate.torque(r, &at, &mut row);
            for (sum, torque) in sums.iter_mut().zip(&row) {
                *sum += torque[0] * torque[0] + torque[1] * torque[1];
            }
            count += 2.0;
        }
    }
    sums.iter().map(|s| (s / f64::max(count, 1.0)).sqrt().max(1e-12)).collect()
}
