//! What the recorded input does between its rows.

use super::evidence::{evidence, noiseless};
use super::scale::scale_of;
use super::thresholds::THRESHOLDS;
use super::timing::timed;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Whether the input is held through a row, as a controller at the rate of the log does, or runs on to the next row:
/// the model at `p` is fitted with either, each with the time of the input, and the line between the rows stands
/// unless the windows speak against it with odds of twenty to one. Where the model misses more than noise it does not
/// decide.
///
/// A line between the rows smooths the noise of the recorded input; what noise makes of the errors is therefore taken
/// out of both.
///
/// The parameters that were fitted to the held input, where it is held: those from a balance of the torques may be far
/// from them, as long as the input stands at the wrong time.
#[must_use]
pub fn held_input(model: &Model, p: &[f64], recordings: &[&Recording]) -> Option<Vec<f64>> {
    let scale = scale_of(model, p, recordings);
    let fits = [Hold::Linear, Hold::Constant].map(|hold| {
        let timed = timed(model, p, 0.0, recordings, hold, &scale)?;
        Some((noiseless(&timed.windows, &timed.fit)?, timed.error(), timed.fit.p))
    });
    let [Some((linear, ..)), Some((constant, error, mut fitted))] = fits else { return None };
    // both by the likelihood of the rows and by what the windows scatter about
    let likely = linear.iter().sum::<f64>() - constant.iter().sum::<f64>() > THRESHOLDS.alike;
    let sure = evidence(&linear, &constant) > THRESHOLDS.alike;
    let right = error <= THRESHOLDS.above_floor;
    fitted.truncate(p.len());
    (likely && sure && right).then_some(fitted)
}
