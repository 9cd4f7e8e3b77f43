//! Local motion from angles at a row where the acceleration may jump.

use std::ops::Range;

use nalgebra::Vector4;

use super::source::Source;
use crate::math::{FewCoefficients, NormalEquations, mean};

/// Number of standard errors within which two neighbourhoods agree.
pub(super) const AGREE: f64 = 2.0;
/// Number of rows to either side of a corner.
const SIDE: usize = 2;
/// Variance of the speed at a corner due to the residuals of its neighbours, in units of the mean square
/// residual over the square of the time step: the residual of five rows with one degree of freedom is the
/// fourth difference D = h² (Δ₁ + Δ₋₁)/2 divided by √70, the error of the speed is h (Δ₋₁ - Δ₁)/8, and equal
/// and opposite changes Δ of the acceleration to either side are equally likely. Derived here.
const OF_NEIGHBOURS: f64 = 70.0 / 16.0;

/// The motion of a wheel from the angles of two rows to either side, if the acceleration jumps at the row, as
/// it does when the input steps.
///
/// ```text
/// alpha = c0 + c1 τ + ½ c2 τ² + ½ c3 τ |τ|
/// ```
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// Angle at the row \[rad\] and speed [rad/s].
    pub(super) alpha: f64,
    pub(super) omega: f64,
    /// Their variances for an angle of variance one.
    pub(super) variance: [f64; 2],
    /// Square of the residual, of one degree of freedom [rad²].
    residual: f64,
    /// Time to the next row \[s\].
    step: f64,
}

impl Corner {
    fn of(source: &Source, piece: &Range<usize>, k: usize, wheel: usize) -> Option<Self> {
        let rows = around(piece, k, SIDE);
        if rows.len() <= 2 * SIDE {
            return None;
        }
        let (t, alpha) = (source.recording.t(), |n: usize| source.alpha(n)[wheel]);
        let step = t[k + 1] - t[k];
        let at = |n: usize| {
            let tau = (t[n] - t[k]) / step;
            let row = Vector4::new(1.0, tau, 0.5 * tau * tau, 0.5 * tau * tau.abs());
            (row, alpha(n) - alpha(k))
        };
        let FewCoefficients { values: c, covariance, .. } =
            NormalEquations::of(rows.clone().map(at)).solve()?;
        // computed from the rows: the sums would lose too many digits
        let residual = rows.map(at).map(|(row, moved)| (moved - row.dot(&c)).powi(2)).sum();
        Some(Self {
            alpha: alpha(k) + c[0],
            omega: c[1] / step,
            variance: [covariance[(0, 0)], covariance[(1, 1)] / (step * step)],
            residual,
            step,
        })
    }
}

/// Rows of a piece at a distance of at most `half` from sample `k`.
pub(super) fn around(piece: &Range<usize>, k: usize, half: usize) -> Range<usize> {
    k.saturating_sub(half).max(piece.start)..(k + half + 1).min(piece.end)
}

/// The corners of some rows of a piece.
pub(super) struct Corners {
    first: usize,
    rows: Vec<Option<Corner>>,
}

impl Corners {
    /// Corners of a wheel at `rows` of a piece, and those around them from which the roughness is estimated.
    pub(super) fn of(
        source: &Source,
        piece: &Range<usize>,
        rows: Range<usize>,
        wheel: usize,
    ) -> Self {
        let first = rows.start.saturating_sub(SIDE).max(piece.start);
        let last = (rows.end + SIDE).min(piece.end);
        let rows = (first..last).map(|k| Corner::of(source, piece, k, wheel)).collect();
        Self { first, rows }
    }

    pub(super) fn at(&self, k: usize) -> Option<&Corner> {
        self.rows.get(k - self.first)?.as_ref()
    }

    /// Variance of the speed at row `k` due to changes of the acceleration at its neighbours [rad²/s²]; zero
    /// if the residuals around it are consistent with noise of standard deviation `sigma` \[rad\].
    pub(super) fn roughness(&self, k: usize, sigma: f64) -> f64 {
        let beside =
            self.rows.iter().skip((k - self.first).saturating_sub(SIDE)).take(2 * SIDE + 1);
        let squares: Vec<f64> = beside.flatten().map(|corner| corner.residual).collect();
        let Some(corner) = self.at(k) else { return 0.0 };
        let (mean, noise) = (mean(squares.iter().copied()), sigma * sigma);
        if mean <= AGREE * AGREE * noise {
            return 0.0;
        }
        OF_NEIGHBOURS * (mean - noise) / (corner.step * corner.step)
    }
}
