//! One correction of the filter, and operations that keep a covariance symmetric and consistent.

use nalgebra::{SMatrix, SVector};

/// alpha1, alpha2, omega1, omega2, d1, d2, and behind a coupling u1, u2, phi1, phi2.
pub(super) type Mean<const N: usize> = SVector<f64, N>;
/// Their covariance.
pub(super) type Covariance<const N: usize> = SMatrix<f64, N, N>;

/// Variance of a wheel that is at rest [rad^2/s^2].
pub(super) const STILL: f64 = 1e-10;

/// Removes asymmetry by rounding.
pub(super) fn make_symmetric<const N: usize>(covariance: &mut Covariance<N>) {
    *covariance = (*covariance + covariance.transpose()) * 0.5;
}

/// Holds wheel `i` at rest.
pub(super) fn freeze<const N: usize>(covariance: &mut Covariance<N>, mean: &mut Mean<N>, i: usize) {
    mean[2 + i] = 0.0;
    for k in 0..N {
        covariance[(2 + i, k)] = 0.0;
        covariance[(k, 2 + i)] = 0.0;
    }
    covariance[(2 + i, 2 + i)] = STILL;
}

/// A scalar measurement: two states with their weights.
pub(super) type Measurement = [(usize, f64); 2];

/// One scalar measurement: returns innovation and its variance, corrects mean, covariance and
/// derivatives; `psi_row` receives the derivative of the prediction by every column.
pub(super) fn correct<const N: usize>(
    [(i, by_i), (k, by_k)]: Measurement,
    value: f64,
    variance: f64,
    mean: &mut Mean<N>,
    covariance: &mut Covariance<N>,
    psi: &mut [[f64; N]],
    psi_row: &mut [f64],
) -> (f64, f64) {
    let e = value - by_i * mean[i] - by_k * mean[k];
    let mut seen: Mean<N> = covariance.column(i) * by_i;
    if by_k != 0.0 {
        seen += covariance.column(k) * by_k;
    }
    let s = by_i * seen[i] + by_k * seen[k] + variance;
    let share = 1.0 / s;
    let gain = seen * share;
    *mean += gain * e;
    // a product that rounding leaves symmetric
    let known: [f64; N] = (seen * share.sqrt()).into();
    for (column, by) in covariance.as_mut_slice().chunks_exact_mut(N).zip(known) {
        for (value, known) in column.iter_mut().zip(known) {
            *value -= known * by;
        }
    }
    let gain: [f64; N] = gain.into();
    for (out, column) in psi_row.iter_mut().zip(psi.iter_mut()) {
        let predicted = by_i * column[i] + by_k * column[k];
        *out = predicted;
        for (value, gain) in column.iter_mut().zip(gain) {
            *value -= gain * predicted;
        }
    }
    (e, s)
}
