//! The identified model as files beside the report.

use super::comparison::Comparison;
use super::fitted::FittedModel;
use super::plan::Plan;
use crate::export::{ModelFiles, files};
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
    let fitted = FittedModel::new(plan, &[], &method.estimates, (&[], &[]), &method.name);
    let fitted = fitted.ok()??;
    let in_model = fitted.model.effect_ids();
    let found = diagnosis.into_iter().flat_map(|d| &d.found);
    let missing: Vec<String> = found.filter(|id| !in_model.contains(id)).cloned().collect();
    Some(files(&fitted.identified(plan, &fitted.columns(), &missing)))
}
