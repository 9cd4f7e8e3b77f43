//! From an information matrix to a covariance, with the directions nothing is known about.

use nalgebra::{DMatrix, DVector};

use super::least_squares::{blind, participants};

/// Eigenvalues of the scaled information matrix below this count as zero.
pub const INFORMATION_TOLERANCE: f64 = 1e-10;

/// What an information matrix says about its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Inverse of the information; the diagonal is infinite for `unidentifiable` parameters.
    pub covariance: DMatrix<f64>,
    /// Square roots of the diagonal of `covariance`.
    pub std_errors: DVector<f64>,
    /// Number of directions in parameter space the data determine.
    pub rank: usize,
    /// Largest over smallest eigenvalue after scaling; infinite if that is not positive.
    pub condition: f64,
    /// Eigenvalues of the information scaled to unit diagonal, largest first.
    pub eigenvalues: Vec<f64>,
    /// Indices of the parameters that take part in a direction without information.
    pub unidentifiable: Vec<usize>,
    /// One unit column per direction without information, in parameters times
    /// `sqrt(information_ii)`.
    pub null_directions: DMatrix<f64>,
}

/// Inverts an information matrix after scaling it to unit diagonal.
///
/// ```text
/// S = D^-1 H D^-1,  D = diag(sqrt h_ii),  S = V diag(e) V',  cov = D^-1 V diag(1/e) V' D^-1
/// ```
///
/// Directions with e below [`INFORMATION_TOLERANCE`] carry no information: parameters with a
/// component above 1e-3 in them get an infinite variance, the others keep theirs. A parameter with
/// h_ii not positive knows nothing; a matrix with a value that is not finite knows nothing at all.
/// The symmetric part of `information` is used.
///
/// # Panics
/// If the matrix is not square.
///
/// # Examples
/// ```
/// use amigo_ident::math::symmetric::information_to_covariance;
/// use nalgebra::DMatrix;
/// // the data see the sum of the first two parameters only
/// let h = DMatrix::from_row_slice(3, 3, &[4.0, 4.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0, 25.0]);
/// let known = information_to_covariance(&h);
/// assert_eq!((known.rank, known.unidentifiable), (2, vec![0, 1]));
/// assert!((known.std_errors[2] - 0.2).abs() < 1e-15);
/// ```
#[must_use]
pub fn information_to_covariance(information: &DMatrix<f64>) -> Identified {
    let n = information.nrows();
    if information.iter().any(|v| !v.is_finite()) {
        return decompose(DMatrix::zeros(n, n), &DVector::repeat(n, 1.0));
    }
    let root = information.diagonal().map(|h| if h > 0.0 { h.sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        if root[i] > 0.0 && root[j] > 0.0 {
            let (upper, lower) = (information[(i, j)], information[(j, i)]);
            (0.5 * upper / root[i] + 0.5 * lower / root[i]) / root[j]
        } else {
            0.0
        }
    });
    decompose(scaled, &root.map(|r| if r > 0.0 { r } else { 1.0 }))
}

fn decompose(scaled: DMatrix<f64>, root: &DVector<f64>) -> Identified {
    let n = root.len();
    let (eigenvalues, vectors) = sorted_eigen(scaled);
    let rank = eigenvalues.iter().filter(|&&e| e > INFORMATION_TOLERANCE).count();

    let mut half = vectors.columns(0, rank).into_owned();
    for k in 0..rank {
        half.column_mut(k).unscale_mut(eigenvalues[k].sqrt());
    }
    for i in 0..n {
        half.row_mut(i).unscale_mut(root[i]);
    }
    let null_directions = vectors.columns_range(rank..).into_owned();
    let unidentifiable = participants(&null_directions);
    let covariance = blind(&half * half.transpose(), &unidentifiable);
    let condition = match (eigenvalues.first(), eigenvalues.last()) {
        (Some(&first), Some(&last)) if last > 0.0 => first / last,
        (Some(_), _) => f64::INFINITY,
        _ => 1.0,
    };
    Identified {
        std_errors: covariance.diagonal().map(f64::sqrt),
        covariance,
        rank,
        condition,
        eigenvalues,
        unidentifiable,
        null_directions,
    }
}

/// Eigenvalues, largest first, and their vectors as columns.
fn sorted_eigen(matrix: DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    if matrix.is_empty() {
        return (Vec::new(), matrix); // nalgebra panics on an empty matrix
    }
    let eigen = matrix.symmetric_eigen();
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    let values = order.iter().map(|&i| eigen.eigenvalues[i]).collect();
    (values, eigen.eigenvectors.select_columns(&order))
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::tests::{assert_close, noisy_line};
    use super::*;

    #[test]
    fn the_covariance_of_a_noisy_regression_equals_that_of_statsmodels() {
        let (x, _) = noisy_line();
        let w = DMatrix::from_diagonal(&DVector::from_fn(40, |i, _| 1.0 + (i % 4) as f64));
        let known = information_to_covariance(&(x.transpose() * w * &x / 0.275856612055222));
        // statsmodels WLS on the same rows; columns differ by 1e4 in size
        assert_close(known.covariance[(0, 0)], 0.002841020937913545, 1e-12);
        assert_close(known.covariance[(0, 2)], -1.2748351871723817e-07, 1e-11);
        assert_close(known.std_errors[2], 4.014635410420255e-10_f64.sqrt(), 1e-12);
        assert_eq!(known.rank, 3);
        assert!(known.condition < 2.0);
    }

    #[test]
    fn scales_twenty_decades_apart_do_not_look_singular() {
        let h = DMatrix::from_row_slice(2, 2, &[1e14, 5e3, 5e3, 1e-6]);
        let known = information_to_covariance(&h);
        // by hand: correlation 0.5, so each variance is 4/3 of the inverse of its information
        assert_eq!(known.rank, 2);
        assert_close(known.covariance[(1, 1)], 4e6 / 3.0, 1e-14);
        assert_close(known.covariance[(0, 0)], 4e-14 / 3.0, 1e-14);
    }

    #[test]
    fn no_information_and_nonsense_give_infinite_errors() {
        let h = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, -3.0]);
        let known = information_to_covariance(&h);
        assert_eq!((known.rank, &known.unidentifiable[..]), (1, &[0, 2][..]));
        assert_close(known.covariance[(1, 1)], 0.5, 1e-15);
        let nonsense = information_to_covariance(&DMatrix::from_element(2, 2, f64::NAN));
        assert_eq!((nonsense.rank, nonsense.unidentifiable), (0, vec![0, 1]));
        let indefinite = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        assert_eq!(information_to_covariance(&indefinite).rank, 1);
        assert_eq!(information_to_covariance(&DMatrix::zeros(0, 0)).rank, 0);
    }
}
