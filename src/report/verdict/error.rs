//! Text on the error of the last model.

use crate::diagnose::{Errors, THRESHOLDS};
use crate::report::format;
use crate::study::FAR_BELOW_FLOOR;

/// "This removes 92 % of the mean square error above the noise floor; …": the error with this number of effects
/// `found`, `named` by the length of its windows.
pub(super) fn words(errors: &Errors, found: usize, named: &str) -> String {
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
            "{with} {named} is {ratio:.2} times the noise floor. The floor is only an upper bound here: it \
             contains noise of the input, estimated from its changes from row to row, which may be part of the command, and \
             the input between the rows."
        ),
        (1.., true) if errors.was_at_floor() => format!(
            "{} influence on this motion is small: the {named} was at the noise floor before and falls by {}.",
            if found == 1 { "Its" } else { "Their" },
            format::percent(errors.fall())
        ),
        (_, true) => format!("{with} {named} is at the noise floor."),
        (0, false) => {
            format!("The {named} is {ratio:.1} times the noise floor{}.", in_perspective(errors))
        }
        (_, false) => format!(
            "This removes {} of the mean square error above the noise floor; the {named} is still {ratio:.1} \
             times the floor{}.",
            removed(errors.unexplained()),
            in_perspective(errors)
        ),
    }
}

/// What can cause an error above the floor, or the error compared with the speed: if the noise is small, the ratio to the
/// floor exaggerates it.
fn in_perspective(errors: &Errors) -> String {
    match caused(errors) {
        Some(cause) => format!(", {cause}"),
        None if errors.ratio() > THRESHOLDS.above_floor && !errors.above_floor() => {
            format!("; the excess is {} of the top speed", format::percent(errors.excess()))
        }
        None => String::new(),
    }
}

/// What can cause an error above the floor without a missing effect: the unknown input between the rows, or the
/// uncertainty of the parameters.
pub(in crate::report) fn caused(errors: &Errors) -> Option<&'static str> {
    if !errors.above_input() {
        Some("no more than the input between its rows can cause")
    } else if !errors.above_all() {
        Some("no more than the uncertainty of the parameters can cause on these recordings")
    } else {
        None
    }
}

/// The removed share of the squared error, rounded such that a remaining error is not stated as zero.
pub(super) fn removed(left: f64) -> String {
    match 100.0 * (1.0 - left) {
        percent if left > 0.0 && percent >= 99.0 => "more than 99 %".into(),
        percent if percent > 0.0 && percent < 0.5 => "less than 1 %".into(),
        percent => format!("{percent:.0} %"),
    }
}
