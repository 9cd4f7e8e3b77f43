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
#[must_use]
pub fn hold(model: &Model, p: &[f64], recordings: &[&Recording]) -> Hold {
    let scale = scale_of(model, p, recordings);
    let fits = [Hold::Linear, Hold::Constant].map(|hold| {
        let timed = timed(model, p, 0.0, recordings, hold, &scale)?;
        Some((noiseless(&timed.windows, &timed.fit)?, timed.error()))
    });
    let [Some((linear, _)), Some((constant, error))] = fits else { return Hold::Linear };
    // both by the likelihood of the rows and by what the windows scatter about
    let likely = linear.iter().sum::<f64>() - constant.iter().sum::<f64>() > THRESHOLDS.alike;
    let sure = evidence(&linear, &constant) > THRESHOLDS.alike;
    let right = error <= THRESHOLDS.above_floor;
    if likely && sure && right { Hold::Constant } else { Hold::Linear }
}
