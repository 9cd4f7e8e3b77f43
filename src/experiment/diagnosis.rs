//! The diagnosis of an experiment: run it, judge it on recordings it was not fitted to, say it.

use super::error::RunError;
use super::plan::{DiagnosisPlan, Plan};
use crate::compare::{Dependence, missing_moment};
use crate::diagnose::{
    Conclusion, Diagnosis, Errors, Judge, Judgement, Limits, Proposal, Ranked, Rivals, conclude,
    diagnose, next_run, probabilities,
};
use crate::identify::kalman::{Likelihood, prepare};
use crate::identify::start::covariance_of_free;
use crate::identify::{Estimate, IdentifyError, Task, start};
use crate::recording::Recording;
use crate::simulate::SimulateError;
use crate::study::{Candidate, DiagnosisStudy, Role, Step, Study, Verdict};

/// Floor that a proposed manoeuvre keeps to, a square of this side [m].
const FLOOR: f64 = 2.0;
/// Its length [s].
const DURATION: f64 = 20.0;
/// Candidates whose error on the judged recordings is simulated.
const JUDGED: usize = 8;

/// Runs the diagnosis of a plan and puts it into words. `study` holds the comparison already.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub(super) fn run_diagnosis(
    plan: &Plan,
    asked: &DiagnosisPlan,
    study: &Study,
) -> Result<DiagnosisStudy, RunError> {
    let train = plan.of(Role::Train);
    let task = Task { model: &plan.model, train: &train, hold: plan.hold, seed: plan.seed };
    let first = start::start(&task, "diagnosis").map_err(failed)?;
    let likelihood = Likelihood {
        prepared: train.iter().map(prepare).collect(),
        hold: plan.hold,
        slow_moment: asked.slow_moment,
        timing: false,
    };
    let diagnosis = diagnose(&plan.model, &first, &likelihood, &asked.settings).map_err(failed)?;
    let judge = Judge::new(plan.judged(), plan.hold);
    let floor = study.judged_floor();
    let before = judge.judge(&plan.model, &diagnosis.base.1.p)?;
    let errors = judge.errors(&diagnosis, floor)?;
    let left = judge.structure_left(&diagnosis, &likelihood)?;
    let proposal = propose(&diagnosis, &likelihood, plan.seed);
    let found = diagnosis.found();
    let conclusion = conclude(found.len(), &errors, left.is_some());
    Ok(DiagnosisStudy {
        verdict: match conclusion {
            Conclusion::Sufficient => Verdict::ModelSufficient,
            Conclusion::Missing => Verdict::EffectsMissing,
            Conclusion::Unknown => Verdict::UnknownEffect,
        },
        sentence: sentence(
            conclusion,
            &diagnosis,
            &errors,
            left.as_ref(),
            asked.settings.false_alarm,
        ),
        found,
        ranking: ranking(&diagnosis, &judge, before, floor)?,
        staircase: staircase(&diagnosis, &judge, before)?,
        unexplained_fraction: errors.unexplained(),
        next_run: advice(&diagnosis, proposal.as_ref()),
        proposal,
        false_alarm: asked.settings.false_alarm,
        missing_moment: Some(missing_moment(
            &plan.model,
            &diagnosis.base.1.p,
            &diagnosis.base.1.noise,
            &likelihood,
        )?),
    })
}

fn failed(e: IdentifyError) -> RunError {
    RunError::NoFit { reasons: e.to_string() }
}

fn staircase(
    diagnosis: &Diagnosis,
    judge: &Judge,
    before: Judgement,
) -> Result<Vec<Step>, SimulateError> {
    let step = |added: Option<String>, j: Judgement| Step {
        added,
        ise_validation: j.ise,
        window_rms_validation: j.window_rms,
    };
    let mut out = vec![step(None, before)];
    for (id, model, maximum) in &diagnosis.steps {
        out.push(step(Some(id.clone()), judge.judge(model, &maximum.p)?));
    }
    Ok(out)
}

