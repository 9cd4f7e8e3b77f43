//! Information matrices: inverse, Newton step, score statistic, elimination of nuisance parameters.

use nalgebra::{DMatrix, DVector};

use super::least_squares::{participants, with_unidentifiable};

/// Eigenvalues of the information scaled to unit diagonal below this count as zero: the rounding
/// of sums over a million rows (1e6 times 2e-16).
const INFORMATION_TOLERANCE: f64 = 1e-10;

/// A symmetric information matrix, scaled to unit diagonal and decomposed.
///
/// ```text
/// S = D^-1 H D^-1,  D = diag(sqrt h_ii),  S = V diag(e) V'
/// ```
///
/// Scaling makes every result independent of units. Directions whose eigenvalue e does not exceed
/// the tolerance carry no information. A parameter with h_ii not positive carries none; a matrix
/// with a value that is not finite carries none at all. The symmetric part is used.
///
/// # Examples
/// ```
/// use amigo_ident::math::Information;
/// use nalgebra::{DMatrix, DVector};
/// // the data see the sum of the first two parameters only
/// let h = DMatrix::from_row_slice(3, 3, &[4.0, 4.0, 0.0, 4.0, 4.0, 0.0, 0.0, 0.0, 25.0]);
/// let known = Information::new(&h);
/// assert_eq!((known.rank(), known.unidentifiable()), (2, vec![0, 1]));
/// assert!((known.covariance()[(2, 2)] - 0.04).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// Square roots of the diagonal, one where it is not positive.
    root: DVector<f64>,
    /// Eigenvalues of the scaled matrix, largest first.
    eigenvalues: Vec<f64>,
    /// Their vectors as columns.
    vectors: DMatrix<f64>,
    /// Number of eigenvalues above the tolerance.
    rank: usize,
}

impl Information {
    /// Decomposes an information matrix with the tolerance 1e-10.
    ///
    /// # Panics
    /// If the matrix is not square.
    #[must_use]
    pub fn new(information: &DMatrix<f64>) -> Self {
        let mut out = Self::decompose(information);
        out.rank = out.eigenvalues.iter().filter(|&&e| e > INFORMATION_TOLERANCE).count();
        out
    }

    /// Decomposes an information matrix and discards directions with less than this share of the largest
    /// eigenvalue.
    ///
    /// # Panics
    /// If the matrix is not square.
    #[must_use]
    pub fn truncated(information: &DMatrix<f64>, share: f64) -> Self {
        let mut out = Self::decompose(information);
        let least = share * out.eigenvalues.first().copied().unwrap_or(0.0).max(1e-300);
        out.rank = out.eigenvalues.iter().filter(|&&e| e > least).count();
        out
    }

