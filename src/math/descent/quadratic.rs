//! A cost with its derivatives at one point.

use nalgebra::{DMatrix, DVector};

/// A cost with its gradient and a positive semidefinite approximation of its Hessian (`J'J` of a
/// least-squares problem, the information matrix of a likelihood).
#[derive(Debug, Clone, PartialEq)]
pub struct Quadratic {
    /// Value of the cost.
    pub cost: f64,
    /// First derivatives of the cost.
    pub gradient: DVector<f64>,
    /// Approximate second derivatives of the cost.
    pub hessian: DMatrix<f64>,
    /// Twice the decrease of the cost by which sampling places each parameter, tr(H⁻¹ J)/p with the covariance J of the
    /// gradient: 1 for a negative log-likelihood, more where residuals are correlated. Zero if unknown.
    pub scatter: f64,
}

impl Quadratic {
    /// Whether all of its numbers are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let mut derivatives = self.gradient.iter().chain(self.hessian.iter());
        self.cost.is_finite() && derivatives.all(|v| v.is_finite())
    }
}
