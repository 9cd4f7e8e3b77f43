//! The models that an experiment ended with: the one that was asked for, and the one with the effects
//! that the diagnosis found.

use nalgebra::DMatrix;

use super::custom::add;
use super::plan::Plan;
use crate::diagnose::INPUT_SHIFT;
use crate::identify::Estimate;
use crate::model::{Model, ModelError};
use crate::study::{DiagnosisStudy, Study};

/// A model with the values that were identified.
#[derive(Clone, Debug)]
pub struct FittedModel {
    /// Effects with what is fixed of their parameters.
    pub model: Model,
    /// One estimate a parameter, in the order of the model.
    pub estimates: Vec<Estimate>,
    /// Their covariance; infinite where a parameter is not identifiable, zero where it is fixed.
    pub covariance: DMatrix<f64>,
    /// The recorded input acts so much later than recorded, within what logging explains \[s\].
    pub input_shift_s: f64,
    /// The method that found the values.
    pub method: String,
}

impl FittedModel {
    /// Of the model of a plan with `added` effects, from estimates with their correlations; `None` if a parameter has
    /// no estimate.
    ///
    /// # Errors
    /// Effects that neither the catalogue nor the plan has.
    pub(super) fn new(
        plan: &Plan,
        added: &[String],
        estimates: &[Estimate],
        correlations: &[Vec<f64>],
        method: &str,
    ) -> Result<Option<Self>, ModelError> {
        let mut model = plan.model.clone();
        for id in added {
            model = add(&model, id, &plan.own)?;
        }
        let place = |symbol: &str| estimates.iter().position(|e| e.symbol == symbol);
        let places: Option<Vec<usize>> = model.symbols().iter().map(|s| place(s)).collect();
        let input_shift_s = place(INPUT_SHIFT).map_or(0.0, |k| estimates[k].value);
        let method = method.to_owned();
        Ok(places.map(|places| {
            let covariance = covariance(estimates, correlations, &places);
            let estimates = places.iter().map(|&k| estimates[k].clone()).collect();
            Self { model, estimates, covariance, input_shift_s, method }
        }))
    }

    /// One value a parameter.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|e| e.value).collect()
    }
}

/// Covariance of some of the estimates; those without a correlation count as independent.
fn covariance(estimates: &[Estimate], correlations: &[Vec<f64>], places: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(places.len(), places.len(), |i, j| {
        let (i, j) = (places[i], places[j]);
        let errors = estimates[i].std_error * estimates[j].std_error;
        let stated = correlations.get(i).and_then(|row| row.get(j)).filter(|c| c.is_finite());
        match (i == j, stated) {
            (true, _) => errors,
            (false, Some(correlation)) if errors.is_finite() => correlation * errors,
            (false, _) => 0.0,
        }
    })
}

/// The models of a finished experiment.
#[derive(Clone, Debug)]
pub struct FittedModels {
    /// The model that was asked for, fitted by the reference method.
    pub given: FittedModel,
    /// The model with the effects that the diagnosis found, if it found any.
    pub found: Option<FittedModel>,
}

impl FittedModels {
    /// The models of a study of `plan`; `None` where no method identified a physical model.
    ///
    /// # Errors
    /// Effects that neither the catalogue nor the plan has.
    pub fn of(plan: &Plan, study: &Study) -> Result<Option<Self>, ModelError> {
        let Some(method) = study.reference_method() else { return Ok(None) };
        let given =
            FittedModel::new(plan, &[], &method.estimates, &method.correlations, &method.name)?;
        let diagnosis = study.diagnosis.as_ref().filter(|d| !d.found.is_empty());
        let of = |d: &DiagnosisStudy| {
            let estimates: Vec<_> = d.parameters.iter().map(|p| p.estimate.clone()).collect();
            FittedModel::new(plan, &d.found, &estimates, &d.correlations, "diagnosis")
        };
        let found = diagnosis.map(of).transpose()?;
        Ok(given.map(|given| Self { given, found: found.flatten() }))
    }

    /// The model with all that is known.
    #[must_use]
    pub fn last(&self) -> &FittedModel {
        self.found.as_ref().unwrap_or(&self.given)
    }
}
