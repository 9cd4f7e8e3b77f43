//! The fits that the report is about: the model as given and the model with what was found.

use rayon::prelude::*;

use super::error::RunError;
use super::plan::{Measured, Plan};
use crate::compare::{
    Floor, angle_rms, curves, failures, horizons, ise, noise_floor, residual_torque,
    simulate_recording, whiteness, window_rms,
};
use crate::diagnose::{Diagnosis, WindowFit, cutoff, mobility};
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::State;
use crate::simulate::{Dynamics, PhysicalDynamics};
use crate::study::{ModelStudy, ParameterStudy, Performance, Study, parameters_of};

/// The study with the model of the reference fit, whose dynamics are `right`.
///
/// # Errors
/// A model that cannot be simulated.
pub(super) fn with_reference(
    plan: &Plan,
    study: Study,
    right: &dyn Dynamics,
) -> Result<Study, RunError> {
    let stage = Stage::new(plan, &study);
    let Some((model, p)) = right.physical() else {
        let given = Some(stage.other(right)?);
        return Ok(Study { given, ..study });
    };
    let cutoff = stage.cutoff(model, p);
    let mut given = stage.physical(model, p, cutoff)?;
    given.parameters = of_method(model, &study);
    let curves = stage.curves(model, cutoff, &given, None);
    Ok(Study { given: Some(given), curves, ..study })
}

/// The study with the models of the diagnosis, so that verdict, errors and figures are of one fit.
///
/// # Errors
/// A model that cannot be simulated.
pub(super) fn with_diagnosis(
    plan: &Plan,
    study: Study,
    diagnosis: &Diagnosis,
) -> Result<Study, RunError> {
    let stage = Stage::new(plan, &study);
    let unit = study.drive_unit;
    let (base, last) = (&diagnosis.base, diagnosis.last());
    let cutoff = stage.cutoff(&base.model, &base.p);
    let study_of = |fit: &WindowFit, found: &[String]| -> Result<ModelStudy, RunError> {
        let mut out = stage.physical(&fit.model, &fit.p, cutoff)?;
        out.effects = study.effects.iter().chain(found).cloned().collect();
        out.parameters = parameters_of(fit, unit);
        Ok(out)
    };
    let given = study_of(base, &[])?;
    let completed = match diagnosis.found().as_slice() {
        [] => None,
        found => Some(study_of(last, found)?),
    };
    // a second mass is no part of the torque balance
    let after = completed.as_ref().filter(|_| !last.model.is_coupled());
    let curves = stage.curves(&base.model, cutoff, &given, after);
    Ok(Study { given: Some(given), completed, curves, ..study })
}

/// Sets the noise floor of every recording to that of the model with what was found: noise of the input moves a
/// model that lacks something by another amount.
///
/// # Errors
/// A model that cannot move.
pub(super) fn floor_under(plan: &Plan, study: &mut Study, fit: &WindowFit) -> Result<(), RunError> {
    let dynamics = PhysicalDynamics { model: fit.model.clone(), p: fit.p.clone() };
    let under = |m: &Measured| noise_floor(&dynamics, &m.recording, plan.hold, plan.seed);
    let floors: Vec<Floor> = plan.recordings.par_iter().map(under).collect::<Result<_, _>>()?;
    study.recordings.iter_mut().zip(floors).for_each(|(r, floor)| r.floor = floor);
    Ok(())
}

/// The parameters of the reference method, with their effects.
fn of_method(model: &Model, study: &Study) -> Vec<ParameterStudy> {
    let Some(method) = study.reference_method() else { return vec![] };
    let known = model.parameters().iter();
    let with = |p: &crate::model::Parameter| {
        let estimate = method.estimates.iter().find(|e| e.symbol == p.spec.symbol)?;
        let (effect, meaning) = (p.effect.clone(), p.spec.meaning.clone());
        Some(ParameterStudy { effect, meaning, estimate: estimate.clone() })
    };
    known.filter_map(with).collect()
}

