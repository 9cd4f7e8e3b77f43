//! Effects written as formulas in the experiment file.

use super::file::CustomEntry;
use crate::effects::{Custom, CustomDefinition, Effect, ParameterSpec};

/// The effect of a `[[model.custom]]` block.
///
/// # Errors
/// In words, what is wrong with the formula or its parameters.
pub(super) fn effect(entry: &CustomEntry) -> Result<Box<dyn Effect>, String> {
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
    Ok(Box::new(custom.map_err(|e| format!("[[model.custom]] {}: {e}", entry.id))?))
}
