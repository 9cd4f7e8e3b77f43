//! Covariance from the scores of blocks, valid where the model or its noise is wrong.

use nalgebra::{DMatrix, DVector};

use super::descent::{Solution, part};
use crate::filter::{HorizonFilter, Reading};
use crate::identify::identifiability::inverse_where_known;
use crate::identify::sampling::at_least;
use crate::math::{raise_errors, sandwich};
use crate::model::Model;
use crate::simulate::Hold;

/// Covariance of the estimated columns and its degrees of freedom.
pub(super) struct Spread {
    pub(super) covariance: DMatrix<f64>,
    pub(super) degrees: f64,
}

/// The sandwich over blocks of some seconds.
///
/// ```text
/// C = H⁻¹ (Σ_b g_b g_b') H⁻¹ m/(m-p),   m blocks, p parameters, m - p degrees of freedom
/// ```
/// At T = 0 no variance is smaller than that of the likelihood, `H⁻¹ Σ e²/S / N`, and the factor is m/(m-1),
/// since the larger of two is used already. With no more blocks than columns only the likelihood is used.
///
/// An input that is not held is unknown between its rows: no standard error is smaller than the change of the solution
/// by halving its rate, the mean over both halves of the rows ([`at_least`]). The time of an input that is held is not
/// estimated: to the covariance is added what its standard error ([`Recording::input_time_error`]) changes.
///
/// ```text
/// C + δδ',   δ: change of the solution with the input later by one standard error
/// ```
///
/// [`Recording::input_time_error`]: crate::recording::Recording::input_time_error
///
/// Source: White, Econometrica 50 (1982); Liang and Zeger, Biometrika 73 (1986).
pub(super) fn spread(solution: &Solution, filter: &HorizonFilter, model: &Model) -> Spread {
    let mut out = of_scores(solution);
    if filter.hold == Hold::Constant {
        // without an error of the time the pass would repeat that of the solution
        if filter.prepared.iter().all(|p| p.recording.input_time_error() == 0.0) {
            return out;
        }
        if let Some(moved) = solution.moved_by(filter, model, Reading::Later) {
            out.covariance += &moved * moved.transpose();
        }
        return out;
    }
    let moved = [0, 1].map(|phase| solution.moved_by(filter, model, Reading::HalfRate(phase)));
    if let [Some(even), Some(odd)] = moved {
        at_least(&mut out.covariance, &(0.5 * (even + odd)));
    }
    out
}

/// The errors from the scores of blocks.
pub(super) fn of_scores(solution: &Solution) -> Spread {
    let n = solution.columns.len();
    let inverse = inverse_where_known(&solution.information());
    let model = &inverse * solution.scale();
    let blocks = solution.sums.iter().flat_map(|s| &s.blocks);
    let scores: Vec<DVector<f64>> = blocks.map(|score| part(score, &solution.columns)).collect();
    let (blocks, columns) = (scores.len() as f64, n as f64);
    let degrees = blocks - columns;
    if degrees < 1.0 {
        return Spread { covariance: model, degrees: 1.0 };
    }
    let lost = if solution.horizon > 0.0 { columns } else { 1.0 };
    let mut covariance = sandwich(&inverse, &scores) * (blocks / (blocks - lost));
    if solution.horizon == 0.0 {
        raise_errors(&mut covariance, &model.diagonal().map(f64::sqrt));
    }
    Spread { covariance, degrees }
}