/// A state as (alpha1, alpha2, omega1, omega2).
pub(super) fn four(s: &State) -> [f64; 4] {
    [s.alpha[0], s.alpha[1], s.omega[0], s.omega[1]]
}

/// What the models of one experiment are judged on.
struct Stage<'a> {
    plan: &'a Plan,
    study: &'a Study,
    recordings: Vec<&'a Recording>,
    judged: Vec<usize>,
}

impl<'a> Stage<'a> {
    fn new(plan: &'a Plan, study: &'a Study) -> Self {
        let recordings: Vec<&Recording> = plan.recordings.iter().map(|m| &m.recording).collect();
        Self { plan, study, recordings, judged: study.judged() }
    }

    fn cutoff(&self, model: &Model, p: &[f64]) -> f64 {
        cutoff(&self.recordings, mobility(model, p))
    }

    /// Everything of a model but its parameters and effects.
    fn physical(&self, model: &Model, p: &[f64], cutoff: f64) -> Result<ModelStudy, RunError> {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        let torque = |r: &&Recording| residual_torque(model, p, r, cutoff);
        let residual_torque: Vec<_> = self.recordings.par_iter().map(torque).collect();
        let analysis = whiteness(model, p, &self.judged_recordings(), self.plan.hold)?;
        let mut out = self.other(&dynamics)?;
        out.effects.clone_from(&self.study.effects);
        out.failures = self.failures(&out.performance, &residual_torque);
        out.horizons.splice(0..0, analysis.one_row);
        out.whiteness = Some(analysis);
        out.residual_torque = residual_torque;
        Ok(out)
    }

    /// What can be said of any dynamics.
    fn other(&self, dynamics: &dyn Dynamics) -> Result<ModelStudy, RunError> {
        let hold = self.plan.hold;
        let one = |r: &&Recording| {
            let simulated = simulate_recording(dynamics, r, hold)?;
            Ok::<_, RunError>(Performance {
                ise: ise(r, &simulated.free),
                window_rms: window_rms(r, &simulated.windows),
                angle_rms: angle_rms(r, &simulated.free),
                ise_parallel: f64::NAN,
                ise_serial_parallel: f64::NAN,
                free: simulated.free.iter().map(|s| s.omega).collect(),
                windows: simulated.windows.iter().map(|s| s.omega).collect(),
                window_starts: simulated.window_starts,
                window_states: simulated.window_states.iter().map(four).collect(),
                emulator: vec![],
            })
        };
        let performance = self.recordings.par_iter().map(one).collect::<Result<_, _>>()?;
        let horizons = horizons(dynamics, &self.judged_recordings(), hold)?;
        Ok(ModelStudy { performance, horizons, ..ModelStudy::default() })
    }

    fn judged_recordings(&self) -> Vec<Recording> {
        self.judged.iter().map(|&r| self.recordings[r].clone()).collect()
    }

    fn failures(
        &self,
        performance: &[Performance],
        torque: &[Vec<[f64; 2]>],
    ) -> Vec<crate::compare::Failure> {
        let of = |r: usize| &self.study.recordings[r];
        let judged = || self.judged.iter().copied();
        let errors: Vec<Vec<[f64; 2]>> = judged()
            .map(|r| {
                let rows = self.recordings[r].omega().iter().zip(&performance[r].windows);
                rows.map(|(m, s)| [m[0] - s[0], m[1] - s[1]]).collect()
            })
            .collect();
        failures(
            &judged().map(|r| self.recordings[r]).collect::<Vec<_>>(),
            &judged().map(|r| of(r).regimes.clone()).collect::<Vec<_>>(),
            &judged().map(|r| torque[r].clone()).collect::<Vec<_>>(),
            &errors,
            &judged().map(|r| of(r).floor.window_rms).collect::<Vec<_>>(),
        )
    }

    fn curves(
        &self,
        model: &Model,
        cutoff: f64,
        before: &ModelStudy,
        after: Option<&ModelStudy>,
    ) -> Vec<crate::compare::Curve> {
        let after = after.map(|m| m.residual_torque.as_slice());
        curves(model, &self.recordings, cutoff, &before.residual_torque, after)
    }
}
