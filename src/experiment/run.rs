//! From a plan to a study: fit, compare, diagnose.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::diagnosis::run_diagnosis;
use super::error::RunError;
use super::models;
use super::plan::{Measured, MethodPlan, Plan};
use crate::compare::{angle_rms, ise, noise_floor, simulate_recording, window_rms};
use crate::identify::{Fit, Task};
use crate::recording::Recording;
use crate::robot::{State, kinematics};
use crate::simulate::{Dynamics, SimulateError, Structure, emulate};
use crate::study::{Invocation, MethodStudy, Performance, RecordingStudy, Role, Study};

/// Methods in the order in which their fit is preferred for the detailed comparison.
const PREFERRED: [&str; 4] = ["prediction_error", "weak_form", "output_error", "torque_regression"];

/// Runs an experiment.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn run(plan: &Plan) -> Result<Study, RunError> {
    run_in_stages(plan, &|_| ())
}

/// The same; `enter` is told of every stage that begins.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub(super) fn run_in_stages(plan: &Plan, enter: &(dyn Fn(&str) + Sync)) -> Result<Study, RunError> {
    let fits = fits_in_stages(plan, enter);
    enter("simulating the recordings");
    let (study, right) = measure(plan, &fits)?;
    if plan.diagnosis.is_none() {
        return models::with_reference(plan, study, &*right);
    }
    enter("diagnosis: trying the effects of the catalogue");
    diagnose(plan, study)
}

/// What a method made of the training recordings.
#[derive(Clone)]
pub struct MethodFit {
    /// The fit, or in words why there is none.
    pub fit: Result<Fit, String>,
    /// Wall time \[s\].
    pub seconds: f64,
}

/// Fits every method of a plan to its training recordings; one entry a method, in their order.
#[must_use]
pub fn fits(plan: &Plan) -> Vec<MethodFit> {
    fits_in_stages(plan, &|_| ())
}

fn fits_in_stages(plan: &Plan, enter: &dyn Fn(&str)) -> Vec<MethodFit> {
    let (train, count) = (plan.of(Role::Train), plan.methods.len());
    let fitted = |(n, method): (usize, &MethodPlan)| {
        enter(&format!("fitting {} (method {} of {count})", method.name, n + 1));
        fit(plan, method, &train)
    };
    plan.methods.iter().enumerate().map(fitted).collect()
}

/// Sets the fits of a plan's methods, one a method, against its recordings: errors, noise floor, regimes,
/// residual torque.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn compare(plan: &Plan, fits: &[MethodFit]) -> Result<Study, RunError> {
    let (study, right) = measure(plan, fits)?;
    models::with_reference(plan, study, &*right)
}

/// Adds the diagnosis to a comparison, where the plan asks for one.
///
/// # Errors
/// If the model cannot be fitted or simulated.
pub fn diagnose(plan: &Plan, study: Study) -> Result<Study, RunError> {
    match &plan.diagnosis {
        Some(asked) => run_diagnosis(plan, asked, study),
        None => Ok(study),
    }
}

/// Measures the errors of the fits; returns the dynamics of the reference fit too.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub(super) fn measure(
    plan: &Plan,
    fits: &[MethodFit],
) -> Result<(Study, Arc<dyn Dynamics>), RunError> {
    let train = plan.of(Role::Train);
    let Some(reference) = reference(fits) else {
        let reasons: Vec<String> =
            fits.iter().filter_map(|f| f.fit.as_ref().err().cloned()).collect();
        return Err(RunError::NoFit { reasons: reasons.join("; ") });
    };
    let right: Arc<dyn Dynamics> = match &fits[reference].fit {
        Ok(fit) => fit.dynamics.clone(),
        Err(_) => unreachable!("the reference is a fit"),
    };
    let recordings = plan
        .recordings
        .par_iter()
        .map(|measured| describe(plan, measured, &*right))
        .collect::<Result<Vec<_>, _>>()?;
    let methods: Vec<MethodStudy> = plan
        .methods
        .par_iter()
        .zip(fits)
        .map(|(method, MethodFit { fit, seconds })| {
            // a fit that cannot be simulated is a row with its reason, like one that does not exist
            method_study(plan, method, fit, *seconds)
                .or_else(|e| method_study(plan, method, &Err(e.to_string()), *seconds))
        })
        .collect::<Result<_, _>>()?;
    let study = Study {
        experiment: plan.name.clone(),
        invocation: invocation(plan),
        title: plan.title.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: plan.seed,
        file: plan.file.clone(),
        robot: plan.model.robot().name.clone(),
        robot_is_given: plan.robot_is_given,
        effects: plan.model.added_ids(),
        drive_unit: train[0].drive_unit(),
        recordings,
        methods,
        reference: Some(reference),
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
        model_out: None,
        what_if: None,
    };
    Ok((study, right))
}

/// The experiment on the command line, by paths from the current folder.
fn invocation(plan: &Plan) -> Invocation {
    let here = std::env::current_dir().unwrap_or_default();
    let file = plan.source.strip_prefix(here).unwrap_or(&plan.source);
    Invocation {
        file: file.display().to_string(),
        recordings: plan.typed.iter().map(|path| path.display().to_string()).collect(),
        out: None,
    }
}

