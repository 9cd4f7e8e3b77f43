//! What a recording keeps for the initial states of simulations.

use std::sync::Arc;

use wide::f64x2;

/// The neighbourhoods of the rows of a recording.
#[derive(Clone, Debug)]
pub(super) struct Neighbourhoods {
    /// Half widths of all but the widest, ascending.
    pub(super) narrower: Vec<usize>,
    pub(super) widest: usize,
    /// Reciprocals of the variances of angle and speed, wheel by wheel; zero for a channel that was not measured.
    pub(super) weights: [f64x2; 2],
    /// Noise of the angles, if they alone were measured: rows that repeat the last value, and counts that hide the speed,
    /// show no corner.
    pub(super) angles_alone: Option<[f64; 2]>,
}

/// How the speeds of a recording follow changes of its input within a neighbourhood.
#[derive(Clone, Debug)]
pub(super) struct Response {
    pub(super) neighbourhoods: Neighbourhoods,
    /// The recorded input: a copy of the recording with another one has the same initial states, because it has the same
    /// motion.
    pub(super) input: Arc<[[f64; 2]]>,
    /// Acceleration of each wheel by the input of each wheel [rad/s² per unit of the input].
    pub(super) gain: [[f64; 2]; 2],
    /// When the input of a row acts.
    pub(super) acts: Acts,
    /// Mean square error of the speeds by what is left of the shape of the motion [rad^2/s^2].
    pub(super) curvature: [f64; 2],
}

/// When the input of a row acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Acts {
    /// Linearly between the rows.
    #[default]
    Between,
    /// From the row to the next one.
    After,
    /// From the row before to this one.
    Before,
}

impl Acts {
    pub(super) const ALL: [Self; 3] = [Self::Between, Self::After, Self::Before];

    /// Mean input between row `n` and the next one.
    pub(super) fn mean(self, m: &[[f64; 2]], n: usize, i: usize) -> f64 {
        match self {
            Self::Between => 0.5 * (m[n][i] + m[n + 1][i]),
            Self::After => m[n][i],
            Self::Before => m[n + 1][i],
        }
    }
}
