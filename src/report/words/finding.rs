//! Sentences on the findings of conditioning.

use std::borrow::Cow;
use std::fmt;

use super::factor::{gear_scale, or_gear, or_metres, plain};
use crate::conditioning::{Action, Channel, Finding, Kind, Sampled, Stated};
use crate::math::Span;

/// When a sensor gives no new value.
fn dead_time(stretches: Span<usize>, from_s: Span<f64>, to_s: Span<f64>) -> String {
    match (stretches.low(), stretches.high()) {
        (1, 1) => format!("from t = {from_s:.3} to {to_s:.3} s"),
        _ => format!("in {stretches} stretches, the first from t = {from_s:.3} to {to_s:.3} s,"),
    }
}

/// The finding.
fn found(name: &str, kind: Kind<Span<usize>, Span<f64>>, channel: Channel) -> String {
    let ms = |s: Span<f64>| format!("{:.2} ms", s.map(|s| 1e3 * s));
    let degrees = |angle: Span<f64>| format!("{:.1}", angle.map(f64::to_degrees));
    let percent = |share: Span<f64>| share.map(|share| 100.0 * share);
    let one = |count: Span<usize>, what: &str| {
        let plural = if count.high() == 1 { "" } else { "s" };
        format!("{count} {what}{plural}")
    };
    match kind {
        Kind::MissingValues { rows, first } => {
            format!("{} without a number in some column (first: row {first})", one(rows, "row"))
        }
        Kind::SparseColumn { share } => {
            format!("{name} has a new value in {:.1} % of the rows", percent(share))
        }
        Kind::HeldColumn { share } => {
            format!("{name} has a value in {:.1} % of the rows", percent(share))
        }
        Kind::OnChange { share } => format!(
            "{name} has no value in {:.1} % of the rows, and most of its successive values differ: a cell is written only when the \
             value changes",
            percent(share)
        ),
        Kind::SlowPair { share } => format!(
            "{name} has a new value in {:.1} % of the rows, less often than the other sensor of the wheel",
            percent(share)
        ),
        Kind::ReadTogether { share } => format!(
            "{name} has a new value in {:.1} % of the rows, and in other rows than the slowest sensor",
            percent(share)
        ),
        Kind::OwnRows { share } => {
            format!("{name} has a new value in {:.1} % of the rows", percent(share))
        }
        Kind::TimeRows { rows, first } => format!(
            "{} whose time does not exceed that before (first: row {first})",
            one(rows, "row")
        ),
        Kind::Jitter { share } => format!(
            "the time stamps scatter by {:.0} % of the sampling interval about even times, at which the motion is \
                 smoother",
            percent(share)
        ),
        Kind::ClockWrap { count, row, period_s } => format!(
            "the time jumps back {} by {period_s} s (first: row {row}), the period of a timer",
            one(count, "time")
        ),
        Kind::NewestFirst { rows } => {
            format!("the time falls from row to row in all {rows} rows: the newest is first")
        }
        Kind::ClockRestart { count, row, back_s } => format!(
            "the time jumps back {} and continues from there (first: by {back_s:.3} s at row {row})",
            one(count, "time")
        ),
        Kind::CoarseClock { tick_s, rows } => format!(
            "the time advances in steps of {} s, each with {rows:.1} rows",
            tick_s.map(|s| (1e6 * s).round() / 1e6)
        ),
        Kind::Batches { rows } => {
            format!("the rows have time stamps in batches of {rows:.1} rows on average")
        }
        Kind::Frozen { rows, first } => format!(
            "{name} keeps its last value in {rows} rows while the wheel is at rest (first: row {first})"
        ),
        Kind::Dead { stretches, rows, from_s, to_s, or_blocked } => format!(
            "{name} has no new value {} ({rows} rows) although its input must have moved the wheel: {}",
            dead_time(stretches, from_s, to_s),
            if or_blocked {
                "its encoder is dead, or the wheel is blocked or not powered"
            } else {
                "its encoder is dead (or the wheel is not powered)"
            }
        ),
        Kind::Stale { rows, first } => format!(
            "{rows} rows repeat the last sample of the sensors although the wheels move; the next new sample \
                 contains the missing motion (first: row {first})"
        ),
        Kind::HalfInterval { rows, first } => format!(
            "both speeds are half of those in the rows around in {} (first: row {first}): the logger misses half an \
                 interval of the encoders",
            one(rows, "row")
        ),
        Kind::Wrapped { period_rad, turns } => {
            format!("{name} wraps at {period_rad:.6} rad, {}", one(turns, "time"))
        }
        Kind::Reset { row, step_rad } => {
            format!("{name} jumps by {step_rad:+.4} rad at row {row} and stays there")
        }
        Kind::Spikes { count, first, largest } => format!(
            "{name} has {} (first: row {first}; the largest deviates by {})",
            one(count, "isolated wrong sample"),
            largest.written(|v| if v.abs() < 1e6 { format!("{v:.4}") } else { format!("{v:e}") })
        ),
        Kind::Onset { count, first, largest } => format!(
            "{name} begins a start with {} above all later speeds (first: row {first}; by up to {largest:.4}), falls to less \
                 than half, and rises from there under the same input",
            one(count, "wrong sample")
        ),
        Kind::Unit { factor, unit } => format!(
            "{name} is {factor:.4} times {} its counterpart: it is in {unit}{}",
            if matches!(channel, Channel::Speed(_)) { "the slope of" } else { "that of" },
            or_gear(factor, unit)
        ),
        Kind::Gear { ratio } => format!(
            "{name} is {} times the slope of its counterpart, which is not the factor of a unit; for a gear between \
                 motor and wheel, or counts of another number per turn, write {}{}",
            ratio.written(plain),
            gear_scale(ratio),
            or_metres(ratio)
        ),
        Kind::Gain { ratio, .. } => format!(
            "{name} is {ratio:.4} times the slope of its angle: one of the two is calibrated wrongly. If it \
             is the speed, write scale = {:.4} in {name}",
            ratio.map(|ratio| 1.0 / ratio)
        ),
        Kind::Sign => format!("{name} has the opposite sign of its counterpart and of the input"),
        Kind::Opposing if matches!(channel, Channel::Input(_)) => {
            format!("{name} acts against the motion of its wheel")
        }
        Kind::Opposing => {
            format!(
                "{name} runs opposite to its input, and in relation to the other wheel as if it were counted backwards"
            )
        }
        Kind::Exchanged => format!("{name} belongs to the other wheel, whose motion it follows"),
        Kind::Lag { lag_s, std_error_s } => {
            format!("{name} lags the angle by {} ± {}", ms(lag_s), ms(std_error_s))
        }
        Kind::LagsDiffer { lag_s, std_error_s } => format!(
            "{name} lags the angle by {} ± {}, which other recordings of this log contradict: not one logger, or another \
                 error of the speeds",
            ms(lag_s),
            ms(std_error_s)
        ),
        Kind::Filtered { lag_s, std_error_s } => format!(
            "{name} lags the angle by {} ± {} and is smoothed",
            ms(lag_s),
            ms(std_error_s)
        ),
        Kind::LowPass { at_rows, time_s, std_error_s, or_late } => format!(
            "{name} is low-pass filtered {}with a time constant of {} ± {}: friction appears as late as the input{}",
            if at_rows { "(exponential average over the rows) " } else { "" },
            ms(time_s),
            ms(std_error_s),
            if or_late {
                " (a late actuator fits the motion almost as well; recorded angles would show which it is)"
            } else {
                ""
            }
        ),
        Kind::StepsBetweenRows => format!(
            "{name} changes between the rows although the file states hold = \"constant\": its steps act at times that \
             scatter over the row (the controller runs faster than the log, or beside it)"
        ),
        Kind::LostRows { rows } => format!(
            "{name} is held from row to row, but its values in {} missing between them (lost by the logger, or left out by \
             another correction) are not used",
            one(rows, "row")
        ),
        Kind::OneSampleARow { half_row_s, sampled } => format!(
            "{name} {}, its course between them is not recorded: a current that the drive regulates is constant there; that \
             of a motor under a constant voltage falls as the motor gains speed, and a1 and a2 are then too {} by the \
             share of {} in the mechanical time constant of the motor, which their intervals do not contain (record the \
             voltages, or more rows)",
            match sampled {
                Sampled::Held => "has one sample a row. If it changes at the rows",
                Sampled::First =>
                    "acts half a row late or is held. If it is read half a row before the sensors, its time is known and \
                     nothing is lost. If it changes at the rows",
                Sampled::Last =>
                    "acts half a row before its time: it is read half a row after the sensors, or at the end of a row over \
                     which it changes. If it is read after the sensors, its time is known and nothing is lost. If it changes \
                     at the rows",
            },
            if sampled == Sampled::Last { "small" } else { "large" },
            ms(half_row_s)
        ),
        Kind::HeldInput => format!(
            "{name} is held between the rows: the motion follows a held input better than a linear one"
        ),
        Kind::RowMeans { middle_s } => format!(
            "{name} is the mean over a row whose middle is {} {} its time: the motion follows an input with these \
             means better than a linear or a held one",
            ms(middle_s.map(f64::abs)),
            if middle_s.low() > 0.0 { "after" } else { "before" }
        ),
        Kind::Phase { shift_s, std_error_s } => format!(
            "{name} acts {} ± {} {} than in the mean of the recordings: its rows are at another phase of the \
                 controller cycle",
            ms(shift_s.map(f64::abs)),
            ms(std_error_s),
            if shift_s.low() > 0.0 { "later" } else { "earlier" }
        ),
        Kind::StartHeading { angle_rad, std_error_rad } => format!(
            "the heading starts {} ± {} degrees from that of another recording, estimated from a torque that repeats with it",
            degrees(angle_rad),
            degrees(std_error_rad)
        ),
        Kind::StartAngle { angle_rad, std_error_rad } => format!(
            "{name} starts {} ± {} degrees from its value in another recording, estimated from a torque that repeats with it",
            degrees(angle_rad),
            degrees(std_error_rad)
        ),
        Kind::Differences { samples, lag_s } => format!(
            "{name} is the difference of the angle over {} ({} late)",
            one(samples, "sample"),
            ms(lag_s)
        ),
        Kind::OfAngle { share } => format!(
            "{name} was computed from the angle: a filter of the angle leaves {:.1} % of the smallest \
             noise that an independent sensor could have",
            percent(share)
        ),
        Kind::DeadSensor => {
            let other = if matches!(channel, Channel::Speed(_)) { "angle" } else { "speed" };
            format!(
                "{name} stays at one value while the {other} of its wheel changes: its sensor is dead"
            )
        }
        Kind::Mirrored => "the torques between the wheels depend on the sum of their speeds, where those of a robot depend \
                           on the difference: one side seems to be counted backwards, input and sensors alike. If so, write \
                           scale = -1 in alpha2, dalpha2 and M2 (or in those of wheel 1: forward is positive for both)"
            .into(),
        Kind::Counts { step_rad, rows } => format!(
            "{name} is computed from encoder counts over {}, one count is {step_rad:.6} rad",
            one(rows, "row")
        ),
        Kind::FewLevels { levels } => format!("{name} has {} only", one(levels, "level")),
        Kind::Magnitude => {
            format!("{name} never changes its sign although its wheel is driven both ways")
        }
        Kind::SpeedSign { share } if share.high() == 0.0 => {
            format!("{name} has the sign of the speed in every row")
        }
        Kind::SpeedSign { share } => {
            format!("{name} has another sign than the speed in {:.1} % of the rows", percent(share))
        }
        Kind::RestOffset { mean, std_error } => {
            format!(
                "{name} is {mean:.5} ± {std_error:.5} while the robot is at rest before it starts"
            )
        }
        Kind::RestNoise { sigma, time_s } => format!(
            "{name} fluctuates by {sigma:.5} (RMS) with a correlation time of {} while the robot stands still",
            ms(time_s)
        ),
        Kind::Refresh { period_s } => {
            format!("the sensors give a new value every {}, less often than the rows", ms(period_s))
        }
        Kind::Quantum { step } => format!("{name} is quantised in steps of {step:.6}"),
    }
}

