//! Forward steps with re-ranking and backward pruning: how many effects are missing.

use std::sync::Arc;

use rayon::prelude::*;

use super::candidate::candidates;
use super::drive_noise::compare_fairly;
use super::judge::Judge;
use super::outcome::{Diagnosis, Ranked};
use super::refit::{Refit, refit};
use super::scan::scan;
use crate::effects::Effect;
use crate::identify::kalman::{Likelihood, Maximum};
use crate::identify::{IdentifyError, Task, start};
use crate::model::Model;
use crate::recording::Recording;

/// What the diagnosis is asked.
#[derive(Clone)]
pub struct Settings {
    /// Ids of the candidates; empty: all.
    pub candidates: Vec<String>,
    /// Candidates beside the catalogue: formulas of the user.
    pub own: Vec<Arc<dyn Effect>>,
    /// Stated false-alarm rate over the whole catalogue.
    pub false_alarm: f64,
    /// Most effects that are added.
    pub max_effects: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { candidates: vec![], own: vec![], false_alarm: 0.05, max_effects: 4 }
    }
}

impl Settings {
    /// Least -ln p of a score for the stated false-alarm rate: the rate is shared by some 500
    /// looks (columns, shapes, and the part of them that is not independent).
    #[must_use]
    pub fn threshold(&self) -> f64 {
        500.0_f64.ln() - self.false_alarm.ln()
    }
}

/// Least log-evidence of a refitted effect.
const EVIDENCE: f64 = 8.0;
/// Least size of an effect that is worth a place in the model, as a share of the rms drive: with
/// little noise far smaller ones are significant, and no model is exact.
const PRACTICAL: f64 = 0.0025;
/// Share of its threshold that a score must reach where the evidence of the refit is strong.
const NEARLY: f64 = 0.8;
/// Evidence, in thresholds, that needs no score.
const DECISIVE: f64 = 10.0;
/// Least share of the squared window error that a spring behind the wheels must take away.
const SPRING: f64 = 0.06;
/// Effects whose Wald statistic falls below this, once others are in, are dropped again.
const KEEP: f64 = 14.0;
/// Candidates that are refitted in full.
const REFITTED: usize = 7;
/// Evidence of the scan's best beyond which those near it are refitted before the others.
const CLEAR_LEAD: f64 = 50.0;
/// Share of it that is near: of the effects that won after all, none had less than half.
const NEAR: f64 = 0.25;
/// Share of the evidence of the best valid refit below which a scan leaves no hope.
const FAR_BEHIND: f64 = 0.1;

/// Rounds of noise and parameters after an effect was accepted, at most.
const ROUNDS: usize = 8;
/// Gain of an effect beyond which all is fitted afresh [nats].
const GROSS: f64 = 200.0;
/// Gain of a round below which the rounds end [nats].
const SETTLED: f64 = 1.0;

/// Searches the effects that are missing from `model`: scan, refit, accept, prune, again.
///
/// # Errors
/// If the model as given cannot be fitted.
pub fn diagnose(
    model: &Model,
    start: &[f64],
    likelihood: &Likelihood,
    settings: &Settings,
) -> Result<Diagnosis, IdentifyError> {
    let base = likelihood.maximise(model, start, None, "diagnosis")?;
    let mut out = Diagnosis {
        base: (model.clone(), base.clone()),
        ranking: vec![],
        steps: vec![],
        equals: vec![],
    };
    let (mut model, mut maximum) = (model.clone(), base);
    for step in 0..settings.max_effects.max(1) {
        let mut ranking = rank(&model, &maximum, likelihood, settings)?;
        let best = ranking.first().filter(|best| accepted(best, likelihood, settings)).cloned();
        let equals = equals(&ranking);
        if step == 0 {
            out.ranking = std::mem::take(&mut ranking);
        }
        let Some(best) = best else { break };
        if settings.max_effects == 0 {
            break;
        }
        let Some(refit) = best.refit else { break };
        let given = out.base.0.effects().len();
        let older = given..model.effects().len();
        let refitted = settle(&refit.model, refit.maximum, refit.gain, likelihood)?;
        (model, maximum) = prune(refit.model, refitted, older, likelihood)?;
        out.steps.push((best.candidate.id.clone(), model.clone(), maximum.clone()));
        out.equals.push(equals);
    }
    Ok(out)
}

