//! Limits of conditioning and import that decide what is reported or which column is used, with their reasons.

mod angles;
mod inputs;
mod samples;
mod speeds;
mod times;

pub(super) use angles::ANGLES;
use angles::Angles;
pub(super) use inputs::INPUTS;
use inputs::Inputs;
pub(super) use samples::SAMPLES;
use samples::Samples;
pub(super) use speeds::SPEEDS;
use speeds::Speeds;
pub(super) use times::TIMES;
use times::Times;

/// Limits by which faults of sensors and loggers are distinguished from motion. All are dimensionless, or counts of rows
/// and windows. Those marked "judgement" are choices; the others follow from statistics or physics.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ConditioningThresholds {
    /// Time stamps, rows and empty cells.
    pub times: Times,
    /// Wheel angles, alone and beside the speeds.
    pub angles: Angles,
    /// Wrong samples, and sensors without a new value.
    pub samples: Samples,
    /// Speeds: counts of an encoder, rests and delays.
    pub speeds: Speeds,
    /// Inputs: magnitudes, offsets and held values.
    pub inputs: Inputs,
}

/// The limits in use.
pub const CONDITIONING: ConditioningThresholds = ConditioningThresholds {
    times: TIMES,
    angles: ANGLES,
    samples: SAMPLES,
    speeds: SPEEDS,
    inputs: INPUTS,
};

/// Limits of conditioning and import. The ending of a name is its unit (`_s`, `_hz`); the others are dimensionless. Those
/// marked "judgement" are choices of what is worth reporting.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ImportThresholds {
    /// Smallest relative deviation of a speed from the slope of its angle that is reported: a rounded encoder constant or
    /// wheel radius causes less (judgement).
    pub gain_off: f64,
    /// Number of standard errors by which that gain must deviate: those of a mean of ten windows exceed it by chance in
    /// one of a thousand channels (Student's t), those of many windows in one of a million.
    pub gain_errors: f64,
    /// Largest relative error of the inertia for which currents are used before voltages (judgement: as accurate as a
    /// torque constant is known). A voltage is held from row to row, and the current falls meanwhile, as the motor gains
    /// speed; one sample a row does not show by how much. The error is half a row over the mechanical time constant of the
    /// motor.
    pub sampled_error: f64,
    /// Mechanical time constant in seconds of a motor with its wheel for that limit, of which a log states nothing before
    /// a fit: geared motors of robots have 0.02 to 0.1 s. With 0.04 s currents are used from 500 rows per second on.
    pub motor_s: f64,
    /// Fastest rate in hertz at which rows of a robot are logged: that of a current controller.
    pub fastest_hz: f64,
    /// Ratio of the rate of the rows to the fastest above which the unit that the name of the time states is wrong. A wrong
    /// unit changes the rate by a factor of a thousand, so that the limit is no matter of precision: half as fast again
    /// admits loggers beyond those known.
    pub impossible: f64,
    /// Number of standard errors within which the smoothing of a speed that is late must be that of a delay, and by which
    /// that of a moving average must be excluded: a delay fails by chance in one of 400 logs, for noise of normal
    /// distribution.
    pub delay_errors: f64,
    /// Smoothing of a speed that sampling causes, as a variance in squares of a row: a sixth by the trapezoids of its integral,
    /// a twelfth by a sensor that counts over one row.
    pub sampled_smoothing: f64,
    /// Part of its full scale by which a command at its limit may differ from it: one of ten bits.
    pub full_scale: f64,
    /// Part of the successive values of a column that may be equal although a cell is written only when the value changes:
    /// a coarse value that changes and returns between two rows is written, and so is a counter that a program sets to zero
    /// where it is zero (judgement; 0.29 in a recording of ten rows per second).
    pub unchanged_written: f64,
    /// Time without a value, in steps between successive ones, from which on a column rests: a coarse sensor of a slow
    /// wheel changes every second or third row, and stamps scatter (judgement).
    pub unchanged_rows: f64,
}

/// The limits in use.
pub const IMPORT: ImportThresholds = ImportThresholds {
    gain_off: 0.02,
    gain_errors: 5.0,
    sampled_error: 0.025,
    motor_s: 0.04,
    fastest_hz: 2e4,
    impossible: 1.5,
    delay_errors: 3.0,
    sampled_smoothing: 0.25,
    full_scale: 0.001,
    unchanged_written: 0.35,
    unchanged_rows: 3.5,
};
