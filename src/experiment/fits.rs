//! The methods of a plan, fitted to its training recordings.

use std::time::Instant;

use super::plan::{MethodPlan, Plan};
use crate::identify::{Fit, Task};
use crate::recording::Recording;
use crate::study::Role;

/// What a method made of the training recordings.
#[derive(Clone)]
pub struct MethodFit {
    /// The fit, or in words why there is none.
    pub fit: Result<Fit, String>,
    /// Wall time \[s\].
    pub seconds: f64,
}

/// Fits every method of a plan to its training recordings; one entry a method, in their order.
#[must_use]
pub fn fits(plan: &Plan) -> Vec<MethodFit> {
    fits_in_stages(plan, &|_| ())
}

/// The same; `enter` is called with every method that begins.
pub(super) fn fits_in_stages(plan: &Plan, enter: &dyn Fn(&str)) -> Vec<MethodFit> {
    let (train, count) = (plan.of(Role::Train), plan.methods.len());
    let fitted = |(n, method): (usize, &MethodPlan)| {
        enter(&format!("fitting {} (method {} of {count})", method.name, n + 1));
        fit(plan, method, &train)
    };
    plan.methods.iter().enumerate().map(fitted).collect()
}

fn fit(plan: &Plan, method: &MethodPlan, train: &[Recording]) -> MethodFit {
    let task = Task { model: &plan.model, train, hold: plan.hold, seed: plan.seed };
    let start = Instant::now();
    let fit =
        super::long::identify(&*method.method, &task, &plan.long()).map_err(|e| e.to_string());
    MethodFit { fit, seconds: start.elapsed().as_secs_f64() }
}
