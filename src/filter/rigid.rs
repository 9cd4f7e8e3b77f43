//! The rigid robot: wheels and body are one.

use nalgebra::{Matrix2, SMatrix};

use super::ProcessNoise;
use super::correction::{Covariance, Mean};
use super::dynamics::slopes_of_mass;
use super::friction::Friction;
use super::push::Push;
use super::sample::{Predicted, Sample};
use super::step::{Body, Braked, Step};
use crate::effects::Motion;
use crate::model::{Linearisation, Model, ModelError, inverse_mass};

/// Torques and masses of a rigid robot, and the last step.
pub(super) struct Rigid<'a> {
    model: &'a Model,
    p: &'a [f64],
    work: Linearisation,
    /// Inverse mass matrix of the wheels that move.
    mobility: Matrix2<f64>,
    push: Push,
}

impl<'a> Rigid<'a> {
    pub(super) fn step(model: &'a Model, p: &'a [f64], noise: ProcessNoise) -> Step<Self> {
        let (work, mobility) = (Linearisation::new(p.len()), Matrix2::zeros());
        Step::new(Self { model, p, work, mobility, push: Push::none() }, noise)
    }
}

impl Body<6> for Rigid<'_> {
    #[inline]
    fn evaluate(
        &mut self,
        sample: &Sample,
        at: &Predicted,
        _: &Mean<6>,
    ) -> Result<Braked, ModelError> {
        let t = sample.t + 0.5 * sample.step;
        let Predicted { alpha, omega, variance, .. } = *at;
        let x = Motion { t, alpha, omega, variance, robot: self.model.robot() };
        self.model.evaluate(&x, self.p, &mut self.work);
        let [m11, m12, m22] = mobility(&self.work.terms.mass, sample.still)?;
        self.mobility = Matrix2::new(m11, m12, m12, m22);
        Ok(Braked { level: self.work.terms.level, mobility: [m11, m12, m22] })
    }

    /// With the smooth slopes C of the torque and K of the friction by the speeds
    /// (`Φ = (1 + A⁻¹ (C h/2 + K h))⁻¹`):
    ///
    /// ```text
    /// a = Φ A⁻¹ (M + d - torque),   dω/dω = -h Φ A⁻¹ (C + K)
    /// ```
    #[inline]
    fn solve(
        &mut self,
        friction: &Friction,
        sample: &Sample,
        mean: &Mean<6>,
        h: f64,
        decay: f64,
    ) -> Result<[f64; 2], ModelError> {
        self.model.differentiate_by_state(&[0.0; 2], &friction.sign, &mut self.work);
        let terms = &self.work.terms;
        let resisting = terms.total_torque(&[0.0; 2], &friction.sign);
        let [first, second] = &self.work.by_state;
        let block = |k: usize| Matrix2::new(first[k], first[k + 1], second[k], second[k + 1]);
        let (by_angle, smooth) = (block(0), block(2));
        let (stiff, mobility) = (friction.stiffness(), self.mobility);
        let implicit = Matrix2::identity() + mobility * (smooth * (0.5 * h) + stiff * h);
        let Some(phi) = implicit.try_inverse() else {
            let [m11, m12, m22] = terms.mass;
            return Err(ModelError::MassNotPositive { m11, m12, m22 });
        };
        let reach = phi * mobility;
        let force = [0, 1].map(|i| sample.input[i] + mean[4 + i] - resisting[i]);
        let by_torque = reach * h;
        self.push = Push {
            h,
            by_angle: (by_angle != Matrix2::zeros()).then(|| by_torque * -by_angle),
            by_speed: by_torque * -(smooth + by_angle * (0.5 * h) + stiff),
            by_torque,
            decay,
        };
        Ok([0, 1].map(|i| reach[(i, 0)] * force[0] + reach[(i, 1)] * force[1]))
    }

    #[inline]
    fn differentiate(&mut self, friction: &Friction, acceleration: &[f64; 2], _: &Mean<6>) {
        self.model.differentiate_by_parameter(acceleration, &friction.sign, &mut self.work);
    }

    #[inline]
    fn advance(
        &mut self,
        sample: &Sample,
        acceleration: &[f64; 2],
        mean: &mut Mean<6>,
        covariance: &mut Covariance<6>,
    ) {
        let h = self.push.h;
        for i in 0..2 {
            let omega = mean[2 + i];
            let after = if sample.still[i] { 0.0 } else { omega + h * acceleration[i] };
            mean[i] += 0.5 * h * (omega + after);
            mean[2 + i] = after;
            mean[4 + i] *= self.push.decay;
        }
        *covariance = self.push.spread(covariance);
    }

    #[inline]
    fn add_noise(&self, torque: &Matrix2<f64>, covariance: &mut Covariance<6>) {
        self.push.add_noise(torque, covariance);
    }

    fn transition(&self) -> Covariance<6> {
        self.push.transition()
    }

    #[inline]
    fn gain(&self) -> SMatrix<f64, 6, 2> {
        self.push.gain()
    }

    #[inline]
    fn carried(&self, column: &[f64; 6], j: Option<usize>, torque: [f64; 2]) -> [f64; 6] {
        let needed = j.map_or([0.0; 2], |j| self.work.by_parameter[j]);
        self.push.moved(column, [torque[0] - needed[0], torque[1] - needed[1]])
    }

    fn parameters(&self) -> usize {
        self.p.len()
    }

    fn mass_slopes(&mut self, predicted: &Predicted) -> Vec<(usize, Matrix2<f64>)> {
        let mut by = |a: &[f64; 2]| {
            self.model.differentiate(a, &predicted.sign, &mut self.work);
            self.work.by_parameter.clone()
        };
        let slopes = slopes_of_mass(&mut by);
        by(&predicted.acceleration);
        slopes
    }
}

/// The inverse mass matrix (m11, m12, m22); if one wheel is at rest, only the other one moves.
#[inline]
fn mobility(mass: &[f64; 3], still: [bool; 2]) -> Result<[f64; 3], ModelError> {
    let inverse = inverse_mass(mass)?;
    Ok(match still {
        [false, false] => inverse,
        [false, true] => [1.0 / mass[0], 0.0, 0.0],
        [true, false] => [0.0, 0.0, 1.0 / mass[2]],
        [true, true] => [0.0; 3],
    })
}
