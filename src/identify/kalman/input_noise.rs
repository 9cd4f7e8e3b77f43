//! What noise of the recorded drive does to the score: it reaches the innovation and, through the
//! acceleration, the derivatives by the inertias, so their product has a mean.

use nalgebra::{DVector, Matrix2};

use super::step::{Covariance, Predicted};
use crate::model::{Linearisation, Model};

/// The mean of the score at the truth, gathered along a pass.
///
/// ```text
/// u = M + n:   x - x̂  gets -G n,   ψ_j = ∂x̂/∂θ_j  gets  G L_j n,   L_j = -(∂A/∂θ_j) Φ A⁻¹
/// C_j = E[ψ_j (x - x̂)'] <- F C_j F' - G L_j σ² G',   then (1 - K h') C_j (1 - K h')'
/// E[Σ ψ e / S] = Σ h' C_j h / S
/// ```
/// with the mass matrix A. The shift of the estimate is the information's inverse times that:
/// errors in the variables, as in any regression on a measured acceleration. The filter's own
/// gain and transition are used. Derived here.
pub(super) struct InputNoise {
    /// Variance of the noise of the drive [N^2 m^2].
    variance: f64,
    /// `∂(mass matrix)/∂θ` of the parameters that have one.
    slopes: Vec<(usize, Matrix2<f64>)>,
    cross: Vec<Covariance>,
    mean: DVector<f64>,
}

impl InputNoise {
    pub(super) fn new(variance: f64, parameters: usize) -> Self {
        let mean = DVector::zeros(parameters);
        Self { variance, slopes: vec![], cross: vec![Covariance::zeros(); parameters], mean }
    }

    /// Nothing is known of a new piece.
    pub(super) fn restart(&mut self) {
        self.cross.iter_mut().for_each(|c| *c = Covariance::zeros());
    }

    /// Over one prediction; `work` holds the terms of the model, and its derivatives are left at
    /// the acceleration of the step.
    pub(super) fn carry(
        &mut self,
        model: &Model,
        predicted: &Predicted,
        step: f64,
        still: [bool; 2],
        work: &mut Linearisation,
    ) {
        self.find_slopes(model, predicted, work);
        let f = &predicted.transition;
        let g = &predicted.gain;
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
    pub(super) fn correct(&mut self, i: usize, s: f64, covariance: &Covariance) {
        let mut keep = Covariance::identity();
        for k in 0..6 {
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

    fn find_slopes(&mut self, model: &Model, predicted: &Predicted, work: &mut Linearisation) {
        let mut by = |a: &[f64; 2]| {
            model.differentiate(a, &predicted.sign, work);
            work.by_parameter.clone()
        };
        let (none, first, second) = (by(&[0.0; 2]), by(&[1.0, 0.0]), by(&[0.0, 1.0]));
        by(&predicted.acceleration);
        let slope = |j: usize| {
            let part = |d: &[[f64; 2]], i: usize| d[j][i] - none[j][i];
            Matrix2::new(part(&first, 0), part(&second, 0), part(&first, 1), part(&second, 1))
        };
        self.slopes =
            (0..none.len()).map(|j| (j, slope(j))).filter(|(_, d)| d.amax() > 0.0).collect();
    }
}
