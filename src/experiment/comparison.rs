//! Comparison of the fits of a plan with its recordings.

use std::sync::Arc;

use rayon::prelude::*;

use super::contradiction::note_contradictions;
use super::error::RunError;
use super::fits::MethodFit;
use super::plan::{MeasuredRecording, MethodPlan, Plan};
use crate::compare::{
    Floor, angle_rms, ise, noise_floor, simulate_recording, window_floor, window_rms,
};
use crate::filter::noise_of_jumps;
use crate::identify::{self, Fit, IdentifyError};
use crate::math::correlations;
use crate::recording::{Noise, Recording};
use crate::robot::{State, kinematics};
use crate::simulate::{Dynamics, PhysicalDynamics, SimulateError, Structure, emulate};
use crate::study::{Judged, MethodStudy, Performance, RecordingStudy, Role, Undetermined};

/// The fits of a plan's methods with their errors on its recordings.
#[derive(Clone)]
pub struct Comparison {
    /// One entry per recording of the plan; the noise floor is that of the model to which the errors belong.
    pub recordings: Vec<RecordingStudy>,
    /// One entry per method of the plan.
    pub methods: Vec<MethodStudy>,
    /// The method whose fit is shown in detail.
    pub reference: usize,
    /// The fitted dynamics.
    pub(super) dynamics: Arc<dyn Dynamics>,
    /// Share of the changes of the inputs that is noise according to the model with the effects found, if there are any:
    /// a missing effect may look like noise.
    noise_of_jumps: Option<f64>,
}

impl Comparison {
    /// The method whose fit is shown in detail.
    #[must_use]
    pub fn reference_method(&self) -> &MethodStudy {
        &self.methods[self.reference]
    }

    /// Why the recordings do not determine the model, by the fits of the methods.
    pub(super) fn undetermined(&self) -> Option<Undetermined> {
        self.reference_method().undetermined_among(&self.methods)
    }

    /// The recordings on which errors are judged.
    #[must_use]
    pub fn judged(&self) -> Judged<'_> {
        Judged::of(&self.recordings)
    }

    /// The same with the noise floor of another model: the effect of input noise depends on the model, and so does how
    /// much of the changes of the input is noise.
    ///
    /// # Errors
    /// The mass matrix is not positive definite.
    pub(super) fn under(self, plan: &Plan, model: &PhysicalDynamics) -> Result<Self, RunError> {
        let mut train = plan.of(Role::Train);
        train.iter_mut().for_each(|r| r.set_noise_of_jumps(1.0));
        let given: Vec<&Recording> = train.iter().collect();
        let share = noise_of_jumps(&model.model, &model.p, &given, plan.hold);
        let mut out = Self { noise_of_jumps: Some(share), ..self };
        let under = |m: &MeasuredRecording| {
            let recording = out.with_noise(m.recording.clone());
            let floor = noise_floor(model, &recording, plan.hold, plan.seed)?;
            Ok((floor, recording.noise()))
        };
        let under: Vec<(Floor, Noise)> =
            plan.recordings.par_iter().map(under).collect::<Result<_, SimulateError>>()?;
        for (recording, (floor, noise)) in out.recordings.iter_mut().zip(under) {
            (recording.floor, recording.noise) = (floor, noise);
        }
        Ok(out)
    }

    /// The recordings of a role, with the noise of their inputs as far as it is known.
    pub(super) fn of(&self, plan: &Plan, role: Role) -> Vec<Recording> {
        plan.of(role).into_iter().map(|r| self.with_noise(r)).collect()
    }

    /// A recording with the noise of its input according to the model with the effects found.
    fn with_noise(&self, mut recording: Recording) -> Recording {
        if let Some(share) = self.noise_of_jumps {
            recording.set_noise_of_jumps(share);
        }
        recording
    }
}

