//! `results.json`, for other programs. Its schema is fixed by the contract.

use serde_json::{Map, Value, json};

use super::verdict::{evidence, recommendation, sentence};
use crate::conditioning::Finding;
use crate::diagnose::Judgement;
use crate::identify::{Estimate, Status};
use crate::report::{is_determined, no_dead_time, sign_of_speed};
use crate::study::{DiagnosisStudy, MethodStudy, ModelStudy, Performance, Role, Study};

/// Version of the layout of `results.json`.
pub const SCHEMA: u32 = 1;

/// The results of a study. Numbers that are not finite are null.
#[must_use]
pub fn results(study: &Study) -> Value {
    let mut out = json!({
        "schema": SCHEMA,
        "experiment": study.experiment,
        "title": study.title,
        "program": { "name": env!("CARGO_PKG_NAME"), "version": study.version },
        "seed": study.seed,
        "robot": study.robot,
        "model": { "effects": study.effects },
        "drive_unit": study.drive_unit,
        "emulator": { "gain": study.emulator_gain },
        "recordings": recordings(study),
        "methods": study.methods.iter().map(|m| method(study, m)).collect::<Vec<_>>(),
        "noise_floor": floor(study),
        "failures": study.given.as_ref().map_or(&[][..], |m| &m.failures),
        "grade": study.grade(),
        "model_as_given": study.given.as_ref().map(|m| model(study, m)),
        "model_completed": study.completed.as_ref().map(|m| model(study, m)),
        "versions": study.versions,
    });
    if !study.truth.is_empty() {
        let truth: Map<String, Value> =
            study.truth.iter().map(|(s, v)| (s.clone(), json!(v))).collect();
        out["truth"] = Value::Object(truth);
    }
    if let Some(d) = &study.diagnosis {
        out["diagnosis"] = diagnosis(study, d);
    }
    out
}

/// The sentences of a list of statements.
fn sentences<T: ToString>(said: &[T]) -> Vec<String> {
    said.iter().map(ToString::to_string).collect()
}

fn recordings(study: &Study) -> Vec<Value> {
    study
        .recordings
        .iter()
        .map(|r| {
            json!({
                "role": r.role.name(),
                "file": r.file,
                "sha256": r.sha256,
                "samples": r.samples,
                "duration_s": r.duration_s,
                "rate_hz": r.rate_hz,
                "noise": {
                    "alpha1": r.noise.alpha[0], "alpha2": r.noise.alpha[1],
                    "dalpha1": r.noise.omega[0], "dalpha2": r.noise.omega[1],
                    "M1": r.noise.torque[0], "M2": r.noise.torque[1],
                },
                "conditioning": r.conditioning.iter().map(conditioning).collect::<Vec<_>>(),
                "findings": sentences(&[&r.findings[..], &r.notes].concat()),
                "dead_time_s": study.timing.ok().map(|t| json!({
                    "value": t.dead_time_s, "std_error": t.std_error_s, "corrected": t.correction_s,
                    "determined": is_determined(&t), "value_otherwise": t.otherwise().map(|(hold, value)| json!({ "hold": hold, "value": value })),
                })),
                "dead_time_unknown": study.timing.err().map(|reason| no_dead_time(&reason)),
            })
        })
        .collect()
}

fn conditioning(finding: &Finding) -> Value {
    let (name, value, unit) = finding.kind.parts();
    json!({
        "channel": finding.channel.name(), "finding": name, "action": finding.action.name(),
        "value": value, "unit": unit, "words": finding.to_string(),
    })
}

fn estimate(e: &Estimate) -> Value {
    json!({
        "symbol": e.symbol,
        "value": e.value,
        "std_error": e.std_error,
        "ci95": [e.interval.0, e.interval.1],
        "unit": e.unit,
        "identifiable": e.identifiable,
        "fixed": e.fixed,
    })
}

fn by_role(study: &Study, value: impl Fn(usize) -> f64) -> Value {
    let mut out = Map::new();
    for role in [Role::Train, Role::Validation] {
        let values: Vec<f64> = (0..study.recordings.len())
            .filter(|&r| study.recordings[r].role == role)
            .map(&value)
            .collect();
        if !values.is_empty() {
            out.insert(role.name().into(), json!(values));
        }
    }
    Value::Object(out)
}