/// The correction, unless it is disabled.
fn done(name: &str, kind: Kind<Span<usize>, Span<f64>>) -> Cow<'static, str> {
    let words = match kind {
        Kind::MissingValues { .. } | Kind::TimeRows { .. } | Kind::SlowPair { .. } => "left out",
        Kind::SparseColumn { .. } => "interpolated linearly between its values",
        Kind::HeldColumn { .. } => "each value is held until the next",
        Kind::OnChange { .. } => "the last value is held in the empty cells",
        Kind::ReadTogether { .. } => "read in the rows of that one, on the line between its values",
        Kind::OwnRows { .. } => {
            "the recording uses these rows; the others only fill their own columns"
        }
        Kind::Jitter { .. } => "the rows are moved to the even times",
        Kind::ClockWrap { .. } => "treated as a timer overflow: the time continues",
        Kind::NewestFirst { .. } => "the rows are turned round",
        Kind::ClockRestart { .. } => {
            "treated as a restarted clock: the rows that follow begin after a gap"
        }
        Kind::CoarseClock { .. } => {
            "treated as a coarse clock: the rows are spread evenly over its steps"
        }
        Kind::Batches { .. } => {
            "treated as times of reception: the rows are moved to equidistant times"
        }
        Kind::Frozen { .. }
        | Kind::Dead { .. }
        | Kind::HalfInterval { .. }
        | Kind::Onset { .. } => "these rows are left out",
        Kind::Stale { .. } => "replaced by the samples that came late",
        Kind::Wrapped { .. } => "unwrapped",
        Kind::Reset { .. } => "treated as a counter reset: the rest is shifted back",
        Kind::Spikes { .. } => "replaced by linear interpolation",
        Kind::Unit { .. } => "converted",
        Kind::Gear { .. }
        | Kind::Gain { .. }
        | Kind::LagsDiffer { .. }
        | Kind::Mirrored
        | Kind::OneSampleARow { .. } => "left as recorded",
        Kind::Sign | Kind::Opposing => "sign reversed",
        Kind::Exchanged => "exchanged",
        Kind::Lag { .. } => "advanced by this time",
        Kind::Filtered { .. } => "not used: the speeds are computed from the angles",
        Kind::LowPass { .. } => "the speed before the filter is used",
        Kind::StepsBetweenRows => {
            "interpolated between the rows, and the noise floor includes the unknown times"
        }
        Kind::LostRows { .. } => "on the line between the rows around them",
        Kind::RowMeans { .. } => "replaced by the line with these means",
        Kind::HeldInput => "simulated as held (hold = \"linear\" interpolates between the rows)",
        Kind::Phase { .. } => "shifted by this time",
        Kind::StartHeading { .. } => "the angles are shifted",
        Kind::StartAngle { .. } => "shifted",
        Kind::Differences { .. } => "not used: it contains no information beyond the angle",
        Kind::OfAngle { .. } => "not used: it contains no information beyond the angle",
        Kind::DeadSensor => {
            "not used, nor is that of the other wheel: the counterparts determine both"
        }
        Kind::Counts { .. } => "replaced by the angle that the counts add up to",
        Kind::FewLevels { .. } => "treated as a command without noise",
        Kind::Magnitude | Kind::SpeedSign { .. } => {
            "takes the sign of the speed (wrong while braking)"
        }
        Kind::RestOffset { .. } => {
            return format!(
                "is it an offset of the sensor? Then write `offset` in {name}; a torque that friction holds at rest is left as \
                 recorded"
            )
            .into();
        }
        Kind::RestNoise { .. } => "counted as noise of the sensor in the noise floor",
        Kind::Refresh { .. } => "rows that repeat a value are not counted as measurements",
        Kind::Quantum { .. } => "modelled as noise of step/sqrt(12)",
    };
    words.into()
}

/// Channels as the subject of a sentence.
fn subject(channels: &[Channel]) -> String {
    let names: Vec<String> = channels.iter().map(|c| c.name()).collect();
    match &names[..] {
        [rest @ .., last] if !rest.is_empty() => {
            format!("each of {} and {last}", rest.join(", "))
        }
        names => names.concat(),
    }
}

impl Stated {
    /// What was found, without its correction.
    #[must_use]
    pub fn what(&self) -> String {
        let first = self.channels.first();
        first.map_or_else(String::new, |c| found(&subject(&self.channels), self.kind, *c))
    }
}

/// In a sentence.
impl fmt::Display for Stated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, done) = (self.what(), done(&subject(&self.channels), self.kind));
        match self.action {
            Action::Corrected(key) => {
                write!(f, "{what}; {done} ([conditioning] {key} = false switches this off)")
            }
            Action::Used => write!(f, "{what}; {done}"),
            Action::Noted => write!(f, "{what}; left as recorded"),
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Stated::of(self).fmt(f)
    }
}
