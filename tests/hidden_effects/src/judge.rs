//! Runs one case through the whole program: files, conditioning, default estimate, diagnosis.

use std::path::Path;

use amigo_ident::effects::find;
use amigo_ident::experiment::{Plan, load, run};
use amigo_ident::study::Study;
use serde::{Deserialize, Serialize};

use super::case::Case;
use super::scenario::Scenario;

/// Symbols of the base parameters.
pub const BASE: [&str; 5] = ["a1", "a2", "a3", "a4", "a5"];

/// A refitted candidate of the first step.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CandidateTest {
    /// Id of the effect.
    pub effect: String,
    /// Reported p-value of the fall of the held-out error.
    pub p_value: f64,
    /// ΔBIC (positive: better with the effect).
    pub delta_bic: f64,
}

/// An estimated parameter beside its true value.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Covered {
    /// Symbol.
    pub symbol: String,
    /// True value [SI].
    pub truth: f64,
    /// Estimate [SI].
    pub value: f64,
    /// Its standard error [SI].
    pub std_error: f64,
    /// Whether the 95 % interval covers the true value.
    pub covered: bool,
}

/// Result at one false-alarm rate.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Said {
    /// The false-alarm rate.
    pub false_alarm: f64,
    /// Effects named, in the order in which they were found.
    pub found: Vec<String>,
    /// The verdict, as in `results.json`.
    pub verdict: String,
    /// Effects that are likely but not significant.
    pub likely: Vec<String>,
    /// 2 s simulation error on the held-out recording, over the floor, by model version.
    pub versions: Vec<f64>,
}

/// Outcome of a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Id of the case.
    pub case: String,
    /// Hidden effects with their parameters.
    pub hidden: Vec<(String, Vec<(String, f64)>)>,
    /// Results by false-alarm rate; after the first that names nothing, smaller rates are not run.
    pub said: Vec<Said>,
    /// Candidates of the first step, best first.
    pub ranking: Vec<CandidateTest>,
    /// Default estimates of the parameters whose true values are known.
    pub estimates: Vec<Covered>,
    /// Dead time [s], where it can be estimated.
    pub dead_time_s: Option<f64>,
    /// Findings of conditioning, in words.
    pub conditioning: Vec<String>,
    /// The error where there is no result.
    pub failure: Option<String>,
    /// Wall time of the first run [s].
    pub seconds: f64,
}

/// Runs the program on the case: at the largest of `rates` first, at the smaller ones while an effect is named
/// (an effect that is not named at a larger rate is not named at a smaller one).
pub fn judge(case: &Case, rates: &[f64]) -> Outcome {
    or_failure(case, |out| attempt(case, rates, out))
}

/// Estimates the parameters of the case with the hidden effects in the model, without a diagnosis.
pub fn estimate(case: &Case) -> Outcome {
    or_failure(case, |out| given(case, out))
}

fn or_failure(case: &Case, outcome: impl Fn(Outcome) -> Result<Outcome, String>) -> Outcome {
    let empty = Outcome {
        case: case.to_string(),
        hidden: vec![],
        said: vec![],
        ranking: vec![],
        estimates: vec![],
        dead_time_s: None,
        conditioning: vec![],
        failure: None,
        seconds: 0.0,
    };
    outcome(empty.clone()).unwrap_or_else(|reason| Outcome { failure: Some(reason), ..empty })
}

/// The hidden effects of a scenario with their parameters.
fn hidden(scenario: &Scenario) -> Vec<(String, Vec<(String, f64)>)> {
    let named = |(s, v): &(&str, f64)| ((*s).to_string(), *v);
    let effects = scenario.effects.iter();
    effects.map(|(id, own)| (id.clone(), own.iter().map(named).collect())).collect()
}

fn given(case: &Case, mut out: Outcome) -> Result<Outcome, String> {
    let scenario = Scenario::new(case)?;
    out.hidden = hidden(&scenario);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let plan = load(&scenario.write_given(folder.path())?, &[]).map_err(|e| e.to_string())?;
    let begin = std::time::Instant::now();
    let study = run(&plan).map_err(|e| e.to_string())?;
    out.seconds = begin.elapsed().as_secs_f64();
    describe(&mut out, &study, &scenario);
    Ok(out)
}

