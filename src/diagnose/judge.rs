//! Evaluation of models on recordings that they were not fitted to.

use rayon::prelude::*;

use super::fit::WindowFit;
use super::outcome::Diagnosis;
use super::thresholds::THRESHOLDS;
use super::verdict::{Errors, structure};
use crate::compare::{
    Asked, Dependence, WindowFloor, ise, persistence_rms, pooled_floor, sensor_floor,
    simulate_recording, unexplained_torque, unresolved, window_rms,
};
use crate::filter::{Likelihood, prepare};
use crate::math::mean;
use crate::model::{Model, ModelError};
use crate::recording::{DriveUnit, Recording, SlowNoise};
use crate::robot::State;
use crate::simulate::{Hold, PhysicalDynamics, SimulateError, WINDOW, halved};

/// Relative difference of the errors of two simulations that rounding explains.
const ROUNDING: f64 = 1e-9;

/// The error of a model on the judged recordings together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Quality index of the free simulations, summed over wheels and recordings [rad^2/s].
    pub ise: f64,
    /// Root mean square error of the windows [rad/s].
    pub window_rms: f64,
}

/// What the last model of a diagnosis leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Left {
    /// The strongest dependence of the residual torque that counts as structure.
    pub structure: Option<Dependence>,
    /// The slow part of the residual torque, the smaller of that of the training and that of the judged recordings, as
    /// autocorrelated noise of the input.
    pub slow: SlowNoise,
}

/// What the sampling of the input may cause of the error of a model over windows, in two bounds [rad/s].
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    /// [`Judge::unresolved`].
    pub unresolved: f64,
    /// Error of a correct model by noise of the speeds alone, [`sensor_floor`].
    pub noise: f64,
}

impl Sampling {
    /// Its part of a squared `error` [rad/s], no more than noise of the speeds leaves of it [rad^2/s^2].
    ///
    /// ```text
    /// min(unresolved², error² - noise²)
    /// ```
    #[must_use]
    pub fn part_of(&self, error: f64) -> f64 {
        let left = (error.powi(2) - self.noise.powi(2)).max(0.0);
        self.unresolved.powi(2).min(left)
    }
}

/// The recordings that errors are judged on, with their smooth motion.
pub struct Judge {
    /// Recordings, preferably held out from all fits.
    pub recordings: Vec<Recording>,
    hold: Hold,
}

impl Judge {
    /// Prepares `recordings` for the evaluation of models with this `hold` of the input.
    #[must_use]
    pub fn new(recordings: Vec<Recording>, hold: Hold) -> Self {
        Self { recordings, hold }
    }

    /// Simulates all recordings with `model` at parameters `p`.
    ///
    /// # Errors
    /// A model that cannot move, or diverges.
    pub fn judge(&self, model: &Model, p: &[f64]) -> Result<Judgement, SimulateError> {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        let one = |recording: &Recording| {
            let simulated = simulate_recording(&dynamics, recording, self.hold)?;
            let total = ise(recording, &simulated.free).iter().sum::<f64>();
            Ok((total, window_rms(recording, &simulated.windows)))
        };
        let each = self.recordings.par_iter().map(one);
        let errors: Vec<(f64, f64)> = each.collect::<Result<_, SimulateError>>()?;
        let square = self.mean_square(errors.iter().map(|(_, window_rms)| *window_rms));
        Ok(Judgement { ise: errors.iter().map(|(ise, _)| ise).sum(), window_rms: square.sqrt() })
    }

    /// Whether the effect `id` of a fit changes the judged simulations, by more than noise of the input. A limit of the
    /// input that the judged recordings do not reach may lower their error through the other parameters alone, which the
    /// recordings that reach it have biased.
    #[must_use]
    pub fn acts(&self, fit: &WindowFit, id: &str) -> bool {
        let Some(e) = fit.place_of(id) else { return false };
        let (effect, p) = (&fit.model.effects()[e], &fit.p[fit.model.slots(e)]);
        let exceeds = |r: &Recording| effect.exceeds_noise(r.torque(), r.noise().torque, p);
        if !self.recordings.iter().any(exceeds) {
            return false;
        }
        let (model, p) = fit.without(e);
        let error = |model: &Model, p: &[f64]| self.judge(model, p).map(|judged| judged.window_rms);
        match (error(&fit.model, &fit.p), error(&model, &p)) {
            (Ok(with), Ok(without)) => (with - without).abs() > ROUNDING * with,
            _ => true,
        }
    }

