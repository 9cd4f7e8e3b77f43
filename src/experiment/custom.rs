//! Effects defined by formulas in the experiment file.

use std::sync::Arc;

use super::file::CustomEntry;
use crate::effects::{Custom, CustomDefinition, Effect, ParameterSpec};
use crate::model::{Model, ModelError};

/// An effect defined in the file.
pub(super) type Own = Arc<dyn Effect>;

/// The effects of all `[[model.custom]]` blocks.
///
/// # Errors
/// Errors in a formula or its parameters, as text.
pub(super) fn effects(entries: &[CustomEntry]) -> Result<Vec<Own>, String> {
    entries.iter().map(effect).collect()
}

/// The model with one more effect, from `own` or from the catalogue.
///
/// # Errors
/// An effect that is in neither, or in the model already.
pub(super) fn add(model: &Model, id: &str, own: &[Own]) -> Result<Model, ModelError> {
    match own.iter().find(|effect| effect.id() == id) {
        Some(effect) => model.add_effect(effect.clone()),
        None => model.add(id),
    }
}

/// The effect of one block.
fn effect(entry: &CustomEntry) -> Result<Own, String> {
    let parameters = entry
        .parameters
        .iter()
        .map(|(symbol, p)| {
            let spec = if p.shape { ParameterSpec::shape } else { ParameterSpec::linear };
            spec(symbol, "of the custom formula", &p.unit, p.range, p.typical)
        })
        .collect();
    let definition = CustomDefinition {
        torque1: entry.torque1.clone(),
        torque2: entry.torque2.clone(),
        parameters,
        description: entry.description.clone(),
    };
    let custom = Custom::new(&entry.id, definition);
    Ok(Arc::new(custom.map_err(|e| format!("[[model.custom]] {}: {e}", entry.id))?))
}
