//! Every limit of the diagnosis, with its reason.

use crate::compare::{AT_FLOOR, REGIME_RATE};
use crate::conditioning::DEAD_S;
use crate::effects::SURELY;

/// Limits of the diagnosis. The ending of a name is its unit (`_s`, `_rad`); the others are dimensionless. Those marked
/// "judgement" are choices of what is worth reporting; the others follow from statistics, physics or measurements.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Thresholds {
    /// Smallest reduction of the held-out error, as a share, by an effect that is named (judgement: a smaller one is no
    /// better model in practice).
    pub least_fall: f64,
    /// The same without a validation recording, where the folds are parts of the same trajectory.
    pub least_fall_crossed: f64,
    /// Factor on the false-alarm rate in cross-validation, for the same reason.
    pub crossed_rate: f64,
    /// Ratio of error to noise floor above which something is missing, and above which a shift in time is not
    /// removed because it may compensate for another effect. The floor is an estimate: one healthy set in a hundred
    /// lies above (prototype measurement on 110 sets of other simulators).
    pub above_floor: f64,
    /// Ratio of error to noise floor above which something is missing even if the residual torque shows no
    /// structure: slow noise of the input would need eight times the variance of all noise that the channels show
    /// (judgement; noise as large as the white one caused 3.1 times the floor once).
    pub far_above_floor: f64,
    /// Largest autocorrelated noise of a measured input as a share of its root mean square (judgement: sensors of
    /// currents and torques are accurate to some percent); a larger slow part of the residual torque is a missing
    /// effect.
    pub sensor_noise: f64,
    /// Error above the floor that matters, as a share of the top speed (judgement: 0.2 %).
    pub excess: f64,
    /// Ratio of error to floor up to which a model, or a regime of driving, is at the floor; the floor itself is
    /// uncertain by about as much.
    pub at_floor: f64,
    /// Squared error above the squared floor, as a share of the latter, below which nothing remains to be
    /// explained: 2 % of the error, less than the uncertainty of the floor.
    pub nothing_left: f64,
    /// Largest share of the error above the floor that may remain if effects are to explain it: they explain at
    /// least half.
    pub unexplained: f64,
    /// Smallest -ln p of the strongest dependence of the residual torque that counts as structure: a chance of one
    /// in ten million for a single test, so that about a hundred tests (bins and variables) cause no false alarm.
    pub structure: f64,
    /// Smallest -ln p of a dependence of the residual torque, with blocks of 1 s as the independent values, for which
    /// coloured noise of the input is no explanation: with about thirty curves such noise exceeds it once in a thousand
    /// recordings. The same of a single block among all blocks.
    pub structure_of_blocks: f64,
    /// Largest ratio, and inverse of the smallest, of what an effect removes from the squared error with every other
    /// row of the input to what it removes with all rows: one for an effect of the robot. An error of interpolation is
    /// four times as large with every other row for steps of the input, and larger for a smooth one, and so is what
    /// compensates for it; two is the geometric mean of one and four.
    pub alike_at_half_rate: f64,
    /// Smallest share of the residual torque that a variable must explain to be named (judgement).
    pub named_share: f64,
    /// Probability that any regime of driving is called significant if the model is correct.
    pub regime_rate: f64,
    /// Error as a share of the top speed below which a model is useful: a speed controller easily corrects what
    /// such a feedforward leaves (judgement).
    pub useful: f64,
    /// Error as a share of the top speed below which a model is poor: above it even the sign of small accelerations
    /// is not predicted (judgement).
    pub poor: f64,
    /// Ratio of error to floor above which a likely effect is mentioned.
    pub likely_above_floor: f64,
    /// Smallest reduction of the held-out error by a likely effect.
    pub likely_fall: f64,
    /// Reduction of the Bayesian information criterion (BIC) above which evidence is strong (Kass and Raftery 1995:
    /// 6 to 10).
    pub strong: f64,
    /// Increase of the BIC of the regression above which it rules an effect out.
    pub ruled_out: f64,
    /// Difference of BIC below which two effects are not distinguishable (odds of 20 to 1); far above the noise, z² of
    /// the difference between windows (Vuong's test).
    pub alike: f64,
    /// Share of the gain of the best refit by which another may be behind that is continued to convergence (cost: a
    /// descent for each).
    pub near_share: f64,
    /// Smallest number of orders of an effect from which on their evidence is divided by its median: a disturbance of
    /// all frequencies raises all of them, and the median of fewer is that of the effect itself.
    pub many_orders: usize,
    /// Share of the gain of the first refit that is negligible: other refits stop when their steps gain less.
    pub negligible_share: f64,
    /// Number of candidates, the first of the screening, that are refitted at each step.
    pub refitted: usize,
    /// The same if the model has a second body, for which every derivative requires a simulation.
    pub refitted_coupled: usize,
    /// Number of candidates, those of the largest evidence, whose error on the judged recordings is simulated (cost:
    /// one simulation each).
    pub judged: usize,
    /// Share of the best criterion of the screening below which an effect with a second body is not refitted: to
    /// first order it explains too little.
    pub far_behind: f64,
    /// Share of the squared error that may remain after the best refit; above it, effects with a second body are
    /// fitted even if the screening ranked them last. A low-pass of the speed sensors is also accepted only if it
    /// leaves less than this share.
    pub most_left: f64,
    /// Number of starts of an effect with several starts that are followed to a minimum.
    pub followed: usize,
    /// Number of standard errors within which a value is not distinguished from another one: a delay from zero or
    /// from a delay that logging explains (a chance of one in twenty).
    pub uncertain: f64,
    /// Number of standard errors by which parameters of a fit may be wrong in the part of an error that they explain (a
    /// chance of one in twenty).
    pub parameter_errors: f64,
    /// Number of rows by which a named lag or delay must exceed the delay that logging explains (judgement): with a
    /// precision of a hundredth of a row, the computing time of a controller alone exceeds it.
    pub least_shift: f64,
    /// Shift of the input, in rows, that each habit of logging explains: the mean over a row, a value held through
    /// it, and a difference of angles are each half a row late. Beside measured angles a difference is detected and
    /// corrected; the shift of speeds recorded alone may contain both.
    pub logging: f64,
    /// First shift of the input that is searched, in rows: an input may be recorded after it has acted, by a row and a
    /// half at most (judgement).
    pub earliest: f64,
    /// Longest delay in seconds that is searched, that of slow motor controllers on a bus.
    pub longest_delay_s: f64,
    /// Number of rows of rest before a step of the input that shows the latest dead time.
    pub rest_rows: usize,
    /// Input that counts as none before such a step, as a share of its range (judgement).
    pub no_input: f64,
    /// Smallest of these steps, as a share of the range of the input: a smaller one may be held by friction
    /// (judgement).
    pub least_step: f64,
    /// Number of standard deviations of its noise above which a speed or an angle shows the onset of motion: less than
    /// one row in a million exceeds it by chance.
    pub moves_errors: f64,
    /// Share of the top speed above which a wheel moves, for sensors without visible noise (judgement).
    pub moves_share: f64,
    /// Share of the top speed below which a wheel at rest has both directions by noise; only faster rows count for the
    /// share of motion against the main direction (judgement).
    pub backward: f64,
    /// Smallest number of held-out windows on which a reduction of the error can be tested.
    pub fewest_windows: usize,
    /// Length of a window in seconds: long enough for friction and viscous effects, short enough that noise of the
    /// input does not dominate; the acceptance test uses the same.
    pub window_s: f64,
    /// Largest growth of the variance of a speed over a window by noise of the input, in variances of the sensor: the
    /// noise is an estimate, and a recording with a large estimate must not lose its weight if the error of the model
    /// is larger than both (judgement).
    pub most_growth: f64,
    /// Factor by which an error of the initial speeds must grow over a window for its growth to be part of the fit
    /// (judgement: below two, the constant by which a window is corrected otherwise contains the larger part of it).
    pub grown_start: f64,
    /// Largest correlation of the errors of neighbouring windows by which their number is corrected (judgement: one
    /// window in nineteen is then independent).
    pub most_correlated: f64,
    /// Largest response of a speed to a relative change of a parameter that is linear, in top speeds: beyond it a
    /// change by 1 %, an ordinary uncertainty, would change the speed by its whole range.
    pub most_response: f64,
    /// Factor on the scatter of the times of steps between the rows with which these must be less likely: an error of
    /// the model at the steps is as likely with any scatter (judgement: half the standard deviation).
    pub less_scatter: f64,
    /// Probability that any parameter of any recording differs so far where all are one: one log in a million.
    pub differs_by_chance: f64,
    /// Smallest relative difference of a parameter between recordings that is reported (judgement: smaller ones do not
    /// justify a second fit).
    pub least_difference: f64,
    /// Number of standard errors by which the input of one recording acts at another time, or its angles start at other
    /// values, than those of the others: one log in a million by chance.
    pub phase_differs: f64,
    /// Smallest difference of these times, in rows, that is corrected (judgement).
    pub least_phase: f64,
    /// Largest difference of the phases between controller and log, in rows: a phase is a part of a row.
    pub most_phase: f64,
    /// Standard error in radians of the phase of a periodic torque above which it is undetermined: that of an amplitude
    /// of ten standard errors. Errors of windows are not independent, and for periodic torques that are absent,
    /// separate phases in each recording fit with six.
    pub known_angle_rad: f64,
    /// Smallest phase in radians for which the angles of a recording are shifted; without the shift a twentieth of the
    /// torque would remain.
    pub least_angle_rad: f64,
    /// Number of other effects of a step that are tried in its place if several effects are found (cost: one fit
    /// for each later effect).
    pub exchanged: usize,
    /// Time in seconds for which the sensors of a wheel must be constant, while its input must have moved it, for their
    /// rows to be left out before the diagnosis: six times the longest dead time that is modelled (0.15 s), which
    /// depends on radio links and buses and not on the robot.
    pub dead_s: f64,
}

