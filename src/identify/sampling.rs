//! Uncertainty of estimates due to the sampling of the input.

use nalgebra::{DMatrix, DVector};

use crate::math::raise_errors;

/// Raises standard errors to the `differences` of the estimates caused by omitting every other row of the
/// input.
///
/// The unknown input between its rows, and the bias of parameters by its noise, do not appear in the
/// residuals, because the model absorbs them. The former grows with the square of the interval, the latter in
/// proportion to it, so the difference between the full and half the rate is one to three times the error at
/// the full rate. A difference within the standard error is due to noise that is already included.
pub(super) fn at_least(covariance: &mut DMatrix<f64>, differences: &DVector<f64>) {
    raise_errors(covariance, differences);
}
