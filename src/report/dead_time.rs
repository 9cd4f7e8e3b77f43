//! Text on the dead time between input and motion.

use crate::diagnose::Timing;
use crate::effects::{self, Change};
use crate::report::format;

/// Number of standard errors for an interval of 95 %.
const INTERVAL: f64 = 1.96;

/// Lower end of the interval \[s\].
fn earliest(timing: &Timing) -> f64 {
    timing.dead_time_s - INTERVAL * timing.std_error_s
}

/// The dead time between input and motion with its interval and its treatment.
#[must_use]
pub fn dead_time(timing: &Timing) -> String {
    let ms = |seconds: f64| format::fixed(1e3 * seconds, 1);
    let Timing { dead_time_s, std_error_s, correction_s, .. } = *timing;
    let value = format!(
        "{} ± {} ms from input to motion (95 %: {} to {} ms)",
        ms(dead_time_s),
        ms(std_error_s),
        ms(earliest(timing)),
        ms(dead_time_s + INTERVAL * std_error_s)
    );
    if correction_s != 0.0 {
        return format!("{value}, {} ms of it by logging and taken out", ms(correction_s));
    }
    if timing.is_late() {
        return format!(
            "{value}, more than logging explains; the methods fit it as a delay of the input, which the model of the file \
             does not have"
        );
    }
    if dead_time_s.abs() > INTERVAL * std_error_s {
        return format!("{value}, left in: it may stand for something else that the model lacks");
    }
    format!("{value}, not distinguished from none")
}

/// What to do about a dead time that the model of the file does not have, without a diagnosis.
#[must_use]
pub fn dead_time_advice() -> String {
    let mut shifting: Vec<_> =
        effects::all().into_iter().filter(|e| e.change() == Change::TimeShift).collect();
    // the one that was fitted first
    shifting.sort_by_key(|effect| !effect.is_delay());
    let ids: Vec<String> = shifting.iter().map(|effect| effect.id()).collect();
    format!("add {} to `effects` of [model], or let a [diagnosis] decide", ids.join(" or "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_the_model_lacks_is_said_with_what_to_add() {
        let of = |dead_time_s, correction_s| {
            let (std_error_s, logging_s) = (0.0004, 0.005);
            dead_time(&Timing { dead_time_s, std_error_s, correction_s, logging_s })
        };
        let late = of(0.0238, 0.0);
        assert!(late.contains("23.8 ± 0.4 ms from input to motion (95 %: 23.0 to 24.6 ms), more"));
        assert!(dead_time_advice().starts_with("add actuator_delay or actuator_lag to"));
        assert!(of(0.0038, 0.0038).ends_with("3.8 ms of it by logging and taken out"));
        assert!(of(0.0038, 0.0).contains("left in: it may stand for something else"));
        assert!(
            of(-0.0038, 0.0).starts_with("−3.8 ± 0.4 ms") && of(-0.0038, 0.0).contains("left in")
        );
        assert!(of(0.0002, 0.0).ends_with("not distinguished from none"));
    }
}
