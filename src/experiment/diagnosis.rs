//! The diagnosis of an experiment: run it, judge it on recordings it was not fitted to, say it.

use super::error::RunError;
use super::models;
use super::plan::{DiagnosisPlan, Plan};
use super::sentence::{Finding, residual_torque, title};
use crate::compare::Variable;
use crate::diagnose::{
    Conclusion, Data, Diagnosis, Judge, Judgement, Limits, Proposal, Ranked, Rivals, THRESHOLDS,
    conclude, diagnose, likely, next_run, probabilities, shifted,
};
use crate::filter::{Likelihood, prepare};
use crate::identify::{Estimate, IdentifyError, Task, start};
use crate::model::Model;
use crate::recording::Recording;
use crate::report::format;
use crate::simulate::SimulateError;
use crate::study::{Candidate, DiagnosisStudy, FoundEffect, Role, Step, Study, Verdict};

/// Floor that a proposed manoeuvre keeps to, a square of this side [m].
const FLOOR: f64 = 2.0;
/// Its length [s].
const DURATION: f64 = 20.0;
/// Candidates whose error on the judged recordings is simulated.
const JUDGED: usize = 8;

/// Adds the diagnosis of a plan, in words, and its models to a study that holds the comparison already.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub(super) fn run_diagnosis(
    plan: &Plan,
    asked: &DiagnosisPlan,
    mut study: Study,
) -> Result<Study, RunError> {
    let Said { mut words, depends_on, diagnosis } = say(plan, asked, &mut study)?;
    let study = models::with_diagnosis(plan, study, &diagnosis)?;
    if words.verdict == Verdict::UnknownEffect {
        words.sentence += &format!(" {}", residual_torque(&study.curves, depends_on));
    }
    Ok(Study { diagnosis: Some(words), ..study })
}

/// A diagnosis and its words.
pub(super) struct Said {
    pub(super) words: DiagnosisStudy,
    /// The variable on which the residual torque of the last model depends significantly.
    depends_on: Option<Variable>,
    diagnosis: Diagnosis,
}

/// Runs the diagnosis of a plan and puts it into words. The noise floor of `study` becomes that of the model with
/// what was found.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub(super) fn say(plan: &Plan, asked: &DiagnosisPlan, study: &mut Study) -> Result<Said, RunError> {
    let diagnosis = search(plan, asked, study)?;
    if !diagnosis.steps.is_empty() {
        models::floor_under(plan, study, diagnosis.last())?;
    }
    let (words, depends_on) = in_words(plan, asked, study, &diagnosis)?;
    Ok(Said { words, depends_on, diagnosis })
}

/// Searches what is missing in the model of a plan.
fn search(plan: &Plan, asked: &DiagnosisPlan, study: &Study) -> Result<Diagnosis, RunError> {
    let train = plan.of(Role::Train);
    let model = with_held(plan, &train, study);
    let task = Task { model: &model, train: &train, hold: plan.hold, seed: plan.seed };
    let starts = starts(plan, &task);
    let validation = plan.of(Role::Validation);
    let corrected_s = plan.timing.map_or(0.0, |t| t.correction_s);
    let data = Data { train: &train, validation: &validation, hold: plan.hold, corrected_s };
    diagnose(&model, &starts, &data, &asked.settings).map_err(failed)
}

/// The model with what the data do not identify held where the preferred fit holds it: a fit that is free to
/// move what no recording shows simulates others worse than the model as it was given. Of a single axis only
/// sums are known, and nothing of one wheel is held.
fn with_held(plan: &Plan, train: &[Recording], study: &Study) -> Model {
    let mut model = plan.model.clone();
    if train.iter().all(Recording::is_single_axis) {
        return model;
    }
    let estimates = study.reference_method().map_or(&[][..], |m| &m.estimates);
    // a fit of which nothing is known holds nothing
    let some = estimates.iter().any(|e| e.identifiable);
    for e in estimates.iter().filter(|e| some && !e.identifiable) {
        model = model.fix(&e.symbol, e.value).unwrap_or(model);
    }
    model
}