/// Noise and parameters in turn until neither gains: a gross effect leaves its refit on the ridge
/// between its parameters and the slow moment that stood in for it, or behind it, so that all is
/// fitted afresh, too (not with a body behind the wheels, whose start would be worse than the scan's).
fn settle(
    model: &Model,
    mut maximum: Maximum,
    gain: f64,
    likelihood: &Likelihood,
) -> Result<Maximum, IdentifyError> {
    if gain > GROSS && !model.is_coupled() {
        let train: Vec<Recording> =
            likelihood.prepared.iter().map(|p| p.recording.clone()).collect();
        let task = Task { model, train: &train, hold: likelihood.hold, seed: 0 };
        let first = start::start(&task, "diagnosis")?;
        let fresh = likelihood.maximise(model, &first, None, "diagnosis")?;
        if fresh.log_likelihood > maximum.log_likelihood {
            maximum = fresh;
        }
    }
    for _ in 0..ROUNDS {
        let (noise, _) = likelihood.noise(model, &maximum.p, &maximum.noise);
        let next = likelihood.maximise(model, &maximum.p, Some(noise), "diagnosis")?;
        let gain = next.log_likelihood - maximum.log_likelihood;
        if gain > 0.0 {
            maximum = next;
        }
        if gain < SETTLED {
            break;
        }
    }
    Ok(maximum)
}

/// Scan of all candidates, refit of the best, ranked.
fn rank(
    model: &Model,
    maximum: &Maximum,
    likelihood: &Likelihood,
    settings: &Settings,
) -> Result<Vec<Ranked>, IdentifyError> {
    let recordings: Vec<&Recording> = likelihood.prepared.iter().map(|p| p.recording).collect();
    let all = candidates(model, &maximum.p, &settings.candidates, &settings.own, &recordings);
    let scores = scan(model, &maximum.p, &maximum.noise, likelihood, &all)?;
    let mut ranked: Vec<Ranked> = Vec::new();
    for (candidate, score) in all.into_iter().zip(scores) {
        match ranked.iter_mut().find(|r| r.candidate.id == candidate.id) {
            Some(present) if present.score.evidence >= score.evidence => {}
            Some(present) => *present = Ranked { candidate, score, refit: None },
            None => ranked.push(Ranked { candidate, score, refit: None }),
        }
    }
    ranked.sort_by(|a, b| b.score.evidence.total_cmp(&a.score.evidence));
    // a scan that shows nothing near the threshold needs no refits
    let worth = |r: &Ranked| r.score.log_significance > 0.5 * settings.threshold();
    let count = ranked.iter().take(REFITTED).take_while(|r| worth(r)).count();
    let first = &mut ranked[..count];
    // a body behind the wheels costs ten others and can bend to much: it must lead the scan, where its
    // column is nearly exact
    let lead = first.first().map_or(0.0, |r| r.score.evidence);
    let dear = |r: &Ranked| r.candidate.is_joint() && r.score.evidence < lead;
    let near = |r: &Ranked| lead <= CLEAR_LEAD || r.score.evidence > NEAR * lead;
    refit_those(first, |r| near(r) && !dear(r), (model, maximum), likelihood);
    // what leads the scan may be out of its range: only a valid refit leaves others behind
    let best = first.iter().filter(|r| r.refit.is_some()).map(Ranked::evidence);
    let best = best.fold(f64::NEG_INFINITY, f64::max);
    let behind = |r: &Ranked| r.score.evidence < FAR_BEHIND * best;
    let rest = |r: &Ranked| !near(r) && !behind(r) && !dear(r);
    refit_those(first, rest, (model, maximum), likelihood);
    compare_fairly(&mut ranked, likelihood);
    ranked.sort_by(|a, b| b.rank().total_cmp(&a.rank()));
    Ok(ranked)
}

/// Refits the candidates that are `wanted`, in parallel.
fn refit_those(
    ranked: &mut [Ranked],
    wanted: impl Fn(&Ranked) -> bool + Sync,
    base: (&Model, &Maximum),
    likelihood: &Likelihood,
) {
    ranked.par_iter_mut().filter(|r| wanted(r)).for_each(|r| {
        r.refit = refit(base.0, base.1, &r.candidate, &r.score, likelihood).ok();
        if let Some(refit) = r.refit.as_mut().filter(|_| r.candidate.is_spring()) {
            refit.in_range = refit.in_range && shows(refit, base, likelihood);
        }
    });
}

