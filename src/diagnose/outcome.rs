//! What the search found: candidates in their order, and the model after every step.

use super::candidate::Candidate;
use super::refit::Refit;
use super::scan::Score;
use crate::identify::kalman::Maximum;
use crate::model::Model;

/// A candidate of one step.
#[derive(Clone)]
pub struct Ranked {
    /// The candidate at its best shape.
    pub candidate: Candidate,
    /// Scan.
    pub score: Score,
    /// Refit, for the best of the scan.
    pub refit: Option<Refit>,
}

impl Ranked {
    /// What candidates are ranked by: evidence of the refit and gain on recordings left out.
    #[must_use]
    pub fn rank(&self) -> f64 {
        match &self.refit {
            Some(r) if r.in_range => r.evidence + r.cross_gain.min(r.gain.max(0.0)),
            Some(_) => f64::NEG_INFINITY,
            None => self.score.evidence.min(0.0),
        }
    }

    /// Log-evidence, of the refit where there is one.
    #[must_use]
    pub fn evidence(&self) -> f64 {
        match &self.refit {
            Some(r) if r.in_range => r.evidence,
            Some(_) => f64::NEG_INFINITY,
            None => self.score.evidence,
        }
    }
}

/// Everything the forward search found.
#[derive(Clone)]
pub struct Diagnosis {
    /// The model as given, fitted.
    pub base: (Model, Maximum),
    /// Candidates of the first step, best first.
    pub ranking: Vec<Ranked>,
    /// The fitted model after each accepted effect, in order.
    pub steps: Vec<(String, Model, Maximum)>,
    /// Effects that the last step cannot tell from the one it added, per step.
    pub equals: Vec<Vec<String>>,
}

impl Diagnosis {
    /// The last model and its maximum.
    #[must_use]
    pub fn last(&self) -> (&Model, &Maximum) {
        match self.steps.last() {
            Some((_, model, maximum)) => (model, maximum),
            None => (&self.base.0, &self.base.1),
        }
    }

    /// Ids of the effects found, first found first.
    #[must_use]
    pub fn found(&self) -> Vec<String> {
        let present = self.last().0.effect_ids();
        self.steps.iter().map(|s| s.0.clone()).filter(|id| present.contains(id)).collect()
    }
}
