//! The input between its rows: held or interpolated.

use super::evidence::{evidence, noiseless};
use super::scale::scale_of;
use super::thresholds::THRESHOLDS;
use super::timing::timed;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Whether the input is held through a row, as by a controller at the rate of the log, or varies linearly to
/// the next row: the model at `p` is fitted with both, each with its own time of the input. Linear
/// interpolation is kept unless the windows contradict it with odds of twenty to one. If the error of the
/// model is larger than noise, there is no decision.
///
/// Linear interpolation reduces the noise of the recorded input; therefore the contribution of noise to the
/// errors is subtracted in both cases.
///
/// Returns the parameters fitted with the held input, if it is held: those from a torque balance may be far
/// from them as long as the input has the wrong time.
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