/// Whether the best candidate is needed at the stated false-alarm rate.
fn accepted(best: &Ranked, likelihood: &Likelihood, settings: &Settings) -> bool {
    let crossed =
        likelihood.prepared.len() < 2 || best.refit.as_ref().is_some_and(|r| r.cross_gain > 0.0);
    let size: f64 =
        best.score.estimate.iter().zip(&best.score.size).map(|(e, s)| (e * s).powi(2)).sum();
    let worth = size.sqrt() > PRACTICAL * likelihood.moment_rms();
    // the score is taken at the noise of the model without the effect, which that effect makes too
    // large; where it nearly reaches its threshold, evidence twice as strong stands in for the rest, and
    // evidence ten times as strong for all of it (two effects can hide each other from their scores)
    let significance = best.score.log_significance;
    let significant = significance > settings.threshold()
        || (significance > NEARLY * settings.threshold()
            && best.evidence() > 2.0 * settings.threshold())
        || best.evidence() > DECISIVE * settings.threshold();
    worth
        && best.refit.as_ref().is_some_and(|r| r.in_range)
        && best.evidence() > EVIDENCE
        && significant
        && crossed
}

/// Whether a spring behind the wheels lowers the error of open-loop windows. Noise of the recorded drive
/// makes a stiff one likely: it reaches the twist as well as what the twist is held against.
fn shows(refit: &Refit, base: (&Model, &Maximum), likelihood: &Likelihood) -> bool {
    let recordings = likelihood.prepared.iter().map(|p| p.recording.clone()).collect();
    let judge = Judge::new(recordings, likelihood.hold);
    let error = |model, p| judge.judge(model, p).map_or(f64::NAN, |j| j.window_rms.powi(2));
    let (before, after) = (error(base.0, &base.1.p), error(&refit.model, &refit.maximum.p));
    after < (1.0 - SPRING) * before
}

/// Effects within three nats of the best, and those that are the same by their equations.
fn equals(ranking: &[Ranked]) -> Vec<String> {
    let Some(best) = ranking.first() else { return vec![] };
    let mut out = best.candidate.effect.description().equivalent;
    for other in &ranking[1..] {
        let near = other.refit.is_some() && other.rank() > best.rank() - 3.0;
        if near && !out.contains(&other.candidate.id) {
            out.push(other.candidate.id.clone());
        }
    }
    out
}

/// Drops effects that an earlier step added (`older`) and the last one made needless: Wald statistic
/// below 14 or a parameter out of its range.
fn prune(
    model: Model,
    maximum: Maximum,
    older: std::ops::Range<usize>,
    likelihood: &Likelihood,
) -> Result<(Model, Maximum), IdentifyError> {
    for e in older.clone() {
        let own: Vec<usize> = model
            .slots(e)
            .filter(|&j| model.parameters()[j].spec.kind == crate::effects::ParameterKind::Linear)
            .collect();
        if own.is_empty() {
            continue;
        }
        let base: Vec<usize> = model.free().into_iter().filter(|j| !own.contains(j)).collect();
        let zero = nalgebra::DVector::zeros(maximum.information.nrows());
        let (information, _) = crate::compare::project(&maximum.information, &zero, &base, &own);
        let theta = nalgebra::DVector::from_fn(own.len(), |j, _| maximum.p[own[j]]);
        let wald = theta.dot(&(information * &theta));
        let outside = own.iter().any(|&j| {
            let range = model.parameters()[j].spec.range;
            maximum.p[j] < range.0 || maximum.p[j] > range.1
        });
        if wald < KEEP || outside {
            let slots = model.slots(e);
            let smaller = model.without(e);
            let p: Vec<f64> =
                (0..maximum.p.len()).filter(|j| !slots.contains(j)).map(|j| maximum.p[j]).collect();
            let again = likelihood.maximise(&smaller, &p, Some(maximum.noise), "diagnosis")?;
            return prune(smaller, again, older.start..older.end - 1, likelihood);
        }
    }
    Ok((model, maximum))
}
