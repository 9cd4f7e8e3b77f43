//! A formula for the residual torque, as a custom effect.

use std::collections::BTreeMap;

use serde::Serialize;

/// A formula for the residual torque, fitted in the model. Its first five fields are those of a
/// `[[model.custom]]` block.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FormulaStudy {
    /// Name of the effect.
    pub id: String,
    /// Description in words.
    pub description: String,
    /// Resisting torque on wheel 1.
    pub torque1: String,
    /// The same on wheel 2.
    pub torque2: Option<String>,
    /// Its parameters by symbol.
    pub parameters: BTreeMap<String, Coefficient>,
    /// The block as text.
    pub toml: String,
    /// Whether it replaces the effects found instead of being added to them.
    pub in_place: bool,
    /// 2 s simulation error on the judged recordings with it [rad/s].
    pub window_rms: f64,
}

/// A parameter of a formula.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coefficient {
    /// SI unit, with the unit of the input in place of N m.
    pub unit: String,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Typical value.
    pub typical: f64,
}