    fn decompose(information: &DMatrix<f64>) -> Self {
        let n = information.nrows();
        let finite = information.iter().all(|v| v.is_finite());
        let root = information.diagonal().map(|h| if finite && h > 0.0 { h.sqrt() } else { 0.0 });
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            if root[i] > 0.0 && root[j] > 0.0 {
                let (upper, lower) = (information[(i, j)], information[(j, i)]);
                (0.5 * upper / root[i] + 0.5 * lower / root[i]) / root[j]
            } else {
                0.0
            }
        });
        let (eigenvalues, vectors) = sorted_eigen(scaled);
        let root = root.map(|r| if r > 0.0 { r } else { 1.0 });
        Self { root, eigenvalues, vectors, rank: 0 }
    }

    /// Number of directions in parameter space that carry information.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Square roots of the diagonal of the information, one where it is not positive.
    #[must_use]
    pub fn scale(&self) -> &DVector<f64> {
        &self.root
    }

    /// Columns P with `P' H P = 1`, one a direction that carries information.
    #[must_use]
    pub fn whitening(&self) -> DMatrix<f64> {
        let mut half = self.vectors.columns(0, self.rank).into_owned();
        for k in 0..self.rank {
            half.column_mut(k).unscale_mut(self.eigenvalues[k].sqrt());
        }
        for (mut row, root) in half.row_iter_mut().zip(self.root.iter()) {
            row.unscale_mut(*root);
        }
        half
    }

    /// The inverse over the directions that carry information:
    /// `D^-1 V diag(1/e) V' D^-1`.
    #[must_use]
    pub fn inverse(&self) -> DMatrix<f64> {
        let half = self.whitening();
        &half * half.transpose()
    }

    /// [`Information::inverse`] with an infinite variance for parameters with a component in a direction
    /// without information; the others are unchanged.
    #[must_use]
    pub fn covariance(&self) -> DMatrix<f64> {
        with_unidentifiable(self.inverse(), &self.unidentifiable())
    }

    /// One unit column per direction without information, in parameters times [`Self::scale`].
    #[must_use]
    pub fn null_directions(&self) -> DMatrix<f64> {
        self.vectors.columns_range(self.rank..).into_owned()
    }

    /// Parameters with a component above 1e-3 in a direction without information.
    #[must_use]
    pub fn unidentifiable(&self) -> Vec<usize> {
        participants(&self.null_directions())
    }

    /// The Newton step `H^-1 g`, zero along directions without information.
    #[must_use]
    pub fn solve(&self, gradient: &DVector<f64>) -> DVector<f64> {
        self.solve_damped(gradient, 0.0)
    }

    /// The step of Levenberg and Marquardt `(H + damping diag H)^-1 g`, zero along directions without
    /// information.
    #[must_use]
    pub fn solve_damped(&self, gradient: &DVector<f64>, damping: f64) -> DVector<f64> {
        let known = self.vectors.columns(0, self.rank);
        let mut along = known.tr_mul(&gradient.component_div(&self.root));
        along.iter_mut().zip(&self.eigenvalues).for_each(|(a, e)| *a /= e + damping);
        (known * along).component_div(&self.root)
    }

    /// The score statistic `s' H^-1 s` over the directions that carry information: chi-squared with
    /// [`Self::rank`] degrees of freedom if the scores have mean zero and covariance H.
    ///
    /// Source: C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948).
    #[must_use]
    pub fn statistic(&self, score: &DVector<f64>) -> f64 {
        self.whitening().tr_mul(score).norm_squared()
    }
}