fn fit(plan: &Plan, method: &MethodPlan, train: &[Recording]) -> MethodFit {
    let task = Task { model: &plan.model, train, hold: plan.hold, seed: plan.seed };
    let start = Instant::now();
    let fit =
        super::long::identify(&*method.method, &task, &plan.long()).map_err(|e| e.to_string());
    MethodFit { fit, seconds: start.elapsed().as_secs_f64() }
}

/// The fit that is shown in detail: the preferred physical one, else the first there is.
fn reference(fits: &[MethodFit]) -> Option<usize> {
    let first = |is: &dyn Fn(&Fit) -> bool| fits.iter().position(|f| f.fit.as_ref().is_ok_and(is));
    let physical = |fit: &Fit| fit.dynamics.physical().is_some();
    PREFERRED
        .iter()
        .find_map(|name| first(&|fit| fit.method == *name && physical(fit)))
        .or_else(|| first(&physical))
        .or_else(|| first(&|_| true))
}

fn describe(
    plan: &Plan,
    measured: &Measured,
    right: &dyn Dynamics,
) -> Result<RecordingStudy, SimulateError> {
    let r = &measured.recording;
    Ok(RecordingStudy {
        role: measured.role,
        file: r.name().into(),
        sha256: measured.sha256.clone(),
        samples: measured.samples(),
        duration_s: measured.duration(),
        rate_hz: 1.0 / r.step(),
        measured: r.measured(),
        noise: r.noise(),
        conditioning: measured.conditioning.clone(),
        findings: measured.findings.clone(),
        floor: noise_floor(right, r, plan.hold, plan.seed)?,
        t: r.t().to_vec(),
        alpha: r.alpha().to_vec(),
        omega: r.omega().to_vec(),
        acceleration: r.local_motion().iter().map(|m| m.acceleration).collect(),
        torque: r.torque().to_vec(),
        regimes: r.regimes(),
        path: path(plan, r),
    })
}

/// The path of the robot, where its lengths are known.
fn path(plan: &Plan, r: &Recording) -> Vec<[f64; 3]> {
    let robot = plan.model.robot();
    if super::robot_table::has_no_track(robot) {
        vec![]
    } else {
        kinematics::path(robot, r.alpha())
    }
}

fn method_study(
    plan: &Plan,
    method: &MethodPlan,
    fit: &Result<Fit, String>,
    seconds: f64,
) -> Result<MethodStudy, SimulateError> {
    let mut out = MethodStudy::new(&method.name, &method.title, &method.options, seconds);
    let fit = match fit {
        Ok(fit) => fit,
        Err(reason) => {
            out.failure = Some(reason.clone());
            return Ok(out);
        }
    };
    out.status = Some(fit.status);
    out.work = fit.work;
    out.estimates.clone_from(&fit.estimates);
    out.notes = fit.notes.iter().map(ToString::to_string).collect();
    out.traces.clone_from(&fit.traces);
    out.correlations = fit.covariance.as_ref().map_or(vec![], correlations);
    out.fuzzy =
        fit.dynamics.fuzzy().map(|f| super::fuzzy_study::fuzzy_study(plan, &method.name, f));
    for measured in &plan.recordings {
        out.performance.push(performance(plan, &*fit.dynamics, &measured.recording)?);
    }
    Ok(out)
}

fn correlations(covariance: &nalgebra::DMatrix<f64>) -> Vec<Vec<f64>> {
    let n = covariance.nrows();
    let scale: Vec<f64> = (0..n).map(|j| covariance[(j, j)].sqrt()).collect();
    (0..n).map(|i| (0..n).map(|j| covariance[(i, j)] / (scale[i] * scale[j])).collect()).collect()
}

fn performance(
    plan: &Plan,
    dynamics: &dyn Dynamics,
    recording: &Recording,
) -> Result<Performance, SimulateError> {
    let simulated = simulate_recording(dynamics, recording, plan.hold)?;
    let emulated = |structure| emulate(dynamics, recording, &plan.gain, structure, plan.hold);
    let total = |states: &Result<Vec<State>, SimulateError>| {
        states.as_ref().map_or(f64::INFINITY, |s| ise(recording, s).iter().sum())
    };
    let parallel = emulated(Structure::Parallel);
    let serial = emulated(Structure::SerialParallel);
    let speeds = |states: &[State]| states.iter().map(|s| s.omega).collect();
    Ok(Performance {
        ise: ise(recording, &simulated.free),
        window_rms: window_rms(recording, &simulated.windows),
        angle_rms: angle_rms(recording, &simulated.free),
        ise_parallel: total(&parallel),
        ise_serial_parallel: total(&serial),
        free: speeds(&simulated.free),
        windows: speeds(&simulated.windows),
        window_starts: simulated.window_starts,
        window_states: simulated.window_states.iter().map(models::four).collect(),
        emulator: parallel.map_or(vec![], |states| states.iter().map(models::four).collect()),
    })
}
