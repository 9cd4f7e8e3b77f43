//! Input of a simulation, and errors of simulations.

use std::ops::Range;

use crate::math::Real;
use crate::model::ModelError;
use crate::recording::{Recording, RecordingError};

/// The input between two samples.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// Linear interpolation between samples (first-order hold).
    #[default]
    Linear,
    /// The value of the previous sample is held (zero-order hold).
    Constant,
}

/// Ratio of the error of linear interpolation at the full rate to the change by halving the rate: the error
/// is proportional to the square of the interval, so it is 1/(4 - 1) of the difference.
pub const BETWEEN_ROWS: f64 = 1.0 / 3.0;

/// A recording with only every other row of its input ([`Recording::half_rate_input`]).
pub(crate) fn halved(recording: &Recording, phase: usize) -> Recording {
    recording.with_torque(recording.half_rate_input(phase).into_owned())
}

/// A `signal` that is held from each row to the next, `shift` seconds later: its mean over each row, so that its
/// integral is exact. The end values of every piece are held.
pub(crate) fn held_later(recording: &Recording, signal: &[[f64; 2]], shift: f64) -> Vec<[f64; 2]> {
    let pieces = recording.pieces().iter();
    let of = |p: &Range<usize>| {
        mean_later(&recording.t()[p.clone()], &signal[p.clone()], shift, recording.step())
    };
    pieces.flat_map(of).collect()
}

/// The same for a signal without gaps, whose last row lasts for `last_s`. At a row the derivative is that of a later
/// input.
pub(crate) fn mean_later<T: Real>(
    t: &[f64],
    signal: &[[T; 2]],
    shift: T,
    last_s: f64,
) -> Vec<[T; 2]> {
    let sums = impulse(t, signal);
    let integral = |at: T| {
        let k = t.partition_point(|row| *row < at.value()).saturating_sub(1);
        [0, 1].map(|i| sums[k][i] + signal[k][i] * (at - t[k]))
    };
    let mean = |k: usize| {
        let h = t.get(k + 1).map_or(last_s, |next| next - t[k]);
        let (from, to) = (integral(-shift + t[k]), integral(-shift + (t[k] + h)));
        [0, 1].map(|i| (to[i] - from[i]) / h)
    };
    (0..t.len()).map(mean).collect()
}

/// Integral of a `signal` that is held from each of the times `t` to the next, from the first one to each.
pub(crate) fn impulse<T: Real>(t: &[f64], signal: &[[T; 2]]) -> Vec<[T; 2]> {
    let mut sums = vec![[T::from(0.0); 2]];
    for k in 1..t.len() {
        let sum = sums[k - 1];
        sums.push([0, 1].map(|i| sum[i] + signal[k - 1][i] * (t[k] - t[k - 1])));
    }
    sums
}

/// The input at the times of the rows, for balances of torques: an input that is held changes there, and the mean of
/// its values before and after acts as much later as the held one.
pub(crate) fn at_rows(pieces: &[Range<usize>], acting: &[[f64; 2]], hold: Hold) -> Vec<[f64; 2]> {
    let mut out = acting.to_vec();
    if hold == Hold::Linear {
        return out;
    }
    for piece in pieces {
        for k in piece.start + 1..piece.end {
            out[k] = [0, 1].map(|i| 0.5 * (acting[k - 1][i] + acting[k][i]));
        }
    }
    out
}

/// The input of a simulation: one row per sample.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Time \[s\], strictly increasing.
    pub t: &'a [f64],
    /// Recorded input [N m]; effects on the input are applied to it.
    pub torque: &'a [[f64; 2]],
    /// Between the samples.
    pub hold: Hold,
}

/// Why a simulation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The mass matrix is not positive definite.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The simulated channels are not a valid recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The motion diverged.
    #[error("the simulated motion diverges at t = {t:.3} s (wheel speed above {limit:.0e} rad/s)")]
    Diverged {
        /// Time \[s\].
        t: f64,
        /// Speed limit [rad/s].
        limit: f64,
    },
}

/// Argument of the nonlinear functions f3, f4 in the emulator.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Structure {
    /// From the emulator's own state.
    Parallel,
    /// From the measured state.
    SerialParallel,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn a_held_input_is_delayed_by_whole_rows_and_by_the_mean_over_a_row() {
        let t: Vec<f64> = (0..12).map(|k| 0.01 * f64::from(k)).collect();
        let held: Vec<[f64; 2]> =
            (0..12).map(|k| [f64::from(k * k % 5), f64::from(k % 3)]).collect();
        let omega = Some(held.clone());
        let channels = Channels { t, alpha: None, omega, torque: held.clone() };
        let recording = Recording::new("held", channels, DriveUnit::Volt).unwrap();
        for (shift, rows) in [(0.02, 2), (0.0, 0), (-0.01, -1)] {
            let later = held_later(&recording, &held, shift);
            for k in 0..12 {
                let from = (k - rows).clamp(0, 11) as usize;
                assert!((later[k as usize][0] - held[from][0]).abs() < 1e-9, "{shift} {k}");
            }
        }
        let later = held_later(&recording, &held, 0.003);
        for k in 1..12 {
            let mean = 0.3 * held[k - 1][0] + 0.7 * held[k][0];
            assert!((later[k][0] - mean).abs() < 1e-9, "{k}");
        }
    }
}
