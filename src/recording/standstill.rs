//! Samples at rest, determined from the sensors.

use super::Recording;

/// Samples on both sides that are averaged.
const HALF: usize = 5;
/// Shortest run of still samples that counts.
const SHORTEST: usize = 10;
/// Angles that differ by more than this moved \[rad\].
const ANGLE: f64 = 0.02;

/// One flag a sample and wheel: the wheel stands still.
///
/// ```text
/// |mean alpha over the next 5 - mean alpha over the previous 5| < max(3 sigma_alpha sqrt(2/5), tiny), < 0.02 rad
/// |mean omega over 11| < 3 sigma_omega / sqrt(11),    runs of at least 10 samples
/// ```
/// `sigma_alpha` \[rad\] and `sigma_omega` [rad/s] are the standard deviations of the noise.
#[must_use]
pub(super) fn standstill(
    recording: &Recording,
    sigma_alpha: &[f64; 2],
    sigma_omega: &[f64; 2],
) -> Vec<[bool; 2]> {
    let mut still = vec![[false; 2]; recording.len()];
    let measured = recording.measured();
    for piece in recording.pieces().iter().filter(|p| p.len() > 2 * HALF + 1) {
        for k in piece.start + HALF..piece.end - HALF {
            for i in 0..2 {
                let mean = |values: &[[f64; 2]], from: usize, to: usize| {
                    values[from..to].iter().map(|v| v[i]).sum::<f64>() / (to - from) as f64
                };
                let (alpha, omega) = (recording.alpha(), recording.omega());
                let moved = (mean(alpha, k + 1, k + HALF + 1) - mean(alpha, k - HALF, k)).abs();
                let limit = 3.0 * sigma_alpha[i] * (2.0 / HALF as f64).sqrt();
                let angle_still = !measured.alpha || moved < limit.clamp(1e-9, ANGLE);
                let speed = mean(omega, k - HALF, k + HALF + 1).abs();
                let speed_limit = 3.0 * sigma_omega[i] / (2.0 * HALF as f64 + 1.0).sqrt();
                let speed_still = !measured.omega || speed < speed_limit.max(1e-9);
                still[k][i] = angle_still && speed_still;
            }
        }
    }
    for i in 0..2 {
        trim_runs(&mut still, i);
        drop_short_runs(&mut still, i);
    }
    still
}

/// A wheel that has just begun to move is not seen to move yet: the ends of runs do not count.
fn trim_runs(still: &mut [[bool; 2]], i: usize) {
    let seen: Vec<bool> = still.iter().map(|s| s[i]).collect();
    for k in 0..seen.len() {
        let around = k.saturating_sub(HALF)..(k + HALF + 1).min(seen.len());
        still[k][i] = seen[around].iter().all(|s| *s);
    }
}

fn drop_short_runs(still: &mut [[bool; 2]], i: usize) {
    let mut start = 0;
    for k in 0..=still.len() {
        if k == still.len() || !still[k][i] {
            if k - start < SHORTEST {
                still[start..k].iter_mut().for_each(|s| s[i] = false);
            }
            start = k + 1;
        }
    }
}
