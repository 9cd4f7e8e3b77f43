//! What the quality check may notice.

mod joined;
mod unit;

use std::f64::consts::TAU;

pub(crate) use self::unit::{RatioUnit, UnitError};
use super::Gaps;
use crate::math::Span;
use crate::recording::DriveUnit;

/// Slowest rate at which starts and stops are still resolved \[Hz\].
pub(crate) const SLOW: f64 = 20.0;
/// Shortest recording worth fitting \[s\]: two windows over which errors are judged.
pub(crate) const SHORT: f64 = 4.0;

/// What a channel of a wheel measures.
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

/// A property of a recording that makes results worse, or that explains them, with counts `C` and other numbers `R`;
/// wheels count from 0, the right one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Issue<C = usize, R = f64> {
    /// Only windows of the recording are held in memory.
    Windows {
        /// Rows of the file.
        rows: C,
        /// How many windows.
        windows: C,
        /// Length of each \[s\].
        length_s: R,
        /// Share of the rows that the windows hold \[1\].
        share: R,
    },
    /// The recording lasts only so long \[s\].
    Short(R),
    /// Sampling rate \[Hz\].
    Slow(R),
    /// Standard deviation of the step in time, over the median step \[1\].
    Uneven(R),
    /// Gaps in time, with the number of pieces too short to judge an error on.
    Gaps(Gaps<C, R>, C),
    /// Share of the rows that repeat the sensors \[1\].
    Repeats(R),
    /// A wheel never moves.
    Still(usize),
    /// An input is constant.
    ConstantInput {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Where it stays.
        value: R,
        /// Of the input.
        unit: DriveUnit,
    },
    /// An input often stands exactly at its extreme.
    AtLimit {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// The extreme.
        value: R,
        /// Of the input.
        unit: DriveUnit,
        /// Share of the samples \[1\].
        share: R,
        /// Whether it is so often there that it is a command of constant size.
        is_command: bool,
    },
    /// Samples that stand out of both neighbours.
    Spikes {
        /// What the channel measures.
        channel: Quantity,
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// How many.
        count: C,
        /// Time of the first \[s\].
        t: R,
        /// The first, between its neighbours.
        around: [R; 3],
    },
    /// Steps of an angle that no motion explains.
    Jumps {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// How many.
        count: C,
        /// Time of the first \[s\].
        t: R,
        /// Its size \[rad\].
        size: R,
    },
    /// Speeds in steps of so many rad/s, a visible part of the speed itself.
    CoarseSpeed(usize, R),
    /// Share of the time at a standstill \[1\].
    Standstill(R),
    /// Both wheels carry the same numbers.
    OneAxis,
    /// The robot drives straight only.
    StraightOnly,
    /// The robot turns on the spot only.
    SpotOnly,
    /// A wheel turns one way only; forward if true.
    OneWay(usize, bool),
    /// Wheel speeds that no robot reaches.
    TooFast {
        /// The highest [rad/s].
        top: R,
        /// Radius of the wheels \[m\].
        radius: R,
    },
    /// The speed of each wheel follows the angle of the other.
    ExchangedSpeeds,
    /// A speed is not the slope of its angle.
    Ratio {
        /// 0 (right) or 1 (left).
        wheel: usize,
        /// Speed over slope \[1\].
        ratio: R,
        /// Radius of the wheels \[m\].
        radius: R,
    },
    /// The input of each wheel moves the other.
    ExchangedInput,
    /// The input of a wheel acts against its motion.
    OpposingInput(usize),
}

/// What was noticed on one or several recordings, with the ranges of the numbers.
pub type StatedIssue = Issue<Span<usize>, Span<f64>>;

/// Whether steps of an angle \[rad\] are those of one that wraps at a turn.
pub(crate) fn is_full_turn(size: Span<f64>) -> bool {
    (size.low().abs() / TAU - 1.0).abs() < 0.05
}