fn ranking(
    diagnosis: &Diagnosis,
    judge: &Judge,
    before: Judgement,
    floor: f64,
) -> Result<Vec<Candidate>, SimulateError> {
    let probabilities = probabilities(&diagnosis.ranking);
    let best = diagnosis.ranking.first().map_or(0.0, Ranked::rank);
    diagnosis
        .ranking
        .iter()
        .zip(probabilities)
        .enumerate()
        .map(|(place, (ranked, probability))| {
            let after = match &ranked.refit {
                Some(r) if place < JUDGED => Some(judge.judge(&r.model, &r.maximum.p)?),
                _ => None,
            };
            let equals = if place == 0 {
                diagnosis.equals.first().cloned().unwrap_or_default()
            } else if ranked.refit.is_some() && ranked.rank() > best - 3.0 && best > 6.0 {
                vec![diagnosis.ranking[0].candidate.id.clone()]
            } else {
                ranked.candidate.effect.description().equivalent
            };
            Ok(candidate(ranked, probability, equals, before, after, floor, judge))
        })
        .collect()
}

fn candidate(
    ranked: &Ranked,
    probability: f64,
    indistinguishable: Vec<String>,
    before: Judgement,
    after: Option<Judgement>,
    floor: f64,
    judge: &Judge,
) -> Candidate {
    let score = &ranked.score;
    let torque_rms =
        score.estimate.iter().zip(&score.size).map(|(e, s)| (e * s).powi(2)).sum::<f64>().sqrt();
    let samples: f64 = judge.recordings.iter().map(|r| r.len() as f64).sum();
    let delta_bic = ranked
        .refit
        .as_ref()
        .map_or(f64::NAN, |r| 2.0 * r.gain - ranked.candidate.p.len() as f64 * samples.ln());
    Candidate {
        effect: ranked.candidate.id.clone(),
        probability,
        indistinguishable,
        p_value: (-score.log_significance).exp(),
        log_significance: score.log_significance,
        evidence: ranked.evidence(),
        delta_bic,
        ise_validation_before: before.ise,
        ise_validation_after: after.map_or(f64::NAN, |j| j.ise),
        window_before: before.window_rms,
        window_after: after.map_or(f64::NAN, |j| j.window_rms),
        parameters: parameters(ranked, judge),
        torque_rms,
        words: words(ranked, before, after, floor),
    }
}

/// The candidate's own parameters in its refit.
fn parameters(ranked: &Ranked, judge: &Judge) -> Vec<Estimate> {
    let Some(refit) = &ranked.refit else { return vec![] };
    let covariance = covariance_of_free(&refit.model, &refit.maximum.information);
    let unit = judge.recordings[0].drive_unit();
    refit
        .model
        .parameters()
        .iter()
        .enumerate()
        .filter(|(_, parameter)| parameter.effect == ranked.candidate.id)
        .map(|(j, parameter)| {
            let fixed = parameter.fixed.is_some();
            let std_error = if fixed { 0.0 } else { covariance[(j, j)].sqrt() };
            let value = refit.maximum.p[j];
            let unit = unit.of(&parameter.spec.unit);
            Estimate { fixed, ..Estimate::new(&parameter.spec.symbol, unit, value, std_error) }
        })
        .collect()
}

/// Evidence in words.
fn words(ranked: &Ranked, before: Judgement, after: Option<Judgement>, floor: f64) -> String {
    let sigma = (2.0 * ranked.score.log_significance).sqrt();
    let Some(after) = after else {
        return format!("not needed: {sigma:.1} sigma in the score test");
    };
    let explainable = before.window_rms.powi(2) - floor * floor;
    let gained = before.window_rms.powi(2) - after.window_rms.powi(2);
    let share = if explainable > 0.02 * floor * floor {
        format!(
            "explains {:.0} % of what the model leaves above noise, ",
            100.0 * (gained / explainable).clamp(0.0, 1.0)
        )
    } else {
        String::new()
    };
    format!(
        "{sigma:.1} sigma in the score test, {share}the window error {} from {:.4} to {:.4} \
         rad/s (noise floor {floor:.4})",
        if after.window_rms < before.window_rms { "falls" } else { "rises" },
        before.window_rms,
        after.window_rms
    )
}

