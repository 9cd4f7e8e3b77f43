//! Samples at rest, determined from the sensors.

use super::Recording;
use crate::math::{self, Moments};

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

/// Correlation of neighbouring rows below which a sensor contains more noise than motion (judgement): that of a motion
/// of several rows is near one, that of white noise zero.
const NOISE: f64 = 0.5;
/// Standard errors of a correlation that is significant.
const SURE: f64 = 5.0;
/// Fewest rows in which noise and motion differ: a correlation of white noise is then below 0.7 by five standard
/// errors.
const FEWEST: usize = 50;
/// Rows by which a motion may follow its input.
const LATER: usize = 2;

/// Whether a sensor of a wheel shows no motion at all: a constant, or white noise that is not correlated with the
/// `input` of the wheel, of its row or of the two before it.
///
/// ```text
/// r_1 = sum (x_k - m) (x_(k-1) - m)/sum (x_k - m)^2 < 0.5,   |corr(x_k, M_(k-j))| < 5/sqrt(n),  j = 0, 1, 2
/// ```
/// In slow logs the speed under changing inputs is as white as noise, and is correlated with the input.
#[must_use]
pub(crate) fn never_moves(sensor: &[f64], input: &[f64]) -> bool {
    let m = Moments::of(sensor.iter().copied()).mean;
    let product: f64 = sensor.windows(2).map(|w| (w[0] - m) * (w[1] - m)).sum();
    let square: f64 = sensor.iter().map(|x| (x - m).powi(2)).sum();
    let limit = SURE / (sensor.len() as f64).sqrt();
    let is_constant = sensor.windows(2).all(|w| w[0] == w[1]);
    let is_white = sensor.len() >= FEWEST && product < NOISE * square;
    is_constant
        || is_white && (0..=LATER).all(|later| correlation(sensor, input, later).abs() < limit)
}

/// The correlation of values with those of the other signal some rows before; zero of a constant.
fn correlation(values: &[f64], others: &[f64], later: usize) -> f64 {
    math::correlation(values.iter().skip(later).copied().zip(others.iter().copied()))
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::never_moves;

    #[test]
    fn noise_is_no_motion_and_that_of_a_coarsely_sampled_wheel_is() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut noise = |count: usize| -> Vec<f64> {
            (0..count).map(|_| random.random_range(-1.0..1.0)).collect()
        };
        let (input, sensor) = (noise(2000), noise(2000));
        assert!(never_moves(&sensor, &input));
        // a gyroscope behind steps of its converter
        let coarse: Vec<f64> = sensor.iter().map(|x| (3.0 * x).round()).collect();
        assert!(never_moves(&coarse, &input));
        assert!(never_moves(&[1.1; 100], &input) && never_moves(&[1.1; 7], &input));
        // a wheel that has reached its speed under a new voltage in every row
        let fast: Vec<f64> = input.iter().zip(&sensor).map(|(u, e)| 8.0 * u + e).collect();
        assert!(!never_moves(&fast, &input));
        let slow: Vec<f64> =
            (0..2000).map(|k| (0.05 * f64::from(k)).sin() + 0.2 * sensor[k as usize]).collect();
        assert!(!never_moves(&slow, &input));
    }
}
