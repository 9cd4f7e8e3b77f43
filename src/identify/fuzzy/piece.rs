//! A part of a recording without a gap, with the data of a simulation.

use crate::recording::Recording;
use crate::simulate::Hold;

/// Longest step of the integrator in fitting \[s\].
const LONGEST_STEP: f64 = 0.01;

/// A part of a recording without a gap.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) t: Vec<f64>,
    /// Measured speeds [rad/s].
    pub(super) omega: Vec<[f64; 2]>,
    /// G u [rad/s²].
    input: Vec<[f64; 2]>,
    hold: Hold,
    /// Standard deviation of the measured speeds [rad/s].
    sigma: [f64; 2],
}

/// Inputs over one interval between samples, interpolated linearly.
pub(super) struct Interval {
    /// Number of integration steps.
    pub(super) steps: usize,
    /// Step size \[s\].
    pub(super) h: f64,
    omega: [[f64; 2]; 2],
    input: [[f64; 2]; 2],
}

impl Interval {
    /// Measured speeds [rad/s] and G u [rad/s²] after the share `c` of step `step`.
    #[inline(always)]
    pub(super) fn at(&self, step: usize, c: f64) -> ([f64; 2], [f64; 2]) {
        let c = (step as f64 + c) / self.steps as f64;
        let line =
            |ends: &[[f64; 2]; 2]| [0, 1].map(|i| ends[0][i] + c * (ends[1][i] - ends[0][i]));
        (line(&self.omega), line(&self.input))
    }
}

impl Piece {
    /// All pieces of a recording, with the input turned into accelerations.
    pub(super) fn all(recording: &Recording, gain: &[[f64; 2]; 2], hold: Hold) -> Vec<Self> {
        let sigma = recording.motion_noise().omega;
        let accelerate = |u: &[f64; 2]| [0, 1].map(|i| gain[i][0] * u[0] + gain[i][1] * u[1]);
        let pieces = recording.pieces().iter().cloned();
        pieces
            .map(|piece| Self {
                t: recording.t()[piece.clone()].to_vec(),
                omega: recording.omega()[piece.clone()].to_vec(),
                input: recording.torque()[piece].iter().map(accelerate).collect(),
                hold,
                sigma,
            })
            .collect()
    }

    /// ∫ sigma1² + sigma2² dt [rad²/s].
    pub(super) fn noise_floor(&self) -> f64 {
        let length = self.t[self.t.len() - 1] - self.t[0];
        length * self.sigma.iter().map(|s| s * s).sum::<f64>()
    }

    /// Weight of sample k in the trapezoid rule \[s\].
    pub(super) fn weight(&self, k: usize) -> f64 {
        let before = if k > 0 { self.t[k] - self.t[k - 1] } else { 0.0 };
        let after = if k + 1 < self.t.len() { self.t[k + 1] - self.t[k] } else { 0.0 };
        0.5 * (before + after)
    }

    /// From sample k - 1 to k.
    #[inline]
    pub(super) fn interval(&self, k: usize) -> Interval {
        let dt = self.t[k] - self.t[k - 1];
        let steps = ((dt / LONGEST_STEP - 1e-6).ceil() as usize).max(1);
        let last = if self.hold == Hold::Linear { k } else { k - 1 };
        Interval {
            steps,
            h: dt / steps as f64,
            omega: [self.omega[k - 1], self.omega[k]],
            input: [self.input[k - 1], self.input[last]],
        }
    }
}
