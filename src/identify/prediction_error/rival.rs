//! Fallback: if a regression of torques simulates held-out pieces better, its values are used.

use super::choice::Candidate;
use super::disagreement::with_disagreement;
use super::held_shapes::{shaped, with_shapes_of};
use crate::identify::inverse_dynamics::Regression;
use crate::identify::open_loop::{OpenLoop, clearly_smaller, mean};
use crate::identify::torque_regression::TorqueRegression;
use crate::identify::{Fit, Note, Task};

/// Relative reduction of the error for which another method is used: that required of an effect.
const MATTERS: f64 = 0.01;

/// Ratio of the errors above which a few pieces are sufficient for the decision: errors of two valid fits
/// differ by a few percent, so that an error larger by one half means that a fit fails on a kind of motion.
const FAILS: f64 = 1.5;

/// The fit, or that of the regression of torques (of `rows` where the model has no shapes) if its 2 s simulation
/// error on held-out pieces is smaller by one percent, and its logarithm by more than a paired standard error: it
/// must be better on most pieces, not only on the few with the largest errors, unless the fit fails on those. A fit
/// whose error on its own training pieces is larger by one half (both have the same number of parameters) is replaced
/// whatever the held-out errors. A kind of motion that was driven once cannot be predicted from the others: if the
/// error of the regression is larger by one half on held-out pieces than with all pieces, only the errors with all
/// pieces are compared. Where the model `errs` by more than noise, the intervals of a fit that is kept include the
/// disagreement of the two.
pub(super) fn better(
    (task, rows): (&Task, Option<Regression>),
    open: &OpenLoop,
    chosen: &Candidate,
    fit: Fit,
    errs: bool,
) -> Fit {
    let shaped = shaped(task.model, &fit);
    let regressed = Task { model: shaped.as_ref().unwrap_or(task.model), ..*task };
    let method = TorqueRegression::default();
    let rows = if shaped.is_some() { method.rows(&regressed).ok() } else { rows };
    let left_out = rows.and_then(|rows| method.left_out(&rows, &open.pieces).ok());
    let Some((mut rival, left_out)) = left_out else { return fit };
    let errors = open.errors(task.model, &left_out);
    let [own, other] = [&fit, &rival].map(|fit| open.mean(task.model, &parameters(fit)).sqrt());
    let fails_in_sample = !(own <= FAILS * other);
    let matters = mean(&errors).sqrt() < (1.0 - MATTERS) * mean(&chosen.held_out).sqrt();
    let logs = |errors: &[f64]| errors.iter().map(|e| e.ln()).collect::<Vec<f64>>();
    let fails = mean(&chosen.held_out).sqrt() > FAILS * mean(&errors).sqrt();
    let clear = fails || clearly_smaller(&logs(&errors), &logs(&chosen.held_out));
    let is_predictable = mean(&errors).sqrt() <= FAILS * other;
    if !other.is_finite() || !(fails_in_sample || (matters && clear && is_predictable)) {
        return if errs { with_disagreement(fit, &rival) } else { fit };
    }
    with_shapes_of(&fit, &mut rival, &regressed);
    let held_out = !fails_in_sample;
    let [regression, filter] = match held_out {
        true => [mean(&errors).sqrt(), mean(&chosen.held_out).sqrt()],
        false => [other, own],
    };
    rival.notes.insert(0, Note::BetterRegression { held_out, regression, filter });
    rival.method = fit.method;
    rival.work.evaluations += fit.work.evaluations;
    rival
}

fn parameters(fit: &Fit) -> Vec<f64> {
    fit.estimates.iter().map(|e| e.value).collect()
}
