//! The cut-off of the low-pass that the screening looks through.

use crate::recording::Recording;

/// Largest cut-off as a share of the sampling rate: beyond it derivatives by differences are wrong by
/// more than a tenth.
const RESOLVED: f64 = 0.1;
/// Largest rms torque due to noise of the acceleration after the low-pass, as a share of the rms torque.
const NOISE: f64 = 0.05;
/// Smallest number of periods of the cut-off frequency in the shortest recording, so that the fit is well
/// conditioned.
const CYCLES: f64 = 20.0;

/// Cut-off of the low-pass \[Hz\]: a tenth of the sampling rate, or lower where noise of the measured speeds
/// would make more than 5 % of the rms torque out of the acceleration.
///
/// ```text
/// var(dw/dt) = 8 π² σ² fc³/(3 fs)
/// ```
#[must_use]
pub fn cutoff(recordings: &[&Recording], mobility: f64) -> f64 {
    let one = |r: &&Recording| {
        let rate = 1.0 / r.step();
        let sum: f64 = r.torque().iter().flatten().map(|m| m * m).sum();
        let rms = (sum / (2 * r.len()) as f64).sqrt();
        let noise = r.motion_noise().omega;
        let sigma = noise[0].max(noise[1]).max(1e-9 * r.top_speed());
        let allowed = NOISE * rms * mobility / sigma;
        let new = r.readings() as f64 / r.len() as f64;
        let eight = 8.0 * std::f64::consts::PI.powi(2);
        let by_noise = (allowed * allowed * 3.0 * rate * new / eight).cbrt();
        by_noise.min(RESOLVED * rate * new).max(CYCLES / r.covered()).min(0.4 * rate)
    };
    recordings.iter().map(one).fold(f64::INFINITY, f64::min)
}
