//! Integrals of sampled signals.

use std::ops::Range;

/// The cumulative integral of a rate at each sample, by the trapezoidal rule; zero at the first. `rate`
/// returns the rate at a sample.
///
/// # Examples
/// ```
/// use amigo_ident::math::cumulative_trapezoid;
/// let rate = [0.0, 2.0, 4.0];
/// assert_eq!(cumulative_trapezoid(&[0.0, 1.0, 3.0], |k| rate[k]), [0.0, 1.0, 7.0]);
/// ```
#[must_use]
pub fn cumulative_trapezoid(t: &[f64], rate: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut integral = vec![0.0; t.len()];
    for k in 1..t.len() {
        integral[k] = integral[k - 1] + 0.5 * (t[k] - t[k - 1]) * (rate(k) + rate(k - 1));
    }
    integral
}

/// The integral of a value over the `pieces` of a signal, by the trapezoidal rule, without the intervals
/// between them. `value` returns the value at a sample.
///
/// # Examples
/// ```
/// use amigo_ident::math::trapezoid;
/// let value = [0.0, 2.0, 4.0, 1.0, 1.0];
/// assert_eq!(trapezoid(&[0.0, 1.0, 3.0, 9.0, 9.5], &[0..3, 3..5], |k| value[k]), 7.5);
/// ```
#[must_use]
pub fn trapezoid(t: &[f64], pieces: &[Range<usize>], value: impl Fn(usize) -> f64) -> f64 {
    let steps = pieces.iter().flat_map(|piece| piece.start + 1..piece.end);
    steps.map(|k| 0.5 * (t[k] - t[k - 1]) * (value(k - 1) + value(k))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_a_sine_is_found_within_the_error_of_the_rule() {
        let t: Vec<f64> = (0..=1000).map(|k| 0.003 * f64::from(k)).collect();
        let integral = cumulative_trapezoid(&t, |k| t[k].sin());
        // h²/12 times the difference of the slopes at the ends, at most 2
        let most = 0.003 * 0.003 / 12.0 * 2.0;
        assert!(t.iter().zip(&integral).all(|(t, i)| (i - (1.0 - t.cos())).abs() <= most));
    }
}
