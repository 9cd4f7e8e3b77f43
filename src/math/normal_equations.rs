//! Linear least squares of a few coefficients, summed row by row.

use nalgebra::{SMatrix, SVector};

/// The sums of a linear least-squares fit `y = x' b + e` with `N` coefficients, for few well-conditioned
/// columns in inner loops; [`super::least_squares::fit`] also tests identifiability.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalEquations<const N: usize> {
    /// Σ x x'.
    pub(crate) matrix: SMatrix<f64, N, N>,
    /// Σ x y.
    pub(crate) right: SVector<f64, N>,
    /// Σ y².
    pub(crate) squares: f64,
    /// Number of rows.
    pub(crate) rows: usize,
}

/// The solution of [`NormalEquations`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct FewCoefficients<const N: usize> {
    /// b = (Σ x x')⁻¹ Σ x y.
    pub(crate) values: SVector<f64, N>,
    /// (Σ x x')⁻¹: covariance of the coefficients for a residual variance of one.
    pub(crate) covariance: SMatrix<f64, N, N>,
    /// s² = (Σ y² - b' Σ x y) / (rows - N), with at least N + 1 rows. Subject to cancellation if the
    /// residuals are small against y.
    pub(crate) residual_variance: f64,
}

impl<const N: usize> FewCoefficients<N> {
    /// Standard error of coefficient `j`.
    pub(crate) fn std_error(&self, j: usize) -> f64 {
        (self.residual_variance * self.covariance[(j, j)]).sqrt()
    }
}

impl<const N: usize> NormalEquations<N> {
    /// The sums of `rows` (x, y).
    #[inline]
    pub(crate) fn of(rows: impl IntoIterator<Item = (SVector<f64, N>, f64)>) -> Self {
        let (matrix, right) = (SMatrix::zeros(), SVector::zeros());
        let mut out = Self { matrix, right, squares: 0.0, rows: 0 };
        for (x, y) in rows {
            out.matrix += x * x.transpose();
            out.right += x * y;
            out.squares += y * y;
            out.rows += 1;
        }
        out
    }

    /// The coefficients; `None` if the rows do not determine them.
    #[inline]
    pub(crate) fn solve(&self) -> Option<FewCoefficients<N>> {
        let covariance = scaled_inverse(&self.matrix)?;
        let values = covariance * self.right;
        let beyond = self.rows.saturating_sub(N).max(1) as f64;
        let residual_variance = (self.squares - self.right.dot(&values)).max(0.0) / beyond;
        Some(FewCoefficients { values, covariance, residual_variance })
    }
}

/// The inverse of a symmetric matrix, scaled to unit diagonal: as accurate in any units. `None` if it is singular.
#[inline]
fn scaled_inverse<const N: usize>(matrix: &SMatrix<f64, N, N>) -> Option<SMatrix<f64, N, N>> {
    let scale = matrix.diagonal().map(|d| 1.0 / d.max(1e-300).sqrt());
    let scale = scale * scale.transpose();
    Some(matrix.component_mul(&scale).try_inverse()?.component_mul(&scale))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn a_line_has_the_coefficients_and_errors_of_the_textbook() {
        // over x = 1, 2, 3, 4: S_xx = 5
        let y = [1.0, 4.0, 4.0, 6.0];
        let row = |k: usize| (Vector2::new(1.0, 1.0 + k as f64), y[k]);
        let fit = NormalEquations::of((0..4).map(row)).solve().unwrap();
        // S_yy = 69 - 225/4 = 51/4, S_xy = 45 - 75/2 = 15/2, slope 3/2, intercept 15/4 - 15/4, s² = (51/4 - 45/4)/2
        assert!((fit.values - Vector2::new(0.0, 1.5)).amax() < 1e-13);
        assert!((fit.residual_variance - 0.75).abs() < 1e-12);
        // s/√S_xx, and s √(Σx²/(n S_xx))
        assert!((fit.std_error(1) - (0.75_f64 / 5.0).sqrt()).abs() < 1e-12);
        assert!((fit.std_error(0) - (0.75_f64 * 30.0 / 20.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn equal_columns_have_no_solution() {
        let rows = [(Vector2::new(1.0, 1.0), 1.0), (Vector2::new(2.0, 2.0), 1.0)];
        assert!(NormalEquations::of(rows).solve().is_none());
    }
}
