//! Recordings whose input does not explain their motion.

use crate::diagnose::{Diagnosis, Errors, Judge, OTHER_TIMES, THRESHOLDS, other_times_as_good};
use crate::recording::Recording;
use crate::simulate::Hold;
use crate::study::Undetermined;

/// Why judged recordings do not determine a model whose simulation explains too little of how their speeds `change`
/// [rad^2/s^2]: the speeds hardly change; noise of the channels alone would make them change by as much; or the input of
/// other times explains the motion as well.
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
    if errors.floor > change {
        return Some(Undetermined::Noisy { floor: errors.floor.sqrt(), change: change.sqrt() });
    }
    if errors.after <= THRESHOLDS.unexplained * change {
        return None;
    }
    let times = other_times_as_good(&diagnosis.base, train, judge, hold);
    let explained = (1.0 - errors.after / change).max(0.0);
    (times > 0).then_some(Undetermined::Unrelated { explained, times, of: OTHER_TIMES })
}
