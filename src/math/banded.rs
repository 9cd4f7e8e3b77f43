//! Cholesky's factorisation of a banded matrix.

use nalgebra::{DMatrix, DVector};

/// The factor L of a symmetric positive definite banded matrix, `V = L L'`.
///
/// A matrix of `n` rows with `band` entries beside the diagonal takes `n band²` operations and
/// `n band` numbers in place of `n³/3` and `n²`.
///
/// Source: Golub and Van Loan, Matrix Computations, sec. 4.3.5.
#[derive(Debug, Clone, PartialEq)]
pub struct BandedCholesky {
    band: usize,
    /// Rows in sequence, each from `band` columns left of the diagonal to the diagonal.
    rows: Vec<f64>,
}

impl BandedCholesky {
    /// Factorises the matrix with the entries `at(i, k)`, `i - band <= k <= i`; `None` if it is not positive
    /// definite.
    pub fn new(n: usize, band: usize, at: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let stride = band + 1;
        let mut rows = vec![0.0; n * stride];
        for i in 0..n {
            let (before, row) = rows[..(i + 1) * stride].split_at_mut(i * stride);
            let first = i.saturating_sub(band);
            for k in first..=i {
                let left = k.saturating_sub(band).max(first);
                let own = &row[left + band - i..k + band - i];
                if k < i {
                    let other = &before[k * stride + left + band - k..k * stride + band];
                    let sum: f64 = own.iter().zip(other).map(|(a, b)| a * b).sum();
                    row[k + band - i] = (at(i, k) - sum) / before[k * stride + band];
                } else {
                    let rest = at(i, i) - own.iter().map(|a| a * a).sum::<f64>();
                    if !(rest > 0.0) {
                        return None;
                    }
                    row[band] = rest.sqrt();
                }
            }
        }
        Some(Self { band, rows })
    }

    /// Replaces b by `V⁻¹ b`: forward, then back substitution.
    fn solve_in_place(&self, b: &mut [f64]) {
        let (band, stride) = (self.band, self.band + 1);
        for i in 0..b.len() {
            let first = i.saturating_sub(band);
            let row = &self.rows[i * stride + first + band - i..i * stride + band];
            let sum: f64 = row.iter().zip(&b[first..i]).map(|(l, x)| l * x).sum();
            b[i] = (b[i] - sum) / self.rows[i * stride + band];
        }
        for i in (0..b.len()).rev() {
            let first = i.saturating_sub(band);
            b[i] /= self.rows[i * stride + band];
            let row = &self.rows[i * stride + first + band - i..i * stride + band];
            let (left, right) = b.split_at_mut(i);
            left[first..].iter_mut().zip(row).for_each(|(x, l)| *x -= l * right[0]);
        }
    }

    /// `V⁻¹ b` from the factor, in time linear in the rows.
    #[must_use]
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let mut x = b.clone();
        self.solve_in_place(x.as_mut_slice());
        x
    }

    /// `V⁻¹ b` of every column.
    #[must_use]
    pub fn solve_columns(&self, b: &DMatrix<f64>) -> DMatrix<f64> {
        let mut x = b.clone();
        let n = x.nrows().max(1);
        x.as_mut_slice().chunks_exact_mut(n).for_each(|column| self.solve_in_place(column));
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Covariance of a moving sum of white noise over `band + 1` values.
    fn moving_sum(n: usize, band: usize) -> DMatrix<f64> {
        let weight = |j: usize| 1.0 + (j as f64).sin();
        DMatrix::from_fn(n, n, |i, k| {
            let apart = i.abs_diff(k);
            (apart..=band).map(|j| weight(j) * weight(j - apart)).sum::<f64>()
                + if apart == 0 { 0.3 } else { 0.0 }
        })
    }

    #[test]
    fn the_solution_is_that_of_the_dense_factorisation() {
        for (n, band) in [(1, 0), (5, 0), (3, 7), (40, 6)] {
            let v = moving_sum(n, band);
            let b = DMatrix::from_fn(n, 2, |i, c| (i as f64 + 3.0 * c as f64).cos());
            let banded = BandedCholesky::new(n, band, |i, k| v[(i, k)]).unwrap();
            let dense = v.clone().cholesky().unwrap();
            // rounding, times a condition of some hundreds
            assert!((banded.solve_columns(&b) - dense.solve(&b)).amax() < 1e-11);
            let column = b.column(0).into_owned();
            assert!((banded.solve(&column) - dense.solve(&column)).amax() < 1e-11);
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let v = [[1.0, 2.0], [2.0, 1.0]];
        assert!(BandedCholesky::new(2, 1, |i, k| v[i][k]).is_none());
        assert!(BandedCholesky::new(1, 0, |_, _| f64::NAN).is_none());
    }
}
