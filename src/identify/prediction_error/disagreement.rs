//! Errors of an estimate that the scatter of its scores does not contain, from another method's estimate.

use crate::identify::{Estimate, Fit, Note};

/// A fit of a model with an error above noise, with intervals that include its disagreement with `other`, a fit of
/// the same model. The filter attributes autocorrelated noise of the input to the inertias, which are then too large
/// by far more than their standard errors. In the regression of torques that noise is in the dependent variable and
/// causes no bias.
///
/// ```text
/// E (θ - θ')² = b² + s² + s'²,   s² → s² + max(0, (θ - θ')² - s² - s'²)
/// ```
/// b: bias of θ, if θ' is unbiased with independent errors. A bias common to both methods is not
/// detected.
pub(super) fn with_disagreement(mut fit: Fit, other: &Fit) -> Fit {
    let mut moved = Vec::new();
    for j in 0..fit.estimates.len() {
        let estimate = &fit.estimates[j];
        let Some(second) = other.estimate(&estimate.symbol) else { continue };
        let known =
            |e: &Estimate| !e.fixed && e.identifiable && e.std_error > 0.0 && e.value.is_finite();
        if !known(estimate) || !known(second) {
            continue;
        }
        let apart = (estimate.value - second.value).powi(2);
        let bias = apart - estimate.std_error.powi(2) - second.std_error.powi(2);
        if bias <= 0.0 {
            continue;
        }
        moved.push((estimate.symbol.clone(), second.value));
        let variance = estimate.std_error.powi(2) + bias;
        let degrees = estimate.degrees;
        let wider = Estimate { std_error: variance.sqrt(), ..estimate.clone() };
        fit.estimates[j] = wider.with_degrees(degrees);
        if let Some(covariance) = &mut fit.covariance {
            covariance[(j, j)] += bias;
        }
    }
    if !moved.is_empty() {
        fit.notes.push(Note::Disagreement(moved));
    }
    fit
}
