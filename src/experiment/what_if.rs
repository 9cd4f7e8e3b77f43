//! The last model of an experiment for the page of its report.

use super::comparison::Comparison;
use super::fitted::FittedModel;
use super::models::Models;
use super::plan::{MeasuredRecording, Plan};
use crate::diagnose::shifted;
use crate::export::{Obstacle, javascript};
use crate::study::{DiagnosisStudy, Performance, Start, WhatIfStudy};

/// The last model of the report as a function; `None` if it is not physical.
pub(super) fn what_if(
    plan: &Plan,
    comparison: &Comparison,
    models: &Models,
    diagnosis: Option<&DiagnosisStudy>,
) -> Option<WhatIfStudy> {
    let last = models.last();
    let estimates: Vec<_> = last.parameters.iter().map(|p| p.estimate.clone()).collect();
    let found = match (&models.completed, diagnosis) {
        (Some(_), Some(diagnosis)) => diagnosis.found.as_slice(),
        _ => &[],
    };
    let method =
        if diagnosis.is_some() { "diagnosis" } else { &comparison.reference_method().name };
    let fitted = FittedModel::new(plan, found, &estimates, (&[], &[]), method).ok()??;
    let performances = plan.recordings.iter().zip(&last.performance);
    Some(WhatIfStudy {
        script: script(plan, &fitted),
        inputs: plan.recordings.iter().map(|m| input(m, fitted.input_shift_s)).collect(),
        starts: performances.map(|(m, p)| starts(m, p)).collect(),
    })
}

fn script(plan: &Plan, fitted: &FittedModel) -> Result<String, Vec<Obstacle>> {
    javascript(&fitted.identified(plan, &fitted.columns(), &[]))
}

fn input(measured: &MeasuredRecording, shift: f64) -> Vec<[f64; 2]> {
    let recording = &measured.recording;
    match shift {
        0.0 => recording.torque().to_vec(),
        _ => shifted(recording, recording.torque(), shift),
    }
}

fn starts(measured: &MeasuredRecording, performance: &Performance) -> Vec<Start> {
    let pieces = measured.recording.pieces();
    let rows = performance.window_starts.iter().zip(&performance.window_states);
    let start = |(&row, &state): (&usize, &[f64; 4])| {
        let is_piece = pieces.iter().any(|piece| piece.start == row);
        Start { row, state, is_piece }
    };
    rows.map(start).collect()
}
