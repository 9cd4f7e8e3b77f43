//! The diagnosis of an experiment, with its verdict.

use std::sync::Arc;

use super::comparison::{Comparison, compare};
use super::custom::Own;
use super::error::RunError;
use super::fits::fits_with;
use super::plan::{DiagnosisPlan, Plan};
use super::robot_table::has_no_track;
use super::stages::Stages;
use crate::compare::{Curve, WindowFloor};
use crate::diagnose::{
    Data, Diagnosis, INPUT_SHIFT, Progress, Settings, THRESHOLDS, Timing, Untimed, WindowFit,
    with_later_input,
};
use crate::effects::{self, Change};
use crate::identify::{IdentifyError, Note, Task, start, start_without_friction};
use crate::model::Model;
use crate::model::base::{A1, A2, A4, A5};
use crate::recording::Recording;
use crate::simulate::{PhysicalDynamics, WINDOW};
use crate::study::{DiagnosisStudy, MethodAtFloor, MethodStudy, Role, Undetermined};
use crate::verdict::{Basis, Settled};

/// A comparison with its diagnosis, if requested.
pub struct Diagnosed {
    /// The comparison; with a diagnosis, the noise floor is that of the model with the effects found.
    pub comparison: Comparison,
    pub(super) settled: Option<Settled>,
    /// The time of the input by the model with the effects found, which replaces that by the model as given.
    pub(super) timing: Option<Timing>,
}

impl Diagnosed {
    /// The verdict, that of the [study](super::study()); `None` without a diagnosis.
    ///
    /// # Errors
    /// A model that cannot be simulated.
    pub fn verdict(self, plan: &Plan) -> Result<Option<DiagnosisStudy>, RunError> {
        let (Some(asked), Some(settled)) = (&plan.diagnosis, self.settled) else { return Ok(None) };
        let curves = with_basis(plan, asked, &self.comparison, |basis| settled.curves(basis));
        verdict(plan, &self.comparison, Some(settled), &curves)
    }
}

impl From<Comparison> for Diagnosed {
    /// Without a diagnosis.
    fn from(comparison: Comparison) -> Self {
        Self { comparison, settled: None, timing: None }
    }
}

/// Searches for missing effects in the model of a plan, if requested.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub fn diagnose(plan: &Plan, comparison: Comparison) -> Result<Diagnosed, RunError> {
    diagnose_with_progress(plan, comparison, None)
}

/// The same; `progress` is called as candidates are fitted.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub(super) fn diagnose_with_progress(
    plan: &Plan,
    comparison: Comparison,
    progress: Option<Progress>,
) -> Result<Diagnosed, RunError> {
    let Some(asked) = &plan.diagnosis else { return Ok(comparison.into()) };
    let settings = Settings { progress, ..asked.settings.clone() };
    let diagnosis = match search(plan, &settings, &comparison) {
        Ok(diagnosis) => diagnosis,
        // the fits are valid without it
        Err(e) => {
            let mut comparison = comparison;
            let reference = &mut comparison.methods[comparison.reference];
            reference.notes.push(Note::NotDiagnosed(e));
            return Ok(comparison.into());
        }
    };
    let floor = floor_of(&comparison);
    let settled =
        with_basis(plan, asked, &comparison, |basis| Settled::of(diagnosis, basis, Some(floor)));
    let timing = timing_with_found(plan, settled.diagnosis());
    let comparison = match plan.late().and(timing) {
        // the methods fitted a delay in place of the effects found
        Some(_) => {
            let fits = fits_with(plan, None, &Stages::hidden());
            compare(plan, &fits).unwrap_or(comparison)
        }
        None => comparison,
    };
    let comparison = match settled.diagnosis().steps.last() {
        Some(_) => comparison.under(plan, &dynamics(settled.diagnosis().last()))?,
        None => comparison,
    };
    Ok(Diagnosed { comparison, settled: Some(settled), timing })
}

/// The time of the input by the model with the effects found: a missing effect may look like a shift in time. `None`
/// without effects, where one of them is a shift itself, and where the data do not determine it within what logging
/// explains.
fn timing_with_found(plan: &Plan, diagnosis: &Diagnosis) -> Option<Timing> {
    let given = match plan.timing {
        Err(Untimed::NotSought) => return None,
        given => given.unwrap_or_else(|_| Timing::unknown(&plan.of(Role::Train))),
    };
    let shifts = |id: &String| effects::find(id).is_some_and(|e| e.change() == Change::TimeShift);
    if diagnosis.found().iter().any(shifts) {
        return None;
    }
    let WindowFit { model, p, covariance, at_bound, .. } = &diagnosis.steps.last()?.fit;
    let j = model.index_of(INPUT_SHIFT).ok()?;
    let std_error_s = covariance[(j, j)].sqrt();
    let is_known = std_error_s.is_finite() && std_error_s > 0.0 && !at_bound[j];
    let dead_time_s = given.correction_s + p[j];
    is_known.then_some(Timing { dead_time_s, std_error_s, ..given })
}