/// Information and score of `own` parameters when the `nuisance` parameters are estimated too (Schur
/// complement).
///
/// ```text
/// I = H_oo - H_on H_nn^-1 H_no,   s = g_o - H_on H_nn^-1 g_n
/// ```
///
/// # Panics
/// If an index does not exist.
#[must_use]
pub fn eliminate(
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    nuisance: &[usize],
    own: &[usize],
) -> (DMatrix<f64>, DVector<f64>) {
    let part = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |i, k| h[(rows[i], columns[k])])
    };
    let pick = |rows: &[usize]| DVector::from_fn(rows.len(), |i, _| g[rows[i]]);
    let half = Information::new(&part(nuisance, nuisance)).whitening();
    let whitened = half.tr_mul(&part(nuisance, own));
    let information = part(own, own) - whitened.tr_mul(&whitened);
    let score = pick(own) - whitened.tr_mul(&half.tr_mul(&pick(nuisance)));
    (information, score)
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
        let known = Information::new(&(x.transpose() * w * &x / 0.275856612055222));
        // statsmodels WLS on the same rows; columns differ by 1e4 in size
        assert_close(known.covariance()[(0, 0)], 0.002841020937913545, 1e-12);
        assert_close(known.covariance()[(0, 2)], -1.2748351871723817e-07, 1e-11);
        assert_close(known.covariance()[(2, 2)].sqrt(), 4.014635410420255e-10_f64.sqrt(), 1e-12);
        assert_eq!(known.rank(), 3);
    }

    #[test]
    fn scales_twenty_decades_apart_do_not_look_singular() {
        let h = DMatrix::from_row_slice(2, 2, &[1e14, 5e3, 5e3, 1e-6]);
        let known = Information::new(&h);
        // by hand: correlation 0.5, so each variance is 4/3 of the inverse of its information
        assert_eq!(known.rank(), 2);
        assert_close(known.covariance()[(1, 1)], 4e6 / 3.0, 1e-14);
        assert_close(known.covariance()[(0, 0)], 4e-14 / 3.0, 1e-14);
    }

    #[test]
    fn no_information_and_nonsense_give_infinite_errors() {
        let h = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, -3.0]);
        let known = Information::new(&h);
        assert_eq!((known.rank(), &known.unidentifiable()[..]), (1, &[0, 2][..]));
        assert_close(known.covariance()[(1, 1)], 0.5, 1e-15);
        let nonsense = Information::new(&DMatrix::from_element(2, 2, f64::NAN));
        assert_eq!((nonsense.rank(), nonsense.unidentifiable()), (0, vec![0, 1]));
        let indefinite = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        assert_eq!(Information::new(&indefinite).rank(), 1);
        assert_eq!(Information::new(&DMatrix::zeros(0, 0)).rank(), 0);
    }

    /// A positive definite matrix of order 4 and a vector, with scales from 1 to 1e3.
    fn regular() -> (DMatrix<f64>, DVector<f64>) {
        let h = DMatrix::from_row_slice(
            4,
            4,
            &[
                4.0, 1.0, 20.0, 300.0, 1.0, 9.0, -30.0, 600.0, 20.0, -30.0, 2500.0, 8000.0, 300.0,
                600.0, 8000.0, 1e6,
            ],
        );
        (h, DVector::from_row_slice(&[1.0, -2.0, 30.0, 4000.0]))
    }

    #[test]
    fn step_statistic_and_elimination_equal_numpy() {
        let (h, g) = regular();
        let known = Information::new(&h);
        // numpy.linalg.solve(h, g); cond(S) = 2, so rounding stays near 1e-15
        let expected =
            [0.1090531561461798, -0.5582087486157256, -0.009583333333333336, 0.004378875968992248];
        let step = known.solve(&g);
        (0..4).for_each(|i| assert_close(step[i], expected[i], 1e-12));
        // (h + diag(h)/2)^-1 g in rational numbers
        let damped = [
            0.0764833747358073,
            -0.2778973359027133,
            -0.0005305212139297615,
            0.0027653583725548827,
        ];
        let step = known.solve_damped(&g, 0.5);
        (0..4).for_each(|i| assert_close(step[i], damped[i], 1e-12));
        // g @ numpy.linalg.solve(h, g)
        assert_close(known.statistic(&g), 18.45347452934662, 1e-12);
        // own = [1, 3], n = [0, 2]: h[own,own] - h[own,n] @ solve(h[n,n], h[n,own])
        let (information, score) = eliminate(&h, &g, &[0, 2], &[1, 3]);
        assert_close(information[(0, 0)], 8.239583333333334, 1e-12);
        assert_close(information[(0, 1)], 619.7916666666667, 1e-12);
        assert_close(information[(1, 1)], 959895.8333333334, 1e-12);
        (0..2).for_each(|i| {
            assert_close(score[i], [-1.8854166666666667, 3857.2916666666665][i], 1e-12)
        });
    }

    #[test]
    fn a_nuisance_without_information_changes_nothing() {
        let h = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 3.0]);
        let (information, score) = eliminate(&h, &DVector::from_row_slice(&[0.0, 6.0]), &[0], &[1]);
        assert_eq!((information[(0, 0)], score[0]), (3.0, 6.0));
        let (alone, _) = eliminate(&h, &DVector::zeros(2), &[], &[1]);
        assert_eq!(alone[(0, 0)], 3.0);
    }

    #[test]
    fn a_truncated_statistic_leaves_out_the_weak_direction() {
        // by hand: scaled eigenvalues 1 + c and 1 - c with vectors (1, 1) and (1, -1) over sqrt 2
        let c = 1.0 - 1e-5;
        let h = DMatrix::from_row_slice(2, 2, &[1.0, c, c, 1.0]);
        let score = DVector::from_row_slice(&[3.0, 1.0]);
        let full = Information::new(&h);
        let part = Information::truncated(&h, 1e-4);
        assert_eq!((full.rank(), part.rank()), (2, 1));
        assert_close(part.statistic(&score), 8.0 / (1.0 + c), 1e-12);
        // the weak eigenvalue 1e-5 is good to 2e-16/1e-5
        assert_close(full.statistic(&score), 8.0 / (1.0 + c) + 2.0 / 1e-5, 1e-9);
    }
}
