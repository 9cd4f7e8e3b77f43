//! From a plan to a study: fit, compare, diagnose.

use super::comparison::{Comparison, compare};
use super::diagnosis::{Diagnosed, diagnose_with_progress, verdict};
use super::error::RunError;
use super::fits::fits_in_stages;
use super::model_out::model_out;
use super::models::{self, Models};
use super::plan::Plan;
use super::robot_table::has_no_track;
use super::stages::Stages;
use super::what_if::what_if;
use crate::study::{Invocation, Study};

/// Runs an experiment.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn run(plan: &Plan) -> Result<Study, RunError> {
    run_in_stages(plan, &Stages::hidden())
}

/// The same, with progress shown by `stages`.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub(super) fn run_in_stages(plan: &Plan, stages: &Stages) -> Result<Study, RunError> {
    let fits = fits_in_stages(plan, stages);
    stages.enter("simulating the recordings");
    let comparison = compare(plan, &fits)?;
    if plan.diagnosis.is_some() {
        stages.enter("diagnosis: trying effects");
    }
    let progress = stages.counting("of this round");
    study(plan, diagnose_with_progress(plan, comparison, Some(progress))?)
}

/// All results of a plan: its comparison and its diagnosis, with the models on which they are based.
///
/// # Errors
/// A model that cannot be simulated.
pub fn study(plan: &Plan, diagnosed: Diagnosed) -> Result<Study, RunError> {
    let Diagnosed { comparison, settled, timing } = diagnosed;
    let models = match &settled {
        Some(settled) => models::of_diagnosis(plan, &comparison, settled.diagnosis())?,
        None => models::of_reference(plan, &comparison)?,
    };
    let diagnosis = verdict(plan, &comparison, settled, &models.curves)?;
    let model_out = model_out(plan, &comparison, diagnosis.as_ref());
    let what_if = what_if(plan, &comparison, &models, diagnosis.as_ref());
    let Comparison { recordings, methods, reference, .. } = comparison;
    // a diagnosis starts from the model of the file, the methods from one with its dead time
    let model = if diagnosis.is_some() { plan.model.clone() } else { plan.fitted_model() };
    let effects = model.added_ids();
    let Models { given, completed, curves } = models;
    Ok(Study {
        experiment: plan.name.clone(),
        invocation: invocation(plan),
        title: plan.title.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: plan.seed,
        file: plan.file.clone(),
        robot: plan.model.robot().name.clone(),
        robot_is_given: plan.robot_is_given,
        track_is_known: !has_no_track(plan.model.robot()),
        effects,
        drive_unit: plan.drive_unit(),
        recordings,
        methods,
        reference: Some(reference),
        emulator_gain: plan.gain.0[2][2],
        given: Some(given),
        completed,
        curves,
        diagnosis,
        emulated: plan.emulated,
        of_paper: plan.of_paper,
        versions: vec![],
        truth: plan.truth.clone(),
        timing: timing.or(plan.timing),
        timing_as_given: timing.and(plan.timing),
        model_out,
        what_if,
    })
}

/// The command line of the experiment, with paths relative to the current folder.
fn invocation(plan: &Plan) -> Invocation {
    let here = std::env::current_dir().unwrap_or_default();
    let file = plan.source.strip_prefix(here).unwrap_or(&plan.source);
    Invocation {
        file: file.display().to_string(),
        recordings: plan.typed.iter().map(|path| path.display().to_string()).collect(),
        out: None,
    }
}