/// The method whose fit of the model as given comes closest to the noise floor of held-out recordings, if it is at the
/// floor although the fit of the diagnosis, which misses no effect, is not.
fn method_at_floor(
    plan: &Plan,
    comparison: &Comparison,
    verdict: &DiagnosisStudy,
) -> Option<MethodAtFloor> {
    let judged = comparison.judged();
    // a delay is another structure
    let asked = judged.are_held_out() && verdict.is_open() && verdict.withheld.is_none();
    if !asked || plan.late().is_some() {
        return None;
    }
    let physical = comparison.methods.iter().filter(|m| m.fuzzy.is_none() && m.failure.is_none());
    let fits = physical.map(|m| MethodAtFloor {
        method: m.name.clone(),
        ratio: judged.window_rms(&m.performance) / judged.floor(),
    });
    let at_floor = fits.filter(|fit| fit.ratio <= THRESHOLDS.at_floor);
    at_floor.min_by(|a, b| a.ratio.total_cmp(&b.ratio))
}

/// The verdict of a diagnosis with the `curves` of the residual torque; `None` without a diagnosis.
///
/// # Errors
/// A model that cannot be simulated.
pub(super) fn verdict(
    plan: &Plan,
    comparison: &Comparison,
    settled: Option<Settled>,
    curves: &[Curve],
) -> Result<Option<DiagnosisStudy>, RunError> {
    let (Some(asked), Some(settled)) = (&plan.diagnosis, settled) else { return Ok(None) };
    let floor = Some(floor_of(comparison));
    let verdict =
        with_basis(plan, asked, comparison, |basis| settled.verdict(curves, basis, floor))?;
    let at_floor = method_at_floor(plan, comparison, &verdict);
    Ok(Some(DiagnosisStudy { at_floor, ..verdict }))
}

/// Calls a function with the basis of the verdict for a plan.
fn with_basis<T>(
    plan: &Plan,
    asked: &DiagnosisPlan,
    comparison: &Comparison,
    f: impl FnOnce(&Basis) -> T,
) -> T {
    let train = comparison.of(plan, Role::Train);
    f(&Basis {
        train: &train,
        validation: &comparison.of(plan, Role::Validation),
        hold: plan.hold,
        false_alarm: asked.settings.false_alarm,
        slow_moment: asked.slow_moment,
        seed: plan.seed,
        undetermined: short(&train).or_else(|| comparison.undetermined()),
    })
}

/// Recordings without a window of the simulation error, in which no two models can be compared.
fn short(train: &[Recording]) -> Option<Undetermined> {
    let seconds: f64 = train.iter().map(Recording::covered).sum();
    (seconds < WINDOW).then_some(Undetermined::Short { seconds })
}

/// The noise floor of the judged recordings.
fn floor_of(comparison: &Comparison) -> WindowFloor {
    let judged = comparison.judged();
    let (expected, most) = (judged.floor(), judged.floor_most());
    WindowFloor { expected, most, slow: judged.floor_slow() }
}

fn dynamics(fit: &WindowFit) -> PhysicalDynamics {
    PhysicalDynamics { model: fit.model.clone(), p: fit.p.clone() }
}

fn search(
    plan: &Plan,
    settings: &Settings,
    comparison: &Comparison,
) -> Result<Diagnosis, IdentifyError> {
    let train = plan.of(Role::Train);
    let model = with_held(plan, &train, comparison);
    let task = Task { model: &model, train: &train, hold: plan.hold, seed: plan.seed };
    let starts = starts(plan, &task);
    let settings = Settings {
        estimates: estimates(&model, comparison),
        held: held_by(&model, &plan.model),
        candidates: candidates(plan, settings),
        ..settings.clone()
    };
    let validation = plan.of(Role::Validation);
    let corrected_s = plan.timing.map_or(0.0, |t: Timing| t.correction_s);
    let data = Data { train: &train, validation: &validation, hold: plan.hold, corrected_s };
    crate::diagnose::diagnose(&model, &starts, &data, &settings)
}

/// The candidates; of a robot whose track is unknown without the effects that depend on it.
fn candidates(plan: &Plan, settings: &Settings) -> Vec<String> {
    if !settings.candidates.is_empty() || !has_no_track(plan.model.robot()) {
        return settings.candidates.clone();
    }
    let catalogue = effects::all().into_iter().map(Arc::from);
    let all = catalogue.chain(settings.own.iter().cloned());
    all.filter(|effect: &Own| !effect.needs_track()).map(|effect| effect.id()).collect()
}

