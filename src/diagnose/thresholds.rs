//! Every limit of the diagnosis, with its reason.

use crate::compare::{AT_FLOOR, REGIME_RATE};
use crate::effects::SURELY;

/// Limits of the diagnosis. All are dimensionless; those marked "taste" say what is worth a reader's
/// attention, the others follow from statistics or physics.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Thresholds {
    /// Least fall of the held-out error of an effect that is named, as a share (taste: a smaller one no
    /// reader would call a better model).
    pub least_fall: f64,
    /// The same without a validation recording: folds share the statistics of one trajectory.
    pub least_fall_crossed: f64,
    /// Share of the false-alarm rate that is asked of cross-validation, for the same reason.
    pub crossed_rate: f64,
    /// Error over the noise floor beyond which something is missing, and a shift in time may stand in for it. The
    /// floor is an estimate: of healthy sets one in a hundred lies above (prototype measurement on 110 sets of other
    /// simulators).
    pub above_floor: f64,
    /// Error over the noise floor beyond which something is missing whether the residual torque shows structure or
    /// not: no colour of the input noise that was tried makes three times the floor.
    pub far_above_floor: f64,
    /// Error beyond the floor that matters, as a share of the top speed (taste: 0.2 %).
    pub excess: f64,
    /// Error over the floor up to which a model, or a regime of driving, is at the floor, which is known to about as
    /// much.
    pub at_floor: f64,
    /// Squared error above the floor, as a share of the floor, below which nothing is left to explain: 2 % of the
    /// error, less than any floor is known to.
    pub nothing_left: f64,
    /// Share of the error above the floor that effects may leave and still explain it: the larger part is explained.
    pub unexplained: f64,
    /// Least -ln p of the strongest dependence of the residual torque that counts as structure: one in ten million
    /// for one look, so that some hundred bins and variables do not make one.
    pub structure: f64,
    /// Share of the residual torque from which on the variable that it depends on is named (taste).
    pub named_share: f64,
    /// Chance that any regime of driving is called significant where the model is right.
    pub regime_rate: f64,
    /// Error as a share of the top speed below which a model is useful: what feedforward leaves to a speed
    /// controller without trouble (taste).
    pub useful: f64,
    /// The same below which a model is poor: beyond it the sign of small accelerations is not predicted (taste).
    pub poor: f64,
    /// Error over the floor beyond which a likely effect is mentioned.
    pub likely_above_floor: f64,
    /// Least fall of the held-out error of a likely effect.
    pub likely_fall: f64,
    /// Bayesian information criterion below which evidence counts as strong (Kass and Raftery 1995: 6 to 10).
    pub strong: f64,
    /// Bayesian information criterion above which the regression rules an effect out.
    pub ruled_out: f64,
    /// Difference of the criterion below which two effects are not distinguishable (odds of 20 to 1).
    pub alike: f64,
    /// The same as a share of the criterion itself, where errors are far above the noise (they are no independent
    /// values, which the criterion counts).
    pub alike_share: f64,
    /// Share of what the first refit gains that decides nothing: others stop where their steps gain less.
    pub negligible_share: f64,
    /// Candidates that are refitted at each step, those that come first in the screening.
    pub refitted: usize,
    /// The same where the model has a second body, whose derivatives cost a simulation each.
    pub refitted_coupled: usize,
    /// Share of the criterion of the screening's best below which an effect with a second body is not refitted:
    /// to first order it explains too little to come first.
    pub far_behind: f64,
    /// Share of the squared error that the best refit may leave before effects with a second body are fitted
    /// though they are far behind, and that a low-pass of the sensors may leave and be one: the larger part is then
    /// unexplained, or explained.
    pub most_left: f64,
    /// Starts of an effect with several that are followed to their minimum.
    pub followed: usize,
    /// Standard errors within which a value may still be another: a delay none, or one that logging explains, the
    /// parameter of an effect zero (a chance of one in twenty).
    pub uncertain: f64,
    /// Rows by which a lag or delay that is named exceeds what logging explains (taste): what is known to a hundredth
    /// of a row exceeds it by what a controller takes for its work.
    pub least_shift: f64,
    /// Shift of the input that each habit of logging explains, in rows: the mean over a row, a value that is held
    /// through it, and a difference of angles all lie half a row off. Beside angles a difference is found and corrected;
    /// a shift of speeds that were recorded alone may be both.
    pub logging: f64,
    /// Fewest held-out windows on which a fall of the error can be tested.
    pub fewest_windows: usize,
    /// Other effects of a step that are tried in its place once several are found (cost: a fit for each effect
    /// behind it).
    pub exchanged: usize,
}

/// The limits that the program uses.
pub const THRESHOLDS: Thresholds = Thresholds {
    least_fall: 0.01,
    least_fall_crossed: 0.02,
    crossed_rate: 0.4,
    above_floor: 1.5,
    far_above_floor: 3.0,
    excess: 0.002,
    at_floor: AT_FLOOR,
    nothing_left: 0.04,
    unexplained: 0.5,
    structure: 16.0,
    named_share: 0.01,
    regime_rate: REGIME_RATE,
    useful: 0.05,
    poor: 0.2,
    likely_above_floor: 1.2,
    likely_fall: 0.02,
    strong: 10.0,
    ruled_out: 10.0,
    alike: 6.0,
    alike_share: 0.1,
    negligible_share: 0.01,
    refitted: 8,
    refitted_coupled: 2,
    far_behind: 0.25,
    most_left: 0.5,
    followed: 2,
    uncertain: SURELY,
    least_shift: 0.25,
    logging: 0.5,
    fewest_windows: 4,
    exchanged: 4,
};