fn sentence(
    conclusion: Conclusion,
    diagnosis: &Diagnosis,
    errors: &Errors,
    left: Option<&Dependence>,
    false_alarm: f64,
) -> String {
    let percent = 100.0 * errors.unexplained();
    let rest = left.map_or("shows against none of the variables".to_string(), |d| {
        format!("depends on the {}", d.variable.words())
    });
    let ratio = (errors.after / errors.floor).sqrt();
    match conclusion {
        Conclusion::Sufficient => {
            let still = if ratio > 1.5 {
                format!(
                    " The error is {ratio:.1} times the noise floor, so the model is not exact."
                )
            } else {
                String::new()
            };
            format!(
                "Nothing is missing: no effect of the catalogue is needed at a false-alarm rate \
                 of {:.0} %.{still}",
                100.0 * false_alarm
            )
        }
        Conclusion::Missing => {
            let names: Vec<String> = diagnosis
                .found()
                .iter()
                .enumerate()
                .map(|(step, id)| match diagnosis.equals.get(step) {
                    Some(equals) if !equals.is_empty() => {
                        format!("{id} (or {}: this data cannot tell)", equals.join(" or "))
                    }
                    _ => id.clone(),
                })
                .collect();
            // at the floor, what is left of next to nothing says nothing
            let explained = if ratio < 1.1 {
                "With it the error is at the noise floor.".to_string()
            } else {
                format!(
                    "With it the model explains all but {percent:.1} % of what can be explained."
                )
            };
            format!("Missing: {}. {explained}", names.join(", then "))
        }
        Conclusion::Unknown if diagnosis.found().is_empty() => format!(
            "Something is missing that no effect of the catalogue explains; it {rest}. The error \
             is {ratio:.1} times the noise floor."
        ),
        Conclusion::Unknown if percent > 99.0 => format!(
            "Something is missing that the catalogue does not explain: {} would be added by the \
             evidence, and the error on recordings that were not fitted does not fall; what is \
             missing {rest}.",
            diagnosis.found().join(", ")
        ),
        Conclusion::Unknown => format!(
            "Something is missing that the catalogue does not explain: with {} {percent:.0} % of \
             what can be explained is left; the rest {rest}.",
            diagnosis.found().join(", ")
        ),
    }
}

/// The manoeuvre that would tell the best candidate from the nearest one that this data cannot
/// tell from it.
fn propose(diagnosis: &Diagnosis, likelihood: &Likelihood, seed: u64) -> Option<Proposal> {
    let best = diagnosis.ranking.first()?;
    let same = best.candidate.effect.description().equivalent;
    let rival = diagnosis.equals.first()?.iter().find(|e| !same.contains(e))?;
    let rival = diagnosis.ranking.iter().find(|r| r.candidate.id == *rival)?;
    let recordings = || likelihood.prepared.iter().map(|p| p.recording);
    let largest = |value: &dyn Fn(&Recording) -> f64| recordings().map(value).fold(0.0, f64::max);
    let peak = |rows: &[[f64; 2]]| rows.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    let limits = Limits {
        speed: largest(&|r| peak(r.omega())),
        moment: 1.2 * largest(&|r| peak(r.moment())),
        floor: FLOOR,
        duration: DURATION,
    };
    let rivals = Rivals {
        effects: [&best.candidate, &rival.candidate],
        sizes: [&best.score.estimate, &rival.score.estimate],
    };
    let (model, maximum) = &diagnosis.base;
    next_run(model, &maximum.p, &maximum.noise, likelihood, &rivals, &limits, seed)
}

/// What to drive next, in words, where two effects cannot be told apart.
fn advice(diagnosis: &Diagnosis, proposal: Option<&Proposal>) -> Option<String> {
    let best = diagnosis.ranking.first()?;
    let equals = diagnosis.equals.first()?;
    let same = best.candidate.effect.description();
    let mut out = Vec::new();
    if !same.equivalent.is_empty() {
        out.push(format!(
            "No recording of wheel speeds and drives can tell {} from {}: they are the same in \
             the equations. A measurement of another kind is needed.",
            same.id,
            same.equivalent.join(" or ")
        ));
    }
    for other in equals.iter().filter(|e| !same.equivalent.contains(e)) {
        let Some(rival) = diagnosis.ranking.iter().find(|r| r.candidate.id == *other) else {
            continue;
        };
        let description = rival.candidate.effect.description();
        out.push(format!(
            "To tell {} from {other}, record: {}; and: {}.",
            same.id, same.excitation, description.excitation
        ));
    }
    if let Some(proposal) = proposal {
        out.push(format!(
            "A manoeuvre of {:.0} s that does it is written to next_run.csv (set-points) and \
             next_run.toml (segments); driven once, it names the right one with a probability of \
             {:.1} %.",
            proposal.movement.duration(),
            100.0 * proposal.probability
        ));
    }
    (!out.is_empty()).then(|| out.join(" "))
}
