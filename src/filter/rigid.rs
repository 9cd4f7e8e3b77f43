//! The rigid robot: wheels and body are one.

use nalgebra::{Matrix2, SMatrix};

use super::ProcessNoise;
use super::correction::{Covariance, Mean, add_torque_noise};
use super::dynamics::slopes_of_mass;
use super::friction::Friction;
use super::push::Push;
use super::sample::{Predicted, Sample};
use super::step::{Body, Braked, Step, has_slow};
use crate::effects::{BASE, Motion};
use crate::model::{Linearisation, Model, ModelError, inverse_mass};

/// Parts of a step for each time constant of torques that depend on the speeds: the error of the implicit step over a
/// part is a share of (1/4)³/12 of the change of the speed.
const PARTS: f64 = 4.0;
/// Most parts of a step: of four time constants, after which 2 % of a speed are left.
const MOST_PARTS: f64 = 16.0;

/// Torques and masses of a rigid robot, and the last step; of four states without slow torques, of six with them.
pub(super) struct Rigid<'a> {
    model: &'a Model,
    p: &'a [f64],
    work: Linearisation,
    /// Inverse mass matrix of the wheels that move.
    mobility: Matrix2<f64>,
    /// The last part of the step.
    push: Push,
    /// The parts before it, with the derivatives of their torques by the parameters.
    earlier: Vec<(Push, Vec<[f64; 2]>)>,
    /// Parts that are not solved yet.
    remaining: usize,
    /// Fastest rate at which torques change the speeds that they depend on, at the last part [1/s]; none before the
    /// first and where both wheels rest.
    rate: Option<f64>,
}

impl<'a> Rigid<'a> {
    pub(super) fn step(model: &'a Model, p: &'a [f64], noise: ProcessNoise) -> Step<Self> {
        let (work, mobility) = (Linearisation::new(p.len()), Matrix2::zeros());
        let (push, earlier) = (Push::none(), vec![]);
        let body = Self { model, p, work, mobility, push, earlier, remaining: 0, rate: None };
        Step::new(body, noise)
    }

    /// The rate from the derivatives of the torques by the speeds at the last evaluation.
    fn rate_there(&self) -> f64 {
        let [first, second] = &self.work.by_state;
        let rates = self.mobility * Matrix2::new(first[2], first[3], second[2], second[3]);
        (0..2).map(|i| rates.row(i).abs().sum()).fold(0.0, f64::max)
    }
}

