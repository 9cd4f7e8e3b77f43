//! Takes out of the recordings what logging does to the time of the input.

use super::plan::{Measured, Plan};
use crate::diagnose::{shifted, timing};
use crate::effects::Change;
use crate::identify::{Task, start};
use crate::recording::Recording;
use crate::study::Role;

/// Estimates when the recorded input acts and moves it where logging explains the shift; every stage sees
/// recordings that agree. A model that has a time shift of its own is left alone.
pub(super) fn align(plan: &mut Plan) {
    let shifts = |e: &std::sync::Arc<dyn crate::effects::Effect>| e.change() == Change::TimeShift;
    let long = plan.recordings.iter().any(|m| m.long.is_some());
    if long || plan.model.effects().iter().any(shifts) {
        return;
    }
    let train = plan.of(Role::Train);
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    let Ok(start) = start::start(&task, "timing") else { return };
    let recordings: Vec<&Recording> = train.iter().collect();
    plan.timing = timing(&plan.model, &start, &recordings, plan.hold);
    let Some(timing) = plan.timing.filter(|t| t.correction_s != 0.0) else { return };
    for Measured { recording, .. } in &mut plan.recordings {
        let moved = shifted(recording, recording.moment(), timing.correction_s);
        *recording = recording.with_moment(moved);
    }
}
