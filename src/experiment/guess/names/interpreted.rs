//! Possible interpretations of a name.

/// Quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::experiment::guess) enum Quantity {
    Time,
    Nanoseconds,
    Angle,
    Speed,
    Torque,
    Current,
    Voltage,
}

/// A wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::experiment::guess) enum Side {
    Right,
    Left,
    /// A number or letter without known meaning: 0 or 1.
    Numbered(usize),
}

/// Interpretation of a name.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::experiment::guess) struct Named {
    pub(in crate::experiment::guess) quantity: Option<Quantity>,
    /// The word that determines the quantity; empty if the unit does.
    pub(in crate::experiment::guess) word: String,
    pub(in crate::experiment::guess) side: Option<Side>,
    pub(in crate::experiment::guess) unit: Option<&'static str>,
    /// Units of the value: 10 of `current_10mA`.
    pub(in crate::experiment::guess) scale: Option<f64>,
    /// Whether it is a number per row.
    pub(in crate::experiment::guess) per_row: bool,
    /// Whether it is a command, and not a measurement.
    pub(in crate::experiment::guess) wished: bool,
    /// Whether it is the voltage of the battery.
    pub(in crate::experiment::guess) battery: bool,
    /// Whether it is the step between two rows.
    pub(in crate::experiment::guess) step: bool,
    /// Whether it is of another part of the robot, or of a sensor of distances.
    pub(in crate::experiment::guess) foreign: bool,
    /// The remaining words.
    pub(in crate::experiment::guess) rest: Vec<String>,
}
