//! Autocorrelated noise of the recorded input, estimated while the robot is at rest.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use crate::math::{median_high, nonnegative, runs};
use crate::recording::{Recording, SlowNoise};

/// Lags of the structure function, and correlation times that are tried, at equal ratios.
const COUNT: usize = 16;
/// Rows of the shortest rest that is used.
const SHORTEST: usize = 10;
/// Median of the square of a standard normal variable.
const MEDIAN_SQUARE: f64 = 0.454_936;
/// Relative variance of the variance that the median of n squares gives, times n: 1/(4 f(m)² m²) with the density f of
/// the square at its median m.
const SPREAD: f64 = 5.44;
/// Correlation times that the longest rest must last: D(s) is then seen to level off, where it would go on to grow under
/// a command that creeps while friction holds the robot, and the standard deviation is known to about two thirds (the
/// variance of n seconds of such noise has a relative error of √(2τ/n)), of several rests to less.
const FEWEST: f64 = 4.0;
/// Log-likelihood by which slow noise of both wheels must be better than none [nats]: that of four standard errors.
const SURE: f64 = 8.0;
/// Smallest variance that is used, as a share of the largest.
const NOTHING: f64 = 1e-3;

/// Autocorrelated noise of each wheel's recorded input, from the rows in which both wheels are at rest. There
/// it does not act on the robot, and the controller does not respond to disturbances: the fluctuations are
/// noise of the sensor. Zero if it is not significant, or smaller than the white noise, and if the rests are
/// too short.
///
/// ```text
/// D(s) = ½ median (M(t + s) - M(t))²/0.455 = σ_w² + σ² (1 - exp(-s/τ)) + c s²,   all ≥ 0
/// ```
/// c describes an input that grows while friction holds the robot; the median is insensitive to steps. Least
/// squares of the relative errors, each weighted by the number of independent pairs.
///
/// Source: structure function (variogram), Matheron 1963; robust as in Cressie and Hawkins, Math. Geol. 12 (1980).
#[must_use]
pub fn rest_noise(recordings: &[&Recording]) -> [SlowNoise; 2] {
    let Some(step) = recordings.iter().map(|r| r.step()).reduce(f64::max) else {
        return Default::default();
    };
    let rests: Vec<(&Recording, Range<usize>)> =
        recordings.iter().flat_map(|r| rests(r).into_iter().map(|rest| (*r, rest))).collect();
    let of_wheel = |i: usize| {
        let run = |(r, rest): &(&Recording, Range<usize>)| {
            r.torque()[rest.clone()].iter().map(|m| m[i]).collect()
        };
        slow_noise(&rests.iter().map(run).collect::<Vec<Vec<f64>>>(), step).unwrap_or_default()
    };
    let found = [0, 1].map(of_wheel);
    let is_plain = found.iter().map(|(_, gain)| gain).sum::<f64>() > SURE;
    found.map(|(noise, _)| if is_plain { noise } else { SlowNoise::default() })
}

/// Runs of rows in which both wheels are at rest.
fn rests(recording: &Recording) -> Vec<Range<usize>> {
    let still = &recording.sensing().still;
    let mut rests = runs(still.len(), |k| still[k] == [true; 2]);
    rests.retain(|rest| rest.len() >= SHORTEST);
    rests
}

/// Values at equal ratios from `low` to `high`.
fn ratios(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..COUNT).map(move |n| low * (high / low).powf(n as f64 / (COUNT - 1) as f64))
}

/// The noise of runs of values `step` \[s\] apart that is larger than their white noise, and how much better it
/// explains them [nats].
fn slow_noise(runs: &[Vec<f64>], step: f64) -> Option<(SlowNoise, f64)> {
    let longest = runs.iter().map(Vec::len).max()?;
    let mut lags: Vec<usize> =
        ratios(1.0, (longest - 1) as f64).map(|lag| lag.round() as usize).collect();
    lags.dedup();
    let seen: Vec<Seen> = lags.iter().map(|&lag| Seen::of(runs, lag, step)).collect();
    let largest = seen.iter().map(|s| s.variance).fold(0.0, f64::max);
    if !(largest > 0.0) {
        return None;
    }
    let fitted = |columns: &dyn Fn(f64) -> Vec<f64>| fitted(&seen, NOTHING * largest, columns);
    let (without, _) = fitted(&|s| vec![1.0, s * s]);
    let fits = ratios(step, longest as f64 * step).map(|time_s| {
        let (misfit, x) = fitted(&|s| vec![1.0, s * s, -(-s / time_s).exp_m1()]);
        (misfit, x[0], SlowNoise { sigma: x[2].sqrt(), time_s })
    });
    let (misfit, white, best) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let is_known = best.sigma.powi(2) > white && longest as f64 * step >= FEWEST * best.time_s;
    is_known.then_some((best, 0.5 * (without - misfit) / SPREAD))
}