/// The limits that the program uses.
pub const THRESHOLDS: Thresholds = Thresholds {
    least_fall: 0.01,
    least_fall_crossed: 0.02,
    crossed_rate: 0.4,
    above_floor: 1.5,
    far_above_floor: 3.0,
    sensor_noise: 0.1,
    excess: 0.002,
    at_floor: AT_FLOOR,
    nothing_left: 0.04,
    unexplained: 0.5,
    structure: 16.0,
    structure_of_blocks: 10.0,
    alike_at_half_rate: 2.0,
    named_share: 0.01,
    regime_rate: REGIME_RATE,
    useful: 0.05,
    poor: 0.2,
    likely_above_floor: 1.2,
    likely_fall: 0.02,
    strong: 10.0,
    ruled_out: 10.0,
    alike: 6.0,
    near_share: 0.1,
    many_orders: 10,
    negligible_share: 0.01,
    refitted: 8,
    refitted_coupled: 2,
    judged: 8,
    far_behind: 0.25,
    most_left: 0.5,
    followed: 2,
    uncertain: SURELY,
    parameter_errors: 2.0,
    least_shift: 0.25,
    logging: 0.5,
    earliest: -1.5,
    longest_delay_s: 0.15,
    rest_rows: 5,
    no_input: 0.02,
    least_step: 0.25,
    moves_errors: 5.0,
    moves_share: 0.02,
    backward: 0.05,
    fewest_windows: 4,
    window_s: 1.0,
    most_growth: 8.0,
    grown_start: 2.0,
    most_correlated: 0.9,
    most_response: 100.0,
    less_scatter: 0.25,
    differs_by_chance: 1e-6,
    least_difference: 0.1,
    phase_differs: 5.0,
    least_phase: 0.1,
    most_phase: 1.0,
    known_angle_rad: 0.1,
    least_angle_rad: 0.05,
    exchanged: 4,
    dead_s: DEAD_S,
};
