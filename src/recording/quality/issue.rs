//! What the quality check may notice, and the words for it.

mod joined;
mod unit;

use std::f64::consts::TAU;

use self::unit::UnitError;
use super::Gaps;
use crate::math::Span;
use crate::recording::DriveUnit;

/// Slowest rate at which starts and stops are still resolved \[Hz\].
pub(super) const SLOW: f64 = 20.0;
/// Shortest recording worth fitting \[s\]: two windows over which errors are judged.
pub(super) const SHORT: f64 = 4.0;
/// Names of the wheels in findings.
const WHEELS: [&str; 2] = ["wheel 1 (right)", "wheel 2 (left)"];

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
    /// Rows a second \[Hz\].
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

impl StatedIssue {
    /// What was seen.
    #[must_use]
    pub fn what(&self) -> String {
        match *self {
            Self::Windows { rows, .. } => {
                format!("{rows} rows are more than are held in memory (hold_rows)")
            }
            Self::Short(duration) => format!("the recording lasts {duration:.2} s"),
            Self::Slow(rate) => format!("{rate:.3} rows a second"),
            Self::Uneven(jitter) => {
                format!("the step in time varies by {:.0} %", percent(jitter))
            }
            Self::Gaps(gaps, _) => {
                format!("{} in time, the longest {:.3} s", number(gaps.count, "gap"), gaps.longest)
            }
            Self::Repeats(share) => {
                format!("{:.0} % of the rows repeat the sensors", percent(share))
            }
            Self::Still(i) => format!("{} never moves", WHEELS[i]),
            Self::ConstantInput { wheel, value, .. } if value.low() == 0.0 => {
                format!("M{} is zero throughout", wheel + 1)
            }
            Self::ConstantInput { wheel, value, unit } => {
                format!("M{} is {value} {} throughout", wheel + 1, unit.symbol())
            }
            Self::AtLimit { wheel, value, unit, share, .. } => format!(
                "M{} is exactly {} {} at its extreme, {:.1} % of the samples",
                wheel + 1,
                value.map(significant),
                unit.symbol(),
                percent(share)
            ),
            Self::Spikes { channel, wheel, count, t, around: [before, first, after] } => format!(
                "{}{} has {} (first at t = {t:.3} s: {first:.4} between {before:.4} and {after:.4})",
                channel.name(),
                wheel + 1,
                number(count, "spike"),
            ),
            Self::Jumps { wheel, count, t, size } => format!(
                "alpha{} has {} (first at t = {t:.3} s: {size:+.3} rad in one step)",
                wheel + 1,
                number(count, "jump"),
            ),
            Self::CoarseSpeed(i, step) => {
                format!("dalpha{} comes in steps of {step:.4} rad/s", i + 1)
            }
            Self::Standstill(share) => {
                format!("the robot stands still for {:.0} % of the time", percent(share))
            }
            Self::OneAxis => "both wheels carry the same numbers".into(),
            Self::StraightOnly => "the robot drives straight only".into(),
            Self::SpotOnly => "the robot turns on the spot only".into(),
            Self::OneWay(i, forward) => {
                let way = if forward { "forward" } else { "backward" };
                format!("{} turns {way} only", WHEELS[i])
            }
            Self::TooFast { top, radius } => format!(
                "wheel speeds up to {top:.0} rad/s, {:.0} m/s on wheels of {radius} m",
                top.map(|top| top * radius.low())
            ),
            Self::ExchangedSpeeds => "dalpha1 follows alpha2 and dalpha2 follows alpha1".into(),
            Self::Ratio { wheel, ratio, .. } => {
                format!("dalpha{0} is {ratio:.4} times the slope of alpha{0}", wheel + 1)
            }
            Self::ExchangedInput => "M1 moves wheel 2 and M2 moves wheel 1".into(),
            Self::OpposingInput(i) => {
                format!("M{} pushes {} against its motion", i + 1, WHEELS[i])
            }
        }
    }

