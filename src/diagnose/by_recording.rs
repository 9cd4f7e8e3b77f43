//! Information on a candidate in each recording.

use nalgebra::{DMatrix, DVector};

/// Information and score of a candidate's columns in each recording separately, after the parameters of the
/// model are eliminated.
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
    /// Reduction of the squared error by these columns with separate coefficients in each
    /// recording.
    pub(super) fn gain(&self, each: &DVector<f64>) -> f64 {
        gain(&self.information, &self.score, each)
    }
}

/// Reduction of a squared error with that information and score at zero by parameters at `p`:
/// `2 g'p - p'Hp`.
pub(super) fn gain(information: &DMatrix<f64>, score: &DVector<f64>, p: &DVector<f64>) -> f64 {
    2.0 * p.dot(score) - p.dot(&(information * p))
}

/// Twice the log-likelihood ratio of columns that reduce the squared error `before` of `degrees` independent
/// values by `gain`.
///
/// ```text
/// LR = n ln(S/(S - gain))
/// ```
pub(super) fn ratio(degrees: f64, before: f64, gain: f64) -> f64 {
    let after = (before - gain).max(1e-12 * before);
    degrees * (before / after).ln()
}
