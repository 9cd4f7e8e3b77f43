//! Result of the search: the ranked candidates, and the model after every step.

use super::acceptance::Fall;
use super::candidate::Candidate;
use super::fit::WindowFit;

/// A candidate of one step.
#[derive(Clone)]
pub struct Ranked {
    /// The candidate at its best shape.
    pub candidate: Candidate,
    /// The effect at every shape that was tried.
    pub shapes: Vec<Candidate>,
    /// Twice the log-likelihood ratio by the low-passed regression.
    pub by_regression: f64,
    /// Twice the log-likelihood ratio by the windows, to first order.
    pub by_windows: f64,
    /// Estimates of the columns' coefficients.
    pub estimate: Vec<f64>,
    /// Root mean square torque of the effect, for those that were refitted [N m].
    pub torque_rms: f64,
    /// Bayesian information criterion of both, over the model without the effect (negative: it is better
    /// with it).
    pub screened: f64,
    /// Fit of the model with the effect, for the first candidates of the screening; `None` without a valid
    /// fit.
    pub refit: Option<WindowFit>,
    /// Bayesian information criterion of the refit by the windows alone.
    pub bic_windows: f64,
    /// What candidates are ranked by: criterion of regression and windows together.
    pub bic: f64,
    /// Fall of the held-out error, for refitted candidates.
    pub fall: Option<Fall>,
}

/// A model with one more effect.
#[derive(Clone)]
pub struct Step {
    /// The effect.
    pub id: String,
    /// The model with it.
    pub fit: WindowFit,
    /// Fall of the held-out error by this step.
    pub last: Fall,
    /// Fall of the held-out error since the model as given.
    pub total: Fall,
    /// Effects that these data do not distinguish from it.
    pub equals: Vec<String>,
}

/// Result of the forward search.
#[derive(Clone)]
pub struct Diagnosis {
    /// The model as given, fitted.
    pub base: WindowFit,
    /// Candidates of the first step, best first.
    pub ranking: Vec<Ranked>,
    /// The accepted effects, in order.
    pub steps: Vec<Step>,
    /// Candidates after the last accepted step, best first.
    pub rest: Vec<Ranked>,
    /// Whether the held-out windows are those of validation recordings (else cross-validation on the training
    /// recordings).
    pub validated: bool,
    /// Windows of the validation recordings, or of the training recordings without them.
    pub tested: usize,
}

impl Diagnosis {
    /// The model with all effects found.
    #[must_use]
    pub fn last(&self) -> &WindowFit {
        self.steps.last().map_or(&self.base, |step| &step.fit)
    }

    /// The candidate of the first step that was found first, which another may precede in the ranking; the best
    /// if none was found.
    #[must_use]
    pub fn leading(&self) -> Option<&Ranked> {
        match self.steps.first() {
            Some(step) => self.ranking.iter().find(|r| r.candidate.id == step.id),
            None => self.ranking.first(),
        }
    }

    /// Ids of the effects found, in the order in which they were found.
    #[must_use]
    pub fn found(&self) -> Vec<String> {
        self.steps.iter().map(|step| step.id.clone()).collect()
    }
}