    /// What to do, or what follows from it.
    #[must_use]
    pub fn remedy(&self) -> String {
        match *self {
            Self::Windows { windows, length_s, share, .. } => {
                return format!(
                    "torque_regression reads every row; all else (other methods, comparison, noise \
                     floor, diagnosis, figures) sees {windows} windows of {length_s:.3} s, spread \
                     over all of it, {:.2} % of the rows",
                    percent(share)
                );
            }
            Self::Short(_) => {
                return format!("record at least {SHORT:.0} s, better 20 s; or check the unit of t");
            }
            Self::Slow(_) => {
                return format!(
                    "what input and motion do between two rows is not in the log, so inertias are uncertain beyond \
                     their intervals: record at {SLOW:.0} Hz or more; or check the unit of t"
                );
            }
            Self::Gaps(_, short) => {
                return format!(
                    "gaps are left out; {short} pieces are too short to judge an error on"
                );
            }
            Self::ConstantInput { wheel, value, .. } if value.low() == 0.0 => {
                return format!("{} coasts, or its input was not recorded", WHEELS[wheel]);
            }
            Self::OpposingInput(i) => {
                return format!("its sign is wrong: scale = -1 for M{} in `columns`", i + 1);
            }
            Self::Ratio { wheel, ratio, radius } => {
                return UnitError::of(ratio.low(), radius.low()).words(wheel);
            }
            Self::Uneven(_) => "write the time of measurement, not that of arrival",
            Self::Repeats(_) => "repeated rows are not counted as measurements",
            Self::Still(_) => {
                "its friction and inertia cannot be seen; check its encoder, or drive both wheels"
            }
            Self::ConstantInput { .. } => "vary the input; a constant one shows little",
            Self::AtLimit { is_command: true, .. } => "a command of constant size",
            Self::AtLimit { .. } => {
                "the input or its sensor is at a limit; what is recorded there may not be what acts \
                 (torque saturation is an effect of the catalogue)"
            }
            // a wheel cannot jump; an input may be commanded to, and conditioning has asked the wheel
            Self::Spikes { channel: Quantity::Input, .. } => {
                "wrong samples, or commands as short as that; the motion of the wheel does not show which"
            }
            Self::Spikes { .. } => {
                "single wrong samples; remove their rows, gaps in time are allowed"
            }
            Self::Jumps { size, .. } if is_full_turn(size) => {
                "the angle wraps at a full turn; count on beyond it"
            }
            Self::Jumps { .. } => {
                "the counter wraps or counts were lost; unwrap it before, or leave the angles out"
            }
            Self::CoarseSpeed(..) => {
                "it seems to be counted from a coarse encoder; the angles hold more"
            }
            Self::Standstill(_) => {
                "standing shows neither inertia nor friction in motion; drive more"
            }
            Self::OneAxis => {
                "one axis written down twice: only a1 + a2 and one friction can be found"
            }
            Self::StraightOnly => {
                "only the sum a1 + a2 can be found, and a3 not at all; record curves and turns as \
                 well"
            }
            Self::SpotOnly => {
                "only the difference a1 - a2 can be found; record straights and curves as well"
            }
            Self::OneWay(..) => {
                "a constant offset of its input is indistinguishable from Coulomb friction; record \
                 reversals"
            }
            Self::TooFast { .. } => {
                "check their unit (rpm? deg/s?) and the wheel radius of [robot]"
            }
            Self::ExchangedSpeeds => {
                "the wheels are exchanged in one pair of columns (wheel 1 is the right one); swap \
                 them in `columns`"
            }
            Self::ExchangedInput => {
                "the inputs are exchanged (wheel 1 is the right one); swap them in `columns`"
            }
        }
        .into()
    }
}

/// What was seen, and what to do.
impl std::fmt::Display for StatedIssue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.what(), self.remedy())
    }
}

/// Four digits of a value, without zeros at the end.
fn significant(value: f64) -> f64 {
    let scale = 10.0_f64.powi(3 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    let rounded = (value * scale).round() / scale;
    if rounded.is_finite() { rounded } else { value }
}

fn percent(share: Span<f64>) -> Span<f64> {
    share.map(|share| 100.0 * share)
}

/// Whether steps of an angle \[rad\] are those of one that wraps at a turn.
fn is_full_turn(size: Span<f64>) -> bool {
    (size.low().abs() / TAU - 1.0).abs() < 0.05
}

fn number(count: Span<usize>, what: &str) -> String {
    let plural = if count.high() == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}
