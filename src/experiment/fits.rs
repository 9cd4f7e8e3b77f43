//! The methods of a plan, fitted to its training recordings.

use std::time::Instant;

use super::long::counted;
use super::plan::{MethodPlan, Plan};
use super::stages::Stages;
use crate::identify::{Fit, IdentifyError, Note, Task};
use crate::recording::{LongRecording, Recording};
use crate::study::Role;

/// Result of a method on the training recordings.
#[derive(Clone)]
pub struct MethodFit {
    /// The fit, or the reason of the failure.
    pub fit: Result<Fit, IdentifyError>,
    /// Wall time \[s\].
    pub seconds: f64,
}

/// Fits every method of a plan to its training recordings; one entry per method, in order.
#[must_use]
pub fn fits(plan: &Plan) -> Vec<MethodFit> {
    fits_in_stages(plan, &Stages::hidden())
}

/// The same, with progress shown for every method.
pub(super) fn fits_in_stages(plan: &Plan, stages: &Stages) -> Vec<MethodFit> {
    let (train, count) = (plan.of(Role::Train), plan.methods.len());
    let fitted = |(n, method): (usize, &MethodPlan)| {
        stages.enter(&format!("fitting {} (method {} of {count})", method.name, n + 1));
        let long = counted(&plan.long(), &stages.counting("rows"));
        fit(plan, method, &train, &long)
    };
    plan.methods.iter().enumerate().map(fitted).collect()
}

fn fit(
    plan: &Plan,
    method: &MethodPlan,
    train: &[Recording],
    long: &[Option<LongRecording>],
) -> MethodFit {
    let task = Task { model: &plan.model, train, hold: plan.hold, seed: plan.seed };
    let long: Vec<Option<&LongRecording>> = long.iter().map(Option::as_ref).collect();
    let start = Instant::now();
    let fit = super::long::identify(&*method.method, &task, &long);
    let mut fit = fit.map(|fit| fit.between_rows(train, plan.hold).driving_frictions(task.model));
    if let (Ok(fit), Some(t)) = (&mut fit, plan.late()) {
        fit.notes.push(Note::Late(t.dead_time_s, t.std_error_s));
    }
    MethodFit { fit, seconds: start.elapsed().as_secs_f64() }
}