/// The structure function at a lag.
struct Seen {
    /// The lag \[s\].
    lag_s: f64,
    /// Half of the mean square of differences over it, by their median.
    variance: f64,
    /// Number of independent pairs.
    pairs: f64,
}

impl Seen {
    fn of(runs: &[Vec<f64>], lag: usize, step: f64) -> Self {
        let pairs = runs.iter().flat_map(|run| run.iter().zip(run.iter().skip(lag)));
        let squares: Vec<f64> = pairs.map(|(a, b)| (b - a).powi(2)).collect();
        Self {
            lag_s: lag as f64 * step,
            pairs: squares.len() as f64 / lag as f64,
            variance: 0.5 * median_high(squares) / MEDIAN_SQUARE,
        }
    }
}

/// Weighted sum of the squared relative errors of a sum of `columns` of the lag \[s\] with coefficients that are not
/// negative, and these; variances below `least` count as that.
fn fitted(seen: &[Seen], least: f64, columns: &dyn Fn(f64) -> Vec<f64>) -> (f64, Vec<f64>) {
    let count = columns(0.0).len();
    let (mut h, mut g) = (DMatrix::zeros(count, count), DVector::zeros(count));
    let mut square = 0.0;
    for &Seen { lag_s, variance, pairs } in seen {
        let weight = pairs / variance.max(least).powi(2);
        let column = DVector::from_vec(columns(lag_s));
        h += weight * &column * column.transpose();
        g += weight * variance * column;
        square += weight * variance * variance;
    }
    let (x, gain) = nonnegative(&h, &g, &vec![true; count]);
    (square - gain, x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Thirty rests of 1 s at 100 Hz: white noise of 0.003, AR(1) noise of `sigma` with 0.1 s, and in a third of them a
    /// `command` beside it.
    fn runs(sigma: f64, command: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let keeps = (-0.01_f64 / 0.1).exp();
        let one = |n: usize| {
            let mut slow = sigma * normal();
            let mut next = |k: usize| {
                slow = keeps * slow + (1.0 - keeps * keeps).sqrt() * sigma * normal();
                let commanded = if n.is_multiple_of(3) { command(0.01 * k as f64) } else { 0.0 };
                slow + 0.003 * normal() + commanded
            };
            (0..100).map(&mut next).collect()
        };
        (0..30).map(one).collect()
    }

    #[test]
    fn noise_of_the_sensor_at_rest_is_found_beside_a_growing_and_a_stepping_command() {
        let commands: [fn(f64) -> f64; 3] =
            [|_| 0.0, |t| 0.03 * t, |t| if t > 0.3 { 0.2 } else { 0.0 }];
        for command in commands {
            let (found, gain) = slow_noise(&runs(0.02, command), 0.01).unwrap();
            // 300 correlation times: 0.08 of the variance; a third of the pairs with a command raises the median of the
            // others by half at most
            assert!((0.8..1.5).contains(&(found.sigma / 0.02)), "{found:?}");
            assert!((0.05..0.3).contains(&found.time_s), "{found:?}");
            assert!(gain > SURE, "{gain}");
        }
    }

    #[test]
    fn white_noise_and_a_growing_command_are_none() {
        let found = slow_noise(&runs(0.0, |t| 0.05 * t), 0.01);
        assert!(found.is_none_or(|(_, gain)| gain < SURE), "{found:?}");
        assert_eq!(slow_noise(&[vec![0.0; 50]], 0.01), None);
    }
}