    /// Root mean square error over windows of the correct model [rad/s], computed from one near it; zero if
    /// the model cannot be simulated.
    #[must_use]
    pub fn floor(&self, model: &Model, p: &[f64]) -> WindowFloor {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        pooled_floor(&dynamics, &self.recordings, self.hold, 0).unwrap_or_default()
    }

    /// Number of windows of the judged recordings times wheels; an axis mapped to both wheels counts once.
    #[must_use]
    pub fn values(&self) -> f64 {
        self.recordings.iter().map(|r| r.wheels().len() as f64 * r.covered() / WINDOW).sum()
    }

    /// Smallest change of the error over windows that the sampling of the input resolves [rad/s]; zero
    /// where the model cannot be simulated.
    #[must_use]
    pub fn unresolved(&self, model: &Model, p: &[f64]) -> f64 {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        unresolved(&dynamics, &self.recordings, self.hold).unwrap_or(0.0)
    }

    /// What the sampling of the input may cause of the error of a model over windows.
    #[must_use]
    pub fn sampling(&self, model: &Model, p: &[f64]) -> Sampling {
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.to_vec() };
        let noise = sensor_floor(&dynamics, &self.recordings, self.hold, 0).unwrap_or(0.0);
        Sampling { unresolved: self.unresolved(model, p), noise }
    }

    /// Mean square error over windows with every other row of the input, the mean over both choices of them
    /// [rad^2/s^2]; `None` if the model cannot be simulated.
    #[must_use]
    pub fn at_half_rate(&self, model: &Model, p: &[f64]) -> Option<f64> {
        let of = |phase| {
            let recordings = self.recordings.iter().map(|r| halved(r, phase)).collect();
            let judged = Self::new(recordings, self.hold).judge(model, p).ok()?;
            Some(judged.window_rms.powi(2))
        };
        Some(0.5 * (of(0)? + of(1)?))
    }

    /// The errors that a diagnosis of the recordings `train` started and ended with, beside the noise `floor`.
    ///
    /// # Errors
    /// A model that cannot move, or diverges.
    pub fn errors(
        &self,
        diagnosis: &Diagnosis,
        floor: WindowFloor,
        train: &[Recording],
    ) -> Result<Errors, SimulateError> {
        let error = |fit: &WindowFit| self.judge(&fit.model, &fit.p).map(|j| j.window_rms.powi(2));
        let errors = Errors {
            before: error(&diagnosis.base)?,
            after: error(diagnosis.last())?,
            floor: floor.expected.powi(2),
            most: floor.most.powi(2),
            uncertain: 0.0,
            slow_floor: floor.is_slow(),
            speed: self.top_speed().powi(2),
        };
        // the parameters of recordings that were fitted have no further error there
        let asked = diagnosis.validated && errors.above_floor();
        if !asked {
            return Ok(errors);
        }
        let uncertain = self.uncertain(diagnosis.last())? / self.misfit(diagnosis.last(), train)?;
        Ok(Errors { uncertain, ..errors })
    }

    /// The squared error of a fit on its training recordings over their squared floor, at least one: the factor by
    /// which an error of the model, beside noise, raises the covariance of the parameters. Whether the model is correct
    /// cannot be decided by a covariance that contains its error.
    fn misfit(&self, fit: &WindowFit, train: &[Recording]) -> Result<f64, SimulateError> {
        let own = Self { recordings: train.to_vec(), hold: self.hold };
        let floor = own.floor(&fit.model, &fit.p).expected.powi(2);
        let error = own.judge(&fit.model, &fit.p)?.window_rms.powi(2);
        // an error or a floor that is not a number widens nothing
        Ok(if error > floor && floor > 0.0 { error / floor } else { 1.0 })
    }

    /// Error over noise floor of a fit on its training recordings, if it is above the floor.
    ///
    /// # Errors
    /// The mass matrix is not positive definite.
    pub fn fails(
        &self,
        fit: &WindowFit,
        train: &[Recording],
    ) -> Result<Option<f64>, SimulateError> {
        let ratio = self.misfit(fit, train)?.sqrt();
        Ok((ratio > THRESHOLDS.above_floor).then_some(ratio))
    }

    /// What the uncertainty of the parameters of a fit may add to the error over windows, squared [rad^2/s^2]:
    /// recordings with another movement than the training ones (faster turns, higher speeds) depend on combinations of
    /// the parameters that the latter determine less well.
    ///
    /// ```text
    /// 2² Σ_k mean (w(p + √λ_k v_k) - w(p))²   λ, v: eigenvalues and eigenvectors of the covariance
    /// ```
    /// Directions that the training recordings do not determine at all, and those in which the model cannot be
    /// simulated, are left out.
    fn uncertain(&self, fit: &WindowFit) -> Result<f64, SimulateError> {
        let known = fit.covariance.map(|v| if v.is_finite() { v } else { 0.0 });
        let eigen = known.symmetric_eigen();
        let windows = |p: &[f64]| -> Result<Vec<Vec<State>>, SimulateError> {
            let dynamics = PhysicalDynamics { model: fit.model.clone(), p: p.to_vec() };
            let of = |r| simulate_recording(&dynamics, r, self.hold).map(|s| s.windows);
            self.recordings.par_iter().map(of).collect()
        };
        let here = windows(&fit.p)?;
        let square = |k: usize| {
            let step = eigen.eigenvectors.column(k) * eigen.eigenvalues[k].max(0.0).sqrt();
            let p: Vec<f64> = fit.p.iter().zip(step.iter()).map(|(p, d)| p + d).collect();
            let there = windows(&p).ok()?;
            let pairs = here.iter().flatten().zip(there.iter().flatten());
            let apart = |(a, b): (&State, &State)| {
                (0..2).map(|i| (a.omega[i] - b.omega[i]).powi(2)).sum::<f64>()
            };
            Some(mean(pairs.map(apart)) / 2.0).filter(|square| square.is_finite())
        };
        let places = (0..eigen.eigenvalues.len()).filter(|&k| eigen.eigenvalues[k] > 0.0);
        Ok(THRESHOLDS.parameter_errors.powi(2) * places.filter_map(square).sum::<f64>())
    }

    /// Mean square change of a speed within the windows [rad^2/s^2]: the squared error of constant speeds.
    #[must_use]
    pub fn change(&self) -> f64 {
        self.mean_square(self.recordings.iter().map(|r| persistence_rms(r, self.hold)))
    }

    /// Mean square over the rows of all recordings of errors of which the root mean square of each is given.
    fn mean_square(&self, rms: impl Iterator<Item = f64>) -> f64 {
        let (mut sum, mut samples) = (0.0, 0.0);
        for (recording, rms) in self.recordings.iter().zip(rms) {
            let count = recording.len() as f64;
            sum += count * rms.powi(2);
            samples += count;
        }
        sum / samples
    }

    /// The largest top speed of the judged recordings [rad/s].
    fn top_speed(&self) -> f64 {
        self.recordings.iter().map(Recording::top_speed).fold(0.0, f64::max)
    }

    /// What the last model of a diagnosis leaves on the training recordings of `likelihood` and, if other ones are
    /// `held_out`, on those that are judged. Its structure may be visible only on the recordings that were not fitted:
    /// if the training data contain one kind of motion only, the parameters absorb the effect.
    ///
    /// # Errors
    /// If the filter cannot run.
    pub fn left_by(
        &self,
        diagnosis: &Diagnosis,
        likelihood: &Likelihood,
        held_out: bool,
    ) -> Result<Left, ModelError> {
        let WindowFit { model, p, .. } = diagnosis.last();
        let elsewhere = held_out.then(|| {
            let prepared = self.recordings.iter().map(prepare).collect();
            Likelihood { prepared, ..likelihood.clone() }
        });
        let mut out = Left { structure: None, slow: SlowNoise::default() };
        for (n, seen) in [likelihood].into_iter().chain(&elsewhere).enumerate() {
            let (noise, _) = seen.noise(model, p, &seen.initial_noise());
            let slow = SlowNoise { sigma: noise.sigma_d, time_s: noise.tau_d };
            // a sensor has the same noise in all recordings; what one of them shows beyond it is no noise of the sensor
            if n == 0 || slow.sigma < out.slow.sigma {
                out.slow = slow;
            }
            let left = unexplained_torque(model, p, &noise, seen, Asked::Tests)?;
            let Some(found) = structure(&left) else { continue };
            let last = out.structure.as_ref().map_or(0.0, |s| s.log_significance);
            if found.log_significance >= last {
                out.structure = Some(found.clone());
            }
        }
        Ok(out)
    }

    /// Error over windows of the correct model [rad/s] with the slow noise of a measured input that the innovations of
    /// the filter show; zero if it is larger than noise of a sensor can be, or if the input is a voltage, which is
    /// commanded.
    #[must_use]
    pub fn coloured_floor(&self, model: &Model, p: &[f64], slow: SlowNoise) -> f64 {
        let squares = self.recordings.iter().flat_map(|r| r.torque().iter().flatten());
        let input = mean(squares.map(|m| m * m)).sqrt();
        let commanded = self.recordings.iter().any(|r| r.drive_unit() == DriveUnit::Volt);
        if commanded || !(slow.sigma <= THRESHOLDS.sensor_noise * input) {
            return 0.0;
        }
        let noisier = |r: &Recording| {
            let mut r = r.clone();
            r.set_slow_input_noise(r.slow_input_noise().map(|own| match own.sigma < slow.sigma {
                true => slow,
                false => own,
            }));
            r
        };
        let recordings = self.recordings.iter().map(noisier).collect();
        Self { recordings, hold: self.hold }.floor(model, p).expected
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::Robot;
    use crate::simulate::{Movement, NoiseLevel, Recorder, record};

    #[test]
    fn a_pause_between_two_stretches_is_no_time_of_measurement() {
        // 10 s, a pause of 180 s, 10 s: five windows of 2 s twice, of two wheels; of one if both are the same axis
        let stretch = |from: f64| (0..=1000).map(move |k| from + 0.01 * f64::from(k));
        let t: Vec<f64> = stretch(0.0).chain(stretch(190.0)).collect();
        let of = |two: f64| {
            let omega = t.iter().map(|t| [t.sin(), two * t.sin()]).collect();
            let torque = t.iter().map(|t| [t.cos(), two * t.cos()]).collect();
            let channels = Channels { t: t.clone(), alpha: None, omega: Some(omega), torque };
            let recording =
                Recording::new("paused", channels, DriveUnit::NewtonMetre).expect("valid");
            Judge::new(vec![recording], Hold::Linear).values()
        };
        // each stretch loses a row
        assert!((of(0.5) - 20.0).abs() < 0.05, "{}", of(0.5));
        assert!((of(1.0) - 10.0).abs() < 0.05, "{}", of(1.0));
    }

    #[test]
    fn a_limit_that_the_recordings_do_not_reach_does_not_act_in_them() {
        let robot = Robot::amigobot();
        let base = Model::base(robot.clone());
        let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };
        let movement = Movement::rich(&robot, 3, 8.0, 12.0);
        let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let made = record("synthetic", &base, &base.initial(), &movement, &recorder).unwrap();
        let largest = made.torque().iter().flatten().fold(0.0, |a: f64, m| a.max(m.abs()));
        let judge = Judge::new(vec![made], Hold::Linear);
        let model = Model::with_effects(robot, &["torque_saturation"]).unwrap();
        let acts = |limit: f64| {
            let mut p = base.initial();
            p.push(limit);
            let covariance = DMatrix::zeros(p.len(), p.len());
            let at_bound = vec![false; p.len()];
            let fit =
                WindowFit { model: model.clone(), p, cost: 0.0, covariance, at_bound, windows: 8 };
            judge.acts(&fit, "torque_saturation")
        };
        assert!(!acts(1.01 * largest));
        assert!(acts(0.7 * largest));
    }
}
