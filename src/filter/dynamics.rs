//! The dynamics of a step: the rigid robot, or (in `coupled`) one with a body behind its wheels.

use nalgebra::Matrix2;

use super::ProcessNoise;
use super::correction::{Covariance, Mean};
use super::push::Push;
use super::step::{Law, Predicted, Sample, move_parameters, predict};
use crate::model::{Linearisation, Model, ModelError};

/// One prediction of a filter with `N` states, and its derivatives.
pub(super) trait Dynamics<const N: usize> {
    /// Fills the states beyond the first six at the start of a piece; `input` acts there [N m].
    fn start(&mut self, input: &[f64; 2], mean: &mut Mean<N>, covariance: &mut Covariance<N>);

    /// Moves mean and covariance over one sample.
    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<N>,
        covariance: &mut Covariance<N>,
        derivatives: bool,
    ) -> Result<Predicted<N>, ModelError>;

    /// The transition matrix of the last prediction.
    fn transition(&self) -> Covariance<N>;

    /// Moves the derivatives of the mean over the same sample: those by the parameters, then those
    /// by torque columns, whose torques on the wheels are `extra` [N m].
    fn carry(
        &self,
        predicted: &Predicted<N>,
        sample: &Sample,
        extra: &[[f64; 2]],
        psi: &mut [[f64; N]],
    );

    /// `∂(mass matrix)/∂θ` of the parameters that have one.
    fn mass_slopes(&mut self, predicted: &Predicted<N>) -> Vec<(usize, Matrix2<f64>)>;
}

/// Wheels and body are one.
pub(super) struct Rigid<'a> {
    law: Law<'a>,
    work: Linearisation,
    /// The last step.
    push: Push,
}

impl<'a> Rigid<'a> {
    pub(super) fn new(model: &'a Model, p: &'a [f64], noise: ProcessNoise) -> Self {
        Self { law: Law { model, p, noise }, work: Linearisation::new(p.len()), push: Push::none() }
    }
}

impl Dynamics<6> for Rigid<'_> {
    fn start(&mut self, _: &[f64; 2], _: &mut Mean<6>, _: &mut Covariance<6>) {}

    #[inline]
    fn predict(
        &mut self,
        sample: &Sample,
        mean: &mut Mean<6>,
        covariance: &mut Covariance<6>,
        derivatives: bool,
    ) -> Result<Predicted<6>, ModelError> {
        let (work, push) = (&mut self.work, &mut self.push);
        let predicted = predict(&self.law, sample, mean, covariance, work, push)?;
        if derivatives {
            let (acceleration, sign) = (&predicted.acceleration, &predicted.sign);
            self.law.model.differentiate_by_parameter(acceleration, sign, work);
        }
        Ok(predicted)
    }

    fn transition(&self) -> Covariance<6> {
        self.push.transition()
    }

    fn carry(&self, _: &Predicted<6>, sample: &Sample, extra: &[[f64; 2]], psi: &mut [[f64; 6]]) {
        move_parameters(&self.push, &self.work, sample, extra, psi);
    }

    fn mass_slopes(&mut self, predicted: &Predicted<6>) -> Vec<(usize, Matrix2<f64>)> {
        let mut by = |a: &[f64; 2]| {
            self.law.model.differentiate(a, &predicted.sign, &mut self.work);
            self.work.by_parameter.clone()
        };
        let slopes = slopes_of_mass(&mut by);
        by(&predicted.acceleration);
        slopes
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
