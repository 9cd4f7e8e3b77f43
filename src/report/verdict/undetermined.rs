//! Words for recordings that do not determine a model.

use crate::report::format::{percent, significant};
use crate::study::Undetermined;

/// Text in place of a comparison with the noise floor.
#[must_use]
pub fn not_determined(why: Undetermined) -> String {
    match why {
        Undetermined::Columns => OF_COLUMNS.to_owned(),
        Undetermined::Steady { change } => format!(
            "The model cannot be determined from these recordings: the speeds hardly change. Of the change of a speed within \
             2 s, {} rad/s (root mean square), the model explains less than half, so that its parameters say little.",
            significant(change, 2)
        ),
        Undetermined::Noisy { floor, change } => format!(
            "The model cannot be determined from these recordings: the noise of their channels would change the simulated \
             speeds by {} rad/s within 2 s, and the measured speeds change by {} rad/s (root mean square).",
            significant(floor, 2),
            significant(change, 2)
        ),
        Undetermined::Unrelated { explained } => format!(
            "The recorded input does not explain this motion: the model explains {} of the change of the speeds within 2 s, \
             and as much of it with the input of other times. Speeds may be set-points instead of measurements, the input \
             may lack its sign or belong to other motors, the rows of the two may have different times, or a torque outside \
             the catalogue may dominate the motion.",
            percent(explained)
        ),
        Undetermined::Short { seconds } => format!(
            "Whether an effect is missing cannot be determined: the training recordings last {} s together, less than a \
             window of the simulation error.",
            significant(seconds, 2)
        ),
        Undetermined::Windows { windows } => format!(
            "{}: the training recordings have {windows} windows of 1 s, which determine no parameter in the fit of the \
             diagnosis. The estimates of the methods are those of all rows.",
            untested(None)
        ),
        Undetermined::Untested { windows, validated, fails } => format!(
            "{}: the {} recordings have {windows} windows of 1 s, too few for a comparison of two models.",
            untested(fails),
            if validated { "validation" } else { "training" }
        ),
        Undetermined::BetweenRows { share, step_s, .. } => format!(
            "The inertias cannot be determined from these recordings: between two rows of {step_s:.3} s the input may act \
             by {:.0} % of the torque that accelerates the robot. The simulation error of such a fit does not measure its \
             quality.",
            100.0 * share
        ),
    }
}

/// What cannot be tested; `fails`: error over noise floor of the training recordings, if the model fails there.
fn untested(fails: Option<f64>) -> String {
    match fails {
        Some(ratio) => format!(
            "Something is missing: on the recordings that were fitted the 2 s simulation error is {} times the noise \
             floor. Which effect it is cannot be tested",
            significant(ratio, 2)
        ),
        None => "Whether an effect is missing cannot be tested".to_owned(),
    }
}

const OF_COLUMNS: &str = "The model cannot be determined from these columns: a1 is not identifiable. The \
                            simulation error of such a fit does not measure its quality.";