/// A diagnosis in words, and the variable on which the residual torque of its last model depends significantly.
fn in_words(
    plan: &Plan,
    asked: &DiagnosisPlan,
    study: &Study,
    diagnosis: &Diagnosis,
) -> Result<(DiagnosisStudy, Option<Variable>), RunError> {
    let train = plan.of(Role::Train);
    let likelihood = Likelihood {
        prepared: train.iter().map(prepare).collect(),
        hold: plan.hold,
        slow_moment: asked.slow_moment,
        timing: false,
    };
    let judge = Judge::new(plan.judged(), plan.hold);
    let floor = study.judged_floor();
    let before = judge.judge(&diagnosis.base.model, &diagnosis.base.p)?;
    let errors = judge.errors(diagnosis, floor)?;
    let left = judge.structure_left(diagnosis, &likelihood)?;
    let found = diagnosis.found();
    let probable = likely(diagnosis, &errors);
    let leaves = probable.and_then(|r| r.fall).map(|fall| fall.ratio);
    let conclusion = conclude(found.len(), &errors, leaves, left.is_some());
    // where nothing is missing there is nothing to record
    let open = conclusion != Conclusion::Sufficient;
    let proposal = open.then(|| propose(diagnosis, &likelihood, plan.seed)).flatten();
    let next_run = open.then(|| advice(diagnosis, probable, proposal.as_ref())).flatten();
    let sentence = Finding {
        conclusion,
        diagnosis,
        errors: &errors,
        likely: probable,
        false_alarm: asked.settings.false_alarm,
        unit: study.drive_unit,
    }
    .sentence();
    let said = DiagnosisStudy {
        verdict: match conclusion {
            Conclusion::Sufficient => Verdict::ModelSufficient,
            Conclusion::Missing => Verdict::EffectsMissing,
            Conclusion::Likely => Verdict::EffectLikely,
            Conclusion::Unknown => Verdict::UnknownEffect,
        },
        sentence,
        found,
        likely: probable.map(|r| r.candidate.id.clone()).into_iter().collect(),
        estimates: models::parameters(diagnosis.last(), train[0].drive_unit())
            .into_iter()
            .map(|p| p.estimate)
            .collect(),
        ranking: ranking(diagnosis, &judge, before, floor)?,
        staircase: staircase(diagnosis, &judge, before)?,
        unexplained_fraction: errors.unexplained(),
        next_run,
        proposal,
        false_alarm: asked.settings.false_alarm,
        effects: diagnosis.steps.iter().map(found_effect).collect(),
    };
    Ok((said, left.map(|dependence| dependence.variable)))
}

/// An accepted effect in words.
fn found_effect(step: &crate::diagnose::Step) -> FoundEffect {
    let effects = step.fit.model.effects();
    let description = effects.iter().map(|e| e.description()).find(|d| d.id == step.id);
    let (title, cause) = description.map_or_else(Default::default, |d| (d.title, d.cause));
    FoundEffect { id: step.id.clone(), title, cause, indistinguishable: step.equals.clone() }
}

