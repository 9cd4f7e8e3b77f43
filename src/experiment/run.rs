//! From a plan to a study: fit, compare, diagnose.

use super::between_rows::add_unknown_course;
use super::comparison::{Comparison, compare, without_fit};
use super::diagnosis::{Diagnosed, diagnose_with_progress, verdict};
use super::error::RunError;
use super::fits::{MethodFit, fits_in_stages};
use super::model_out::model_out;
use super::models::{self, Models};
use super::plan::Plan;
use super::robot_table::has_no_track;
use super::stages::Stages;
use super::what_if::what_if;
use crate::simulate::SimulateError;
use crate::study::{Grade, Invocation, MethodStudy, RecordingStudy, Study};

/// Runs an experiment.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn run(plan: &Plan) -> Result<Study, RunError> {
    let stages = Stages::hidden();
    compared(plan, &fits_in_stages(plan, &stages), &stages).map_err(|unfitted| unfitted.reason)
}

/// Why an experiment has no model, and what a report can still show.
pub(super) struct Unfitted {
    /// Why no fit can be simulated.
    pub(super) reason: RunError,
    /// The recordings, and the methods with their reasons; `None` if methods have fits that can be simulated.
    pub(super) study: Option<Box<Study>>,
}

impl From<RunError> for Unfitted {
    fn from(reason: RunError) -> Self {
        Self { reason, study: None }
    }
}

/// [`run`] with progress shown by `stages`.
///
/// # Errors
/// As [`run`], with the rows of the methods.
pub(super) fn run_in_stages(plan: &Plan, stages: &Stages) -> Result<Study, Unfitted> {
    compared(plan, &fits_in_stages(plan, stages), stages)
}

/// The results of the fits.
fn compared(plan: &Plan, fits: &[MethodFit], stages: &Stages) -> Result<Study, Unfitted> {
    stages.enter("simulating the recordings");
    let comparison = compare(plan, fits).map_err(|reason| {
        let study = match &reason {
            RunError::NoFit(_) => Some(unfitted(plan, fits, None)),
            RunError::Simulate(e) => Some(unfitted(plan, fits, Some(e))),
            RunError::Model(_) => None,
        };
        Unfitted { reason, study: study.map(Box::new) }
    })?;
    if plan.diagnosis.is_some() {
        stages.enter("diagnosis: trying effects");
    }
    let progress = stages.counting("of this round");
    Ok(study(plan, diagnose_with_progress(plan, comparison, Some(progress))?)?)
}

/// The study of fits none of which can be simulated.
fn unfitted(plan: &Plan, fits: &[MethodFit], simulation: Option<&SimulateError>) -> Study {
    let (recordings, methods) = without_fit(plan, fits, simulation);
    bare(plan, recordings, methods)
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
    let Comparison { mut recordings, methods, reference, .. } = comparison;
    let is_explained = diagnosis.as_ref().is_some_and(|d| !d.errors.above_floor());
    if let Some(timing) = timing.filter(|_| is_explained) {
        add_unknown_course(plan, &mut recordings, timing);
    }
    // a diagnosis starts from the model of the file, the methods from one with its dead time
    let model = if diagnosis.is_some() { plan.model.clone() } else { plan.fitted_model() };
    let effects = model.added_ids();
    let Models { given, completed, curves } = models;
    Ok(with_usable_model(Study {
        effects,
        reference: Some(reference),
        given: Some(given),
        completed,
        curves,
        diagnosis,
        timing: timing.map_or(plan.timing, Ok),
        timing_as_given: timing.map(|_| plan.timing),
        model_out,
        what_if,
        ..bare(plan, recordings, methods)
    }))
}

/// The study without the files of a model that is graded as not usable.
fn with_usable_model(study: Study) -> Study {
    match study.grade() {
        Some(Grade::NotUsable) => Study { model_out: None, ..study },
        _ => study,
    }
}

/// A study of recordings and methods without a model.
fn bare(plan: &Plan, recordings: Vec<RecordingStudy>, methods: Vec<MethodStudy>) -> Study {
    Study {
        experiment: plan.name.clone(),
        invocation: invocation(plan),
        title: plan.title.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: plan.seed,
        file: plan.file.clone(),
        robot: plan.model.robot().name.clone(),
        robot_is_given: plan.robot_is_given,
        track_is_known: !has_no_track(plan.model.robot()),
        effects: plan.model.added_ids(),
        drive_unit: plan.drive_unit(),
        recordings,
        methods,
        reference: None,
        emulator_gain: plan.gain.0[2][2],
        given: None,
        completed: None,
        curves: vec![],
        diagnosis: None,
        emulated: plan.emulated,
        of_paper: plan.of_paper,
        versions: vec![],
        truth: plan.truth.clone(),
        timing: plan.timing,
        timing_as_given: None,
        model_out: None,
        what_if: None,
    }
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
