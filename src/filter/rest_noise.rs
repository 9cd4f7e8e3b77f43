//! Noise of the recorded input that goes on from row to row, as it shows while the robot stands still.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::standstill::standstill;
use crate::math::{median_high, nonnegative};
use crate::recording::{Recording, SlowNoise};

/// Lags of the structure function, and correlation times that are tried, at equal ratios.
const COUNT: usize = 16;
/// Rows of the shortest rest that is looked at.
const SHORTEST: usize = 10;
/// Median of the square of a standard normal variable.
const MEDIAN_SQUARE: f64 = 0.454_936;
/// Correlation times that the rests must last together: the standard deviation is then known to about a third
/// (the variance of n seconds of such noise has a relative error of √(2τ/n)).
const FEWEST: f64 = 4.0;
/// Variance below which a lag shows nothing, as a share of the largest.
const NOTHING: f64 = 1e-3;

/// Noise of each wheel's recorded input beside what is white, from the rows in which both wheels stand still. The robot
/// does not feel it there, and a controller does not answer: what the record shows is noise of the sensor, whatever
/// disturbs the robot when it moves. Zero where it moves a robot less than the white noise does, and where the rests are
/// too short to know it.
///
/// ```text
/// D(s) = ½ median (M(t + s) - M(t))²/0.455 = σ_w² + σ² (1 - exp(-s/τ)) + c s²,   all ≥ 0
/// ```
/// c takes an input that grows while friction holds the robot; of steps the median sees nothing. Least squares of the
/// relative errors, each weighted by the number of independent pairs.
///
/// Source: structure function (variogram), Matheron 1963; robust as in Cressie and Hawkins, Math. Geol. 12 (1980).
#[must_use]
pub fn rest_noise(recordings: &[&Recording]) -> [SlowNoise; 2] {
    let Some(step) = recordings.iter().map(|r| r.step()).reduce(f64::max) else {
        return Default::default();
    };
    let rests: Vec<(&Recording, Range<usize>)> =
        recordings.iter().flat_map(|r| rests(r).into_iter().map(|rest| (*r, rest))).collect();
    [0, 1].map(|i| {
        let runs: Vec<Vec<f64>> = rests
            .iter()
            .map(|(r, rest)| r.torque()[rest.clone()].iter().map(|m| m[i]).collect())
            .collect();
        slow_noise(&runs, step).unwrap_or_default()
    })
}

/// Runs of rows in which both wheels stand still.
fn rests(recording: &Recording) -> Vec<Range<usize>> {
    let noise = recording.noise();
    let still = standstill(recording, &noise.alpha, &noise.omega);
    let rows: Vec<usize> = (0..still.len()).filter(|&k| still[k] == [true; 2]).collect();
    let runs = rows.chunk_by(|a, b| a + 1 == *b).map(|run| run[0]..run[run.len() - 1] + 1);
    runs.filter(|run| run.len() >= SHORTEST).collect()
}

/// Values at equal ratios from `low` to `high`.
fn ratios(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..COUNT).map(move |n| low * (high / low).powf(n as f64 / (COUNT - 1) as f64))
}

/// The noise of runs of values `step` \[s\] apart beside what is white.
fn slow_noise(runs: &[Vec<f64>], step: f64) -> Option<SlowNoise> {
    let longest = runs.iter().map(Vec::len).max()?;
    let mut lags: Vec<usize> =
        ratios(1.0, (longest - 1) as f64).map(|l| l.round() as usize).collect();
    lags.dedup();
    let seen: Vec<(f64, f64, f64)> = lags.iter().map(|&lag| structure(runs, lag, step)).collect();
    let largest = seen.iter().map(|(_, variance, _)| *variance).fold(0.0, f64::max);
    if !(largest > 0.0) {
        return None;
    }
    let fits = ratios(step, longest as f64 * step).map(|time_s| {
        let (misfit, [white, slow]) = fitted(&seen, time_s, NOTHING * largest);
        (misfit, white, SlowNoise { sigma: slow.sqrt(), time_s })
    });
    let (_, white, best) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let seconds: f64 = runs.iter().map(|run| run.len() as f64 * step).sum();
    // spectral densities at low frequencies, which move a robot
    let exceeds = 2.0 * best.sigma.powi(2) * best.time_s > white * step;
    (exceeds && seconds >= FEWEST * best.time_s).then_some(best)
}

/// The structure function at a lag: time \[s\], variance, and the number of independent pairs.
fn structure(runs: &[Vec<f64>], lag: usize, step: f64) -> (f64, f64, f64) {
    let squares: Vec<f64> = runs
        .iter()
        .flat_map(|run| run.iter().zip(run.iter().skip(lag)))
        .map(|(a, b)| (b - a).powi(2))
        .collect();
    let pairs = squares.len() as f64 / lag as f64;
    (lag as f64 * step, 0.5 * median_high(squares) / MEDIAN_SQUARE, pairs)
}

/// Misfit of noise with that correlation time \[s\], and the variances of the white and of the slow part; variances below
/// `least` count as that.
fn fitted(seen: &[(f64, f64, f64)], time_s: f64, least: f64) -> (f64, [f64; 2]) {
    let mut h = DMatrix::zeros(3, 3);
    let (mut g, mut square) = (DVector::zeros(3), 0.0);
    for &(s, variance, pairs) in seen {
        let weight = pairs / variance.max(least).powi(2);
        let column = DVector::from_column_slice(&[1.0, -(-s / time_s).exp_m1(), s * s]);
        h += weight * &column * column.transpose();
        g += weight * variance * column;
        square += weight * variance * variance;
    }
    let (x, gain) = nonnegative(&h, &g, &[true; 3]);
    (square - gain, [x[0], x[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Ten rests of 1 s at 100 Hz: white noise of 0.003, AR(1) noise of `sigma` with 0.1 s, and `command` beside it.
    fn runs(sigma: f64, command: impl Fn(usize, f64) -> f64) -> Vec<Vec<f64>> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let keeps = (-0.01_f64 / 0.1).exp();
        let one = |n: usize| {
            let mut slow = sigma * normal();
            let mut next = |k: usize| {
                slow = keeps * slow + (1.0 - keeps * keeps).sqrt() * sigma * normal();
                slow + 0.003 * normal() + command(n, 0.01 * k as f64)
            };
            (0..100).map(&mut next).collect()
        };
        (0..10).map(one).collect()
    }

    #[test]
    fn noise_of_the_sensor_at_rest_is_found_beside_a_growing_and_a_stepping_command() {
        let commands: [fn(usize, f64) -> f64; 3] = [
            |_, _| 0.0,
            |n, t| 0.1 * t * (n % 2) as f64,
            |n, t| if t > 0.3 { 0.2 * n as f64 } else { 0.0 },
        ];
        for command in commands {
            let found = slow_noise(&runs(0.02, command), 0.01).unwrap();
            // 100 correlation times: 0.14 of the variance, and half as much again by the median
            assert!((found.sigma / 0.02 - 1.0).abs() < 0.3, "{found:?}");
            assert!((0.04..0.25).contains(&found.time_s), "{found:?}");
        }
    }

    #[test]
    fn white_noise_is_none() {
        let found = slow_noise(&runs(0.0, |n, t| 0.05 * t * n as f64), 0.01).unwrap_or_default();
        assert!(found.sigma < 0.002, "{found:?}");
        assert_eq!(slow_noise(&[vec![0.0; 50]], 0.01), None);
    }
}
