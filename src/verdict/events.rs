//! Single times at which more acts on the robot than stationary noise explains.

use super::formula::residual_torques;
use crate::compare::{Residual, intervals};
use crate::diagnose::{THRESHOLDS, WindowFit, cutoff, mobility};
use crate::recording::Recording;
use crate::simulate::{Hold, halved};
use crate::study::Events;

/// Where the residual torque of a fit is larger than any stationary noise, and the unknown input between the rows,
/// explain. `None` if nowhere, and with a second body, which the torque balance does not contain.
pub(super) fn events(fit: &WindowFit, recordings: &[&Recording], hold: Hold) -> Option<Events> {
    let WindowFit { model, p, .. } = fit;
    if model.is_coupled() {
        return None;
    }
    let cutoff = cutoff(recordings, mobility(model, p));
    let of = |recordings: &[&Recording]| residual_torques(model, p, recordings, hold, cutoff);
    let [even, odd] = [0, 1].map(|phase| {
        let halves: Vec<Recording> = recordings.iter().map(|r| halved(r, phase)).collect();
        of(&halves.iter().collect::<Vec<_>>())
    });
    let times = recordings.iter().map(|r| r.t());
    let rows = times.zip(of(recordings)).zip(even.into_iter().zip(odd));
    let all: Vec<Residual> = rows
        .map(|((t, torque), (even, odd))| Residual { t, torque, halves: [even, odd] })
        .collect();
    let intervals = intervals(&all, THRESHOLDS.structure_of_blocks);
    let names = recordings.iter().map(|r| r.name().to_owned()).collect();
    (!intervals.is_empty()).then_some(Events { intervals, names })
}
