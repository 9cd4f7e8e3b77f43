//! Candidates and steps of a diagnosis with their errors on the judged recordings.

use crate::diagnose::{Diagnosis, Judge, Judgement, Ranked, THRESHOLDS, probabilities};
use crate::identify::Estimate;
use crate::simulate::SimulateError;
use crate::study::{Candidate, Step, parameters_of};

/// Candidates whose error on the judged recordings is simulated.
const JUDGED: usize = 8;

pub(super) fn staircase(
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

pub(super) fn ranking(
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
    let all = parameters_of(refit, judge.recordings[0].drive_unit());
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
