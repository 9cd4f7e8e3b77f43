//! Recordings whose input does not explain their motion.

use crate::diagnose::{Diagnosis, Errors, Judge, THRESHOLDS, other_times_as_good};
use crate::recording::Recording;
use crate::simulate::Hold;
use crate::study::Undetermined;

/// Why judged recordings do not determine a model: their speeds hardly change; or the input of other times explains the
/// motion as well, where the model explains less than half of how the speeds change, or where noise of the channels
/// alone would change them by more.
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
    if !is_noisy && errors.after <= THRESHOLDS.unexplained * change
        || other_times_as_good(diagnosis.last(), train, judge, hold) == 0
    {
        return None;
    }
    let explained = (1.0 - errors.after / change).max(0.0);
    Some(match is_noisy {
        true => Undetermined::Noisy { floor: errors.floor.sqrt(), change: change.sqrt() },
        false => Undetermined::Unrelated { explained },
    })
}
