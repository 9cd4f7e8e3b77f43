//! When a descent ends, and its bounds.

use nalgebra::DVector;

use super::quadratic::Quadratic;

/// Settings of [`super::minimise`].
#[derive(Debug, Clone, PartialEq)]
pub struct MinimiseOptions {
    /// Maximum number of accepted steps.
    pub max_iterations: usize,
    /// Converged when the expected decrease, or the actual one of two steps in a row, falls below
    /// this share of the cost.
    pub relative_tolerance: f64,
    /// Converged when the expected decrease falls below this, in the unit of the cost (1e-6 is
    /// a thousandth of a standard error for a negative log-likelihood).
    pub absolute_tolerance: f64,
    /// Converged when the expected decrease falls below this share of [`Quadratic::scatter`].
    pub scatter_tolerance: f64,
    /// Smallest value of each parameter, if bounded.
    pub lower: Option<DVector<f64>>,
    /// Largest value of each parameter, if bounded.
    pub upper: Option<DVector<f64>>,
    /// Damping of the first step, relative to the curvature.
    pub initial_damping: f64,
    /// Whether a converged descent takes the undamped step that it found to be negligible, without another evaluation:
    /// with a loose tolerance this removes most of the remaining error. It also ends the descent one evaluation earlier
    /// if the decrease left after it is negligible, as the last two decreases extrapolate.
    pub last_step: bool,
}

impl Default for MinimiseOptions {
    fn default() -> Self {
        Self {
            max_iterations: 100,
            relative_tolerance: 1e-12,
            absolute_tolerance: 1e-14,
            scatter_tolerance: 0.0,
            lower: None,
            upper: None,
            initial_damping: 1e-3,
            last_step: false,
        }
    }
}

impl MinimiseOptions {
    /// A negligible decrease of the cost.
    pub(super) fn tolerance(&self, here: &Quadratic) -> f64 {
        let relative = self.relative_tolerance * here.cost.abs();
        self.absolute_tolerance.max(relative).max(self.scatter_tolerance * here.scatter)
    }
}
