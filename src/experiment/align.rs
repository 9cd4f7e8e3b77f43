//! What is settled from the training recordings before any method sees them: where shapes start, and when the
//! recorded input acts.

use super::plan::{Measured, Plan};
use crate::diagnose::{shapes_placed, timing, with_later_input};
use crate::effects::Change;
use crate::filter::noise_of_jumps;
use crate::identify::{Task, start};
use crate::recording::Recording;
use crate::study::Role;

/// Sets where fits of the model's shapes start; recordings that are read block by block leave them at their
/// typical values.
pub(super) fn place(plan: &mut Plan) {
    if plan.recordings.iter().all(|m| m.long.is_none()) {
        plan.model = shapes_placed(&plan.model, &plan.of(Role::Train), plan.hold);
    }
}

/// Estimates when the recorded input acts and moves it where logging explains the shift, and how much of its jumps from
/// row to row is noise; every stage sees recordings that agree. A model that has a time shift of its own is left alone.
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
    let share = noise_of_jumps(&plan.model, &start, &recordings, plan.hold);
    plan.recordings.iter_mut().for_each(|m| m.recording.set_noise_of_jumps(share));
    let Some(timing) = plan.timing.filter(|t| t.correction_s != 0.0) else { return };
    for Measured { recording, .. } in &mut plan.recordings {
        *recording = with_later_input(recording, timing.correction_s);
    }
}
