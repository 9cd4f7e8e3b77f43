//! One case through the whole diagnosis.

use amigo_ident::compare::noise_floor;
use amigo_ident::diagnose::{Conclusion, Judge, Settings, conclude, diagnose};
use amigo_ident::identify::kalman::{Likelihood, prepare};
use amigo_ident::identify::{Task, start};
use amigo_ident::model::Model;
use amigo_ident::robot::Robot;
use amigo_ident::simulate::{Hold, PhysicalDynamics};

use super::cases::{Case, same};
use super::made::recordings;

/// What the diagnosis said of a case.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    /// Effects named, in the order in which they were found.
    pub(crate) found: Vec<String>,
    /// The first candidates of the first step.
    pub(crate) ranking: Vec<String>,
    /// Those that the first step could not tell from its best.
    pub(crate) equals: Vec<String>,
    /// The verdict.
    pub(crate) conclusion: Conclusion,
    /// Share of the explainable error of the held-out recording that is left.
    pub(crate) unexplained: f64,
    /// Window error above the floor without the effects, as a ratio of variances.
    pub(crate) excess: f64,
    /// Wall time [s].
    pub(crate) seconds: f64,
}

/// Runs the diagnosis of the base model on the recordings of `case`.
pub(crate) fn judge(case: &Case) -> Outcome {
    let (train, held_out) = recordings(case);
    let model = Model::base(Robot::amigobot());
    let begin = std::time::Instant::now();
    let task = Task { model: &model, train: &train, hold: Hold::Linear, seed: 0 };
    let first = start::start(&task, "benchmark").expect("moving recordings");
    let likelihood = Likelihood {
        prepared: train.iter().map(prepare).collect(),
        hold: Hold::Linear,
        slow_moment: true,
        timing: false,
    };
    let diagnosis =
        diagnose(&model, &first, &likelihood, &Settings::default()).expect("the base model fits");
    let (last, maximum) = diagnosis.last();
    let dynamics = PhysicalDynamics { model: last.clone(), p: maximum.p.clone() };
    let motion = held_out.local_motion();
    let floor = noise_floor(&dynamics, &held_out, &motion, Hold::Linear, 0).expect("it moves");
    let judge = Judge::new(vec![held_out], Hold::Linear);
    let errors = judge.errors(&diagnosis, floor.window_rms).expect("it moves");
    let left = judge.structure_left(&diagnosis, &likelihood).expect("the filter runs");
    let found = diagnosis.found();
    Outcome {
        conclusion: conclude(found.len(), &errors, left.is_some()),
        ranking: diagnosis.ranking.iter().take(3).map(|r| r.candidate.id.clone()).collect(),
        equals: diagnosis.equals.first().cloned().unwrap_or_default(),
        unexplained: errors.unexplained(),
        excess: errors.before / errors.floor - 1.0,
        seconds: begin.elapsed().as_secs_f64(),
        found,
    }
}

impl Outcome {
    /// Whether the first effect named is one that was hidden, or its twin.
    pub(crate) fn first(&self, case: &Case) -> bool {
        let first = self.found.first();
        first.is_some_and(|f| case.hidden.iter().any(|h| same(f, h)))
    }

    /// Whether it is, or is reported as "this data cannot tell".
    pub(crate) fn class(&self, case: &Case) -> bool {
        let said = self.equals.iter().any(|e| case.hidden.iter().any(|h| same(e, h)));
        self.first(case) || !self.found.is_empty() && said
    }

    /// Whether a hidden effect is among the first three of the ranking.
    pub(crate) fn top3(&self, case: &Case) -> bool {
        self.ranking.iter().any(|r| case.hidden.iter().any(|h| same(r, h)))
    }

    /// Whether what was hidden was named, and nothing else.
    pub(crate) fn exact(&self, case: &Case) -> bool {
        self.found.len() == case.hidden.len()
            && case.hidden.iter().all(|h| self.found.iter().any(|f| same(f, h)))
    }
}
