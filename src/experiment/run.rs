//! From a plan to a study: fit, compare, diagnose.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::error::RunError;
use super::plan::{Measured, MethodPlan, Plan};
use crate::compare::{
    failures, ise, missing_moment, noise_floor, simulate_recording, window_errors, window_rms,
};
use crate::identify::kalman::{Likelihood, prepare};
use crate::identify::{Fit, Task};
use crate::recording::{LocalMotion, Recording};
use crate::robot::{State, kinematics};
use crate::simulate::{Dynamics, PhysicalDynamics, SimulateError, Structure, emulate};
use crate::study::{MethodStudy, Performance, RecordingStudy, Role, Study};

/// Methods in the order in which their fit is preferred for the detailed comparison.
const PREFERRED: [&str; 4] = ["prediction_error", "weak_form", "output_error", "torque_regression"];

/// Runs an experiment.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn run(plan: &Plan) -> Result<Study, RunError> {
    let (mut study, right) = compare(plan)?;
    locate(plan, &*right, &mut study)?;
    if let Some(asked) = &plan.diagnosis {
        study.diagnosis = Some(super::diagnosis::run_diagnosis(plan, asked, &study)?);
    }
    Ok(study)
}

/// Fits every method and measures its error; returns the dynamics of the reference fit too.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub(super) fn compare(plan: &Plan) -> Result<(Study, Arc<dyn Dynamics>), RunError> {
    let motions: Vec<Vec<LocalMotion>> =
        plan.recordings.par_iter().map(|m| m.recording.local_motion()).collect();
    let train = plan.of(Role::Train);
    let fits: Vec<(Result<Fit, String>, f64)> =
        plan.methods.iter().map(|method| fit(plan, method, &train)).collect();
    let reference = reference(&fits);
    let Some(reference) = reference else {
        let reasons: Vec<String> =
            fits.iter().filter_map(|(fit, _)| fit.as_ref().err().cloned()).collect();
        return Err(RunError::NoFit { reasons: reasons.join("; ") });
    };
    let right: Arc<dyn Dynamics> = match &fits[reference].0 {
        Ok(fit) => fit.dynamics.clone(),
        Err(_) => unreachable!("the reference is a fit"),
    };
    let recordings = plan
        .recordings
        .par_iter()
        .zip(&motions)
        .map(|(measured, motion)| describe(plan, measured, motion, &*right))
        .collect::<Result<Vec<_>, _>>()?;
    let methods: Vec<MethodStudy> = plan
        .methods
        .par_iter()
        .zip(&fits)
        .map(|(method, (fit, seconds))| method_study(plan, method, fit, *seconds, &motions))
        .collect::<Result<_, _>>()?;
    let study = Study {
        experiment: plan.name.clone(),
        title: plan.title.clone(),
        version: env!("CARGO_PKG_VERSION").into(),
        seed: plan.seed,
        file: plan.file.clone(),
        robot: plan.model.robot().name.clone(),
        effects: plan.model.added_ids(),
        drive_unit: train[0].drive_unit(),
        recordings,
        methods,
        reference: Some(reference),
        emulator_gain: plan.gain.0[2][2],
        failures: vec![],
        missing_moment: None,
        diagnosis: None,
        versions: vec![],
        truth: plan.truth.clone(),
        model_out: None,
    };
    Ok((study, right))
}

fn fit(plan: &Plan, method: &MethodPlan, train: &[Recording]) -> (Result<Fit, String>, f64) {
    let task = Task { model: &plan.model, train, hold: plan.hold, seed: plan.seed };
    let start = Instant::now();
    let fit =
        super::long::identify(&*method.method, &task, &plan.long()).map_err(|e| e.to_string());
    (fit, start.elapsed().as_secs_f64())
}

/// The fit that is shown in detail: the preferred physical one, else the first there is.
fn reference(fits: &[(Result<Fit, String>, f64)]) -> Option<usize> {
    let named = |name: &str| {
        fits.iter().position(|(fit, _)| {
            fit.as_ref().is_ok_and(|f| f.method == name && f.dynamics.physical().is_some())
        })
    };
    PREFERRED
        .iter()
        .find_map(|name| named(name))
        .or_else(|| {
            fits.iter().position(|(f, _)| f.as_ref().is_ok_and(|f| f.dynamics.physical().is_some()))
        })
        .or_else(|| fits.iter().position(|(fit, _)| fit.is_ok()))
}

fn describe(
    plan: &Plan,
    measured: &Measured,
    motion: &[LocalMotion],
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
        findings: measured.findings.clone(),
        floor: noise_floor(right, r, motion, plan.hold, plan.seed)?,
        t: r.t().to_vec(),
        alpha: r.alpha().to_vec(),
        omega: r.omega().to_vec(),
        acceleration: motion.iter().map(|m| m.acceleration).collect(),
        moment: r.moment().to_vec(),
        regimes: r.regimes(motion),
        path: kinematics::path(plan.model.robot(), r.alpha()),
    })
}

fn method_study(
    plan: &Plan,
    method: &MethodPlan,
    fit: &Result<Fit, String>,
    seconds: f64,
    motions: &[Vec<LocalMotion>],
) -> Result<MethodStudy, SimulateError> {
    let mut out = MethodStudy {
        name: method.name.clone(),
        title: method.title.clone(),
        options: method.options.clone(),
        failure: None,
        status: None,
        seconds,
        work: crate::identify::Work::default(),
        estimates: vec![],
        correlations: vec![],
        notes: vec![],
        traces: vec![],
        performance: vec![],
        fuzzy: None,
    };
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
    out.notes.clone_from(&fit.notes);
    out.traces.clone_from(&fit.traces);
    out.correlations = fit.covariance.as_ref().map_or(vec![], correlations);
    out.fuzzy = fit.dynamics.fuzzy().map(super::fuzzy_study::fuzzy_study);
    for (measured, motion) in plan.recordings.iter().zip(motions) {
        out.performance.push(performance(plan, &*fit.dynamics, &measured.recording, motion)?);
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
    motion: &[LocalMotion],
) -> Result<Performance, SimulateError> {
    let simulated = simulate_recording(dynamics, recording, motion, plan.hold)?;
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
        ise_parallel: total(&parallel),
        ise_serial_parallel: total(&serial),
        free: speeds(&simulated.free),
        windows: speeds(&simulated.windows),
        emulator: parallel.map_or(vec![], |states| {
            states.iter().map(|s| [s.alpha[0], s.alpha[1], s.omega[0], s.omega[1]]).collect()
        }),
    })
}

/// Where the reference fit fails, on the judged recordings.
fn locate(plan: &Plan, right: &dyn Dynamics, study: &mut Study) -> Result<(), RunError> {
    let Some((model, p)) = right.physical() else { return Ok(()) };
    let judged = plan.judged();
    let likelihood = Likelihood {
        prepared: judged.iter().map(prepare).collect(),
        hold: plan.hold,
        slow_moment: true,
        timing: false,
    };
    let (noise, _) = likelihood.noise(model, p, &likelihood.initial_noise());
    let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
    let mut errors = Vec::new();
    for recording in &judged {
        let motion = recording.local_motion();
        let simulated = simulate_recording(&dynamics, recording, &motion, plan.hold)?;
        errors.push(window_errors(recording, &simulated.windows));
    }
    let floors: Vec<f64> =
        study.judged().iter().map(|&r| study.recordings[r].floor.window_rms).collect();
    study.failures = failures(model, p, &noise, &likelihood, &errors, &floors)?;
    study.missing_moment = Some(missing_moment(model, p, &noise, &likelihood)?);
    Ok(())
}