/// The model with unidentifiable parameters fixed at the values of the preferred fit: if parameters are free
/// that the recordings do not determine, simulations of other recordings are worse than with the model as
/// given. For a single axis only sums of parameters are identifiable, and no parameter of one wheel is fixed.
fn with_held(plan: &Plan, train: &[Recording], comparison: &Comparison) -> Model {
    let mut model = plan.model.clone();
    // a descent that stalled far from a minimum contains no information on identifiability
    if train.iter().all(Recording::is_single_axis) || comparison.undetermined().is_some() {
        return model;
    }
    let estimates = &comparison.reference_method().estimates;
    // a fit without any identifiable parameter fixes nothing
    let some = estimates.iter().any(|e| e.identifiable);
    let is_open = |j: usize| estimates.get(j).is_some_and(|e| !e.identifiable);
    // of a1 and a2 the sum or the difference is known, which a1 alone can take
    let of_pair = |j: usize| j == A1 && is_open(A2);
    let open = (0..estimates.len()).filter(|j| some && is_open(*j) && !of_pair(*j));
    for j in open {
        let e = &estimates[j];
        // a fit in which a dominant torque is missing may have a negative friction
        let value = if matches!(j, A4 | A5) { e.value.max(0.0) } else { e.value };
        model = model.fix(&e.symbol, value).unwrap_or(model);
    }
    model
}

/// Symbols of the parameters that are fixed in a model and not in that of the file.
fn held_by(model: &Model, file: &Model) -> Vec<String> {
    let pairs = model.parameters().iter().zip(file.parameters());
    let held = pairs.filter(|(a, b)| a.fixed.is_some() && b.fixed.is_none());
    held.map(|(a, _)| a.spec.symbol.clone()).collect()
}

/// Initial values of the fits: from the weak form, after removing a dead time that exceeds what logging
/// explains (it can invert the sign of inertias in fast steps), and from the construction data.
fn starts(plan: &Plan, task: &Task) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    let late = plan.timing.map_or(0.0, |t: Timing| t.dead_time_s - t.correction_s);
    if late > task.train.iter().map(Recording::step).fold(0.0, f64::max) {
        let later = |r| with_later_input(r, late, task.hold);
        let moved: Vec<Recording> = task.train.iter().map(later).collect();
        out.extend(start::start(&Task { train: &moved, ..*task }, "diagnosis").ok());
    }
    out.extend(start::start(task, "diagnosis").ok());
    out.extend(start_without_friction(task));
    out.push(task.model.initial());
    out
}

/// The physical estimates of a comparison as further initial values: a fit of windows may end without dry
/// friction from all other starts. Those of a fitted dead time are left out.
fn estimates(model: &Model, comparison: &Comparison) -> Vec<Vec<f64>> {
    let count = model.parameters().len();
    let of = |m: &MethodStudy| m.estimates.iter().take(count).map(|e| e.value).collect::<Vec<_>>();
    let is_whole = |p: &Vec<f64>| p.len() == count && p.iter().all(|value| value.is_finite());
    comparison.methods.iter().map(of).filter(is_whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{compare, fits, load};

    #[test]
    fn the_verdict_of_an_experiment_is_that_of_the_library() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/experiments/outside_catalogue.toml");
        let plan = load(file.as_ref(), &[]).unwrap();
        let asked = plan.diagnosis.as_ref().unwrap();
        let comparison = compare(&plan, &fits(&plan)).unwrap();
        let found = search(&plan, &asked.settings, &comparison).unwrap();
        let (train, validation) = (plan.of(Role::Train), plan.of(Role::Validation));
        let basis = Basis::new(&train, &validation, plan.hold);
        let alone = crate::verdict::verdict(&found, &basis).unwrap();
        let run = diagnose(&plan, comparison).unwrap().verdict(&plan).unwrap().unwrap();
        assert_eq!((alone.verdict, alone.found), (run.verdict, run.found));
        let block = |study: Option<crate::study::FormulaStudy>| study.map(|f| (f.id, f.toml));
        assert!(run.formula.is_some());
        assert_eq!(block(alone.formula), block(run.formula));
    }

    #[test]
    fn the_estimates_of_the_methods_are_starts_of_a_diagnosis() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/experiments/outside_catalogue.toml");
        let plan = load(file.as_ref(), &[]).unwrap();
        let comparison = compare(&plan, &fits(&plan)).unwrap();
        let own = &comparison.reference_method().estimates;
        let own: Vec<f64> = own.iter().map(|e| e.value).collect();
        assert!(estimates(&plan.model, &comparison).contains(&own));
    }
}
