//! The methods of a plan, fitted to its training recordings.

use std::time::Instant;

use super::long::counted;
use super::plan::{MethodPlan, Plan};
use super::stages::Stages;
use crate::diagnose::Timing;
use crate::identify::{Estimate, Excited, Fit, IdentifyError, Note, Task};
use crate::recording::LongRecording;
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
    fits_with(plan, plan.late(), stages)
}

/// The same with a delay of the input only for a dead time that is too `late` for logging.
pub(super) fn fits_with(plan: &Plan, late: Option<Timing>, stages: &Stages) -> Vec<MethodFit> {
    let (train, count) = (plan.of(Role::Train), plan.methods.len());
    let model = plan.model_with(late);
    let task = Task { model: &model, train: &train, hold: plan.hold, seed: plan.seed };
    let excited = Excited::new(task);
    let fitted = |(n, method): (usize, &MethodPlan)| {
        stages.enter(&format!("fitting {} (method {} of {count})", method.name, n + 1));
        let long = counted(&plan.long(), &stages.counting("rows"));
        fit(method, &excited, late, &long)
    };
    plan.methods.iter().enumerate().map(fitted).collect()
}

fn fit(
    method: &MethodPlan,
    excited: &Excited,
    late: Option<Timing>,
    long: &[Option<LongRecording>],
) -> MethodFit {
    let long: Vec<Option<&LongRecording>> = long.iter().map(Option::as_ref).collect();
    let start = Instant::now();
    let identify = |excited: &Excited| {
        super::long::identify(&*method.method, excited, &long).map(|fit| excited.qualified(fit))
    };
    let fit = match late {
        Some(timing) => with_dead_time(excited, timing, identify),
        None => identify(excited),
    };
    MethodFit { fit, seconds: start.elapsed().as_secs_f64() }
}

/// Fits a model whose last parameter is a delay that stands for the measured dead time. A fit whose delay
/// contradicts the measurement ended in another minimum, of which simulations of whole recordings have several: it
/// is repeated with the delay as measured. The intervals of a method that holds the delay contain the error of the
/// measurement.
fn with_dead_time(
    excited: &Excited,
    timing: Timing,
    identify: impl Fn(&Excited) -> Result<Fit, IdentifyError>,
) -> Result<Fit, IdentifyError> {
    let model = excited.task().model;
    let (time, error) = (timing.dead_time_s, timing.std_error_s);
    let delay = model.parameters().len() - 1;
    let mut fit = identify(excited)?;
    let contradicts = |e: &Estimate| !e.fixed && !timing.agrees_with(e.value, e.std_error);
    if let Some(estimate) = fit.estimates.get(delay).filter(|e| contradicts(e))
        && let Ok(held) = model.fix(&estimate.symbol, time)
    {
        fit = identify(&Excited::new(Task { model: &held, ..*excited.task() }))?;
    }
    if fit.holds(delay) {
        let at_error = |model| identify(&Excited::new(Task { model: &model, ..*excited.task() }));
        let later = model.fix(&fit.estimates[delay].symbol, time + error).ok().map(at_error);
        if let Some(Ok(later)) = later {
            fit.set_measured(delay, error, &later);
        }
    }
    let fitted = fit.dynamics.physical().is_some();
    fit.notes.push(Note::Late { time, error, fitted });
    Ok(fit)
}
