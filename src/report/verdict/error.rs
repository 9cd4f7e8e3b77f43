//! Text on the error of the last model.

use crate::diagnose::{Errors, THRESHOLDS};
use crate::report::format;
use crate::study::FAR_BELOW_FLOOR;

/// "This removes 92 % of the error above the noise floor; …": the error with this number of effects `found`.
pub(super) fn words(errors: &Errors, found: usize) -> String {
    let ratio = errors.ratio();
    if !ratio.is_finite() {
        return "The simulation of the model diverges on the judged recordings.".into();
    }
    let with = match found {
        0 => "The",
        1 => "With it, the",
        _ => "With them, the",
    };
    match (found, ratio <= THRESHOLDS.at_floor) {
        (_, true) if ratio < FAR_BELOW_FLOOR => format!(
            "{with} 2 s simulation error is {ratio:.2} times the noise floor. The floor is only an upper \
             bound here: it contains the largest possible effects of noise of the input, estimated from its changes from \
             row to row, and of the input between the rows."
        ),
        (1.., true) if errors.was_at_floor() => format!(
            "{} influence on this motion is small: the 2 s simulation error was at the noise floor before and falls by {}.",
            if found == 1 { "Its" } else { "Their" },
            format::percent(errors.fall())
        ),
        (_, true) => format!("{with} 2 s simulation error is at the noise floor."),
        (0, false) => format!(
            "The 2 s simulation error is {ratio:.1} times the noise floor{}.",
            in_perspective(errors)
        ),
        (_, false) => format!(
            "This removes {} of the error above the noise floor; the 2 s simulation error is still {ratio:.1} times \
             the floor{}.",
            removed(errors.unexplained()),
            in_perspective(errors)
        ),
    }
}

/// An error above the floor compared with the speed, with the unknown input between the rows, and with the uncertainty of
/// the parameters: if the noise is small, the ratio to the floor exaggerates it.
fn in_perspective(errors: &Errors) -> String {
    match errors.ratio() > THRESHOLDS.above_floor && !errors.above_floor() {
        true => {
            format!("; the excess is {} of the top speed", format::percent(errors.excess()))
        }
        false if !errors.above_input() => {
            ", no more than the input between its rows can cause".to_owned()
        }
        false if !errors.above_all() => {
            ", no more than the uncertainty of the parameters can cause on these recordings"
                .to_owned()
        }
        false => String::new(),
    }
}

/// The removed share of the squared error, rounded such that a remaining error is not stated as zero.
pub(super) fn removed(left: f64) -> String {
    let percent = 100.0 * (1.0 - left);
    if left > 0.0 && percent >= 99.0 { "more than 99 %".into() } else { format!("{percent:.0} %") }
}
