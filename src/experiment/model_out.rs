//! The identified model as files beside the report.

use super::comparison::Comparison;
use super::plan::Plan;
use crate::export::{Identified, ModelFiles, files};
use crate::study::DiagnosisStudy;

/// Files of the reference fit: the best physical one, or a fuzzy system if no fit is physical.
pub(super) fn model_out(
    plan: &Plan,
    comparison: &Comparison,
    diagnosis: Option<&DiagnosisStudy>,
) -> Option<ModelFiles> {
    let method = comparison.reference_method();
    if let Some(fuzzy) = &method.fuzzy {
        return Some(ModelFiles { files: fuzzy.functions.clone(), obstacles: vec![] });
    }
    let estimates = plan
        .model
        .symbols()
        .iter()
        .map(|symbol| method.estimates.iter().find(|e| e.symbol == *symbol))
        .collect::<Option<Vec<_>>>()?;
    let values: Vec<f64> = estimates.iter().map(|e| e.value).collect();
    let std_errors: Vec<f64> = estimates.iter().map(|e| e.std_error).collect();
    let units: Vec<String> = estimates.iter().map(|e| e.unit.clone()).collect();
    Some(files(&Identified {
        model: &plan.model,
        values: &values,
        std_errors: &std_errors,
        units: &units,
        drive_unit: plan.drive_unit(),
        hold: plan.hold,
        experiment: &plan.name,
        method: &method.name,
        missing: diagnosis.map_or(&[], |d| d.found.as_slice()),
    }))
}
