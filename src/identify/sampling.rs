//! What the sampling of the input leaves open in estimates.

use nalgebra::{DMatrix, DVector};

/// Raises standard errors to the `differences` that every other row of the input makes in the estimates;
/// correlations stay.
///
/// ```text
/// C_ij <- C_ij s_i s_j,   s_i = max(1, |d_i|/√C_ii)
/// ```
/// What the input does between its rows, and what noise of its rows does to an estimate that divides by them, is
/// in no residual: the model takes it up. Both grow with the interval, as its square and in proportion, so that
/// the difference from the whole to half of the rate is one to three times the error at the whole rate. A
/// difference within the standard error is that of the noise that is counted in it already.
pub(super) fn at_least(covariance: &mut DMatrix<f64>, differences: &DVector<f64>) {
    let stretch: Vec<f64> = differences
        .iter()
        .enumerate()
        .map(|(i, d)| (d.abs() / covariance[(i, i)].sqrt()).max(1.0))
        .map(|s| if s.is_finite() { s } else { 1.0 })
        .collect();
    for i in 0..stretch.len() {
        for k in 0..stretch.len() {
            covariance[(i, k)] *= stretch[i] * stretch[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_errors_are_raised_to_the_differences_and_correlations_stay() {
        let mut c = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 1.0, 0.0, 0.5, 0.0, 9.0]);
        at_least(&mut c, &DVector::from_row_slice(&[-6.0, 0.3, f64::NAN]));
        let expected = [36.0, 3.0, 1.5, 3.0, 1.0, 0.0, 1.5, 0.0, 9.0];
        assert!(c.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{c}");
    }
}
