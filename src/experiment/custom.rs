//! Effects written as formulas in the experiment file.

use super::file::CustomEntry;
use crate::effects::Effect;

/// The effect of a `[[model.custom]]` block.
///
/// # Errors
/// In words, what is wrong with the formula or its parameters.
pub(super) fn effect(entry: &CustomEntry) -> Result<Box<dyn Effect>, String> {
    Err(format!("model.custom: `{}` is not supported yet", entry.id))
}
