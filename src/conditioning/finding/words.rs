//! The words of findings.

use super::{Channel, Kind};
use crate::math::Span;

/// The factor of a gear that a ratio of speed to slope of the angle may be, and the columns whose values it turns into
/// those of the wheel: those of the faster shaft.
fn gear_scale(ratio: Span<f64>) -> String {
    let (key, scale) = if ratio.low() > 1.0 {
        ("dalpha", ratio.map(|ratio| 1.0 / ratio))
    } else {
        ("alpha", ratio)
    };
    format!("scale = {scale:.4} in {key}1 and {key}2")
}

/// What was found, and what is done about it unless it is switched off.
pub(super) fn words(
    name: &str,
    kind: Kind<Span<usize>, Span<f64>>,
    channel: Channel,
) -> (String, String) {
    let ms = |s: Span<f64>| format!("{:.2} ms", s.map(|s| 1e3 * s));
    let degrees = |angle: Span<f64>| format!("{:.1}", angle.map(f64::to_degrees));
    let percent = |share: Span<f64>| share.map(|share| 100.0 * share);
    let one = |count: Span<usize>, what: &str| {
        let plural = if count.high() == 1 { "" } else { "s" };
        format!("{count} {what}{plural}")
    };
    match kind {
        Kind::MissingValues { rows, first } => (
            format!("{} without a number in some column (first: row {first})", one(rows, "row")),
            "left out".into(),
        ),
        Kind::SparseColumn { share } => (
            format!("{name} has a new value in {:.1} % of the rows", percent(share)),
            "the line between its values stands for it".into(),
        ),
        Kind::HeldColumn { share } => (
            format!("{name} has a value in {:.1} % of the rows", percent(share)),
            "it holds until the next".into(),
        ),
        Kind::OwnRows { share } => (
            format!("{name} has a new value in {:.1} % of the rows", percent(share)),
            "the recording has these rows; the others serve their own columns".into(),
        ),
        Kind::TimeRows { rows, first } => (
            format!(
                "{} whose time does not exceed that before (first: row {first})",
                one(rows, "row")
            ),
            "left out".into(),
        ),
        Kind::Jitter { share } => (
            format!(
                "the times of the rows scatter by {:.0} % of a row about even times, on which the sensors move more \
                 smoothly",
                percent(share)
            ),
            "the rows stand on the even times".into(),
        ),
        Kind::ClockWrap { count, row, period_s } => (
            format!(
                "the time goes back {} by {period_s} s (first: row {row}), the period of a timer",
                one(count, "time")
            ),
            "a timer that wrapped: the time goes on".into(),
        ),
        Kind::ClockRestart { count, row, back_s } => (
            format!(
                "the time goes back {} and on from there (first: by {back_s:.3} s at row {row})",
                one(count, "time")
            ),
            "a restarted clock: what follows stands behind a gap".into(),
        ),
        Kind::CoarseClock { tick_s, rows } => (
            format!(
                "the time goes on in steps of {} s, each with {rows:.1} rows",
                tick_s.map(|s| (1e6 * s).round() / 1e6)
            ),
            "a coarse clock: the rows are spread evenly over its steps".into(),
        ),
        Kind::Stale { rows, first } => (
            format!(
                "{rows} rows repeat the last sample of the sensors although the wheels move, and later ones make up for \
                 it (first: row {first})"
            ),
            "the samples that came late stand in their place".into(),
        ),
        Kind::Wrapped { period_rad, turns } => {
            (format!("{name} wraps at {period_rad:.6} rad, {turns} times"), "unwrapped".into())
        }
        Kind::Reset { row, step_rad } => (
            format!("{name} jumps by {step_rad:+.4} rad at row {row} and stays there"),
            "a reset counter: what follows is shifted back".into(),
        ),
        Kind::Spikes { count, first, largest } => (
            format!(
                "{name} has {} (first: row {first}; the largest stands out by {})",
                one(count, "isolated wrong sample"),
                largest.written(|v| if v.abs() < 1e6 {
                    format!("{v:.4}")
                } else {
                    format!("{v:e}")
                })
            ),
            "replaced by the line between the neighbours".into(),
        ),
        Kind::Unit { factor, unit } => {
            let other =
                if matches!(channel, Channel::Speed(_)) { "the slope of" } else { "that of" };
            // a length as well as a gear may be any number
            let or = if matches!(unit, "m" | "m/s") {
                format!(
                    " (or a gear of {:.4} lies between motor and wheel: write {})",
                    factor.map(|factor| factor.max(1.0 / factor)),
                    gear_scale(factor)
                )
            } else {
                String::new()
            };
            (
                format!("{name} is {factor:.4} times {other} its counterpart: it is in {unit}{or}"),
                "converted".into(),
            )
        }
        Kind::Gear { ratio } => (
            format!(
                "{name} is {ratio:.4} times the slope of its counterpart, which is the factor of no unit: of a gear between \
                 motor and wheel write {}",
                gear_scale(ratio)
            ),
            "left as recorded".into(),
        ),
        Kind::Sign => (
            format!("{name} has the opposite sign of its counterpart and of the input"),
            "turned".into(),
        ),
        Kind::Opposing if matches!(channel, Channel::Input(_)) => {
            (format!("{name} acts against the motion of its wheel"), "turned".into())
        }
        Kind::Opposing => (
            format!("{name} counts against its input and, nearly always, against the other wheel"),
            "turned".into(),
        ),
        Kind::Exchanged => (
            format!("{name} belongs to the other wheel: it follows the motion of that one"),
            "exchanged".into(),
        ),
        Kind::Lag { lag_s, std_error_s } => (
            format!("{name} lags the angle by {} ± {}", ms(lag_s), ms(std_error_s)),
            "advanced by that".into(),
        ),
        Kind::Filtered { lag_s, std_error_s } => (
            format!(
                "{name} lags the angle by {} ± {}, more than a sample, and is smoothed",
                ms(lag_s),
                ms(std_error_s)
            ),
            "left out: speeds are those of the angles".into(),
        ),
        Kind::LowPass { time_s, std_error_s, or_late } => (
            format!(
                "{name} is the speed behind a low-pass of {} ± {}: friction of the wheels acts as late as their input{}",
                ms(time_s),
                ms(std_error_s),
                if or_late {
                    " (a late actuator explains the motion hardly worse; angles would show which it is)"
                } else {
                    ""
                }
            ),
            "the speed before it".into(),
        ),
        Kind::HeldInput => (
            format!(
                "{name} keeps its value until the next row: the motion follows that better than a line"
            ),
            "simulated so (hold = \"linear\" draws a line between the rows)".into(),
        ),
        Kind::Phase { shift_s, std_error_s } => (
            format!(
                "{name} acts {} ± {} {} than in the mean of the recordings: the rows stand at another phase of the \
                 controller's",
                ms(shift_s.map(f64::abs)),
                ms(std_error_s),
                if shift_s.low() > 0.0 { "later" } else { "earlier" }
            ),
            "moved by that".into(),
        ),
        Kind::StartHeading { angle_rad, std_error_rad } => (
            format!(
                "the heading starts {} ± {} degrees from that of another recording, as a torque that repeats with it says",
                degrees(angle_rad),
                degrees(std_error_rad)
            ),
            "the angles start there".into(),
        ),
        Kind::StartAngle { angle_rad, std_error_rad } => (
            format!(
                "{name} starts {} ± {} degrees from where another recording has it, as a torque that repeats with it says",
                degrees(angle_rad),
                degrees(std_error_rad)
            ),
            "starts there".into(),
        ),
        Kind::Differences { samples, lag_s } => (
            format!(
                "{name} is the difference of the angle over {} ({} late)",
                one(samples, "sample"),
                ms(lag_s)
            ),
            "left out: it holds nothing beside the angle".into(),
        ),
        Kind::OfAngle { share } => (
            format!(
                "{name} was computed from the angle: a filter of it leaves {:.1} % of the noise that \
                 an own sensor would leave at least",
                percent(share)
            ),
            "left out: it holds nothing beside the angle".into(),
        ),
        Kind::Counts { step_rad, rows } => (
            format!(
                "{name} is made of the counts of an encoder over {}, one count of {step_rad:.6} rad",
                one(rows, "row")
            ),
            "the angle that they add up to stands for it".into(),
        ),
        Kind::FewLevels { levels } => (
            format!("{name} has {} only", one(levels, "level")),
            "taken as a command without noise".into(),
        ),
        Kind::Magnitude => (
            format!("{name} never changes its sign although its wheel is driven both ways"),
            "takes the sign of the speed".into(),
        ),
        Kind::RestOffset { mean, std_error } => (
            format!("{name} is {mean:.5} ± {std_error:.5} while the robot stands before it starts"),
            format!("an offset of the sensor? `offset` of the column {name} takes it out"),
        ),
        Kind::Refresh { period_s } => (
            format!(
                "the sensors give a new value every {}, the rows come more often",
                ms(period_s)
            ),
            "rows that repeat a value do not count as measurements".into(),
        ),
        Kind::Quantum { step } => (
            format!("{name} comes in steps of {step:.6}"),
            "counted as noise of step/sqrt(12)".into(),
        ),
    }
}
