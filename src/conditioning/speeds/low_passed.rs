//! Whether speeds that lag their angles by about a row are those behind a low-pass of first order, and not those of an
//! earlier time. Read later by its lag, such a speed remains smoothed, and a model takes that for physics.
//!
//! ```text
//! delay L:     ∫ Omega dt from t_k + L to t_(k+1) + L                       = alpha_(k+1) - alpha_k + e
//! low-pass L:  ∫ Omega dt from t_k to t_(k+1) + L (Omega_(k+1) - Omega_k)   = alpha_(k+1) - alpha_k + e
//! z = Σ d/sqrt(Σ (d - mean d)²),   d: e² of the delay less that of the low-pass, each less that of noise, over a window
//! noise: 2 s_alpha² + s_Omega² Σ w²,   w: weights of the samples in the integral of straight lines
//! ```
//! The second equation is that of the filter, L Omega' + Omega = alpha'. Source of z: Vuong, Econometrica 57 (1989), two models
//! of which neither contains the other.

use std::iter;

use nalgebra::Vector2;

use super::super::thresholds::SPEEDS;
use super::{Lag, Samples, integral, noise_variance, read, windows};
use crate::math::{NormalEquations, mean, robust_deviation};

/// Rounds in which windows far off the others are left out: their set is final after two or three.
const ROUNDS: usize = 5;

/// Time constant of the low-pass of a wheel's speed, found like a delay from the windows that are not far off the others. A
/// delay leaves large errors where a filtered speed changes most, and those windows would be left out. `None` if the windows
/// do not agree with a low-pass either.
pub(super) fn time(s: &Samples, start: f64) -> Option<Lag> {
    let way = integral(s);
    let row = |(a, b): &(usize, usize)| {
        let (angle, change) = (s.alpha[*b] - s.alpha[*a], s.omega[*b] - s.omega[*a]);
        (way[*b] - way[*a] - angle, Vector2::new(change, angle))
    };
    let rows: Vec<(f64, Vector2<f64>)> = windows(s).iter().map(row).collect();
    let fitted_to_near = |values: Vector2<f64>| {
        let error = |(e, x): &(f64, Vector2<f64>)| e - x.dot(&values);
        let limit = SPEEDS.jumps * robust_deviation(rows.iter().map(error));
        let is_used = |e: f64| limit.is_nan() || limit <= 0.0 || e.abs() <= limit;
        let used = rows.iter().filter(|row| is_used(error(row)));
        NormalEquations::of(used.map(|(e, x)| (*x, *e)))
    };
    // the time, and the relative error of the gain
    let mut values = Vector2::new(-start, 0.0);
    for _ in 1..ROUNDS {
        values = fitted_to_near(values).solve()?.values;
    }
    let sums = fitted_to_near(values);
    let fit = sums.solve()?;
    let whole: f64 = rows.iter().map(|(_, x)| x[0] * x[0]).sum();
    let lag = Lag { value: -fit.values[0], std_error: fit.std_error(0) };
    let is_informed = sums.matrix[(0, 0)] / whole > SPEEDS.informed;
    (is_informed && are_low_passed(iter::once((s, lag.value)))).then_some(lag)
}

/// Whether the speeds of wheels are low-passed with these lags \[s\].
pub(super) fn are_low_passed<'s>(wheels: impl Iterator<Item = (&'s Samples, f64)>) -> bool {
    let late = wheels.filter(|(_, lag)| *lag > 0.0);
    let d: Vec<f64> = late.flat_map(|(s, lag)| evidence(s, lag)).collect();
    let mean = mean(d.iter().copied());
    let spread: f64 = d.iter().map(|d| (d - mean).powi(2)).sum();
    d.iter().sum::<f64>() > SPEEDS.smoothed_errors * spread.sqrt()
}

/// What every window shows for the low-pass.
fn evidence(s: &Samples, lag: f64) -> Vec<f64> {
    let way = integral(s);
    let errors = |k: usize| {
        let at = |k: usize| read(s, &way, s.t[k] + lag, k);
        let (from, to) = (at(k)?.0, at(k + 1)?.0);
        let angle = s.alpha[k + 1] - s.alpha[k];
        let filter = way[k + 1] - way[k] + lag * (s.omega[k + 1] - s.omega[k]);
        Some([(to - from - angle).powi(2), (filter - angle).powi(2)])
    };
    let of_window = |(a, b): (usize, usize)| (a..b).map(errors).collect::<Option<Vec<_>>>();
    let found: Vec<Vec<[f64; 2]>> = windows(s).into_iter().filter_map(of_window).collect();
    let noise = noise(s, lag);
    let whole = [0, 1].map(|n| mean(found.iter().flatten().map(|e| e[n])));
    // fourth differences of slow rows contain motion
    let share = whole.iter().zip(noise).map(|(e, noise)| e / noise).fold(1.0, f64::min);
    let by_noise = share * (noise[0] - noise[1]);
    found.iter().map(|w| w.iter().map(|e| e[0] - e[1] - by_noise).sum()).collect()
}

/// Variances of the error of a row by noise, with the delay and with the low-pass \[rad^2\].
fn noise(s: &Samples, lag: f64) -> [f64; 2] {
    let (angle, speed) = (noise_variance(&s.alpha), noise_variance(&s.omega));
    let of = |weights: &[f64]| {
        2.0 * angle + speed * weights.iter().map(|w| (w * s.step).powi(2)).sum::<f64>()
    };
    let rows = lag / s.step;
    let u = rows.fract();
    [of(&[0.5 * (1.0 - u).powi(2), 0.5 + u - u * u, 0.5 * u * u]), of(&[0.5 - rows, 0.5 + rows])]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{done, lag_of, of_motion};
    use crate::conditioning::Kind;

    #[test]
    fn a_low_pass_of_about_a_row_is_no_delay() {
        // the exact output of a filter with this time constant, of the sum of sines that the motion is
        let behind = |lag: f64| {
            move |t: f64| {
                let sine = |w: f64, t: f64| {
                    ((w * t).sin() - w * lag * (w * t).cos()) / (1.0 + (w * lag).powi(2))
                };
                let of = |[slow, fast]: [f64; 2]| 3.0 * sine(slow, t) + 2.0 * sine(fast, t);
                [of([1.7, 23.0]), of([1.3, 19.0])]
            }
        };
        let moved = |t: f64| {
            let of = |[slow, fast]: [f64; 2]| {
                3.0 * (1.0 - (slow * t).cos()) / slow + 2.0 * (1.0 - (fast * t).cos()) / fast
            };
            [of([1.7, 23.0]), of([1.3, 19.0])]
        };
        for (lag, seed) in [(0.008, 1), (0.008, 2), (0.012, 3), (0.012, 4)] {
            let filtered = done(of_motion((moved, behind(lag)), 0.0, 0.01, 1e-4, seed));
            let found = filtered.findings[0].kind;
            assert!(
                matches!(found, Kind::Filtered { lag_s, .. } if (lag_s - lag).abs() < 0.002),
                "{found:?}"
            );
            assert!(filtered.channels.omega.is_none());
            // the same lag of a sensor that is read late
            let delayed = done(of_motion((moved, behind(0.0)), lag, 0.01, 1e-4, seed));
            let (value, _) = lag_of(&delayed.findings).unwrap();
            assert!((value - lag).abs() < 0.002 && delayed.channels.omega.is_some(), "{value}");
        }
    }
}
