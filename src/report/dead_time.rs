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
        return format!(
            "{value}, of which {} ms are corrected: as much as logging can cause",
            ms(correction_s)
        );
    }
    if timing.is_late() {
        return format!(
            "{value}, more than logging explains; the methods estimate it as an input delay, which the \
             model of the file does not contain"
        );
    }
    if dead_time_s.abs() > INTERVAL * std_error_s {
        return format!(
            "{value}; not corrected in the recordings, because it may be caused by an effect missing from the model"
        );
    }
    format!("{value}, not significantly different from zero")
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

    #[test]
    fn a_time_that_the_model_lacks_is_said_with_what_to_add() {
        let of = |dead_time_s, correction_s| {
            let (std_error_s, logging_s) = (0.0004, 0.005);
            dead_time(&Timing { dead_time_s, std_error_s, correction_s, logging_s })
        };
        let late = of(0.0238, 0.0);
        assert!(late.contains("23.8 ± 0.4 ms from input to motion (95 %: 23.0 to 24.6 ms), more"));
        assert!(dead_time_advice().starts_with("add actuator_delay or actuator_lag to"));
        assert!(of(0.0038, 0.0038).ends_with("3.8 ms are corrected: as much as logging can cause"));
        assert!(of(0.0038, 0.0).contains("because it may be caused by"));
        assert!(
            of(-0.0038, 0.0).starts_with("−3.8 ± 0.4 ms")
                && of(-0.0038, 0.0).contains("not corrected")
        );
        assert!(of(0.0002, 0.0).ends_with("not significantly different from zero"));
    }
}
