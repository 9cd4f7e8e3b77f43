//! The classical Runge-Kutta method of order 4.

use std::ops::{Add, Mul};

/// One step of length `h` from `x` of the classical Runge-Kutta method for `x' = rate(c, x)`.
///
/// ```text
/// x + h/6 (k1 + 2 k2 + 2 k3 + k4),   k2 = rate(1/2, x + h/2 k1),  k3 = rate(1/2, x + h/2 k2), ...
/// ```
///
/// The stage is given as the share c of the step (0, 1/2 or 1), so that inputs known at these three
/// places are taken as they are. The entries may be SIMD lanes.
///
/// # Errors
/// The first error of `rate`.
///
/// # Examples
/// ```
/// use std::convert::Infallible;
/// use amigo_ident::math::runge_kutta_step;
/// let decay = |_: f64, x: &[f64; 1]| Ok::<_, Infallible>([-x[0]]);
/// let Ok(x) = runge_kutta_step(&[1.0], 0.1, decay);
/// assert!((x[0] - (-0.1_f64).exp()).abs() < 1e-7); // local error h^5/120
/// ```
#[inline]
pub fn runge_kutta_step<const N: usize, T, E>(
    x: &[T; N],
    h: f64,
    mut rate: impl FnMut(f64, &[T; N]) -> Result<[T; N], E>,
) -> Result<[T; N], E>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let first = rate(0.0, x)?;
    runge_kutta_from(x, &first, h, rate)
}

/// [`runge_kutta_step`] where the rate at the start is known.
///
/// # Errors
/// The first error of `rate`.
#[inline]
pub fn runge_kutta_from<const N: usize, T, E>(
    x: &[T; N],
    first: &[T; N],
    h: f64,
    mut rate: impl FnMut(f64, &[T; N]) -> Result<[T; N], E>,
) -> Result<[T; N], E>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let along = |h: f64, k: &[T; N]| -> [T; N] { std::array::from_fn(|i| x[i] + k[i] * h) };
    let second = rate(0.5, &along(0.5 * h, first))?;
    let third = rate(0.5, &along(0.5 * h, &second))?;
    let fourth = rate(1.0, &along(h, &third))?;
    let sixth = h / 6.0;
    Ok(std::array::from_fn(|i| {
        x[i] + (first[i] + (second[i] + third[i]) * 2.0 + fourth[i]) * sixth
    }))
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    #[test]
    fn halving_the_step_divides_the_error_by_sixteen() {
        // x' = x cos t, x(0) = 1: x = exp(sin t)
        let error = |count: u32| {
            let h = 1.0 / f64::from(count);
            let end = (0..count).map(f64::from).fold([1.0], |x, k| {
                let rate = |c: f64, x: &[f64; 1]| Ok::<_, Infallible>([x[0] * ((k + c) * h).cos()]);
                let Ok(x) = runge_kutta_step(&x, h, rate);
                x
            });
            (end[0] - 1.0_f64.sin().exp()).abs()
        };
        let order = (error(20) / error(40)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn an_error_of_the_rate_ends_the_step() {
        let rate = |c: f64, _: &[f64; 1]| if c < 1.0 { Ok([1.0]) } else { Err("end") };
        assert_eq!(runge_kutta_step(&[0.0], 1.0, rate), Err("end"));
    }
}
