//! The fits on which the report is based: the model as given and the model with the effects found.

use rayon::prelude::*;

use super::comparison::{Comparison, four};
use super::error::RunError;
use super::plan::Plan;
use crate::compare::{
    Curve, Horizon, Unexplained, angle_rms, curves, failures, horizons, ise, simulate_recording,
    whiteness, window_rms,
};
use crate::diagnose::{Diagnosis, WindowFit, cutoff, mobility};
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{Dynamics, PhysicalDynamics};
use crate::study::{MethodStudy, ModelStudy, ParameterStudy, Performance, parameters_of};
use crate::verdict::{curves_of, residual_torques};

/// The fits on which the report is based.
pub(super) struct Models {
    /// The model as given.
    pub(super) given: ModelStudy,
    /// The model with the effects found by the diagnosis; `None` if there are none.
    pub(super) completed: Option<ModelStudy>,
    /// Residual torque of both models over the variables, for all recordings.
    pub(super) curves: Vec<Curve>,
}

impl Models {
    /// The most complete model.
    pub(super) fn last(&self) -> &ModelStudy {
        self.completed.as_ref().unwrap_or(&self.given)
    }
}

/// The model of the reference fit.
///
/// # Errors
/// A model that cannot be simulated.
pub(super) fn of_reference(plan: &Plan, comparison: &Comparison) -> Result<Models, RunError> {
    let stage = Stage::new(plan, comparison);
    let Some((model, p)) = comparison.dynamics.physical() else {
        let given = stage.other(&*comparison.dynamics)?;
        return Ok(Models { given, completed: None, curves: vec![] });
    };
    let cutoff = stage.cutoff(model, p);
    let parameters = of_method(model, comparison.reference_method());
    let given = stage.physical((model, p), parameters, model.added_ids(), cutoff)?;
    let before = Unexplained { model, p, hold: plan.hold, torque: &given.residual_torque };
    let curves = curves(&stage.recordings, cutoff, before, None);
    Ok(Models { given, completed: None, curves })
}

/// The models of a diagnosis, so that verdict, errors and figures belong to one fit.
///
/// # Errors
/// A model that cannot be simulated.
pub(super) fn of_diagnosis(
    plan: &Plan,
    comparison: &Comparison,
    diagnosis: &Diagnosis,
) -> Result<Models, RunError> {
    let stage = Stage::new(plan, comparison);
    let (base, last) = (&diagnosis.base, diagnosis.last());
    let cutoff = stage.cutoff(&base.model, &base.p);
    let study_of = |fit: &WindowFit, found: &[String]| -> Result<ModelStudy, RunError> {
        let parameters = parameters_of(fit, plan.drive_unit());
        let effects = [&plan.model.added_ids(), found].concat();
        stage.physical((&fit.model, &fit.p), parameters, effects, cutoff)
    };
    let given = study_of(base, &[])?;
    let completed = match diagnosis.found().as_slice() {
        [] => None,
        found => Some(study_of(last, found)?),
    };
    let after = completed.as_ref().map(|study| &study.residual_torque[..]);
    let curves =
        curves_of(diagnosis, &stage.recordings, plan.hold, cutoff, &given.residual_torque, after);
    Ok(Models { given, completed, curves })
}

/// The parameters of the reference method, with their effects.
fn of_method(model: &Model, method: &MethodStudy) -> Vec<ParameterStudy> {
    let known = model.parameters().iter();
    let with = |p: &crate::model::Parameter| {
        let estimate = method.estimates.iter().find(|e| e.symbol == p.spec.symbol)?;
        let (effect, meaning) = (p.effect.clone(), p.spec.meaning.clone());
        Some(ParameterStudy { effect, meaning, estimate: estimate.clone() })
    };
    known.filter_map(with).collect()
}

/// Data on which the models of an experiment are evaluated.
struct Stage<'a> {
    plan: &'a Plan,
    comparison: &'a Comparison,
    recordings: Vec<&'a Recording>,
    judged: Vec<usize>,
}

impl<'a> Stage<'a> {
    fn new(plan: &'a Plan, comparison: &'a Comparison) -> Self {
        let recordings: Vec<&Recording> = plan.recordings.iter().map(|m| &m.recording).collect();
        Self { plan, comparison, recordings, judged: comparison.judged().numbers() }
    }

    fn cutoff(&self, model: &Model, p: &[f64]) -> f64 {
        cutoff(&self.recordings, mobility(model, p))
    }

    /// A physical model with parameter values and the ids of its effects beyond the base.
    fn physical(
        &self,
        (model, p): (&Model, &[f64]),
        parameters: Vec<ParameterStudy>,
        effects: Vec<String>,
        cutoff: f64,
    ) -> Result<ModelStudy, RunError> {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        let residual_torque = residual_torques(model, p, &self.recordings, self.plan.hold, cutoff);
        let analysis = whiteness(model, p, &self.judged_recordings(), self.plan.hold)?;
        let (performance, horizons) = self.simulated(&dynamics)?;
        Ok(ModelStudy {
            effects,
            parameters,
            failures: self.failures(&performance, &residual_torque),
            performance,
            residual_torque,
            horizons: analysis.one_row.into_iter().chain(horizons).collect(),
            whiteness: Some(analysis),
        })
    }

    /// Results that are available for any dynamics.
    fn other(&self, dynamics: &dyn Dynamics) -> Result<ModelStudy, RunError> {
        let (performance, horizons) = self.simulated(dynamics)?;
        Ok(ModelStudy { performance, horizons, ..ModelStudy::default() })
    }

    /// The errors on every recording, and those of the judged recordings over simulations of different
    /// lengths.
    fn simulated(
        &self,
        dynamics: &dyn Dynamics,
    ) -> Result<(Vec<Performance>, Vec<Horizon>), RunError> {
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
        Ok((performance, horizons(dynamics, &self.judged_recordings(), hold)?))
    }

    fn judged_recordings(&self) -> Vec<Recording> {
        self.judged.iter().map(|&r| self.recordings[r].clone()).collect()
    }

    fn failures(
        &self,
        performance: &[Performance],
        torque: &[Vec<[f64; 2]>],
    ) -> Vec<crate::compare::Failure> {
        let of = |r: usize| &self.comparison.recordings[r];
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
}
