//! Linear interpolation.

use super::scalar::Real;

/// The line through two points `(x[0], y[0])` and `(x[1], y[1])` at `at`; beyond them it is extrapolated.
///
/// ```text
/// y(at) = y_0 + (at - x_0)/(x_1 - x_0) (y_1 - y_0)
/// ```
///
/// # Examples
/// ```
/// use amigo_ident::math::interpolate;
/// assert_eq!(interpolate([1.0, 3.0], [10.0, 20.0], 1.5), 12.5);
/// ```
#[must_use]
pub fn interpolate<T: Real>(x: [f64; 2], y: [T; 2], at: T) -> T {
    let share = (at - T::from(x[0])) / (x[1] - x[0]);
    y[0] + share * (y[1] - y[0])
}

/// [`interpolate`] of the values of both wheels in two rows.
#[must_use]
pub fn interpolate_wheels<T: Real>(x: [f64; 2], rows: [[T; 2]; 2], at: T) -> [T; 2] {
    [0, 1].map(|i| interpolate(x, [rows[0][i], rows[1][i]], at))
}
