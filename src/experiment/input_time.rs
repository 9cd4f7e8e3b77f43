//! The time of the input of an experiment, before its models are fitted.

use std::iter;

use super::plan::Plan;
use crate::diagnose::{THRESHOLDS, Timing, Untimed, timing};
use crate::effects;
use crate::identify::{Task, excited_start, frictionless_start};
use crate::recording::{DriveUnit, Recording};
use crate::study::Role;

/// The time of the input by the motion of the training recordings. A model without friction, or one that the motion
/// does not excite, is replaced by one that follows it. If a torque or current leaves an error above the noise floor, and
/// none with the friction that most robots have, the viscous one, the time is that by the latter: without it a motion that slows
/// down early looks like an early input. Beside a voltage it is part of the back-EMF.
pub(super) fn time_of_input(plan: &Plan, start: &[f64]) -> Result<Timing, Untimed> {
    let train = plan.of(Role::Train);
    let recordings: Vec<&Recording> = train.iter().collect();
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    let given = (plan.model.clone(), start.to_vec());
    let (model, p) = frictionless_start(&task, THRESHOLDS.longest_delay_s).unwrap_or(given);
    let excited = excited_start(&Task { model: &model, ..task });
    let (model, p) = excited.unwrap_or((model, p));
    let given = timing(&model, &p, &recordings, plan.hold);
    let is_open = match &given {
        Ok(timing) => timing.above_floor,
        Err(reason) => matches!(reason, Untimed::AboveFloor | Untimed::Later { .. }),
    };
    if !is_open || plan.drive_unit() == DriveUnit::Volt {
        return given;
    }
    let viscous = effects::most_common().and_then(|id| model.add(&id).ok());
    let Some(viscous) = viscous else { return given };
    let start: Vec<f64> =
        p.into_iter().chain(iter::repeat(0.0)).take(viscous.parameters().len()).collect();
    let complete = timing(&viscous, &start, &recordings, plan.hold);
    if complete.is_ok_and(|timing| !timing.above_floor) { complete } else { given }
}
