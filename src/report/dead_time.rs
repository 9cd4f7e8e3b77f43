//! Text on the dead time between input and motion.

use crate::diagnose::Timing;
use crate::effects::{self, Change};

/// Number of standard errors for an interval of 95 %.
const INTERVAL: f64 = 1.96;

/// Whether the motion is delayed by more than a row of `step` \[s\] and no part of it was corrected: a logger
/// that holds its input explains half a row, one that differentiates an encoder another half.
#[must_use]
pub fn is_late(timing: &Timing, step: f64) -> bool {
    timing.correction_s == 0.0 && earliest(timing) > step
}

/// Lower end of the interval \[s\].
fn earliest(timing: &Timing) -> f64 {
    timing.dead_time_s - INTERVAL * timing.std_error_s
}

/// The dead time between input and motion with its interval and its treatment, in rows of `step` \[s\].
#[must_use]
pub fn dead_time(timing: &Timing, step: f64) -> String {
    let ms = |seconds: f64| format!("{:.1}", 1e3 * seconds);
    let Timing { dead_time_s, std_error_s, correction_s } = *timing;
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
    if is_late(timing, step) {
        return format!(
            "{value}, more than logging explains. The model has no such time, and its inertias and friction take a part \
             of it: add {} to `effects` of [model], or let a [diagnosis] decide",
            shifting().join(" or ")
        );
    }
    if dead_time_s.abs() > INTERVAL * std_error_s {
        return format!("{value}, left in: it may stand for something else that the model lacks");
    }
    format!("{value}, not distinguished from none")
}

/// The effects that shift the input in time.
fn shifting() -> Vec<String> {
    let all = effects::all();
    all.iter().filter(|e| e.change() == Change::TimeShift).map(|e| e.id()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_that_the_model_lacks_is_said_with_what_to_add() {
        let of = |dead_time_s, correction_s| {
            dead_time(&Timing { dead_time_s, std_error_s: 0.0004, correction_s }, 0.01)
        };
        let late = of(0.0238, 0.0);
        assert!(late.contains("23.8 ± 0.4 ms from input to motion (95 %: 23.0 to 24.6 ms), more"));
        let named = ["actuator_delay", "actuator_lag"].iter().all(|id| late.contains(id));
        assert!(named, "{late}");
        assert!(of(0.0038, 0.0038).ends_with("3.8 ms of it by logging and taken out"));
        assert!(of(0.0038, 0.0).contains("left in: it may stand for something else"));
        assert!(of(-0.0038, 0.0).contains("left in"));
        assert!(of(0.0002, 0.0).ends_with("not distinguished from none"));
    }
}
