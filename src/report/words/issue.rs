//! Sentences on the issues found by the quality check.

use std::fmt;

use crate::math::{Span, round_significant};
use crate::recording::{
    DriveUnit, Finding, Quantity, RatioUnit, SHORT, SLOW, StatedIssue, UnitError, is_full_turn,
};

/// Names of the wheels in sentences.
const WHEELS: [&str; 2] = ["wheel 1 (right)", "wheel 2 (left)"];

/// The unit behind the value of an input. A voltage may be a command in units of its own (PWM), of which none is
/// stated.
fn unit_after(unit: DriveUnit) -> String {
    if unit == DriveUnit::Volt { String::new() } else { format!(" {}", unit.symbol()) }
}

impl StatedIssue {
    /// The issue.
    #[must_use]
    pub fn what(&self) -> String {
        match *self {
            Self::Windows { rows, .. } => {
                format!(
                    "{rows} rows are more than are held in memory (hold_rows), and are not conditioned"
                )
            }
            Self::Short(duration) => format!("the recording lasts {duration:.2} s"),
            Self::Settles { step_s, constant_s } => format!(
                "rows of {:.0} ms are longer than the time constant of the wheels ({:.0} ms)",
                step_s.map(|s| 1e3 * s),
                constant_s.map(|s| 1e3 * s)
            ),
            Self::Slow(rate) => {
                format!("{} rows a second", rate.map(|rate| round_significant(rate, 3)))
            }
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
            Self::ConstantInput { wheel, value, unit } if value.low() == value.high() => {
                format!("M{} is {value}{} throughout", wheel + 1, unit_after(unit))
            }
            Self::ConstantInput { wheel, value, unit } => format!(
                "M{} is constant in each of them, at values of {value}{}",
                wheel + 1,
                unit_after(unit)
            ),
            Self::AtLimit { wheel, value, unit, share, .. } => format!(
                "M{} is exactly {}{} at its extreme, {:.1} % of the samples",
                wheel + 1,
                value.map(|value| round_significant(value, 4)),
                unit_after(unit),
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
            Self::TooLarge { wheel, top, unit } => {
                let top = top.map(|top| round_significant(top, 2));
                format!("M{} reaches {top}{}", wheel + 1, unit_after(unit))
            }
            Self::ExchangedSpeeds => "dalpha1 follows alpha2 and dalpha2 follows alpha1".into(),
            Self::Ratio { wheel, ratio, .. } => {
                let ratio = ratio.written(|ratio| round_significant(ratio, 4).to_string());
                format!("dalpha{0} is {ratio} times the slope of alpha{0}", wheel + 1)
            }
            Self::ExchangedInput => "M1 moves wheel 2 and M2 moves wheel 1".into(),
            Self::SignUntested(i) => format!("the sign of M{} is not tested", i + 1),
            Self::OpposingInput(i) => {
                format!("M{} pushes {} against its motion", i + 1, WHEELS[i])
            }
        }
    }

    /// The remedy, or the consequence.
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
            Self::Settles { .. } => {
                "methods that use derivatives (torque_regression, weak_form, total_least_squares) have errors beyond \
                 their intervals: use prediction_error, and log faster"
            }
            Self::Gaps(_, short) => {
                let short = match (short.high(), number(short, "piece")) {
                    (0, _) => String::new(),
                    (1, piece) => format!("; {piece} between them is too short to judge an error on"),
                    (_, pieces) => format!("; {pieces} between them are too short to judge an error on"),
                };
                return format!("gaps are left out{short}");
            }
            Self::ConstantInput { wheel, value, .. } if value.low() == 0.0 => {
                return format!("{} coasts, or its input was not recorded", WHEELS[wheel]);
            }
            Self::OpposingInput(i) => {
                return format!("its sign is wrong: scale = -1 for M{} in `columns`", i + 1);
            }
            Self::Ratio { wheel, ratio, radius } => {
                return wrong_units(UnitError::of(ratio.low(), radius.low()), wheel);
            }
            Self::SignUntested(_) => "too few rows in motion; compare it with the sign of the acceleration",
            Self::Uneven(_) => {
                "possibly these are times of arrival: write those of measurement (rows at uneven times are used as they are)"
            }
            Self::Repeats(_) => "repeated rows are not counted as measurements",
            Self::Still(_) => {
                "its friction and inertia are not identifiable; check its encoder, or drive both wheels"
            }
            Self::ConstantInput { .. } => "vary the input; a constant one carries little information",
            Self::AtLimit { is_command: true, .. } => "a command of constant size",
            Self::AtLimit { .. } => {
                "the input or its sensor is at a limit; what is recorded there may not be what acts \
                 (torque saturation is an effect of the catalogue)"
            }
            // a wheel cannot jump; an input can be commanded to, and conditioning has checked the response of
            // the wheel
            Self::Spikes { channel: Quantity::Input, .. } => {
                "wrong samples or very short commands; the motion of the wheel does not show which"
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
                "it seems to come from a coarse encoder; the angles carry more information"
            }
            Self::Standstill(_) => {
                "rest carries no information on inertia or friction in motion; drive more"
            }
            Self::OneAxis => {
                "one axis recorded twice: a1 is its inertia (a2 and a3 are fixed at zero), and of the frictions \
                 only the sum is identifiable"
            }
            Self::StraightOnly => {
                "only the sum a1 + a2 is identifiable, and a3 not at all; record curves and turns as well"
            }
            Self::SpotOnly => {
                "only the difference a1 - a2 is identifiable; record straights and curves as well"
            }
            Self::OneWay(..) => {
                "a constant offset of its input is indistinguishable from Coulomb friction; record \
                 reversals"
            }
            Self::TooFast { .. } => {
                "check their unit (rpm? deg/s?) and the wheel radius of [robot]"
            }
            Self::TooLarge { unit, .. } => {
                return format!(
                    "more than the motor of a wheel has; if the values are thousandths, write unit = \"m{}\" for M1 and M2 in \
                     `columns`",
                    unit.symbol()
                );
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

/// The issue and its remedy.
impl fmt::Display for StatedIssue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.what(), self.remedy())
    }
}

