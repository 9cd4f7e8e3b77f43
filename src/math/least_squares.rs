//! Weighted linear least squares with a test of identifiability.

use nalgebra::{DMatrix, DVector, Dyn, QR};

use super::error::{MathError, check_finite, check_length};
use super::singular_values::{SingularValues, singular_values};

/// Singular values below this share of the largest one count as zero, after every column of the
/// design matrix was scaled to unit norm.
pub const RANK_TOLERANCE: f64 = 1e-9;

/// A coefficient takes part in a null direction if its component exceeds this.
pub const PARTICIPATION: f64 = 1e-3;

/// The result of a linear least-squares fit.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFit {
    /// Coefficients; in a rank-deficient fit the minimum-norm solution (after column scaling).
    pub coefficients: DVector<f64>,
    /// Covariance of the coefficients; the diagonal is infinite for `unidentifiable` ones.
    pub covariance: DMatrix<f64>,
    /// Square roots of the diagonal of `covariance`.
    pub std_errors: DVector<f64>,
    /// `y - X b`, not weighted.
    pub residuals: DVector<f64>,
    /// Weighted residual sum of squares over `degrees_of_freedom`: the variance of a row of
    /// weight one.
    pub residual_variance: f64,
    /// Rows of positive weight minus `rank`.
    pub degrees_of_freedom: usize,
    /// Number of directions in coefficient space that the data determine.
    pub rank: usize,
    /// Largest over smallest singular value of the scaled design matrix; infinite if that is zero.
    pub condition: f64,
    /// Singular values of the scaled design matrix, largest first.
    pub singular_values: Vec<f64>,
    /// Indices of the coefficients that take part in a null direction.
    pub unidentifiable: Vec<usize>,
    /// One unit column per direction that the data do not determine, in coefficients times column norm.
    pub null_directions: DMatrix<f64>,
    /// `(X' W X)^-1` (pseudo-inverse where deficient): covariance for unit residual variance.
    unit_covariance: DMatrix<f64>,
}

/// Fits `y = X b + e` by weighted least squares.
///
/// ```text
/// b = argmin sum_i w_i (y_i - x_i' b)^2,   cov b = s^2 (X' W X)^-1,   s^2 = r' W r / (n - rank)
/// ```
///
/// Columns are scaled to unit norm, X = QR, R = U S V' by Jacobi rotations; singular values below
/// [`RANK_TOLERANCE`] times the largest are treated as zero.
///
/// Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed., 5.3 and 5.5.
///
/// # Errors
/// If lengths differ, a value is not finite, a weight is negative, there is no column, or there are
/// not more rows of positive weight than columns. A deficient rank is not an error: the result states it.
///
/// # Examples
/// ```
/// use amigo_ident::math::least_squares::fit;
/// use nalgebra::{DMatrix, DVector};
/// // y = 1 + 2 t, with the third column a copy of the second
/// let x = DMatrix::from_fn(5, 3, |i, j| if j == 0 { 1.0 } else { i as f64 });
/// let y = DVector::from_fn(5, |i, _| 1.0 + 2.0 * i as f64);
/// let fit = fit(&x, &y, None)?;
/// assert_eq!((fit.rank, fit.unidentifiable), (2, vec![1, 2]));
/// assert!((fit.coefficients[0] - 1.0).abs() < 1e-12 && fit.std_errors[1].is_infinite());
/// # Ok::<(), amigo_ident::math::MathError>(())
/// ```
pub fn fit(
    x: &DMatrix<f64>,
    y: &DVector<f64>,
    weights: Option<&DVector<f64>>,
) -> Result<LinearFit, MathError> {
    fit_above(RANK_TOLERANCE, x, y, weights)
}

/// [`fit`] without the directions whose singular value is below this share of the largest.
///
/// # Errors
/// As [`fit`].
pub fn fit_above(
    share: f64,
    x: &DMatrix<f64>,
    y: &DVector<f64>,
    weights: Option<&DVector<f64>>,
) -> Result<LinearFit, MathError> {
    let rows = check(x, y, weights)?;
    let (mut a, mut b) = (x.clone(), y.clone());
    if let Some(w) = weights {
        let root = w.map(f64::sqrt);
        a.column_iter_mut().for_each(|mut column| column.component_mul_assign(&root));
        b.component_mul_assign(&root);
    }
    Ok(Decomposed::new(a, share).fit(b, (x, y, weights), rows))
}

/// [`fit_above`] of several right-hand sides on one design matrix, without weights.
///
/// # Errors
/// As [`fit`].
pub(crate) fn fits_above<const N: usize>(
    share: f64,
    x: &DMatrix<f64>,
    sides: [DVector<f64>; N],
) -> Result<[LinearFit; N], MathError> {
    let mut rows = x.nrows();
    for y in &sides {
        rows = check(x, y, None)?;
    }
    let decomposed = Decomposed::new(x.clone(), share);
    Ok(sides.map(|y| decomposed.fit(y.clone(), (x, &y, None), rows)))
}

/// A design matrix with columns of unit norm, decomposed.
struct Decomposed {
    scale: DVector<f64>,
    qr: QR<f64, Dyn, Dyn>,
    svd: SingularValues,
    rank: usize,
}

impl Decomposed {
    fn new(mut a: DMatrix<f64>, share: f64) -> Self {
        let scale = scale_columns(&mut a);
        let qr = a.qr();
        let svd = singular_values(qr.r());
        let rank = numerical_rank(&svd.values, share);
        Self { scale, qr, svd, rank }
    }

