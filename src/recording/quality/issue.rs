//! Issues that the quality check may find.

mod joined;
mod unit;

use std::f64::consts::TAU;

pub(crate) use self::unit::{RatioUnit, UnitError};
use super::Gaps;
use crate::math::Span;
use crate::recording::DriveUnit;

/// Lowest rate that resolves starts and stops \[Hz\].
pub(crate) const SLOW: f64 = 20.0;
/// Shortest useful recording \[s\]: two windows of the simulation error.
pub(crate) const SHORT: f64 = 4.0;

/// Quantity measured by a channel of a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Quantity {
    /// Angle \[rad\].
    #[serde(rename = "alpha")]
    Angle,
    /// Speed [rad/s].
    #[serde(rename = "dalpha")]
    Speed,
    /// Torque, voltage or current of its motor.
    #[serde(rename = "M")]
    Input,
}

impl Quantity {
    /// Name in files, without the number of the wheel.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "alpha",
            Self::Speed => "dalpha",
            Self::Input => "M",
        }
    }
}

/// A property of a recording that degrades or explains results, with counts of type `C` and other numbers of
/// type `R`; wheels are counted from 0, the right wheel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Issue<C = usize, R = f64> {
    /// Only windows of the recording are held in memory.
    Windows {
        /// Rows of the file.
        rows: C,
        /// Number of windows.
        windows: C,
        /// Length of each \[s\].
        length_s: R,
        /// Share of the rows in the windows \[1\].
        share: R,
    },
    /// Short duration \[s\].
    Short(R),
    /// Sampling rate \[Hz\].
    Slow(R),
    /// Rows that last longer than the speeds take to settle under a new input.
    Settles {
        /// Median step \[s\].
        step_s: R,
        /// Time constant of the faster wheel \[s\].
        constant_s: R,
    },
    /// Standard deviation of the time step over its median \[1\].
    Uneven(R),
    /// Gaps in time, with the number of pieces that are too short for an error.
    Gaps(Gaps<C, R>, C),
    /// Share of the rows that repeat the previous sensor values \[1\].
    Repeats(R),
    /// A wheel never moves.
    Still(usize),
    /// An input is constant.
    ConstantInput {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// The constant [unit of the input].
        value: R,
        /// Unit of the input.
        unit: DriveUnit,
    },
    /// An input is often exactly at its extreme value.
    AtLimit {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// The extreme value.
        value: R,
        /// Unit of the input.
        unit: DriveUnit,
        /// Share of the samples \[1\].
        share: R,
        /// Whether this is so frequent that it is a command of constant magnitude.
        is_command: bool,
    },
    /// Samples that deviate from both neighbours.
    Spikes {
        /// What the channel measures.
        channel: Quantity,
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Number of spikes.
        count: C,
        /// Time of the first \[s\].
        t: R,
        /// The first spike between its neighbours.
        around: [R; 3],
    },
    /// Steps of an angle that no motion explains.
    Jumps {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Number of steps.
        count: C,
        /// Time of the first \[s\].
        t: R,
        /// Its size \[rad\].
        size: R,
    },
    /// Speeds of a wheel with a quantisation step [rad/s] that is a considerable part of the speed.
    CoarseSpeed(usize, R),
    /// Share of the time at a standstill \[1\].
    Standstill(R),
    /// Both wheels have identical values.
    OneAxis,
    /// The robot drives straight only.
    StraightOnly,
    /// The robot turns on the spot only.
    SpotOnly,
    /// A wheel turns in one direction only; `true`: forward.
    OneWay(usize, bool),
    /// An input larger than any motor of a wheel has.
    TooLarge {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Its largest values.
        top: R,
        /// Unit of the input.
        unit: DriveUnit,
    },
    /// Wheel speeds above any realistic value.
    TooFast {
        /// The highest [rad/s].
        top: R,
        /// Radius of the wheels \[m\].
        radius: R,
    },
    /// The speed of each wheel matches the angle of the other.
    ExchangedSpeeds,
    /// A speed differs from the derivative of its angle.
    Ratio {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Ratio of speed to derivative of the angle \[1\].
        ratio: R,
        /// Radius of the wheels \[m\].
        radius: R,
    },
    /// The input of each wheel drives the other wheel.
    ExchangedInput,
    /// The input of a wheel opposes its motion.
    OpposingInput(usize),
    /// A wheel moves for too short a time for the test of its input's sign.
    SignUntested(usize),
}

/// An issue of one or several recordings, with the ranges of the numbers.
pub type StatedIssue = Issue<Span<usize>, Span<f64>>;

/// Whether steps of an angle \[rad\] are those of an angle wrapped at a full turn.
pub(crate) fn is_full_turn(size: Span<f64>) -> bool {
    (size.low().abs() / TAU - 1.0).abs() < 0.05
}
