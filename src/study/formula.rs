//! A dependence of the residual torque as an effect of the user's own.

use std::collections::BTreeMap;

use serde::Serialize;

/// A formula over what the residual torque depends on, tried in the model. Its first five fields are those of a
/// `[[model.custom]]` block.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FormulaStudy {
    /// Name of the effect.
    pub id: String,
    /// What it is, in words.
    pub description: String,
    /// Resisting torque on wheel 1.
    pub torque1: String,
    /// The same on wheel 2.
    pub torque2: Option<String>,
    /// Its parameters by symbol.
    pub parameters: BTreeMap<String, Coefficient>,
    /// The block as text.
    pub toml: String,
    /// Whether the model has it in place of what was found, not beside that.
    pub in_place: bool,
    /// 2 s simulation error on the judged recordings of the model with it [rad/s].
    pub window_rms: f64,
}

/// A parameter of a formula.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coefficient {
    /// SI unit, with that of the input in place of N m.
    pub unit: String,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Typical value.
    pub typical: f64,
}