    /// The fit of a right-hand side, `b` with the weights of the decomposed matrix, from so many `rows` of positive
    /// weight.
    fn fit(
        &self,
        mut b: DVector<f64>,
        (x, y, weights): (&DMatrix<f64>, &DVector<f64>, Option<&DVector<f64>>),
        rows: usize,
    ) -> LinearFit {
        let Self { scale, qr, svd, rank } = self;
        qr.q_tr_mul(&mut b);
        let rotated = b.rows(0, x.ncols()).into_owned();
        let coefficients = solve(svd, *rank, &rotated).component_div(scale);
        let unit_covariance = unscale(&pseudo_inverse_of_square(svd, *rank), scale);
        let residuals = y - x * &coefficients;
        let degrees_of_freedom = rows - rank;
        let residual_variance = weighted_square(&residuals, weights) / degrees_of_freedom as f64;
        let null_directions = svd.right.columns_range(*rank..).into_owned();
        let unidentifiable = participants(&null_directions);
        let covariance = with_unidentifiable(&unit_covariance * residual_variance, &unidentifiable);
        LinearFit {
            std_errors: covariance.diagonal().map(f64::sqrt),
            coefficients,
            covariance,
            residuals,
            residual_variance,
            degrees_of_freedom,
            rank: *rank,
            condition: condition(&svd.values),
            singular_values: svd.values.clone(),
            unidentifiable,
            null_directions,
            unit_covariance,
        }
    }
}

impl LinearFit {
    /// `(X' W X)^-1`, the covariance for unit residual variance; infinite on the diagonal of
    /// `unidentifiable` coefficients.
    #[must_use]
    pub fn unit_covariance(&self) -> DMatrix<f64> {
        with_unidentifiable(self.unit_covariance.clone(), &self.unidentifiable)
    }
}

/// Indices of the parameters whose component in any of the null directions exceeds
/// [`PARTICIPATION`].
pub(crate) fn participants(null_directions: &DMatrix<f64>) -> Vec<usize> {
    // the norm of a row does not depend on the basis chosen for the null space
    let norms = null_directions.row_iter().map(|row| row.norm());
    norms.enumerate().filter(|&(_, norm)| norm > PARTICIPATION).map(|(i, _)| i).collect()
}

/// Sets the variance of the parameters that are not identifiable to infinity.
pub(crate) fn with_unidentifiable(
    mut covariance: DMatrix<f64>,
    unidentifiable: &[usize],
) -> DMatrix<f64> {
    for &i in unidentifiable {
        covariance[(i, i)] = f64::INFINITY;
    }
    covariance
}

/// Checks the input and counts the rows of positive weight.
fn check(
    x: &DMatrix<f64>,
    y: &DVector<f64>,
    weights: Option<&DVector<f64>>,
) -> Result<usize, MathError> {
    if x.ncols() == 0 {
        let setting = "number of columns";
        return Err(MathError::OutOfRange { setting, found: 0.0, expected: "1 or more" });
    }
    check_length("the right-hand side", y.len(), x.nrows())?;
    for column in x.column_iter() {
        check_finite("the design matrix", column.iter())?;
    }
    check_finite("the right-hand side", y.iter())?;
    let mut rows = x.nrows();
    if let Some(w) = weights {
        check_length("the weights", w.len(), x.nrows())?;
        check_finite("the weights", w.iter())?;
        if let Some(&found) = w.iter().find(|&&w| w < 0.0) {
            return Err(MathError::OutOfRange { setting: "weight", found, expected: ">= 0" });
        }
        rows = w.iter().filter(|&&w| w > 0.0).count();
    }
    let required = x.ncols() + 1;
    if rows < required {
        return Err(MathError::TooFewSamples { method: "least squares", found: rows, required });
    }
    Ok(rows)
}

/// Scales every column to unit norm (a zero column stays) and returns the norms.
fn scale_columns(a: &mut DMatrix<f64>) -> DVector<f64> {
    let norms = a.column_iter().map(|c| c.norm()).map(|n| if n > 0.0 { n } else { 1.0 });
    let scale = DVector::from_iterator(a.ncols(), norms);
    for (mut column, norm) in a.column_iter_mut().zip(scale.iter()) {
        column /= *norm;
    }
    scale
}

fn numerical_rank(values: &[f64], share: f64) -> usize {
    let largest = values.first().copied().unwrap_or(0.0);
    values.iter().filter(|&&s| s > share * largest).count()
}

fn condition(values: &[f64]) -> f64 {
    match (values.first(), values.last()) {
        (Some(&largest), Some(&smallest)) if smallest > 0.0 => largest / smallest,
        (Some(_), _) => f64::INFINITY,
        _ => 1.0,
    }
}

fn solve(svd: &SingularValues, rank: usize, b: &DVector<f64>) -> DVector<f64> {
    let mut solution = DVector::zeros(svd.values.len());
    for k in 0..rank {
        let amount = svd.left_scaled.column(k).dot(b) / svd.values[k].powi(2);
        solution.axpy(amount, &svd.right.column(k), 1.0);
    }
    solution
}

fn pseudo_inverse_of_square(svd: &SingularValues, rank: usize) -> DMatrix<f64> {
    let mut half = svd.right.columns(0, rank).into_owned();
    for k in 0..rank {
        half.column_mut(k).unscale_mut(svd.values[k]);
    }
    &half * half.transpose()
}

fn unscale(covariance: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    let (n, m) = covariance.shape();
    DMatrix::from_fn(n, m, |i, j| covariance[(i, j)] / (scale[i] * scale[j]))
}

fn weighted_square(residuals: &DVector<f64>, weights: Option<&DVector<f64>>) -> f64 {
    let term = |(i, r): (usize, &f64)| weights.map_or(1.0, |w| w[i]) * r * r;
    residuals.iter().enumerate().map(term).sum()
}

#[cfg(test)]
#[path = "least_squares_tests.rs"]
pub(crate) mod tests;