/// What is wrong in the columns of a wheel, by the ratio of its speed to the slope of its angle, and the remedy.
fn wrong_units(error: UnitError, wheel: usize) -> String {
    let (speed, angle) = (format!("dalpha{}", wheel + 1), format!("alpha{}", wheel + 1));
    let sign = error.opposite.then(|| {
        format!(
            "the sign of one of them is wrong (forward is positive for both wheels): scale = -1 on {speed} or {angle}"
        )
    });
    let state = |words: String| Some(format!("{words}; say so in `columns`"));
    let unit = match error.unit {
        Some(RatioUnit::Right) => None,
        Some(RatioUnit::Speed(unit)) => state(format!("{speed} is in {unit}")),
        Some(RatioUnit::DegreesPerSecond) => {
            state(format!("{speed} is in deg/s, or t in a wrong unit"))
        }
        Some(RatioUnit::Angle(unit)) => state(format!("{angle} is in {unit}")),
        Some(RatioUnit::Time(unit)) => state(format!("t is in {unit}")),
        None => Some(
            "a unit, a gear ratio or the counts per turn are wrong; correct it with unit or scale in `columns`"
                .into(),
        ),
    };
    [sign, unit].into_iter().flatten().collect::<Vec<_>>().join(", and ")
}

fn percent(share: Span<f64>) -> Span<f64> {
    share.map(|share| 100.0 * share)
}

fn number(count: Span<usize>, what: &str) -> String {
    let plural = if count.high() == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

impl Finding {
    /// What was seen.
    #[must_use]
    pub fn what(&self) -> String {
        self.issue.stated().what()
    }

    /// What to do, or what follows from it.
    #[must_use]
    pub fn remedy(&self) -> String {
        self.issue.stated().remedy()
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.issue.stated().fmt(f)
    }
}
