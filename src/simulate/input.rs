//! What a simulation is given, and why it may stop.

use crate::model::ModelError;
use crate::recording::{Recording, RecordingError};

/// What the input does between two samples.
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
    /// Runs in a straight line from sample to sample (first-order hold).
    #[default]
    Linear,
    /// Keeps the value of the earlier sample (zero-order hold).
    Constant,
}

/// Error of a straight line between the rows at the whole rate over what halving the rate changes: it falls
/// as the square of the interval, so of a difference of 4 - 1 parts one is left.
pub const BETWEEN_ROWS: f64 = 1.0 / 3.0;

/// A signal of a recording with every other row, the even (`phase` 0) or the odd ones, on the line between its
/// neighbours. That serves an input that is held as well: holding the row before would make it late by half a row in the
/// mean, which no shape of the input between the rows does.
pub(crate) fn every_other(
    recording: &Recording,
    signal: &[[f64; 2]],
    phase: usize,
) -> Vec<[f64; 2]> {
    let t = recording.t();
    let mut out = signal.to_vec();
    for piece in recording.pieces() {
        for k in piece.clone().filter(|k| k % 2 == phase && *k > piece.start && k + 1 < piece.end) {
            let share = (t[k] - t[k - 1]) / (t[k + 1] - t[k - 1]);
            let (from, to) = (signal[k - 1], signal[k + 1]);
            out[k] = [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
        }
    }
    out
}

/// The input of a simulation: one row a sample.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Time \[s\], strictly increasing.
    pub t: &'a [f64],
    /// Recorded input [N m]; effects on the input are applied to it.
    pub torque: &'a [[f64; 2]],
    /// Between the samples.
    pub hold: Hold,
}

/// Why a simulation stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The model has no acceleration.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// What was simulated is no recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The motion left all bounds.
    #[error("the simulated motion diverges at t = {t:.3} s (wheel speed above {limit:.0e} rad/s)")]
    Diverged {
        /// When \[s\].
        t: f64,
        /// Bound [rad/s].
        limit: f64,
    },
}

/// Where the nonlinear functions f3, f4 take their argument from.
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