/// Compares the fits, one per method of the plan, with its recordings: errors and noise floor.
///
/// # Errors
/// If no method has a fit, or nothing can be simulated.
pub fn compare(plan: &Plan, fits: &[MethodFit]) -> Result<Comparison, RunError> {
    let mut out = compare_in(plan, fits, Detail::Report)?;
    note_contradictions(&mut out.methods, out.reference, Judged::of(&out.recordings));
    Ok(out)
}

/// [`compare`] without what the rows of a grid do not contain: the noise floor of the free simulation, the errors of
/// emulators, and what only a report shows of a recording.
///
/// # Errors
/// As [`compare`].
pub(super) fn compare_figures(plan: &Plan, fits: &[MethodFit]) -> Result<Comparison, RunError> {
    compare_in(plan, fits, Detail::Figures)
}

/// The recordings and the methods of a plan none of whose fits can be simulated: without noise floor, which depends on
/// the model, and each method with the reason, `simulation` for a fit.
pub(super) fn without_fit(
    plan: &Plan,
    fits: &[MethodFit],
    simulation: Option<&SimulateError>,
) -> (Vec<RecordingStudy>, Vec<MethodStudy>) {
    let unknown = f64::NAN;
    let floor = Floor {
        ise: [unknown; 2],
        window_rms: unknown,
        window_most: unknown,
        window_slow: unknown,
    };
    let recordings = plan.recordings.iter();
    let recordings = recordings.map(|m| as_shown(plan, m, described(m, floor))).collect();
    let reason = |fit: &MethodFit| match (&fit.fit, simulation) {
        (Err(reason), _) => Some(reason.clone()),
        (Ok(_), Some(reason)) => Some(reason.clone().into()),
        (Ok(_), None) => None,
    };
    let row =
        |(method, fit): (&MethodPlan, &MethodFit)| Some(failed(method, reason(fit)?, fit.seconds));
    let methods = plan.methods.iter().zip(fits).filter_map(row).collect();
    (recordings, methods)
}

/// How much of a comparison is computed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Detail {
    Report,
    Figures,
}

fn compare_in(plan: &Plan, fits: &[MethodFit], detail: Detail) -> Result<Comparison, RunError> {
    let Some((reference, fit)) = reference(fits) else {
        return Err(RunError::NoFit(fits.iter().filter_map(|f| f.fit.clone().err()).collect()));
    };
    let dynamics = fit.dynamics.clone();
    let recordings = plan
        .recordings
        .par_iter()
        .map(|measured| describe(plan, measured, &*dynamics, detail))
        .collect::<Result<_, _>>()?;
    let methods = plan
        .methods
        .par_iter()
        .zip(fits)
        .map(|(method, MethodFit { fit, seconds })| {
            // a fit that cannot be simulated is reported like a failed one, with the reason
            let study = |fit: &_| method_study(plan, method, (fit, *seconds), detail);
            study(fit).or_else(|e| study(&Err(e.into())))
        })
        .collect::<Result<_, _>>()?;
    Ok(Comparison { recordings, methods, reference, dynamics, noise_of_jumps: None })
}

