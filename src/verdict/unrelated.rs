//! Recordings whose input does not explain their motion.

use crate::diagnose::{Diagnosis, Errors, Judge, THRESHOLDS, other_times_as_good};
use crate::recording::Recording;
use crate::simulate::Hold;
use crate::study::Undetermined;

/// Why judged recordings do not determine a model: their speeds hardly change; noise of the channels alone would change
/// them by more, and no effect is found; or the model explains less than half of their change, and as much of it with
/// the input of other times.
pub(super) fn unrelated(
    diagnosis: &Diagnosis,
    (judge, hold): (&Judge, Hold),
    errors: &Errors,
    train: &[Recording],
) -> Option<Undetermined> {
    let change = judge.change();
    if errors.are_of_steady_speeds(change) {
        return Some(Undetermined::Steady { change: change.sqrt() });
    }
    let is_noisy = errors.floor > change;
    let is_poor = errors.after > THRESHOLDS.unexplained * change;
    // such noise hides every effect, except those that were found
    let hides = is_noisy && diagnosis.steps.is_empty();
    let is_unrelated = || other_times_as_good(diagnosis.last(), train, judge, hold) > 0;
    if !hides && !((is_noisy || is_poor) && is_unrelated()) {
        return None;
    }
    let explained = (1.0 - errors.after / change).max(0.0);
    Some(match is_noisy {
        true => Undetermined::Noisy { floor: errors.floor.sqrt(), change: change.sqrt() },
        false => Undetermined::Unrelated { explained },
    })
}
