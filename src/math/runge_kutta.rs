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
#[inline(always)]
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
#[inline(always)]
pub fn runge_kutta_from<const N: usize, T, E>(
    x: &[T; N],
    first: &[T; N],
    h: f64,
    mut rate: impl FnMut(f64, &[T; N]) -> Result<[T; N], E>,
) -> Result<[T; N], E>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let second = rate(0.5, &along(x, 0.5 * h, first))?;
    let third = rate(0.5, &along(x, 0.5 * h, &second))?;
    let fourth = rate(1.0, &along(x, h, &third))?;
    let mut sum = fourth;
    for i in 0..N {
        sum[i] = first[i] + (second[i] + third[i]) * 2.0 + fourth[i];
    }
    Ok(along(x, h / 6.0, &sum))
}

/// One step of length `h` of the classical method for `x'' = rate(c, x, v)`, `v = x'`, from position `x` and
/// speed `v` with known initial acceleration `first`: position and speed at the end of the step.
///
/// ```text
/// v + h/6 (k1 + 2 k2 + 2 k3 + k4),   x + h (v + h/6 (k1 + k2 + k3))
/// ```
///
/// Equivalent to [`runge_kutta_from`] for positions and speeds together. The stages of the positions are
/// known in advance, so an acceleration that does not depend on the position needs no position stages.
///
/// # Errors
/// The first error of `rate`.
#[inline(always)]
pub fn runge_kutta_motion<const N: usize, T, E>(
    x: &[T; N],
    v: &[T; N],
    first: &[T; N],
    h: f64,
    mut rate: impl FnMut(f64, &[T; N], &[T; N]) -> Result<[T; N], E>,
) -> Result<([T; N], [T; N]), E>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let (half, sixth) = (0.5 * h, h / 6.0);
    let at_second = along(v, half, first);
    let second = rate(0.5, &along(x, half, v), &at_second)?;
    let at_third = along(v, half, &second);
    let third = rate(0.5, &along(x, half, &at_second), &at_third)?;
    let fourth = rate(1.0, &along(x, h, &at_third), &along(v, h, &third))?;
    let (mut inner, mut all) = (second, third);
    for i in 0..N {
        inner[i] = first[i] + second[i] + third[i];
        all[i] = inner[i] + second[i] + third[i] + fourth[i];
    }
    Ok((along(x, h, &along(v, sixth, &inner)), along(v, sixth, &all)))
}

/// `x + h k`, without a closure, which would not be compiled for the wide registers of the caller.
#[inline(always)]
fn along<const N: usize, T>(x: &[T; N], h: f64, k: &[T; N]) -> [T; N]
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let mut out = *x;
    for i in 0..N {
        out[i] = x[i] + k[i] * h;
    }
    out
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
    fn a_step_of_a_motion_is_that_of_its_places_and_speeds_together() {
        let (x, v, h) = ([0.3, -1.2], [0.7, 0.4], 0.05);
        let rate = |c: f64, x: &[f64; 2], v: &[f64; 2]| {
            Ok::<_, Infallible>([c - x[0] * v[1], (x[1] + v[0]).sin() - 0.3 * v[1] * v[1]])
        };
        let Ok(first) = rate(0.0, &x, &v);
        let Ok((place, speed)) = runge_kutta_motion(&x, &v, &first, h, rate);
        let together = |c: f64, y: &[f64; 4]| {
            let Ok(a) = rate(c, &[y[0], y[1]], &[y[2], y[3]]);
            Ok::<_, Infallible>([y[2], y[3], a[0], a[1]])
        };
        let Ok(y) = runge_kutta_step(&[x[0], x[1], v[0], v[1]], h, together);
        for (one, other) in place.iter().chain(&speed).zip(y) {
            assert!((one - other).abs() < 1e-15, "{one} {other}"); // rounding
        }
    }

    #[test]
    fn an_error_of_the_rate_ends_the_step() {
        let rate = |c: f64, _: &[f64; 1]| if c < 1.0 { Ok([1.0]) } else { Err("end") };
        assert_eq!(runge_kutta_step(&[0.0], 1.0, rate), Err("end"));
    }
}
