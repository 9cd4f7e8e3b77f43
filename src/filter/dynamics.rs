//! The dynamics over a row, as the loop over rows uses them.

use nalgebra::{Matrix2, SMatrix};

use super::correction::{Covariance, Mean};
use super::sample::{Predicted, Sample};
use crate::model::ModelError;

/// One prediction of a filter with `N` states, and its derivatives.
pub(super) trait Dynamics<const N: usize> {
    /// Fills the states beyond angles and speeds at the start of a piece; `input` acts there [N m].
    fn start(&mut self, input: &[f64; 2], mean: &mut Mean<N>, covariance: &mut Covariance<N>);

    /// Moves mean and covariance over one sample.
    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<N>,
        covariance: &mut Covariance<N>,
        derivatives: bool,
    ) -> Result<Predicted, ModelError>;

    /// The transition matrix of the last prediction.
    fn transition(&self) -> Covariance<N>;

    /// Effect of a torque on the wheels that lasts over the last prediction.
    fn gain(&self) -> SMatrix<f64, N, 2>;

    /// Moves the derivatives of the mean over the same sample: those by the parameters, then those
    /// by torque columns, whose torques on the wheels are `extra` [N m].
    fn carry(&self, sample: &Sample, extra: &[[f64; 2]], psi: &mut [[f64; N]]);

    /// `∂(mass matrix)/∂θ` of the parameters that have one; none where it is not computed.
    fn mass_slopes(&mut self, _: &Predicted) -> Vec<(usize, Matrix2<f64>)> {
        vec![]
    }
}

/// `∂(mass matrix)/∂θ` of the parameters that have one, from the derivatives `by` of the torque balance at an
/// acceleration.
pub(super) fn slopes_of_mass(
    mut by: impl FnMut(&[f64; 2]) -> Vec<[f64; 2]>,
) -> Vec<(usize, Matrix2<f64>)> {
    let (none, first, second) = (by(&[0.0; 2]), by(&[1.0, 0.0]), by(&[0.0, 1.0]));
    let slope = |j: usize| {
        let part = |d: &[[f64; 2]], i: usize| d[j][i] - none[j][i];
        Matrix2::new(part(&first, 0), part(&second, 0), part(&first, 1), part(&second, 1))
    };
    (0..none.len()).map(|j| (j, slope(j))).filter(|(_, d)| d.amax() > 0.0).collect()
}
