//! The key that gives a model the effects of its input.

use crate::effects;
use crate::recording::DriveUnit;

/// `effects = ["back_emf"]`: the effects that belong to every model with an input in this unit.
pub(super) fn effects_of(unit: DriveUnit) -> String {
    let ids: Vec<String> =
        effects::belonging_to(unit).iter().map(|id| format!("\"{id}\"")).collect();
    format!("effects = [{}]", ids.join(", "))
}
