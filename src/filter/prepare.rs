//! A recording ready for the filter.

use super::standstill::standstill;
use crate::recording::{Noise, Recording};

/// What of a recording the filter needs and what does not change between passes.
#[derive(Clone, Debug)]
pub struct Prepared<'a> {
    /// The recording, from which the other fields are computed.
    pub recording: &'a Recording,
    /// Wheels at rest.
    pub still: Vec<[bool; 2]>,
    /// Variances of (alpha1, alpha2, omega1, omega2).
    pub variance: [f64; 4],
    /// Channels that are measured on their own.
    pub used: [bool; 4],
    /// Variance of w1 - w2, and of w1 + w2, that noise leaves in the local motion [rad^2/s^2].
    pub speed_variance: f64,
    /// Noise of the input from differences [N m].
    pub torque_noise: f64,
}

/// Prepares a recording: noise from differences, standstill, channels.
#[must_use]
pub fn prepare(recording: &Recording) -> Prepared<'_> {
    let noise = recording.noise();
    let measured = recording.measured();
    // speeds computed from the angles are not an independent measurement
    let speeds = measured.omega && !(measured.alpha && recording.speeds_are_smoothed());
    // a channel without any visible noise still has rounding; nothing is known exactly
    let floor = |sigma: f64, scale: f64| (sigma * sigma).max((1e-6 * scale).powi(2));
    let largest = |values: &[[f64; 2]], i: usize| {
        values.iter().map(|v| v[i].abs()).fold(0.0, f64::max).max(1e-3)
    };
    let variance = [
        floor(noise.alpha[0], 1.0),
        floor(noise.alpha[1], 1.0),
        floor(noise.omega[0], largest(recording.omega(), 0)),
        floor(noise.omega[1], largest(recording.omega(), 1)),
    ];
    Prepared {
        recording,
        still: standstill(recording, &noise.alpha, &noise.omega),
        variance,
        used: [measured.alpha, measured.alpha, speeds, speeds],
        speed_variance: speed_variance(recording, &noise, speeds),
        torque_noise: 0.5 * (noise.torque[0] + noise.torque[1]),
    }
}

/// In the middle of the longest piece: with even samples it is the same nearly everywhere. Rows that
/// repeat a slow sensor tell nothing, nor do speeds made from angles.
fn speed_variance(recording: &Recording, noise: &Noise, speeds: bool) -> f64 {
    let fresh = recording.fresh().iter().filter(|fresh| **fresh).count().max(1);
    let repeated = (recording.len() as f64 / fresh as f64).sqrt();
    let seen = Noise {
        alpha: noise.alpha.map(|sigma| sigma * repeated),
        omega: noise.omega.map(|sigma| if speeds { sigma * repeated } else { f64::INFINITY }),
        ..*noise
    };
    let longest = recording.pieces().iter().max_by_key(|piece| piece.len());
    longest.map_or(0.0, |piece| {
        let variance = recording.local_speed_variance((piece.start + piece.end) / 2, &seen);
        variance.iter().sum()
    })
}
