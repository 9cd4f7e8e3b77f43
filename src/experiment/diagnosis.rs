//! The diagnosis of an experiment, with its verdict.

use super::comparison::Comparison;
use super::error::RunError;
use super::plan::Plan;
use crate::compare::{Curve, WindowFloor};
use crate::diagnose::{
    Data, Diagnosis, Judge, Settings, THRESHOLDS, Told, WindowFit, cutoff, mobility,
    with_later_input,
};
use crate::identify::{IdentifyError, Task, start};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::PhysicalDynamics;
use crate::study::{DiagnosisStudy, Role, is_undetermined};
use crate::verdict::{Basis, Concluded, Trial, concluded, curves_of, residual_torques};

/// A comparison with its diagnosis, where the plan asks for one.
pub struct Diagnosed {
    /// The comparison; with a diagnosis, the noise floor is that of the model with what was found.
    pub comparison: Comparison,
    pub(super) outcome: Option<Outcome>,
}

impl Diagnosed {
    /// The verdict; `None` where no diagnosis was asked for.
    #[must_use]
    pub fn verdict(&self) -> Option<&DiagnosisStudy> {
        self.outcome.as_ref().map(|outcome| &outcome.concluded.words)
    }
}

impl From<Comparison> for Diagnosed {
    /// Without a diagnosis.
    fn from(comparison: Comparison) -> Self {
        Self { comparison, outcome: None }
    }
}

/// A diagnosis and its verdict.
pub(super) struct Outcome {
    pub(super) diagnosis: Diagnosis,
    concluded: Concluded,
    /// Noise floor of the judged recordings under the last model.
    floor: WindowFloor,
    /// The formula of what the residual torque depends on, where it was tried already.
    trial: Option<Trial>,
}

impl Outcome {
    /// The verdict beside the `curves` of the residual torque.
    pub(super) fn concluded(self, plan: &Plan, curves: &[Curve]) -> DiagnosisStudy {
        let Self { diagnosis, concluded, floor, trial } = self;
        let (train, judged) = (plan.of(Role::Train), plan.judged());
        let basis = Basis { floor: Some(floor), ..Basis::new(&train, &judged, plan.hold) };
        let says = concluded.says_dependence(curves);
        let trial = || trial.or_else(|| Trial::of(curves, &diagnosis, &basis));
        let trial = says.then(trial).flatten().filter(|trial| trial.explains(floor.expected));
        concluded.with_dependence(curves, &basis, trial.map(Trial::study))
    }
}

/// Searches what is missing in the model of a plan, where the plan asks for it.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub fn diagnose(plan: &Plan, comparison: Comparison) -> Result<Diagnosed, RunError> {
    diagnose_told(plan, comparison, None)
}

/// The same; `told` is told of the progress.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub(super) fn diagnose_told(
    plan: &Plan,
    comparison: Comparison,
    told: Option<Told>,
) -> Result<Diagnosed, RunError> {
    let Some(asked) = &plan.diagnosis else { return Ok(comparison.into()) };
    let settings = Settings { told, ..asked.settings.clone() };
    let diagnosis = search(plan, &settings, &comparison)?;
    let (diagnosis, trial) = unless_in_place(plan, &comparison, diagnosis);
    let comparison = match diagnosis.steps.last() {
        Some(_) => comparison.under(plan, &dynamics(diagnosis.last()))?,
        None => comparison,
    };
    let floor = floor_of(&comparison);
    let basis = Basis {
        train: &plan.of(Role::Train),
        judged: &plan.judged(),
        hold: plan.hold,
        floor: Some(floor),
        false_alarm: asked.settings.false_alarm,
        slow_moment: asked.slow_moment,
        seed: plan.seed,
    };
    let concluded = concluded(&diagnosis, &basis)?;
    let is_undetermined = stalled_without_inertia(&comparison) && !knows_inertia(diagnosis.last());
    let concluded = concluded.unless_undetermined(is_undetermined);
    let outcome = Outcome { diagnosis, concluded, floor, trial };
    Ok(Diagnosed { comparison, outcome: Some(outcome) })
}

