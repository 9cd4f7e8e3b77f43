//! The last model of an experiment for the page of its report.

use super::fitted::FittedModel;
use super::plan::{Measured, Plan};
use crate::diagnose::shifted;
use crate::export::{Identified, javascript, reasons};
use crate::study::{Performance, Start, Study, WhatIf};

/// The model that the report ends with as a function; `None` if it is not physical.
pub(super) fn what_if(plan: &Plan, study: &Study) -> Option<WhatIf> {
    let last = study.last_model()?;
    let estimates: Vec<_> = last.parameters.iter().map(|p| p.estimate.clone()).collect();
    let found = match (&study.completed, &study.diagnosis) {
        (Some(_), Some(diagnosis)) => diagnosis.found.as_slice(),
        _ => &[],
    };
    let fitted = FittedModel::new(plan, found, &estimates, "").ok()??;
    let performances = plan.recordings.iter().zip(&last.performance);
    Some(WhatIf {
        script: script(plan, study, &fitted),
        inputs: plan.recordings.iter().map(|m| input(m, fitted.input_shift_s)).collect(),
        starts: performances.map(|(m, p)| starts(m, p)).collect(),
    })
}

fn script(plan: &Plan, study: &Study, fitted: &FittedModel) -> Result<String, String> {
    let std_errors: Vec<f64> = fitted.estimates.iter().map(|e| e.std_error).collect();
    let units: Vec<String> = fitted.estimates.iter().map(|e| e.unit.clone()).collect();
    let by_diagnosis = study.diagnosis.is_some();
    let method = study.reference_method().filter(|_| !by_diagnosis);
    let identified = Identified {
        model: &fitted.model,
        values: &fitted.values(),
        std_errors: &std_errors,
        units: &units,
        drive_unit: study.drive_unit.symbol(),
        hold: plan.hold,
        experiment: &study.experiment,
        method: method.map_or("diagnosis", |m| &m.name),
        missing: &[],
    };
    javascript(&identified).map_err(|obstacles| reasons(&obstacles))
}

fn input(measured: &Measured, shift: f64) -> Vec<[f64; 2]> {
    let recording = &measured.recording;
    match shift {
        0.0 => recording.torque().to_vec(),
        _ => shifted(recording, recording.torque(), shift),
    }
}

fn starts(measured: &Measured, performance: &Performance) -> Vec<Start> {
    let pieces = measured.recording.pieces();
    let rows = performance.window_starts.iter().zip(&performance.window_states);
    let start = |(&row, &state): (&usize, &[f64; 4])| {
        let is_piece = pieces.iter().any(|piece| piece.start == row);
        Start { row, state, is_piece }
    };
    rows.map(start).collect()
}
