//! Candidates and steps of a diagnosis with their errors on the judged recordings.

use crate::diagnose::{Diagnosis, Judge, Judgement, Ranked, THRESHOLDS, is_refuted, probabilities};
use crate::identify::Estimate;
use crate::simulate::SimulateError;
use crate::study::{CandidateStudy, StepStudy, parameters_of};

pub(super) fn staircase(
    diagnosis: &Diagnosis,
    judge: &Judge,
    before: Judgement,
) -> Result<Vec<StepStudy>, SimulateError> {
    let step = |added: Option<String>, j: Judgement| StepStudy {
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

pub(super) fn ranking(
    diagnosis: &Diagnosis,
    judge: &Judge,
    before: Judgement,
) -> Result<Vec<CandidateStudy>, SimulateError> {
    let judged = |(place, ranked): (usize, &Ranked)| match &ranked.refit {
        Some(fit) if place < THRESHOLDS.judged => judge.judge(&fit.model, &fit.p).map(Some),
        _ => Ok(None),
    };
    let after: Vec<Option<Judgement>> =
        diagnosis.ranking.iter().enumerate().map(judged).collect::<Result<_, _>>()?;
    let most = before.window_rms * (1.0 + THRESHOLDS.least_fall);
    let raises = |after: &Option<Judgement>| after.as_ref().is_some_and(|j| j.window_rms > most);
    let pairs = diagnosis.ranking.iter().zip(&after);
    let refuted: Vec<bool> =
        pairs.map(|(ranked, after)| is_refuted(ranked, raises(after))).collect();
    let probabilities = probabilities(&diagnosis.ranking, &refuted);
    let leading = diagnosis.leading();
    let ranking = diagnosis.ranking.iter().zip(probabilities).zip(after.into_iter().zip(refuted));
    Ok(ranking
        .map(|((ranked, probability), (after, no_better))| {
            // effects that do nothing are all alike
            let is_alike = |best: &&Ranked| {
                ranked.refit.is_some()
                    && !no_better
                    && (ranked.bic - best.bic).abs() < THRESHOLDS.alike
            };
            let id = &ranked.candidate.id;
            let first = diagnosis.steps.first().filter(|step| step.id == *id);
            let other = leading.filter(|best| best.candidate.id != *id).filter(is_alike);
            let equals = match (first, other) {
                (Some(step), _) => step.equals.clone(),
                (None, Some(best)) => vec![best.candidate.id.clone()],
                (None, None) => ranked.candidate.effect.description().equivalent,
            };
            let study = candidate(ranked, before, after, judge);
            CandidateStudy { probability, no_better, indistinguishable: equals, ..study }
        })
        .collect())
}

/// A candidate with its errors, not yet compared with others.
fn candidate(
    ranked: &Ranked,
    before: Judgement,
    after: Option<Judgement>,
    judge: &Judge,
) -> CandidateStudy {
    // an effect on the input is ranked by its distance from the best one by the windows, which may be far below zero
    // though its own windows prefer it
    let of_input = ranked.candidate.is_of_input();
    let own = 2.0 * ranked.bic_windows;
    let bic =
        if of_input && ranked.bic.is_finite() { ranked.bic.min(own.max(0.0)) } else { ranked.bic };
    CandidateStudy {
        effect: ranked.candidate.id.clone(),
        probability: f64::NAN,
        no_better: false,
        indistinguishable: vec![],
        p_value: ranked.fall.map_or(1.0, |fall| fall.p_value),
        log_significance: ranked.fall.map_or(0.0, |fall| -fall.p_value.ln()),
        evidence: -0.5 * bic,
        delta_bic: -bic,
        before,
        after,
        by_regression: ranked.by_regression,
        by_windows: ranked.by_windows,
        parameters: parameters(ranked, judge),
        torque_rms: ranked.torque_rms,
    }
}

/// The candidate's own parameters in its refit.
fn parameters(ranked: &Ranked, judge: &Judge) -> Vec<Estimate> {
    let Some(refit) = &ranked.refit else { return vec![] };
    let all = parameters_of(refit, judge.recordings[0].drive_unit());
    all.into_iter().filter(|p| p.effect == ranked.candidate.id).map(|p| p.estimate).collect()
}
