//! The final models of an experiment: the one of the file, and the one with the effects found by the
//! diagnosis.

use super::custom::add;
use super::plan::Plan;
use crate::diagnose::INPUT_SHIFT;
use crate::identify::Estimate;
use crate::model::{Model, ModelError};
use crate::study::{DiagnosisStudy, Study};

/// A model with its identified values.
#[derive(Clone, Debug)]
pub struct FittedModel {
    /// The model, including fixed parameters.
    pub model: Model,
    /// One estimate per parameter, in the order of the model.
    pub estimates: Vec<Estimate>,
    /// Shift of the input that logging explains: the input acts this much later than recorded \[s\].
    pub input_shift_s: f64,
    /// The method that estimated the values.
    pub method: String,
}

impl FittedModel {
    /// The model of a plan with `added` effects; `None` if a parameter has no estimate.
    ///
    /// # Errors
    /// Effects that are neither in the catalogue nor in the plan.
    pub(super) fn new(
        plan: &Plan,
        added: &[String],
        estimates: &[Estimate],
        method: &str,
    ) -> Result<Option<Self>, ModelError> {
        let mut model = plan.model.clone();
        for id in added {
            model = add(&model, id, &plan.own)?;
        }
        let of = |symbol: &String| estimates.iter().find(|e| e.symbol == *symbol).cloned();
        let found: Option<Vec<Estimate>> = model.symbols().iter().map(of).collect();
        let shift = of(&INPUT_SHIFT.to_owned()).map_or(0.0, |e| e.value);
        let method = method.to_owned();
        Ok(found.map(|estimates| Self { model, estimates, input_shift_s: shift, method }))
    }

    /// One value per parameter.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|e| e.value).collect()
    }
}

/// The models of a completed experiment.
#[derive(Clone, Debug)]
pub struct FittedModels {
    /// The model of the file, fitted by the reference method.
    pub given: FittedModel,
    /// The model with the effects found by the diagnosis, if any.
    pub found: Option<FittedModel>,
}

impl FittedModels {
    /// The models of a study of `plan`; `None` if no method identified a physical model.
    ///
    /// # Errors
    /// Effects that are neither in the catalogue nor in the plan.
    pub fn of(plan: &Plan, study: &Study) -> Result<Option<Self>, ModelError> {
        let Some(method) = study.reference_method() else { return Ok(None) };
        let given = FittedModel::new(plan, &[], &method.estimates, &method.name)?;
        let diagnosis = study.diagnosis.as_ref().filter(|d| !d.found.is_empty());
        let of = |d: &DiagnosisStudy| {
            let estimates: Vec<_> = d.parameters.iter().map(|p| p.estimate.clone()).collect();
            FittedModel::new(plan, &d.found, &estimates, "diagnosis")
        };
        let found = diagnosis.map(of).transpose()?;
        Ok(given.map(|given| Self { given, found: found.flatten() }))
    }

    /// The most complete model.
    #[must_use]
    pub fn last(&self) -> &FittedModel {
        self.found.as_ref().unwrap_or(&self.given)
    }
}
