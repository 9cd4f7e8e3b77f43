//! A recording ready for the filter.

use crate::recording::{Recording, Sensing};

/// The quantities of a recording that the filter needs and that do not change between passes.
#[derive(Clone, Debug)]
pub struct Prepared<'a> {
    /// The recording, from which the other fields are taken.
    pub recording: &'a Recording,
    /// Wheels at rest.
    pub still: &'a [[bool; 2]],
    /// Variances of (alpha1, alpha2, omega1, omega2).
    pub variance: [f64; 4],
    /// Channels that are measured on their own.
    pub used: [bool; 4],
    /// Variance of w1 - w2, and of w1 + w2, in the local motion due to noise [rad^2/s^2].
    pub speed_variance: f64,
    /// Noise of the input from differences [N m].
    pub torque_noise: f64,
}

/// A view of the recording's own [`Recording::sensing`], with the noise of its input.
#[must_use]
pub fn prepare(recording: &Recording) -> Prepared<'_> {
    let Sensing { still, variance, used, speed_variance } = recording.sensing();
    let input = recording.input_noise();
    Prepared {
        recording,
        still,
        variance: *variance,
        used: *used,
        speed_variance: *speed_variance,
        torque_noise: 0.5 * (input[0] + input[1]),
    }
}