fn method(study: &Study, m: &MethodStudy) -> Value {
    if let Some(reason) = &m.failure {
        return json!({
            "method": m.name, "status": "failed", "reason": reason.to_string(), "seconds": m.seconds,
            "parameters": [],
        });
    }
    let of = |value: &dyn Fn(&Performance) -> f64| {
        by_role(study, |r| m.performance.get(r).map_or(f64::NAN, value))
    };
    json!({
        "method": m.name,
        "options": m.options,
        "status": m.status.map_or("converged", Status::name),
        "seconds": m.seconds,
        "iterations": m.work.iterations,
        "evaluations": m.work.evaluations,
        "parameters": m.estimates.iter().map(estimate).collect::<Vec<_>>(),
        "correlations": m.correlations,
        "combinations": m.combinations(),
        "notes": sentences(&m.notes),
        "angle_rms": of(&|p| p.angle_rms),
        "ise": of(&|p| p.ise[0] + p.ise[1]),
        "window_rms": of(&|p| p.window_rms),
        "ise_emulator": {
            "parallel": of(&|p| p.ise_parallel),
            "serial_parallel": of(&|p| p.ise_serial_parallel),
        },
    })
}

fn floor(study: &Study) -> Value {
    json!({
        "ise": by_role(study, |r| study.recordings[r].floor.ise.iter().sum()),
        "window_rms": by_role(study, |r| study.recordings[r].floor.window_rms),
    })
}

/// The fit on which the verdict is based: its error, floor and ratio, parameters and residual analysis.
fn model(study: &Study, m: &ModelStudy) -> Value {
    let (error, floor) = (study.error_of(m), study.judged_floor());
    json!({
        "effects": m.effects,
        "window_rms": error,
        "noise_floor": floor,
        "ratio": error / floor,
        "parameters": m.parameters.iter().map(|p| estimate(&p.estimate)).collect::<Vec<_>>(),
        "failures": m.failures,
        "horizons": m.horizons,
        "residual_analysis": m.whiteness,
    })
}

fn diagnosis(study: &Study, d: &DiagnosisStudy) -> Value {
    let ranking: Vec<Value> = d
        .ranking
        .iter()
        .map(|c| {
            let after = |value: fn(&Judgement) -> f64| c.after.as_ref().map(value);
            json!({
                "effect": c.effect,
                "probability": c.probability,
                "indistinguishable": c.indistinguishable,
                "p_value": c.p_value,
                "log_significance": c.log_significance,
                "evidence": c.evidence,
                "delta_bic": c.delta_bic,
                "ise_validation_before": c.before.ise,
                "ise_validation_after": after(|j| j.ise),
                "window_rms_validation_before": c.before.window_rms,
                "window_rms_validation_after": after(|j| j.window_rms),
                "torque_rms": c.torque_rms,
                "words": evidence(c, d),
                "parameters": c.parameters.iter().map(estimate).collect::<Vec<_>>(),
            })
        })
        .collect();
    json!({
        "verdict": d.verdict,
        "sentence": sentence(d),
        "sign_of_speed": sign_of_speed(study),
        "found": d.found,
        "likely": d.likely().iter().map(|effect| &effect.id).collect::<Vec<_>>(),
        "parameters": d.parameters.iter().map(|p| estimate(&p.estimate)).collect::<Vec<_>>(),
        "correlations": d.correlations,
        "thresholds": crate::diagnose::THRESHOLDS,
        "ranking": ranking,
        "staircase": d.staircase,
        "unexplained_fraction": d.errors.unexplained(),
        "next_run": recommendation(d),
        "next_movement": d.proposal,
        "false_alarm": d.false_alarm,
        "effects": d.effects,
        "formula": d.formula,
        "differs": d.differs.as_ref().map(|d| json!({
            "recording": d.recording, "parameter": d.symbol, "share": d.share, "std_error": d.std_error,
        })),
        "dependences": study.curves.iter().map(|c| json!({
            "variable": c.variable, "acting": c.acting, "log_significance": c.log_significance,
            "share_before": c.share_before, "share_after": c.share_after,
        })).collect::<Vec<_>>(),
    })
}
