//! Effect of noise of the recorded input on the score: it enters the innovation and, through the
//! acceleration, the derivatives with respect to the inertias, so their product has a non-zero mean.

use nalgebra::{DVector, Matrix2, SMatrix};

use super::correction::Covariance;

/// Expected score at the true parameters, accumulated during a pass.
///
/// ```text
/// u = M + n:   x - x̂  gets -G n,   ψ_j = ∂x̂/∂θ_j  gets  G L_j n,   L_j = -(∂A/∂θ_j) Φ A⁻¹
/// C_j = E[ψ_j (x - x̂)'] <- F C_j F' - G L_j σ² G',   then (1 - K h') C_j (1 - K h')'
/// E[Σ ψ e / S] = Σ h' C_j h / S
/// ```
/// with the mass matrix A. The shift of the estimate is the information's inverse times that:
/// errors in the variables, as in any regression on a measured acceleration. The filter's own
/// gain and transition are used. Derived here.
pub(super) struct InputNoise<const N: usize> {
    /// Variance of the noise of the input [N^2 m^2].
    variance: f64,
    /// `∂(mass matrix)/∂θ` of the parameters that have one.
    slopes: Vec<(usize, Matrix2<f64>)>,
    cross: Vec<Covariance<N>>,
    mean: DVector<f64>,
}

impl<const N: usize> InputNoise<N> {
    pub(super) fn new(variance: f64, parameters: usize) -> Self {
        let mean = DVector::zeros(parameters);
        Self { variance, slopes: vec![], cross: vec![Covariance::<N>::zeros(); parameters], mean }
    }

    /// Nothing is known of a new piece.
    pub(super) fn restart(&mut self) {
        self.cross.iter_mut().for_each(|c| *c = Covariance::<N>::zeros());
    }

    /// Over one prediction with the transition matrix `f` and the gain `g` of a torque; `slopes` are
    /// `∂(mass matrix)/∂θ` of the parameters that have one.
    pub(super) fn carry(
        &mut self,
        (f, g): (&Covariance<N>, &SMatrix<f64, N, 2>),
        slopes: Vec<(usize, Matrix2<f64>)>,
        step: f64,
        still: [bool; 2],
    ) {
        self.slopes = slopes;
        let reach = g.fixed_view::<2, 2>(2, 0) / step;
        for (j, slope) in &self.slopes {
            let cross = &mut self.cross[*j];
            *cross =
                f * *cross * f.transpose() + g * (slope * reach * self.variance) * g.transpose();
            for i in (0..2).filter(|&i| still[i]) {
                cross.row_mut(2 + i).fill(0.0);
                cross.column_mut(2 + i).fill(0.0);
            }
        }
    }

    /// Over one correction of state `i` with innovation variance `s` and the covariance before it.
    pub(super) fn correct(&mut self, i: usize, s: f64, covariance: &Covariance<N>) {
        let mut keep = Covariance::<N>::identity();
        for k in 0..N {
            keep[(k, i)] -= covariance[(k, i)] / s;
        }
        for (j, _) in &self.slopes {
            let cross = &mut self.cross[*j];
            self.mean[*j] += cross[(i, i)] / s;
            *cross = keep * *cross * keep.transpose();
        }
    }

    /// `E[Σ ψ e / S]` of every parameter.
    pub(super) fn finish(self) -> DVector<f64> {
        self.mean
    }
}
