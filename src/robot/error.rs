//! Errors in the data of a robot.

use thiserror::Error;

/// A robot whose data cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RobotError {
    /// A construction value is not a finite number in its range.
    #[error("robot: {key} = {found:?}, expected {expected}; {key} is the {meaning}")]
    Value {
        /// Key of the experiment file, for example `l1_m`.
        key: &'static str,
        /// Meaning of the key.
        meaning: &'static str,
        /// Value found, in the unit of the key.
        found: f64,
        /// Allowed range as text.
        expected: &'static str,
    },
    /// The two wheels have different masses, which eq. (15) does not allow.
    #[error(
        "robot: m2_kg = {m2}, expected m1_kg = {m1}: the equations hold for equal wheels; give \
         both the mean mass and add the lateral centre of mass as an effect for the difference"
    )]
    UnequalWheels {
        /// Mass of wheel 1 \[kg\].
        m1: f64,
        /// Mass of wheel 2 \[kg\].
        m2: f64,
    },
}
