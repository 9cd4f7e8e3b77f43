//! What each recording says of a candidate by itself.

use nalgebra::{DMatrix, DVector};

use super::candidate::Candidate;
use super::regression::{ColumnRoom, Regression};

/// Information and score of a candidate's columns in each recording by itself, one recording after the other, where the
/// parameters of the model have taken their part.
pub(super) struct ByRecording {
    /// Information of the columns of all recordings.
    pub(super) information: DMatrix<f64>,
    /// Their score.
    pub(super) score: DVector<f64>,
    /// Squared error before.
    pub(super) square: f64,
    /// Independent values among the errors.
    pub(super) degrees: f64,
}

impl ByRecording {
    /// What these columns, at values recording by recording, take of the squared error.
    pub(super) fn gain(&self, each: &DVector<f64>) -> f64 {
        gain(&self.information, &self.score, each)
    }
}

/// What parameters at `p` take of a squared error with that information and score at zero: `2 g'p - p'Hp`.
pub(super) fn gain(information: &DMatrix<f64>, score: &DVector<f64>, p: &DVector<f64>) -> f64 {
    2.0 * p.dot(score) - p.dot(&(information * p))
}

/// Twice the log-likelihood ratio of columns that take `gain` of the squared error `before` of so many independent
/// values.
///
/// ```text
/// LR = n ln(S/(S - gain))
/// ```
pub(super) fn ratio(degrees: f64, before: f64, gain: f64) -> f64 {
    let after = (before - gain).max(1e-12 * before);
    degrees * (before / after).ln()
}

impl Regression<'_> {
    /// What the low-passed torques of each recording say of a candidate's columns.
    pub(super) fn by_recording(&self, candidate: &Candidate, room: &mut ColumnRoom) -> ByRecording {
        let each = self.products_by_recording(candidate, room);
        let count = candidate.columns();
        let base = each.first().map_or(0, |products| products.beside.ncols() - 1);
        let size = each.len() * count;
        let mut among = DMatrix::zeros(size, size);
        let mut beside = DMatrix::zeros(size, base + 1);
        for (r, products) in each.into_iter().enumerate() {
            among.view_mut((r * count, r * count), (count, count)).copy_from(&products.among);
            beside.rows_mut(r * count, count).copy_from(&products.beside);
        }
        let by_base = beside.columns(0, base);
        ByRecording {
            information: among - by_base * by_base.transpose(),
            // columns of a candidate stand on the side of the input, the base on that of the motion
            score: -beside.column(base),
            square: self.residual_square(),
            degrees: self.degrees,
        }
    }
}
