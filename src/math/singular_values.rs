//! Singular values of small matrices by one-sided Jacobi rotations.

use nalgebra::{DMatrix, DVector};

/// Upper bound of the number of sweeps (about ten are needed in practice).
const MAX_SWEEPS: usize = 60;

/// Singular value decomposition `A V = U S`, singular values in descending order.
#[derive(Debug, Clone)]
pub(crate) struct SingularValues {
    /// The columns of U, each times its singular value.
    pub(crate) left_scaled: DMatrix<f64>,
    /// Singular values, largest first.
    pub(crate) values: Vec<f64>,
    /// The columns are the right singular vectors.
    pub(crate) right: DMatrix<f64>,
}

/// Decomposes a finite matrix with at least as many rows as columns.
///
/// Rotations make the columns of `A V` orthogonal. Unlike bidiagonal methods they keep the relative accuracy
/// of small singular values, which the determination of the rank requires.
///
/// Source: M. R. Hestenes, "Inversion of matrices by biorthogonalization", SIAM J. 6 (1958).
pub(crate) fn singular_values(matrix: DMatrix<f64>) -> SingularValues {
    let columns = matrix.ncols();
    let mut left = matrix;
    let mut right = DMatrix::identity(columns, columns);
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..columns {
            for q in p + 1..columns {
                rotated |= make_orthogonal(&mut left, &mut right, p, q);
            }
        }
        if !rotated {
            break;
        }
    }
    let norms: Vec<f64> = left.column_iter().map(|c| c.norm()).collect();
    let mut order: Vec<usize> = (0..columns).collect();
    order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
    SingularValues {
        left_scaled: left.select_columns(&order),
        values: order.iter().map(|&i| norms[i]).collect(),
        right: right.select_columns(&order),
    }
}

/// Pseudo-inverse of a matrix with at least as many rows as columns; singular values up to `least` count as
/// zero. `None` if an entry is not finite, for which the pseudo-inverse of nalgebra does not terminate.
pub(crate) fn pseudo_inverse(matrix: &DMatrix<f64>, least: f64) -> Option<DMatrix<f64>> {
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let svd = singular_values(matrix.clone());
    let rank = svd.values.iter().take_while(|value| **value > least).count();
    Some(svd.pseudo_inverse(rank))
}

/// Orthonormal columns that span those of a matrix with at least as many rows as columns; directions whose singular
/// value, after the columns are scaled to a norm of one, is less than `share` of the largest are left out.
pub(crate) fn orthonormal(mut columns: DMatrix<f64>, share: f64) -> DMatrix<f64> {
    for mut column in columns.column_iter_mut() {
        let norm = column.norm();
        if norm > 0.0 {
            column /= norm;
        }
    }
    let SingularValues { left_scaled: mut basis, values, .. } = singular_values(columns);
    let largest = values.first().copied().unwrap_or(0.0);
    let rank = values.iter().take_while(|value| **value > share * largest).count();
    basis.resize_horizontally_mut(rank, 0.0);
    basis.column_iter_mut().zip(&values).for_each(|(mut column, value)| column /= *value);
    basis
}

impl SingularValues {
    /// Pseudo-inverse from this number of largest singular values.
    pub(crate) fn pseudo_inverse(&self, rank: usize) -> DMatrix<f64> {
        let squares = self.values[..rank].iter().map(|value| value * value);
        let squares = DVector::from_iterator(rank, squares);
        let mut left = self.left_scaled.columns(0, rank).transpose();
        left.row_iter_mut().zip(&squares).for_each(|(mut row, square)| row /= *square);
        self.right.columns(0, rank) * left
    }
}

/// Rotates columns `p` and `q` until they are orthogonal; false if they already were.
fn make_orthogonal(left: &mut DMatrix<f64>, right: &mut DMatrix<f64>, p: usize, q: usize) -> bool {
    let (pp, qq) = (left.column(p).norm_squared(), left.column(q).norm_squared());
    let pq = left.column(p).dot(&left.column(q));
    if pq.abs() <= 4.0 * f64::EPSILON * (pp * qq).sqrt() {
        return false;
    }
    let zeta = (qq - pp) / (2.0 * pq);
    let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    rotate(left, p, q, cosine, cosine * tangent);
    rotate(right, p, q, cosine, cosine * tangent);
    true
}

/// Rotates columns `p` < `q`.
fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, cosine: f64, sine: f64) {
    let rows = m.nrows();
    let (before, from_q) = m.as_mut_slice().split_at_mut(q * rows);
    for (first, second) in before[p * rows..][..rows].iter_mut().zip(&mut from_q[..rows]) {
        let (a, b) = (*first, *second);
        *first = cosine * a - sine * b;
        *second = sine * a + cosine * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_singular_values_of_a_hilbert_matrix_equal_mpmath() {
        let hilbert = DMatrix::from_fn(6, 6, |i, j| 1.0 / (i + j + 1) as f64);
        let svd = singular_values(hilbert.clone());
        // mpmath.svd at 50 digits; the entries are rounded, so the smallest is good to 1e-17/1e-7
        assert!((svd.values[0] / 1.618_899_858_924_339 - 1.0).abs() < 1e-14);
        assert!((svd.values[5] / 1.082_799_484_565_55e-7 - 1.0).abs() < 1e-8);
        let identity = svd.right.transpose() * &svd.right;
        assert!((identity - DMatrix::identity(6, 6)).amax() < 1e-14);
        assert!((hilbert * &svd.right - svd.left_scaled).amax() < 1e-15);
    }

    #[test]
    fn the_pseudo_inverse_equals_that_of_numpy_and_ends_without_numbers() {
        let a = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 2.0, 4.0, 3.0, 6.0]);
        // numpy.linalg.pinv: of rank one, a'/norm^2
        let inverse = pseudo_inverse(&a, 1e-9).unwrap();
        assert!((inverse - a.transpose() / 70.0).amax() < 1e-15);
        let b = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 3.0]);
        let exact = DMatrix::from_row_slice(2, 2, &[0.6, -0.2, -0.2, 0.4]);
        assert!((pseudo_inverse(&b, 0.0).unwrap() - exact).amax() < 1e-15);
        assert_eq!(pseudo_inverse(&DMatrix::from_element(9, 9, f64::NAN), 0.0), None);
    }

    #[test]
    fn the_orthonormal_basis_of_dependent_columns_has_their_rank_and_spans_them() {
        // the third column is the sum of the first two, in another unit
        let a =
            DMatrix::from_row_slice(4, 3, &[1., 0., 1e6, 2., 1., 3e6, 0., 1., 1e6, 1., 3., 4e6]);
        let basis = orthonormal(a.clone(), 1e-8);
        assert_eq!(basis.ncols(), 2);
        assert!((basis.tr_mul(&basis) - DMatrix::identity(2, 2)).amax() < 1e-14);
        // 1e6 times the rounding of a number
        assert!((&a - &basis * basis.tr_mul(&a)).amax() < 1e-8);
        // a model whose parameters are all given has no columns
        assert_eq!(orthonormal(DMatrix::zeros(4, 0), 1e-8).shape(), (4, 0));
    }

    #[test]
    fn a_zero_column_has_a_zero_singular_value() {
        let svd = singular_values(DMatrix::from_row_slice(2, 2, &[0.0, 3.0, 0.0, 4.0]));
        assert_eq!(svd.values, [5.0, 0.0]);
    }
}