/// The diagnosis without what was found, where the model is far above the floor with it and better with a formula of what
/// the residual torque depends on in its place; else with that formula, where it was tried.
fn unless_in_place(
    plan: &Plan,
    comparison: &Comparison,
    diagnosis: Diagnosis,
) -> (Diagnosis, Option<Trial>) {
    if diagnosis.steps.is_empty() {
        return (diagnosis, None);
    }
    let (train, judged, floor) = (plan.of(Role::Train), plan.judged(), floor_of(comparison));
    let errors = Judge::new(judged.clone(), plan.hold).errors(&diagnosis, floor);
    if !errors.is_ok_and(|errors| errors.far_above_all()) {
        return (diagnosis, None);
    }
    let recordings: Vec<&Recording> = plan.recordings.iter().map(|m| &m.recording).collect();
    let WindowFit { model, p, .. } = &diagnosis.base;
    let cutoff = cutoff(&recordings, mobility(model, p));
    let [before, after] = [&diagnosis.base, diagnosis.last()]
        .map(|fit| residual_torques(&fit.model, &fit.p, &recordings, cutoff));
    let curves = curves_of(&diagnosis, &recordings, cutoff, &before, Some(&after));
    let trial = Trial::of(&curves, &diagnosis, &Basis::new(&train, &judged, plan.hold));
    match trial {
        Some(trial) if trial.in_place && trial.explains(floor.expected) => {
            let rest = diagnosis.ranking.clone();
            (Diagnosis { steps: vec![], rest, ..diagnosis }, None)
        }
        trial => (diagnosis, trial),
    }
}

/// The noise floor of the judged recordings.
fn floor_of(comparison: &Comparison) -> WindowFloor {
    let judged = comparison.judged();
    WindowFloor { expected: judged.floor(), most: judged.floor_most() }
}

fn dynamics(fit: &WindowFit) -> PhysicalDynamics {
    PhysicalDynamics { model: fit.model.clone(), p: fit.p.clone() }
}

fn search(
    plan: &Plan,
    settings: &Settings,
    comparison: &Comparison,
) -> Result<Diagnosis, RunError> {
    let train = plan.of(Role::Train);
    let model = with_held(plan, &train, comparison);
    let task = Task { model: &model, train: &train, hold: plan.hold, seed: plan.seed };
    let starts = starts(plan, &task);
    let validation = plan.of(Role::Validation);
    let corrected_s = plan.timing.map_or(0.0, |t| t.correction_s);
    let data = Data { train: &train, validation: &validation, hold: plan.hold, corrected_s };
    crate::diagnose::diagnose(&model, &starts, &data, settings).map_err(failed)
}

/// Whether the preferred fit stalled where a1 is not identifiable, though wheels turn against each other.
fn stalled_without_inertia(comparison: &Comparison) -> bool {
    is_undetermined(&comparison.recordings, Some(comparison.reference_method()))
}

/// Whether a fit identifies a1: its 95 % interval holds positive values only.
fn knows_inertia(fit: &WindowFit) -> bool {
    let Ok(j) = fit.model.index_of("a1") else { return false };
    fit.p[j] > THRESHOLDS.uncertain * fit.covariance[(j, j)].sqrt()
}

/// The model with what the data do not identify held where the preferred fit holds it: a fit that is free to
/// move what no recording shows simulates others worse than the model as it was given. Of a single axis only
/// sums are known, and nothing of one wheel is held.
fn with_held(plan: &Plan, train: &[Recording], comparison: &Comparison) -> Model {
    let mut model = plan.model.clone();
    // where a descent went astray and stalled tells nothing of the data
    if train.iter().all(Recording::is_single_axis) || stalled_without_inertia(comparison) {
        return model;
    }
    let estimates = &comparison.reference_method().estimates;
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
