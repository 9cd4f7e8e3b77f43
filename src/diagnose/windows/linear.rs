//! Derivatives of rows in which the simulated speed depends on the parameters beyond any linear range.
//!
//! A wheel at rest breaks away when the driving torque exceeds its friction. If the torque increases slowly then, the
//! time of this depends on the parameters without limit, and the derivatives of all later rows with it:
//!
//! ```text
//! dt/dp = -(∂g/∂p)/(dg/dt),   g: driving torque less friction
//! ```
//! A single such window would dominate the sums of all others, although its errors are linear only for the smallest of
//! changes.

use super::window::See;
use crate::diagnose::THRESHOLDS;

/// Parameters in units of the largest linear response of a speed to them.
pub(super) struct Linear {
    /// `(p/(most_response top speed))²` of each estimated parameter, in the unit of its square times s²/rad².
    squares: Vec<f64>,
}

impl Linear {
    /// For parameters of these `sizes`, and wheels that reach `top` [rad/s].
    pub(super) fn new(sizes: &[f64], top: f64) -> Self {
        let most = THRESHOLDS.most_response * top;
        Self { squares: sizes.iter().map(|size| (size / most).powi(2)).collect() }
    }

    /// The function that calls `see` with derivatives times their [`Linear::factor`].
    pub(super) fn see<'s>(
        &'s self,
        see: See<'s>,
    ) -> impl FnMut(usize, usize, f64, &[f64], bool) + 's {
        let mut less = Vec::new();
        move |row, wheel, error, psi, still| {
            let factor = self.factor(psi);
            if factor == 1.0 {
                return see(row, wheel, error, psi, still);
            }
            less.clear();
            less.extend(psi.iter().map(|d| d * factor));
            see(row, wheel, error, &less, still);
        }
    }

    /// Factor on the derivatives `psi` of a speed: one in the linear range, and beyond it such that the row counts the
    /// less the farther it is from linear.
    ///
    /// ```text
    /// min(1, 1/ρ²),   ρ² = Σ (ψ_j p_j)² / (most_response top speed)²
    /// ```
    pub(super) fn factor(&self, psi: &[f64]) -> f64 {
        let square: f64 = psi.iter().zip(&self.squares).map(|(d, s)| d * d * s).sum();
        if square > 1.0 { square.recip() } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_in_the_linear_range_are_unchanged_and_others_count_less() {
        let linear = Linear::new(&[0.5, 0.0, 2.0], 10.0);
        // 0.5 · 1000 rad/s per unit and relative change: half of 100 top speeds
        assert_eq!(linear.factor(&[1000.0, 1e9, 0.0]), 1.0);
        // ten times the largest linear response leaves a tenth of it
        let far = [2e4, 0.0, 0.0];
        assert!((far[0] * linear.factor(&far) * 0.5 / 1000.0 - 0.1).abs() < 1e-12);
    }
}
