//! From the result of the search to the verdict.

use super::Basis;
use super::concluded::Concluded;
use super::formula::{Trial, curves_of, residual_torques};
use crate::compare::{Curve, WindowFloor};
use crate::diagnose::{Diagnosis, Judge, THRESHOLDS, WindowFit, cutoff, mobility};
use crate::model::base::A1;
use crate::recording::Recording;
use crate::simulate::SimulateError;
use crate::study::{DiagnosisStudy, Undetermined};

/// A diagnosis without effects that only approximate something outside the catalogue.
pub(crate) struct Settled {
    diagnosis: Diagnosis,
    /// The formula for the residual torque, if already tried.
    trial: Option<Trial>,
}

impl Settled {
    /// Removes the effects found if the model with them is far above the noise floor, and a formula for the
    /// residual torque in their place gives a better model. `floor`: that of the judged recordings under the
    /// model as given, if already known.
    pub(crate) fn of(diagnosis: Diagnosis, basis: &Basis, floor: Option<WindowFloor>) -> Self {
        if diagnosis.steps.is_empty() {
            return Self { diagnosis, trial: None };
        }
        let judge = Judge::new(basis.judged().to_vec(), basis.hold);
        let WindowFit { model, p, .. } = &diagnosis.base;
        let floor = floor.unwrap_or_else(|| judge.floor(model, p));
        if !judge.errors(&diagnosis, floor, basis.train).is_ok_and(|errors| errors.far_above_all())
        {
            return Self { diagnosis, trial: None };
        }
        match Trial::of(&curves(&diagnosis, basis), &diagnosis, basis) {
            Some(trial) if trial.in_place && trial.explains(floor.expected) => {
                let rest = diagnosis.ranking.clone();
                Self { diagnosis: Diagnosis { steps: vec![], rest, ..diagnosis }, trial: None }
            }
            trial => Self { diagnosis, trial },
        }
    }

    /// The diagnosis without effects that only approximate a formula.
    pub(crate) fn diagnosis(&self) -> &Diagnosis {
        &self.diagnosis
    }

    /// Residual torque of its models over the variables.
    pub(crate) fn curves(&self, basis: &Basis) -> Vec<Curve> {
        curves(&self.diagnosis, basis)
    }

    /// The verdict, with the `curves` of the residual torque. `floor`: that of the judged recordings under
    /// the last model, if already known.
    ///
    /// # Errors
    /// The mass matrix is not positive definite, or the motion diverges.
    pub(crate) fn verdict(
        self,
        curves: &[Curve],
        basis: &Basis,
        floor: Option<WindowFloor>,
    ) -> Result<DiagnosisStudy, SimulateError> {
        let Self { diagnosis, trial } = self;
        // for a second mass the curves do not show the remaining error, because the torque balance does not
        // contain it
        let shows = diagnosis.steps.is_empty() || curves.iter().any(|c| c.share_after.is_some());
        let curves = if shows { curves } else { &[] };
        let stands = |why: &Undetermined| {
            *why != Undetermined::Columns || !identifies_inertia(diagnosis.last())
        };
        let undetermined = basis.undetermined.filter(stands);
        let concluded = Concluded::of((&diagnosis, curves), basis, floor, undetermined)?;
        let dependence = concluded.dependence(curves);
        let tried = || trial.or_else(|| Trial::of(curves, &diagnosis, basis));
        let trial = dependence.is_some().then(tried).flatten();
        let trial = trial.filter(|trial| trial.explains(concluded.floor));
        concluded.study(dependence, trial.map(Trial::study))
    }
}

/// Residual torque of the model as given, and of the model with the effects found, over the variables.
fn curves(diagnosis: &Diagnosis, basis: &Basis) -> Vec<Curve> {
    let recordings: Vec<&Recording> = basis.train.iter().chain(basis.validation).collect();
    let (base, last) = (&diagnosis.base, diagnosis.last());
    let cutoff = cutoff(&recordings, mobility(&base.model, &base.p));
    let of =
        |fit: &WindowFit| residual_torques(&fit.model, &fit.p, &recordings, basis.hold, cutoff);
    let after = (!diagnosis.steps.is_empty()).then(|| of(last));
    curves_of(diagnosis, &recordings, basis.hold, cutoff, &of(base), after.as_deref())
}

/// Whether a fit identifies a1: its 95 % interval contains only positive values.
fn identifies_inertia(fit: &WindowFit) -> bool {
    fit.p[A1] > THRESHOLDS.uncertain * fit.covariance[(A1, A1)].sqrt()
}