/// Where the fits start: at the weak form, on recordings without their dead time first where that is longer
/// than logging explains (it turns the inertias of quick steps round), and at the construction data.
fn starts(plan: &Plan, task: &Task) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    let late = plan.timing.map_or(0.0, |t| t.dead_time_s - t.correction_s);
    if late > task.train.iter().map(Recording::step).fold(0.0, f64::max) {
        let moved: Vec<Recording> =
            task.train.iter().map(|r| r.with_moment(shifted(r, r.moment(), late))).collect();
        out.extend(start::start(&Task { train: &moved, ..*task }, "diagnosis").ok());
    }
    out.extend(start::start(task, "diagnosis").ok());
    out.push(task.model.initial());
    out
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
    for s in &diagnosis.steps {
        out.push(step(Some(s.id.clone()), judge.judge(&s.fit.model, &s.fit.p)?));
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
    let best = diagnosis.ranking.first().map_or(0.0, |r| r.bic);
    diagnosis
        .ranking
        .iter()
        .zip(probabilities)
        .enumerate()
        .map(|(place, (ranked, probability))| {
            let after = match &ranked.refit {
                Some(fit) if place < JUDGED => Some(judge.judge(&fit.model, &fit.p)?),
                _ => None,
            };
            let equals = if place == 0 {
                diagnosis.steps.first().map(|s| s.equals.clone()).unwrap_or_default()
            } else if ranked.refit.is_some() && ranked.bic < best + THRESHOLDS.alike {
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
    Candidate {
        effect: ranked.candidate.id.clone(),
        probability,
        indistinguishable,
        p_value: ranked.fall.map_or(1.0, |fall| fall.p_value),
        log_significance: ranked.fall.map_or(0.0, |fall| -fall.p_value.ln()),
        evidence: -0.5 * ranked.bic,
        delta_bic: -ranked.bic,
        ise_validation_before: before.ise,
        ise_validation_after: after.map_or(f64::NAN, |j| j.ise),
        window_before: before.window_rms,
        window_after: after.map_or(f64::NAN, |j| j.window_rms),
        parameters: parameters(ranked, judge),
        torque_rms: ranked.torque_rms,
        words: words(ranked, before, after, floor),
    }
}

/// The candidate's own parameters in its refit.
fn parameters(ranked: &Ranked, judge: &Judge) -> Vec<Estimate> {
    let Some(refit) = &ranked.refit else { return vec![] };
    let all = models::parameters(refit, judge.recordings[0].drive_unit());
    all.into_iter().filter(|p| p.effect == ranked.candidate.id).map(|p| p.estimate).collect()
}

/// Evidence in words.
fn words(ranked: &Ranked, before: Judgement, after: Option<Judgement>, floor: f64) -> String {
    let Some(after) = after else {
        return format!(
            "not refitted (likelihood ratio {:.0} by regression, {:.0} over the windows)",
            ranked.by_regression, ranked.by_windows
        );
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
        "{share}the 2 s simulation error {} from {:.4} to {:.4} rad/s (noise floor {floor:.4})",
        if after.window_rms < before.window_rms { "falls" } else { "rises" },
        before.window_rms,
        after.window_rms
    )
}

/// The manoeuvre that would tell the best candidate from the nearest one that this data cannot
/// tell from it.
fn propose(diagnosis: &Diagnosis, likelihood: &Likelihood, seed: u64) -> Option<Proposal> {
    let (best, rival) = competing(diagnosis)?;
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
        sizes: [&best.estimate, &rival.estimate],
    };
    let base = &diagnosis.base;
    let (noise, _) = likelihood.noise(&base.model, &base.p, &likelihood.initial_noise());
    next_run(&base.model, &base.p, &noise, likelihood, &rivals, &limits, seed)
}

/// The two effects that a further recording should distinguish: the first that was found and one that is not
/// distinguishable from it, or, where none was found, the first two that would lower the criterion.
fn competing(diagnosis: &Diagnosis) -> Option<(&Ranked, &Ranked)> {
    let best = diagnosis.ranking.first()?;
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

/// What to drive next, in words, where two effects cannot be told apart.
fn advice(
    diagnosis: &Diagnosis,
    likely: Option<&Ranked>,
    proposal: Option<&Proposal>,
) -> Option<String> {
    let best = diagnosis.ranking.first()?;
    let same = best.candidate.effect.description();
    let mut out = Vec::new();
    if let Some(likely) = likely {
        let likely = likely.candidate.effect.description();
        out.push(format!("To prove {}, record: {}.", title(&likely.id), likely.excitation));
    }
    let found = diagnosis.steps.first();
    if !same.equivalent.is_empty() && found.is_some() {
        out.push(format!(
            "No recording of wheel speeds and torques distinguishes {} from {}: they are the same in \
             the equations. A measurement of another kind is needed.",
            title(&same.id),
            same.equivalent.iter().map(|id| title(id)).collect::<Vec<_>>().join(" or ")
        ));
    }
    let rivals: Vec<String> = match found {
        Some(step) => step.equals.clone(),
        None => competing(diagnosis).map(|(_, r)| r.candidate.id.clone()).into_iter().collect(),
    };
    for other in rivals.iter().filter(|e| !same.equivalent.contains(e)) {
        let Some(rival) = diagnosis.ranking.iter().find(|r| r.candidate.id == *other) else {
            continue;
        };
        let description = rival.candidate.effect.description();
        if found.is_none() {
            let (first, second) = (title(&same.id), title(other));
            out.push(format!(
                "Of the catalogue, {first} and {second} come closest, neither proven."
            ));
        }
        out.push(format!(
            "To distinguish {} from {}, record: {}; and: {}.",
            title(&same.id),
            title(other),
            same.excitation,
            description.excitation
        ));
    }
    if let Some(proposal) = proposal {
        out.push(format!(
            "A manoeuvre of {:.0} s that does it is written to next_run.csv (set-points) and \
             next_run.toml (segments); driven once, it identifies the right one with a probability of {}.",
            proposal.movement.duration(),
            format::probability(proposal.probability)
        ));
    }
    (!out.is_empty()).then(|| out.join(" "))
}
