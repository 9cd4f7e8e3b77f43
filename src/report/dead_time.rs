//! Text on the dead time between input and motion.

use crate::diagnose::{THRESHOLDS, Timing, Untimed};
use crate::effects::{self, Change};
use crate::math::distribution::NORMAL_95;
use crate::report::format;
use crate::simulate::Hold;

fn ms(seconds: f64) -> String {
    format::fixed(1e3 * seconds, 1)
}

/// Whether the recordings determine the time: its interval of 95 % is not wider than the range in which it is searched.
#[must_use]
pub(crate) fn is_determined(timing: &Timing) -> bool {
    2.0 * NORMAL_95 * timing.std_error_s <= THRESHOLDS.longest_delay_s
}

/// What the time is: that from input to motion, or that of the input in the log.
#[must_use]
pub(crate) fn dead_time_name(timing: &Timing) -> &'static str {
    if timing.is_early() { "Time of the input" } else { "Dead time" }
}

/// The time with its standard error and interval.
fn value(timing: &Timing) -> String {
    let Timing { dead_time_s, std_error_s, .. } = *timing;
    let reach = NORMAL_95 * std_error_s;
    match timing.is_early() {
        true => format!(
            "the input acts {} ± {} ms before it is recorded (95 %: {} to {} ms{})",
            ms(-dead_time_s),
            ms(std_error_s),
            ms(-dead_time_s - reach),
            ms(-dead_time_s + reach),
            otherwise(timing)
        ),
        false => format!(
            "{} ± {} ms from input to motion (95 %: {} to {} ms{})",
            ms(dead_time_s),
            ms(std_error_s),
            ms(dead_time_s - reach),
            ms(dead_time_s + reach),
            otherwise(timing)
        ),
    }
}

/// The time with another input between the rows, where that is possible.
fn otherwise(timing: &Timing) -> String {
    match timing.otherwise() {
        Some((Hold::Constant, time)) => format!(
            "; {} ms if the input is held from row to row, hold = \"constant\", which these recordings do not exclude",
            ms(time)
        ),
        Some((Hold::Linear, time)) => format!(
            ", as one held from row to row cannot; with the line between the rows, hold = \"linear\", {} ms from input to \
             motion",
            ms(time)
        ),
        None => String::new(),
    }
}

/// The dead time between input and motion with its interval and its treatment, by the model as given.
#[must_use]
pub fn dead_time(timing: &Timing) -> String {
    let Timing { dead_time_s, std_error_s, correction_s, .. } = *timing;
    if !is_determined(timing) {
        return UNDETERMINED.to_owned();
    }
    let treatment = if correction_s != 0.0 {
        corrected(timing)
    } else if timing.is_late() {
        ", more than logging explains; the methods estimate it as an input delay, which the model of the file does not \
         contain"
            .to_owned()
    } else if dead_time_s.abs() > NORMAL_95 * std_error_s {
        "; not corrected in the recordings, because an effect missing from the model may cause it: prediction_error and a \
         diagnosis estimate it with the parameters"
            .to_owned()
    } else {
        ZERO.to_owned()
    };
    value(timing) + &treatment
}

/// Why no dead time is reported.
#[must_use]
pub fn no_dead_time(reason: &Untimed) -> String {
    match *reason {
        Untimed::NotSought => "not estimated: the model has a time of its input itself, a recording is read in windows, or \
                               the torque balance gives no initial parameters"
            .to_owned(),
        Untimed::NotExcited => {
            "not determined: the motion does not excite the parameters of the torque balance".to_owned()
        }
        Untimed::NoMinimum => format!(
            "not determined: no time up to {} ms explains the motion better than the times around it",
            ms(THRESHOLDS.longest_delay_s)
        ),
        Untimed::AboveFloor => format!(
            "not determined: the error of the model is more than {} times the noise floor, and no time between the ends of \
             the range (up to {} ms) lowers it most; the torque balance may attribute what causes that error to a dead time",
            THRESHOLDS.above_floor,
            ms(THRESHOLDS.longest_delay_s)
        ),
        Untimed::Later { time_s, onset_s } => format!(
            "not determined: the model would need {} ms, but wheels moved {} ms after a step of the input from rest; an \
             effect missing from the model may cause the difference",
            ms(time_s),
            ms(onset_s)
        ),
    }
}

const UNDETERMINED: &str =
    "not determined by these recordings: starts, stops and reversals of the input would show it";
const ZERO: &str = ", not significantly different from zero";

fn corrected(timing: &Timing) -> String {
    let shift = ms(timing.correction_s.abs());
    format!(", of which {shift} ms are corrected: as much as logging can cause")
}

/// The same by the model with the effects `found`, and what became of the time by the model as given, `before`, if that
/// gave one.
#[must_use]
pub(crate) fn dead_time_with(found: &str, timing: &Timing, before: Option<&Timing>) -> String {
    let Timing { dead_time_s, std_error_s, correction_s, .. } = *timing;
    if !is_determined(timing) {
        return UNDETERMINED.to_owned();
    }
    let treatment = if correction_s != 0.0 {
        corrected(timing)
    } else if dead_time_s.abs() > NORMAL_95 * std_error_s {
        ", as logging can cause; the fits of the diagnosis and of prediction_error estimate it with the parameters"
            .to_owned()
    } else {
        ZERO.to_owned()
    };
    let differs = |before: &&Timing| {
        is_determined(before) && !timing.agrees_with(before.dead_time_s, before.std_error_s)
    };
    let seeming = match before.filter(differs) {
        None => String::new(),
        Some(before) => format!(
            ". Without {found} in the model it would seem to be {} ± {} ms from input to motion; the difference is due to \
             the missing effect",
            ms(before.dead_time_s),
            ms(before.std_error_s)
        ),
    };
    format!("{}{treatment}{seeming}", value(timing))
}

