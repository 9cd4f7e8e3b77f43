//! Speeds that were computed from the recorded angles by a linear filter, also by one that looks ahead:
//! central differences, Savitzky-Golay, a difference of angles that were filtered forward and backward.
//!
//! ```text
//! omega_k = sum_j b_j (alpha_(k+j+1) - alpha_(k+j)) + e_k,   j = -m..m-1      (b by least squares)
//!         = sum_j c_j alpha_(k+j) + e_k,                     c_j = b_(j-1) - b_j
//! ```
//! The angle's white noise of variance s^2 passes such a filter with s^2 sum c_j^2. The noise of an
//! independent sensor is not correlated with it, so that e has at least that variance, for any accuracy
//! of the sensor and any b; for a speed that was computed from these angles only rounding and the ends
//! of the filter remain.

use nalgebra::{DMatrix, DVector};

use super::super::signal::noise_variance;
use super::{Finding, Kind, Samples};
use crate::conditioning::thresholds::SPEEDS;
use crate::math::noise::fourth_difference_correlation;
use crate::math::{fit, trimmed_mean_square};

/// Half width of the filters in samples: one of a tenth of the Nyquist frequency, of second order and
/// run both ways, has decayed to a thousandth there.
const HALF: usize = 32;
/// Largest number of rows: about fifty per coefficient, for a statistical error of 1 %.
const ROWS: usize = 3000;

/// Residual of a speed after the best filter of the angle.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// As a share of the noise of the angle that passes the filter, both as deviations.
    share: f64,
    /// Whether filters of full length were tested.
    whole: bool,
}

impl Left {
    pub(super) fn is_computed(self) -> bool {
        self.share < SPEEDS.of_angle
    }

    /// Whether the speed is measured and not computed from the angles.
    pub(super) fn is_measured(self) -> bool {
        self.whole && !self.is_computed()
    }

    pub(super) fn share(self) -> f64 {
        self.share
    }
}

/// The largest share of the recordings whose speeds are found to be computed.
pub fn common_share<'a>(recordings: impl Iterator<Item = &'a [Finding]>) -> Option<f64> {
    let shown = recordings.flatten().filter_map(|f| match f.kind {
        Kind::OfAngle { share } => Some(share),
        _ => None,
    });
    shown.max_by(f64::total_cmp)
}

/// Residual of a wheel's speed after the best filter; `None` if the noise of the angle cannot be determined,
/// or if there are too few rows.
pub(super) fn left(s: &Samples) -> Option<Left> {
    let runs: Vec<Vec<f64>> = s.pieces.iter().map(|p| s.alpha[p.clone()].to_vec()).collect();
    if fourth_difference_correlation(&runs)? > SPEEDS.white {
        return None;
    }
    let half = HALF.min(s.t.len() / (2 * SPEEDS.rows_a_coefficient));
    let inside = s.pieces.iter().flat_map(|p| p.start + half..p.end.saturating_sub(half));
    let inside: Vec<usize> = inside.collect();
    let rows: Vec<usize> =
        inside.iter().copied().step_by(inside.len().div_ceil(ROWS).max(1)).collect();
    if half == 0 || rows.len() < SPEEDS.rows_a_coefficient * 2 * half {
        return None;
    }
    let step = |k: usize, j: usize| s.alpha[k + j + 1 - half] - s.alpha[k + j - half];
    let x = DMatrix::from_fn(rows.len(), 2 * half, |row, j| step(rows[row], j));
    let y = DVector::from_fn(rows.len(), |row, _| s.omega[rows[row]]);
    let b = fit(&x, &y, None).ok()?.coefficients;
    let errors = y - &x * &b;
    let freedom = rows.len() as f64 / (rows.len() - 2 * half) as f64;
    let left = freedom * trimmed_mean_square(errors.iter().map(|e| e * e).collect());
    let at = |j: usize| b.get(j).copied().unwrap_or(0.0);
    let before = |j: usize| j.checked_sub(1).map_or(0.0, at);
    let gain: f64 = (0..=2 * half).map(|j| (before(j) - at(j)).powi(2)).sum();
    let passed = gain * noise_variance(&s.alpha);
    (passed > 0.0).then(|| Left { share: (left / passed).sqrt(), whole: half == HALF })
}
