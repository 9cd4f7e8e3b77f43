//! Linear regression that is robust to outliers.

use nalgebra::{DMatrix, DVector};

use super::error::MathError;
use super::least_squares::{LinearFit, fit};
use super::order::robust_deviation;

/// Huber's threshold in standard deviations: 95 % efficient on clean normal data.
pub const HUBER_THRESHOLD: f64 = 1.345;

const MAX_ITERATIONS: usize = 200;

/// Result of a Huber fit: the last reweighted least-squares fit and its convergence.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustFit {
    /// The coefficients with the covariance of the M-estimator; `residual_variance` and the
    /// residuals are those of the reweighted problem.
    pub fit: LinearFit,
    /// Final weight of each row, in (0, 1]; below one for outliers.
    pub row_weights: DVector<f64>,
    /// Robust standard deviation of a row of weight one (median absolute residual / 0.6745).
    pub scale: f64,
    /// Reweighting steps taken.
    pub iterations: usize,
    /// Whether the coefficients converged.
    pub converged: bool,
}

/// Fits `y = X b + e` with outliers in some rows, by iteratively reweighted least squares.
///
/// ```text
/// minimise sum rho(r_i/s),  rho'(u) = psi(u) = u if |u| <= c, else c sgn u;  s = median|r| / 0.6745
/// cov b = k^2 [ s^2 sum psi^2 / (n - p) ] / [ mean psi' ]^2 (X'WX)^-1
/// k = 1 + (p/n) var psi' / (mean psi')^2
/// ```
///
/// `c` is [`HUBER_THRESHOLD`]. Prior `weights` (inverse variances up to a factor) multiply the
/// squares before r is formed.
///
/// Source: P. J. Huber, *Robust Statistics* (1981), 7.6 and 7.8.
///
/// # Errors
/// As [`fit`].
pub fn fit_huber(
    x: &DMatrix<f64>,
    y: &DVector<f64>,
    weights: Option<&DVector<f64>>,
) -> Result<RobustFit, MathError> {
    let root = weights.map_or_else(|| DVector::repeat(y.len(), 1.0), |w| w.map(f64::sqrt));
    let plain = fit(x, y, weights)?;
    let mut current = plain.clone();
    let mut row_weights = DVector::repeat(y.len(), 1.0);
    let mut scale = robust_deviation(current.residuals.component_mul(&root).iter().copied());
    let (mut iterations, mut converged) = (0, scale == 0.0);
    while !converged && iterations < MAX_ITERATIONS {
        iterations += 1;
        let standard = current.residuals.component_mul(&root) / scale;
        row_weights = standard.map(|u| (HUBER_THRESHOLD / u.abs()).min(1.0));
        let total = row_weights.component_mul(&root).component_mul(&root);
        let next = fit(x, y, Some(&total))?;
        converged = settled(&next, &current);
        current = next;
        scale = robust_deviation(current.residuals.component_mul(&root).iter().copied());
        converged |= scale == 0.0;
    }
    if scale > 0.0 {
        let standard = current.residuals.component_mul(&root) / scale;
        let variance = variance_of_row(&standard, scale, current.rank);
        current.covariance = plain.unit_covariance() * variance;
        current.std_errors = current.covariance.diagonal().map(f64::sqrt);
    }
    Ok(RobustFit { fit: current, row_weights, scale, iterations, converged })
}

/// Whether no identifiable coefficient changed by more than a millionth of its standard error.
fn settled(next: &LinearFit, current: &LinearFit) -> bool {
    (0..next.coefficients.len()).all(|i| {
        let step = (next.coefficients[i] - current.coefficients[i]).abs();
        step <= 1e-6 * next.std_errors[i]
    })
}

/// The factor that turns `(X'WX)^-1` into the covariance of the M-estimator.
fn variance_of_row(standard: &DVector<f64>, scale: f64, rank: usize) -> f64 {
    let n = standard.len() as f64;
    let psi_squared: f64 = standard.iter().map(|u| u.abs().min(HUBER_THRESHOLD).powi(2)).sum();
    let slope = standard.iter().filter(|u| u.abs() <= HUBER_THRESHOLD).count() as f64 / n;
    let correction = 1.0 + rank as f64 / n * (slope * (1.0 - slope)) / (slope * slope);
    (correction * scale / slope).powi(2) * psi_squared / (n - rank as f64)
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::tests::{assert_close, noisy_line};
    use super::*;

    #[test]
    fn three_wild_rows_of_forty_give_the_fit_and_errors_of_statsmodels_rlm() {
        let (x, mut y) = noisy_line();
        y[3] += 15.0;
        y[17] -= 12.0;
        y[30] += 20.0;
        let robust = fit_huber(&x, &y, None).unwrap();
        assert!(robust.converged);
        // statsmodels 0.14 RLM(HuberT).fit(tol=1e-13); we stop at 1e-6 standard errors
        let expected = [1.998728487727014, -0.30837405306517096, 0.0003972196575130937];
        let errors = [0.06079474105180629, 0.020305797173905467, 2.2635012502536234e-05];
        for i in 0..3 {
            assert_close(robust.fit.coefficients[i], expected[i], 1e-6);
            assert_close(robust.fit.std_errors[i], errors[i], 1e-6);
        }
        assert_close(robust.scale, 0.43976742612218195, 1e-6);
        assert!([3, 17, 30].iter().all(|&i| robust.row_weights[i] < 0.06));
    }

    #[test]
    fn an_exact_line_is_returned_at_once() {
        let (x, _) = noisy_line();
        let y = &x * DVector::from_row_slice(&[1.0, 2.0, 0.0]);
        let robust = fit_huber(&x, &y, None).unwrap();
        assert!((robust.fit.coefficients[1] - 2.0).abs() < 1e-12);
    }
}
