//! Whether speeds that are late are those of an earlier time, or means over some time.
//!
//! A sensor that passes on its speed lambda later delays it. A filter with the same lag also smooths it, by the variance
//! s^2 of its weights over time:
//!
//! ```text
//! Omega(t + lambda) = g alpha(t) + (s^2/2) alpha''(t) + …       s = 0: a delay;   s^2 = lambda^2/3: a moving average
//!
//! Omega(b + lambda) - Omega(a + lambda) = g (alpha(b) - alpha(a)) - delta (omega(b) - omega(a)) + k (q(b) - q(a)) + e
//! q = (lambda^2/6) alpha'',   k = 3 s^2/lambda^2
//! ```
//! k and its error by least squares over the windows of the lag. A moving average is the filter that smooths the least of
//! those in use (k = 1; a low-pass of first order has 3). alpha'' is that of a parabola through the angles within 2 lambda,
//! without that at t itself, whose noise is in e.

use nalgebra::Vector3;

use super::super::thresholds::IMPORT;
use super::{Samples, integral, read, windows};
use crate::math::NormalEquations;

/// Samples to either side of t that the parabola requires: one more than its coefficients on both sides together.
const BESIDE: usize = 2;

/// Whether the speed of a wheel is delayed by `lag` \[s\] and not filtered. `false` if its motion does not show it.
pub(super) fn is_delayed(s: &Samples, lag: f64) -> bool {
    let way = integral(s);
    let at = |k: usize| {
        let (passed, speed) = read(s, &way, s.t[k] + lag, k)?;
        Some((passed, speed, smoothed(s, k, lag)?))
    };
    let row = |(a, b): &(usize, usize)| {
        let (from, to) = (at(*a)?, at(*b)?);
        let x = Vector3::new(s.alpha[*b] - s.alpha[*a], from.1 - to.1, to.2 - from.2);
        Some((x, to.0 - from.0))
    };
    let rows = NormalEquations::of(windows(s).iter().filter_map(row));
    let Some(fit) = rows.solve() else { return false };
    let (k, reach) = (fit.values[2], IMPORT.delay_errors * fit.std_error(2));
    let by_sampling = 3.0 * IMPORT.sampled_smoothing * (s.step / lag).powi(2);
    k - reach < by_sampling && k + reach < 1.0
}

/// By how much a moving average with this lag would change the angle of sample `k`, `q` \[rad\].
fn smoothed(s: &Samples, k: usize, lag: f64) -> Option<f64> {
    let piece = s.pieces.iter().find(|piece| piece.contains(&k))?;
    let reach = (2.0 * lag.abs() / s.step).ceil().max(BESIDE as f64) as usize;
    let (from, to) = (k.checked_sub(reach)?, k + reach);
    if from < piece.start || to >= piece.end {
        return None;
    }
    let others = (from..=to).filter(|j| *j != k);
    // times in lags, so that the sums have the same size
    let row = |j: usize| {
        let x = (s.t[j] - s.t[k]) / lag;
        (Vector3::new(1.0, x, x * x), s.alpha[j] - s.alpha[k])
    };
    let parabola = NormalEquations::of(others.map(row)).solve()?;
    Some(parabola.values[2] / 3.0)
}