impl<const N: usize> Body<N> for Rigid<'_> {
    #[inline]
    fn evaluate(
        &mut self,
        sample: &Sample,
        at: &Predicted,
        _: &Mean<N>,
    ) -> Result<Braked, ModelError> {
        if self.remaining > 0 {
            self.earlier.push((self.push.clone(), self.work.by_parameter.clone()));
        }
        let t = sample.t + 0.5 * sample.step;
        let Predicted { alpha, omega, variance, .. } = *at;
        let x = Motion { t, alpha, omega, variance, robot: self.model.robot() };
        self.model.evaluate(&x, self.p, &mut self.work);
        let [m11, m12, m22] = mobility(&self.work.terms.mass, sample.still)?;
        self.mobility = Matrix2::new(m11, m12, m12, m22);
        Ok(Braked { level: self.work.terms.level, mobility: [m11, m12, m22] })
    }

    fn begin(&mut self, h: f64) -> usize {
        self.earlier.clear();
        let rate = match self.rate {
            Some(rate) => rate,
            None if self.model.effects().len() == BASE.len() => 0.0,
            None => {
                self.model.differentiate_by_state(&[0.0; 2], &[0.0; 4], &mut self.work);
                self.rate_there()
            }
        };
        self.remaining = (PARTS * rate * h).ceil().clamp(1.0, MOST_PARTS) as usize;
        self.remaining
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
        mean: &Mean<N>,
        h: f64,
        decay: f64,
    ) -> Result<[f64; 2], ModelError> {
        self.model.differentiate_by_state(&[0.0; 2], &friction.sign, &mut self.work);
        let moves = self.mobility != Matrix2::zeros();
        self.rate = moves.then(|| self.rate_there());
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
        let slow = |i: usize| if has_slow::<N>() { mean[4 + i] } else { 0.0 };
        let force = [0, 1].map(|i| sample.input[i] + slow(i) - resisting[i]);
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
    fn differentiate(&mut self, friction: &Friction, acceleration: &[f64; 2], _: &Mean<N>) {
        self.model.differentiate_by_parameter(acceleration, &friction.sign, &mut self.work);
    }

    #[inline]
    fn advance(
        &mut self,
        sample: &Sample,
        acceleration: &[f64; 2],
        mean: &mut Mean<N>,
        covariance: &mut Covariance<N>,
    ) {
        self.remaining -= 1;
        let h = self.push.h;
        for i in 0..2 {
            let omega = mean[2 + i];
            let after = if sample.still[i] { 0.0 } else { omega + h * acceleration[i] };
            mean[i] += 0.5 * h * (omega + after);
            mean[2 + i] = after;
            if has_slow::<N>() {
                mean[4 + i] *= self.push.decay;
            }
        }
        *covariance = self.push.spread(covariance);
    }

    #[inline]
    fn add_noise(&self, torque: &Matrix2<f64>, covariance: &mut Covariance<N>) {
        match self.earlier.is_empty() {
            true => self.push.add_noise(torque, covariance),
            false => add_torque_noise(covariance, &Body::<N>::gain(self), torque),
        }
    }

    fn transition(&self) -> Covariance<N> {
        let earlier = self.earlier.iter().map(|(push, _)| push.transition());
        let before =
            earlier.fold(Covariance::<N>::identity(), |all, part: Covariance<N>| part * all);
        self.push.transition::<N>() * before
    }

    #[inline]
    fn gain(&self) -> SMatrix<f64, N, 2> {
        let parts = self.earlier.iter().map(|(push, _)| push).chain([&self.push]);
        let none = SMatrix::<f64, N, 2>::zeros();
        match self.earlier.is_empty() {
            true => self.push.gain(),
            false => parts.fold(none, |all, part| part.transition::<N>() * all + part.gain::<N>()),
        }
    }

    #[inline]
    fn carried(&self, column: &[f64; N], j: Option<usize>, torque: [f64; 2]) -> [f64; N] {
        let moved = |push: &Push, by: &[[f64; 2]], x: &[f64; N]| {
            let needed = j.map_or([0.0; 2], |j| by[j]);
            push.moved(x, [torque[0] - needed[0], torque[1] - needed[1]])
        };
        let mut x = *column;
        for (push, by) in &self.earlier {
            x = moved(push, by, &x);
        }
        moved(&self.push, &self.work.by_parameter, &x)
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

#[cfg(test)]
mod tests {
    use super::super::pass::{NoColumns, PassSettings, filter_pass};
    use super::super::{ProcessNoise, prepare};
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit, Recording};
    use crate::robot::{Robot, State};
    use crate::simulate::{Hold, Input, simulate};

    #[test]
    fn a_row_of_several_time_constants_is_predicted_to_the_noise() {
        let model = Model::base(Robot::amigobot()).add("back_emf").unwrap();
        // 60 ms straight and 12 ms turning, in rows of 50 ms
        let p = [0.0108, 0.0072, 0.0, 0.25, 0.25, 0.3];
        let t: Vec<f64> = (0..800).map(|k| 0.05 * f64::from(k)).collect();
        let level = |k: usize| 3.0 + 9.0 * ((k / 16 * 7919) % 13) as f64 / 13.0;
        let torque: Vec<[f64; 2]> = (0..t.len()).map(|k| [level(k), level(k + 80)]).collect();
        let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
        let motion = simulate(&model, &p, &input, State::default()).unwrap();
        let noise = |k: usize| 0.07 * ((k * k + 3 * k) as f64).sin();
        let omega = motion.iter().enumerate();
        let omega = omega.map(|(k, s)| [s.omega[0] + noise(k), s.omega[1] + noise(k + 777)]);
        let channels = Channels { alpha: None, omega: Some(omega.collect()), torque, t };
        let recording = Recording::new("slow", channels, DriveUnit::Volt).unwrap();
        let noise = ProcessNoise { sigma_m: 1e-4, sigma_d: 0.0, tau_d: 1.0, later: 0.0 };
        let (derivatives, keep_innovations, input_noise) = (true, true, false);
        let settings =
            PassSettings { noise, derivatives, keep_innovations, input_noise, step_scatter: 1.0 };
        let pass = filter_pass(&model, &p, &prepare(&recording), &settings, &NoColumns).unwrap();
        let e: Vec<f64> = pass.innovations.iter().map(|i| i.value.powi(2)).collect();
        let rms = (e.iter().sum::<f64>() / e.len() as f64).sqrt();
        // noise of 0.05 rms; a single implicit step misses by 0.8 rad/s. Parts of a quarter of a time constant are off
        // by 0.1 % of steps of 30 rad/s
        assert!(rms < 0.07, "{rms}");
        // the true parameters are a root of the score, to a few standard deviations
        let z = pass.score[0] / pass.information[(0, 0)].sqrt();
        assert!(z.abs() < 5.0, "{z}");
    }
}
