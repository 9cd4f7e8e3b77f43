//! The final models of an experiment: the one of the file, and the one with the effects found by the
//! diagnosis.

use nalgebra::DMatrix;

use super::custom::add;
use super::plan::Plan;
use crate::diagnose::INPUT_SHIFT;
use crate::export::Identified;
use crate::identify::Estimate;
use crate::model::{Model, ModelError};
use crate::study::{Combination, DiagnosisStudy, Study};

/// A model with its identified values.
#[derive(Clone, Debug)]
pub struct FittedModel {
    /// The model, including fixed parameters.
    pub model: Model,
    /// One estimate per parameter, in the order of the model.
    pub estimates: Vec<Estimate>,
    /// Their covariance; infinite where a parameter is not identifiable, zero where it is fixed.
    pub covariance: DMatrix<f64>,
    /// Shift of the input that logging explains: the input acts this much later than recorded \[s\].
    pub input_shift_s: f64,
    /// The method that estimated the values.
    pub method: String,
}

impl FittedModel {
    /// The model of a plan with `added` effects, from estimates with their correlations and the combinations that are
    /// identifiable where single parameters are not; `None` if a parameter has no estimate.
    ///
    /// # Errors
    /// Effects that are neither in the catalogue nor in the plan.
    pub(super) fn new(
        plan: &Plan,
        added: &[String],
        estimates: &[Estimate],
        (correlations, combinations): (&[Vec<f64>], &[Combination]),
        method: &str,
    ) -> Result<Option<Self>, ModelError> {
        let place = |symbol: &str| estimates.iter().position(|e| e.symbol == symbol);
        let estimated = |model: &Model| model.symbols().iter().all(|s| place(s).is_some());
        // a diagnosis starts from the model of the file, the methods fit a dead time too
        let of_method = Some(plan.fitted_model()).filter(|m| added.is_empty() && estimated(m));
        let mut model = of_method.unwrap_or_else(|| plan.model.clone());
        for id in added {
            model = add(&model, id, &plan.own)?;
        }
        let places: Option<Vec<usize>> = model.symbols().iter().map(|s| place(s)).collect();
        let input_shift_s = place(INPUT_SHIFT).map_or(0.0, |k| estimates[k].value);
        let method = method.to_owned();
        Ok(places.map(|places| {
            let mut covariance = covariance(estimates, correlations, &places);
            let estimates: Vec<_> = places.iter().map(|&k| estimates[k].clone()).collect();
            combinations.iter().for_each(|c| set_combination(&mut covariance, &estimates, c));
            Self { model, estimates, covariance, input_shift_s, method }
        }))
    }

    /// One value per parameter.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|e| e.value).collect()
    }

    /// Its estimates as columns.
    pub(super) fn columns(&self) -> Columns {
        Columns {
            values: self.values(),
            std_errors: self.estimates.iter().map(|e| e.std_error).collect(),
            units: self.estimates.iter().map(|e| e.unit.clone()).collect(),
        }
    }

    /// The model as the exports take it, with its [`FittedModel::columns`] and the ids of effects that it lacks.
    pub(super) fn identified<'a>(
        &'a self,
        plan: &'a Plan,
        columns: &'a Columns,
        missing: &'a [String],
    ) -> Identified<'a> {
        Identified {
            model: &self.model,
            values: &columns.values,
            std_errors: &columns.std_errors,
            units: &columns.units,
            drive_unit: plan.drive_unit(),
            hold: plan.hold,
            experiment: &plan.name,
            method: &self.method,
            missing,
        }
    }
}

/// Values, standard errors and units of the parameters of a model, in its order.
pub(super) struct Columns {
    pub(super) values: Vec<f64>,
    std_errors: Vec<f64>,
    units: Vec<String>,
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

/// Standard deviation across an identifiable combination of two parameters, relative to its value: none of the two is
/// known, but their covariance is finite.
const UNKNOWN: f64 = 100.0;

/// Sets the covariance of two parameters of which only a combination is identifiable.
///
/// ```text
/// C = s² u u'/(u'u)² + (UNKNOWN c)² o o',   u = (1, w),  o = (w, -1),   c, s: the combination and its standard error
/// ```
fn set_combination(covariance: &mut DMatrix<f64>, estimates: &[Estimate], of: &Combination) {
    let place = |symbol: &str| estimates.iter().position(|e| e.symbol == symbol);
    let (Some(i), Some(j)) = (place(&of.first), place(&of.second)) else { return };
    // a fit with the second parameter fixed has the standard error of the combination in the first
    let own = estimates[i].std_error;
    let error = if own.is_finite() && own > 0.0 { own } else { of.std_error };
    let (known, open) = ([1.0, of.weight], [of.weight, -1.0]);
    let square = 1.0 + of.weight.powi(2);
    for (a, &row) in [i, j].iter().enumerate() {
        covariance.row_mut(row).fill(0.0);
        covariance.column_mut(row).fill(0.0);
        for (b, &column) in [i, j].iter().enumerate().take(a + 1) {
            let along = (error / square).powi(2) * known[a] * known[b];
            let across = (UNKNOWN * of.value).powi(2) * open[a] * open[b];
            covariance[(row, column)] = along + across;
            covariance[(column, row)] = along + across;
        }
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
        let combinations = method.combinations();
        let among = (method.correlations.as_slice(), combinations.as_slice());
        let given = FittedModel::new(plan, &[], &method.estimates, among, &method.name)?;
        let diagnosis = study.diagnosis.as_ref().filter(|d| !d.found.is_empty());
        let of = |d: &DiagnosisStudy| {
            let estimates: Vec<_> = d.parameters.iter().map(|p| p.estimate.clone()).collect();
            let among = (d.correlations.as_slice(), combinations.as_slice());
            FittedModel::new(plan, &d.found, &estimates, among, "diagnosis")
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