/// What to do about a dead time that the model of the file does not have, without a diagnosis.
#[must_use]
pub fn dead_time_advice() -> String {
    let mut shifting: Vec<_> =
        effects::all().into_iter().filter(|e| e.change() == Change::TimeShift).collect();
    // the one that was fitted first
    shifting.sort_by_key(|effect| !effect.is_delay());
    let ids: Vec<String> = shifting.iter().map(|effect| effect.id()).collect();
    format!("add {} to `effects` of [model], or add a [diagnosis] block", ids.join(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(dead_time_s: f64, correction_s: f64) -> Timing {
        let std_error_s = 0.0004;
        Timing { dead_time_s, std_error_s, correction_s, logging_s: 0.005, ..Timing::default() }
    }

    #[test]
    fn why_there_is_none_is_stated_with_its_numbers() {
        let later = no_dead_time(&Untimed::Later { time_s: 0.05, onset_s: 0.02 });
        assert!(later.contains("need 50.0 ms, but wheels moved 20.0 ms after"), "{later}");
        let above = no_dead_time(&Untimed::AboveFloor);
        assert!(above.contains("more than 1.5 times the noise floor"), "{above}");
        // whether an effect is missing is for the verdict to say
        assert!(!above.contains("missing"), "{above}");
    }

    #[test]
    fn a_time_that_the_model_lacks_is_stated_with_what_to_add() {
        let of = |time, correction| dead_time(&of(time, correction));
        let late = of(0.0238, 0.0);
        assert!(late.contains("23.8 ± 0.4 ms from input to motion (95 %: 23.0 to 24.6 ms), more"));
        assert!(dead_time_advice().starts_with("add actuator_delay or actuator_lag to"));
        assert!(of(0.0038, 0.0038).ends_with("3.8 ms are corrected: as much as logging can cause"));
        assert!(of(0.0038, 0.0).contains("an effect missing from the model may cause it"));
        assert!(of(-0.0038, 0.0).starts_with(
            "the input acts 3.8 ± 0.4 ms before it is recorded (95 %: 3.0 to 4.6 ms); not corrected"
        ));
        assert!(of(0.0002, 0.0).ends_with("not significantly different from zero"));
    }

    #[test]
    fn an_input_that_is_unknown_between_its_rows_has_two_times() {
        let open = |time, other| Timing { step_s: 0.01, other: Some(other), ..of(time, 0.0) };
        let late = dead_time(&open(0.025, Hold::Constant));
        assert!(late.contains("24.2 to 25.8 ms; 20.0 ms if the input is held"), "{late}");
        // one that was taken for held, but acts before it is given
        let early = dead_time(&open(-0.0044, Hold::Linear));
        assert!(
            early.contains("3.6 to 5.2 ms, as one held from row to row cannot; with"),
            "{early}"
        );
        assert!(early.contains("0.6 ms from input to motion"), "{early}");
        // a held input acts from its row on
        assert!(!dead_time(&open(0.001, Hold::Constant)).contains("held"));
        assert!(!dead_time(&of(0.025, 0.0)).contains("held"));
    }

    #[test]
    fn an_interval_wider_than_the_range_searched_determines_nothing() {
        // straight runs of a robot at one speed
        let open = Timing { std_error_s: 1.2376, ..of(0.034, 0.0) };
        for text in [dead_time(&open), dead_time_with("turning scrub", &open, Some(&of(0.0, 0.0)))]
        {
            assert!(text.starts_with("not determined by these recordings"), "{text}");
        }
        assert!(!dead_time_with("turning scrub", &of(0.002, 0.0), Some(&open)).contains("Without"));
    }

    #[test]
    fn a_time_that_an_effect_stands_for_is_not_that_of_the_input() {
        let before = Timing { std_error_s: 0.0029, ..of(0.0214, 0.0) };
        let said = dead_time_with("quadratic drag", &of(-0.0065, 0.0), Some(&before));
        assert!(said.starts_with("the input acts 6.5 ± 0.4 ms before it is recorded"), "{said}");
        assert!(
            said.ends_with(
                "Without quadratic drag in the model it would seem to be 21.4 ± 2.9 ms from input to motion; the \
                 difference is due to the missing effect"
            ),
            "{said}"
        );
        let alike = dead_time_with("quadratic drag", &of(-0.0065, 0.0), Some(&of(-0.0061, 0.0)));
        assert!(!alike.contains("Without"), "{alike}");
        let alone = dead_time_with("quadratic drag", &of(-0.0065, 0.0), None);
        assert_eq!(alone, alike);
        assert_eq!(dead_time_name(&of(-0.0065, 0.0)), "Time of the input");
        assert_eq!(dead_time_name(&of(0.0002, 0.0)), "Dead time");
    }
}
