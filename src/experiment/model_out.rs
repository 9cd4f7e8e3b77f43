//! The identified model as files beside the report.

use super::plan::Plan;
use crate::export::{Identified, Written, files};
use crate::study::Study;

/// What is written of the reference fit: the best physical one, or a fuzzy system where no fit is physical.
pub(super) fn model_out(plan: &Plan, study: &Study) -> Option<Written> {
    let method = study.reference_method()?;
    if let Some(fuzzy) = &method.fuzzy {
        return Some(Written { files: fuzzy.functions.clone(), obstacles: vec![] });
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
        drive_unit: study.drive_unit.symbol(),
        hold: plan.hold,
        experiment: &study.experiment,
        method: &method.name,
        missing: study.diagnosis.as_ref().map_or(&[], |d| d.found.as_slice()),
    }))
}
