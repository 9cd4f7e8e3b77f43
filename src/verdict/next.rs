//! Recommended recordings if two effects are not distinguishable.

use crate::diagnose::{Diagnosis, Limits, Proposal, Ranked, Rivals, next_run};
use crate::effects::Description;
use crate::filter::Likelihood;
use crate::recording::Recording;
use crate::study::Advice;

/// Side of the square floor area for a proposed manoeuvre \[m\].
const FLOOR: f64 = 2.0;
/// Its length \[s\].
const DURATION: f64 = 20.0;

/// The manoeuvre that distinguishes the best candidate from the nearest one that is not distinguishable from
/// it by these data.
pub(super) fn propose(
    diagnosis: &Diagnosis,
    likelihood: &Likelihood,
    seed: u64,
) -> Option<Proposal> {
    let (best, rival) = competing(diagnosis)?;
    let recordings = || likelihood.prepared.iter().map(|p| p.recording);
    let largest = |value: &dyn Fn(&Recording) -> f64| recordings().map(value).fold(0.0, f64::max);
    let peak = |rows: &[[f64; 2]]| rows.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    let limits = Limits {
        speed: largest(&|r| peak(r.omega())),
        // the drive has reached it; whether it can do more is not recorded
        torque: largest(&|r| peak(r.torque())),
        floor: FLOOR,
        duration: DURATION,
    };
    let rivals = Rivals {
        effects: [&best.candidate, &rival.candidate],
        sizes: [&best.estimate, &rival.estimate],
    };
    let base = &diagnosis.base;
    let (noise, _) = likelihood.noise(&base.model, &base.p, &likelihood.initial_noise());
    next_run(&base.model, &base.p, &noise, likelihood, &rivals, &limits, seed)
}

/// The two effects that a further recording should distinguish: the first that was found and one that is not
/// distinguishable from it; if none was found, the first two that would lower the criterion.
fn competing(diagnosis: &Diagnosis) -> Option<(&Ranked, &Ranked)> {
    let best = diagnosis.leading()?;
    let same = best.candidate.effect.description().equivalent;
    let rival = match diagnosis.steps.first() {
        Some(step) => {
            let other = step.equals.iter().find(|e| !same.contains(e))?;
            diagnosis.ranking.iter().find(|r| r.candidate.id == *other)?
        }
        None => diagnosis.ranking.get(1)?,
    };
    let good = |r: &Ranked| r.refit.is_some() && r.bic < 0.0;
    (good(best) && good(rival)).then_some((best, rival))
}

/// Recording that can prove an effect; at a higher rate if the unknown input `between_rows` may be the cause.
pub(super) fn to_prove(ranked: &Ranked, between_rows: bool) -> Advice {
    let effect = &ranked.candidate.effect;
    let Description { id, excitation, .. } = effect.description();
    Advice::Prove {
        effect: id,
        excitation,
        faster: between_rows || effect.change().acts_between_rows(),
    }
}

/// Recommended recording if two effects are not distinguishable.
pub(super) fn advice(diagnosis: &Diagnosis, likely: Option<&Ranked>) -> Vec<Advice> {
    let Some(best) = diagnosis.leading() else { return vec![] };
    let same = best.candidate.effect.description();
    let mut out: Vec<Advice> = likely.iter().map(|likely| to_prove(likely, false)).collect();
    let found = diagnosis.steps.first();
    if !same.equivalent.is_empty() && found.is_some() {
        out.push(Advice::Equivalent { effect: same.id.clone(), others: same.equivalent.clone() });
    }
    let rivals: Vec<String> = match found {
        Some(step) => step.equals.clone(),
        None => competing(diagnosis).map(|(_, r)| r.candidate.id.clone()).into_iter().collect(),
    };
    for other in rivals.into_iter().filter(|e| !same.equivalent.contains(e)) {
        let Some(rival) = diagnosis.ranking.iter().find(|r| r.candidate.id == other) else {
            continue;
        };
        let effects = [same.id.clone(), other];
        if found.is_none() {
            out.push(Advice::Closest(effects.clone()));
        }
        let excitation = rival.candidate.effect.description().excitation;
        out.push(Advice::Distinguish {
            effects,
            excitations: [same.excitation.clone(), excitation],
        });
    }
    out
}
