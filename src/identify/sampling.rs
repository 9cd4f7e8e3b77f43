//! What the sampling of the input leaves open in estimates.

use nalgebra::{DMatrix, DVector};

use crate::math::raise_errors;

/// Raises standard errors to the `differences` that every other row of the input makes in the estimates.
///
/// What the input does between its rows, and what noise of its rows does to an estimate that divides by them, is
/// in no residual: the model takes it up. Both grow with the interval, as its square and in proportion, so that
/// the difference from the whole to half of the rate is one to three times the error at the whole rate. A
/// difference within the standard error is that of the noise that is counted in it already.
pub(super) fn at_least(covariance: &mut DMatrix<f64>, differences: &DVector<f64>) {
    raise_errors(covariance, differences);
}
