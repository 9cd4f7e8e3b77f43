//! Covariances of estimates from the scores of parts of the data.

use nalgebra::{DMatrix, DVector};

/// Covariance of an estimate whose estimating equations have these independent `scores`.
///
/// ```text
/// C = B (sum_b s_b s_b') B'
/// ```
///
/// `bread` B is the inverse of the derivative of the sum of the scores: of a least-squares problem or a likelihood,
/// the inverse of the information matrix.
///
/// Source: H. White, Econometrica 50 (1982).
///
/// # Examples
/// ```
/// use amigo_ident::math::sandwich;
/// use nalgebra::{DMatrix, DVector};
/// // the mean of 1, 2, 6: B = 1/3, scores are the residuals -2, -1, 3
/// let scores = [-2.0, -1.0, 3.0].map(|s| DVector::from_element(1, s));
/// let c = sandwich(&DMatrix::from_element(1, 1, 1.0 / 3.0), &scores);
/// assert!((c[(0, 0)] - 14.0 / 9.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn sandwich<'a>(
    bread: &DMatrix<f64>,
    scores: impl IntoIterator<Item = &'a DVector<f64>>,
) -> DMatrix<f64> {
    let mut middle = DMatrix::zeros(bread.ncols(), bread.ncols());
    scores.into_iter().for_each(|s| middle.ger(1.0, s, s, 1.0));
    bread * middle * bread.transpose()
}

/// Covariance of an estimate whose errors are correlated and of unequal size within blocks of rows
/// (cluster-robust).
///
/// ```text
/// C = c sandwich(B, s_b),   s_b = sum_{i in b} z_i psi_i,   c = G/(G-1) (n-1)/(n-k)
/// ```
///
/// `bread` B is the inverse of `sum z x' psi'`, `z` the instruments (the columns themselves for
/// least squares), `psi` the influence of each residual (weight times residual), `block` the block
/// of each row. `rows` n is the number of rows of data, which the rows of `z` may stand for; k is the
/// width of `z`. With no more blocks than columns rows count as independent.
///
/// Source: K.-Y. Liang, S. L. Zeger, Biometrika 73 (1986); the factor c is that of Stata and
/// statsmodels.
///
/// # Panics
/// If the lengths differ.
#[must_use]
pub fn clustered_covariance(
    bread: &DMatrix<f64>,
    z: &DMatrix<f64>,
    psi: &DVector<f64>,
    block: &[usize],
    rows: usize,
) -> DMatrix<f64> {
    let blocks = block.iter().max().map_or(0, |b| b + 1);
    let one = |i: usize| if blocks <= z.ncols() { i } else { block[i] };
    let mut scores = std::collections::BTreeMap::<usize, DVector<f64>>::new();
    let mut next = 0;
    while next < z.nrows() {
        let first = next;
        let sum = scores.entry(one(first)).or_insert_with(|| DVector::zeros(z.ncols()));
        // neighbouring rows mostly belong to one block
        while next < z.nrows() && one(next) == one(first) {
            for (sum, z) in sum.iter_mut().zip(z.row(next).iter()) {
                *sum += psi[next] * z;
            }
            next += 1;
        }
    }
    let (groups, n) = (scores.len() as f64, rows as f64);
    let factor = groups / (groups - 1.0) * (n - 1.0) / (n - z.ncols() as f64).max(1.0);
    sandwich(bread, scores.values()) * factor
}

/// Raises standard errors to at least the absolute values of `errors`; correlations are unchanged.
///
/// ```text
/// C_ij <- C_ij s_i s_j,   s_i = max(1, |e_i| / sqrt C_ii), 1 where that is not finite
/// ```
pub fn raise_errors(covariance: &mut DMatrix<f64>, errors: &DVector<f64>) {
    let stretch = errors.zip_map(&covariance.diagonal(), |error, variance| {
        let ratio = error.abs() / variance.sqrt();
        if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
    });
    covariance.component_mul_assign(&(&stretch * stretch.transpose()));
}

/// Correlations of a covariance, row by row: `C_ij / sqrt(C_ii C_jj)`, NaN if a variance is zero or infinite.
#[must_use]
pub fn correlations(covariance: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let n = covariance.nrows();
    let scale: Vec<f64> = (0..n).map(|j| covariance[(j, j)].sqrt()).collect();
    (0..n).map(|i| (0..n).map(|j| covariance[(i, j)] / (scale[i] * scale[j])).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::fit;
    use super::super::least_squares::tests::{assert_close, noisy_line};
    use super::*;

    #[test]
    fn the_sandwich_of_eight_blocks_equals_statsmodels_cluster_covariance() {
        let (x, y) = noisy_line();
        let weights = DVector::from_fn(40, |i, _| 1.0 + (i % 4) as f64);
        let fit = fit(&x, &y, Some(&weights)).unwrap();
        let blocks: Vec<usize> = (0..40).map(|i| i / 5).collect();
        let psi = fit.residuals.component_mul(&weights);
        let c = clustered_covariance(&fit.unit_covariance(), &x, &psi, &blocks, 40);
        let expected = [
            [0.0032485525177141875, 0.0005279127579972065, -1.5964191383867757e-07],
            [0.0005279127579972065, 0.0003793349024497552, -1.5231841083127594e-07],
            [-1.5964191383867757e-07, -1.5231841083127597e-07, 2.2652778749312896e-10],
        ];
        for i in 0..3 {
            for j in 0..3 {
                assert_close(c[(i, j)], expected[i][j], 1e-10);
            }
        }
    }

    #[test]
    fn errors_are_raised_and_correlations_stay() {
        let mut c = DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 1.0, 0.0, 0.5, 0.0, 9.0]);
        raise_errors(&mut c, &DVector::from_row_slice(&[-6.0, 0.3, f64::NAN]));
        let expected = [36.0, 3.0, 1.5, 3.0, 1.0, 0.0, 1.5, 0.0, 9.0];
        assert!(c.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{c}");
    }
}