/// The fit that is shown in detail: the preferred physical one, otherwise the first.
fn reference<'a>(fits: &'a [MethodFit]) -> Option<(usize, &'a Fit)> {
    let made = || fits.iter().enumerate().filter_map(|(n, f)| Some((n, f.fit.as_ref().ok()?)));
    let physical = |fit: &Fit| fit.dynamics.physical().is_some();
    let ranked = |found: (usize, &'a Fit)| Some((identify::find(&found.1.method)?.rank()?, found));
    let all = made().filter(|(_, fit)| physical(fit)).filter_map(ranked);
    all.min_by_key(|(rank, _)| *rank)
        .map(|(_, found)| found)
        .or_else(|| made().find(|(_, fit)| physical(fit)))
        .or_else(|| made().next())
}

fn describe(
    plan: &Plan,
    measured: &MeasuredRecording,
    dynamics: &dyn Dynamics,
    detail: Detail,
) -> Result<RecordingStudy, SimulateError> {
    let floor = if detail == Detail::Report { noise_floor } else { window_floor };
    let floor = floor(dynamics, &measured.recording, plan.hold, plan.seed)?;
    let described = described(measured, floor);
    // the rows of a grid contain nothing of it, and it takes a fifth of the time of a cell
    Ok(match detail {
        Detail::Report => as_shown(plan, measured, described),
        Detail::Figures => described,
    })
}

/// With what only a report shows: the notes of the quality check, the regimes and the path.
fn as_shown(
    plan: &Plan,
    measured: &MeasuredRecording,
    described: RecordingStudy,
) -> RecordingStudy {
    let r = &measured.recording;
    RecordingStudy {
        notes: super::quality::notes(measured, plan.model.robot()),
        regimes: r.regimes(),
        path: path(plan, r),
        ..described
    }
}

/// A recording with the error of the correct model on it, without what [`as_shown`] adds.
fn described(measured: &MeasuredRecording, floor: Floor) -> RecordingStudy {
    let r = &measured.recording;
    RecordingStudy {
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
        notes: vec![],
        floor,
        t: r.t().to_vec(),
        alpha: r.alpha().to_vec(),
        omega: r.omega().to_vec(),
        torque: r.torque().to_vec(),
        regimes: vec![],
        path: vec![],
    }
}

/// The path of the robot, if its geometry is known.
fn path(plan: &Plan, r: &Recording) -> Vec<[f64; 3]> {
    let robot = plan.model.robot();
    if super::robot_table::has_no_track(robot) {
        vec![]
    } else {
        kinematics::path(robot, r.alpha())
    }
}

/// A method without a fit.
fn failed(method: &MethodPlan, reason: IdentifyError, seconds: f64) -> MethodStudy {
    let nothing = MethodStudy::new(&method.name, &method.title, &method.options, seconds);
    MethodStudy { failure: Some(reason), ..nothing }
}

fn method_study(
    plan: &Plan,
    method: &MethodPlan,
    (fit, seconds): (&Result<Fit, IdentifyError>, f64),
    detail: Detail,
) -> Result<MethodStudy, SimulateError> {
    let nothing = MethodStudy::new(&method.name, &method.title, &method.options, seconds);
    let fit = match fit {
        Ok(fit) => fit,
        Err(reason) => return Ok(failed(method, reason.clone(), seconds)),
    };
    let fuzzy = fit.dynamics.fuzzy();
    let on = |m: &MeasuredRecording| performance(plan, &*fit.dynamics, &m.recording, detail);
    Ok(MethodStudy {
        status: Some(fit.status),
        work: fit.work,
        estimates: fit.estimates.clone(),
        notes: fit.notes.clone(),
        traces: fit.traces.clone(),
        correlations: fit.covariance.as_ref().map_or(vec![], correlations),
        fuzzy: fuzzy.map(|f| super::fuzzy_study::fuzzy_study(plan, &method.name, f)),
        performance: plan.recordings.iter().map(on).collect::<Result<_, _>>()?,
        ..nothing
    })
}

fn performance(
    plan: &Plan,
    dynamics: &dyn Dynamics,
    recording: &Recording,
    detail: Detail,
) -> Result<Performance, SimulateError> {
    let simulated = simulate_recording(dynamics, recording, plan.hold)?;
    let emulated = |structure| match detail {
        Detail::Report => emulate(dynamics, recording, &plan.gain, structure, plan.hold).ok(),
        Detail::Figures => None,
    };
    let total = |states: &Option<Vec<State>>| {
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
        window_states: simulated.window_states.iter().map(four).collect(),
        emulator: parallel.map_or(vec![], |states| states.iter().map(four).collect()),
    })
}

/// A state as (alpha1, alpha2, omega1, omega2).
pub(super) fn four(s: &State) -> [f64; 4] {
    [s.alpha[0], s.alpha[1], s.omega[0], s.omega[1]]
}