fn attempt(case: &Case, rates: &[f64], mut out: Outcome) -> Result<Outcome, String> {
    let scenario = Scenario::new(case)?;
    out.hidden = hidden(&scenario);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let file = scenario.write(folder.path(), false)?;
    let mut rates = rates.to_vec();
    rates.sort_by(|a, b| b.total_cmp(a));
    for rate in rates {
        if out.said.last().is_some_and(|said| said.found.is_empty()) {
            let nothing = out.said.last().cloned().expect("just looked at");
            out.said.push(Said { false_alarm: rate, ..nothing });
            continue;
        }
        let begin = std::time::Instant::now();
        let study = asked(&file, rate)?;
        if out.said.is_empty() {
            out.seconds = begin.elapsed().as_secs_f64();
            describe(&mut out, &study, &scenario);
        }
        out.said.push(said(&study, rate)?);
    }
    Ok(out)
}

fn asked(file: &Path, rate: f64) -> Result<Study, String> {
    let mut plan: Plan = load(file, &[]).map_err(|e| e.to_string())?;
    let asked = plan.diagnosis.as_mut().ok_or("the file asks for a diagnosis")?;
    asked.settings.false_alarm = rate;
    run(&plan).map_err(|e| e.to_string())
}

fn said(study: &Study, rate: f64) -> Result<Said, String> {
    let diagnosis = study.diagnosis.as_ref().ok_or("there is no diagnosis")?;
    let floor = study.judged_floor();
    let verdict = serde_json::to_value(diagnosis.verdict).map_err(|e| e.to_string())?;
    Ok(Said {
        false_alarm: rate,
        found: diagnosis.found.clone(),
        verdict: verdict.as_str().unwrap_or_default().into(),
        likely: diagnosis.likely().into_iter().map(|effect| effect.id.clone()).collect(),
        versions: diagnosis
            .staircase
            .iter()
            .map(|s| ratio(s.window_rms_validation / floor))
            .collect(),
    })
}

/// A ratio that JSON can represent.
fn ratio(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::MAX }
}

/// The part of the outcome that does not depend on the rate.
fn describe(out: &mut Outcome, study: &Study, scenario: &Scenario) {
    if let Some(diagnosis) = &study.diagnosis {
        let refitted = diagnosis.ranking.iter().filter(|c| {
            c.after.is_some_and(|after| after.window_rms.is_finite()) && c.delta_bic.is_finite()
        });
        out.ranking = refitted
            .map(|c| CandidateTest {
                effect: c.effect.clone(),
                p_value: c.p_value,
                delta_bic: c.delta_bic,
            })
            .collect();
    }
    let estimates = study.methods.first().map_or(&[][..], |m| &m.estimates);
    let own = scenario.effects.iter().flat_map(|(_, own)| own.iter().copied());
    for (symbol, truth) in BASE.into_iter().zip(scenario.truth).chain(own) {
        let Some(e) = estimates.iter().find(|e| e.symbol == symbol && e.identifiable) else {
            continue;
        };
        let covered = e.interval.0 <= truth && truth <= e.interval.1;
        let (value, std_error) = (e.value, e.std_error);
        out.estimates.push(Covered { symbol: symbol.into(), truth, value, std_error, covered });
    }
    out.dead_time_s = study.timing.ok().map(|t| t.dead_time_s);
    let findings = study.recordings.iter().flat_map(|r| r.conditioning.iter());
    out.conditioning = findings.filter(|f| f.is_remarkable()).map(ToString::to_string).collect();
    out.conditioning.sort();
    out.conditioning.dedup();
}

/// Whether two ids have the same equations.
pub fn same(a: &str, b: &str) -> bool {
    let twins = || find(a).map(|e| e.description().equivalent).unwrap_or_default();
    a == b || twins().iter().any(|t| t == b)
}

impl Outcome {
    /// Result at a rate; at the nearest larger one that was run.
    pub fn at(&self, rate: f64) -> Option<&Said> {
        self.said.iter().find(|said| (said.false_alarm - rate).abs() < 1e-9)
    }
}

impl Said {
    /// Whether the first effect named is a hidden one.
    pub fn named(&self, hidden: &[String]) -> bool {
        self.found.first().is_some_and(|f| hidden.iter().any(|h| same(h, f)))
    }

    /// Whether exactly the hidden effects were named.
    pub fn exact(&self, hidden: &[String]) -> bool {
        self.found.len() == hidden.len()
            && hidden.iter().all(|h| self.found.iter().any(|f| same(h, f)))
    }

    /// Whether the error of a later version is above that of an earlier one.
    pub fn rises(&self) -> bool {
        self.versions.windows(2).any(|w| w[1] > 1.000_001 * w[0])
    }

    /// Whether the verdict is "nothing is missing" although the error is above 1.5 times the floor.
    pub fn silent(&self) -> bool {
        self.verdict == "model_sufficient" && self.versions.last().is_some_and(|last| *last > 1.5)
    }
}
