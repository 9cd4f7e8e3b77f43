//! The diagnosis of an experiment, with its verdict.

use super::error::RunError;
use super::models;
use super::plan::{DiagnosisPlan, Plan};
use crate::compare::Variable;
use crate::diagnose::{Data, Diagnosis, diagnose, with_later_input};
use crate::identify::{IdentifyError, Task, start};
use crate::model::Model;
use crate::recording::Recording;
use crate::study::{DiagnosisStudy, Role, Study, Verdict};
use crate::verdict::{Basis, concluded, residual_torque, unless_undetermined};

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
    let words = unless_undetermined(words, study.is_undetermined());
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
    let basis = Basis {
        train: &plan.of(Role::Train),
        judged: &plan.judged(),
        hold: plan.hold,
        floor: Some(study.judged_floor()),
        false_alarm: asked.settings.false_alarm,
        slow_moment: asked.slow_moment,
        seed: plan.seed,
    };
    let (words, depends_on) = concluded(&diagnosis, &basis)?;
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

/// Where the fits start: at the weak form, on recordings without their dead time first where that is longer
/// than logging explains (it turns the inertias of quick steps round), and at the construction data.
fn starts(plan: &Plan, task: &Task) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    let late = plan.timing.map_or(0.0, |t| t.dead_time_s - t.correction_s);
    if late > task.train.iter().map(Recording::step).fold(0.0, f64::max) {
        let moved: Vec<Recording> = task.train.iter().map(|r| with_later_input(r, late)).collect();
        out.extend(start::start(&Task { train: &moved, ..*task }, "diagnosis").ok());
    }
    out.extend(start::start(task, "diagnosis").ok());
    out.push(task.model.initial());
    out
}

fn failed(e: IdentifyError) -> RunError {
    RunError::NoFit { reasons: e.to_string() }
}
