//! The step between two rows: what acts in it, and what its prediction used.

use crate::simulate::Ends;

/// The input over one sample.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    /// Time at the start, since the start of the recording \[s\].
    pub(super) t: f64,
    /// Length \[s\].
    pub(super) step: f64,
    /// Acting input that the step uses [N m].
    pub(super) input: [f64; 2],
    /// The acting input at both ends of the sample [N m].
    pub(super) ends: Ends,
    /// Correction of the mean input for its effect on the angle (first moment over the step), see
    /// [`lag_of_angle`] [N m].
    pub(super) tilt: [f64; 2],
    /// Change of the recorded input over the sample [N m].
    pub(super) change: [f64; 2],
    /// Smoothed less recorded input, mean over the row [N m]; derivatives by inertias are taken with
    /// the smoothed one.
    pub(super) smoother: [f64; 2],
    /// Variance of a friction along each direction that may reverse within the sample [N^2 m^2],
    /// for steps that do not add it themselves.
    pub(super) crossing: [f64; 4],
    /// Derivative of `input` by each parameter; empty where no effect acts on the input.
    pub(super) by_parameter: &'a [[f64; 2]],
    /// Derivative of `ends` by each parameter that acts through them.
    pub(super) ends_by_parameter: &'a [Option<Ends>],
    /// Variance of the speed of the body due to sensor noise alone, for any process noise
    /// [rad^2/s^2].
    pub(super) speed_variance: f64,
    /// Wheels at rest during the sample.
    pub(super) still: [bool; 2],
}

/// Where a prediction was linearised, for the columns that are propagated with it.
#[derive(Clone, Copy)]
pub(super) struct Predicted {
    /// Mean acceleration over the step [rad/s^2].
    pub(super) acceleration: [f64; 2],
    /// Friction signs at its start, statistically linearised.
    pub(super) sign: [f64; 4],
    /// Angles in the middle of the step \[rad\].
    pub(super) alpha: [f64; 2],
    /// Speeds at its start [rad/s].
    pub(super) omega: [f64; 2],
    /// Variances of angles and speeds at its start.
    pub(super) variance: [f64; 4],
    /// Variance of w1 - w2 and of w1 + w2 there.
    pub(super) spread: [f64; 2],
}

/// Difference between the change of the angle by the mean of an input and that by the input, from
/// its first moment.
///
/// ```text
/// ∫ (h - s) M ds = h² (mean/2 - tilt),   tilt = c (1 - c)/3 (M1 - M0)
/// ```
/// with the weight c of the later row in the mean: exact for a linear input (c = 1/2, M0/3 + M1/6),
/// a held one (c = 0), and one held over each of m parts of the row, c = (m - 1)/(2 m). Derived
/// here.
pub(super) fn lag_of_angle(later: f64, start: &[f64; 2], end: &[f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| later * (1.0 - later) / 3.0 * (end[i] - start[i]))
}
