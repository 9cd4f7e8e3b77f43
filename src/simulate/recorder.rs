//! Simulated recordings: a robot with known parameters follows a movement and is recorded with noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::SimulateError;
use super::movement::Movement;
use super::stepper::Stepper;
use crate::model::Model;
use crate::recording::{Channels, DriveUnit, Recording, RecordingError};
use crate::robot::State;

/// Standard deviations of the added noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct NoiseLevel {
    /// Wheel speeds [rad/s].
    #[schemars(range(min = 0.0))]
    pub dalpha: f64,
    /// Wheel angles \[rad\].
    #[schemars(range(min = 0.0))]
    pub alpha: f64,
    /// Recorded torques [N m].
    #[serde(rename = "M")]
    #[schemars(range(min = 0.0))]
    pub torque: f64,
}

impl NoiseLevel {
    /// All three multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            dalpha: factor * self.dalpha,
            alpha: factor * self.alpha,
            torque: factor * self.torque,
        }
    }
}

/// Settings of a simulated recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorder {
    /// Sampling rate \[Hz\].
    pub rate: f64,
    /// Rate of the speed controller of the robot, between whose steps the torques are held \[Hz\].
    pub control_rate: f64,
    /// Added noise.
    pub noise: NoiseLevel,
    /// Counts per turn of the wheel encoder; `None`: angles are not quantised.
    pub ticks: Option<f64>,
    /// Seed of the noise.
    pub seed: u64,
}

/// Time span of commands from which the acting input is computed \[s\]; lags and delays are far shorter.
const MEMORY: f64 = 0.4;
/// Bandwidth of the speed controller [1/s].
const BANDWIDTH: f64 = 12.0;

/// Simulates the robot `truth` (parameters `p`) following `movement` under a speed controller, and records
/// it.
///
/// The controller uses the base model with the construction parameters: torques by inverse dynamics of the
/// movement, eq. (14), plus proportional-integral feedback of the speeds, held between its steps. The
/// recorded torques are the commanded ones.
///
/// # Errors
/// The mass matrix is not positive definite, or the motion diverges.
pub fn record(
    name: &str,
    truth: &Model,
    p: &[f64],
    movement: &Movement,
    recorder: &Recorder,
) -> Result<Recording, SimulateError> {
    record_disturbed(name, truth, p, movement, recorder, &mut |_, _| [0.0; 2])
}

/// [`record`] with additional torques on the wheels that are neither recorded nor part of the model:
/// `disturbance(t, state)` [N m], held between the controller's steps.
///
/// # Errors
/// The mass matrix is not positive definite, or the motion diverges.
pub fn record_disturbed(
    name: &str,
    truth: &Model,
    p: &[f64],
    movement: &Movement,
    recorder: &Recorder,
    disturbance: &mut dyn FnMut(f64, &State) -> [f64; 2],
) -> Result<Recording, SimulateError> {
    drive(truth, p, movement, recorder, disturbance)?.recorded(name, recorder)
}

/// A motion under control without noise: time, state and command in every row.
pub(crate) struct Drive(Vec<(f64, State, [f64; 2])>);

impl Drive {
    /// The motion of [`record`], at the rates of `recorder`.
    ///
    /// # Errors
    /// The mass matrix is not positive definite, or the motion diverges.
    pub(crate) fn new(
        truth: &Model,
        p: &[f64],
        movement: &Movement,
        recorder: &Recorder,
    ) -> Result<Self, SimulateError> {
        drive(truth, p, movement, recorder, &mut |_, _| [0.0; 2])
    }

    /// Its recording, with the noise of `recorder`.
    ///
    /// # Errors
    /// Too few rows.
    pub(crate) fn recorded(
        &self,
        name: &str,
        recorder: &Recorder,
    ) -> Result<Recording, SimulateError> {
        Ok(noisy(name, &self.0, recorder)?)
    }
}

fn drive(
    truth: &Model,
    p: &[f64],
    movement: &Movement,
    recorder: &Recorder,
    disturbance: &mut dyn FnMut(f64, &State) -> [f64; 2],
) -> Result<Drive, SimulateError> {
    let robot = truth.robot();
    let step = 1.0 / recorder.control_rate;
    let steps = (movement.duration() * recorder.control_rate).round() as usize;
    let every = (recorder.control_rate / recorder.rate).round().max(1.0) as usize;
    let nominal = robot.parameters();
    let inertia = nominal.a1 + nominal.a2.abs();
    let mut stepper = Stepper::new(truth, p, 0.0, State::default());
    let mut integral = [0.0; 2];
    let (mut times, mut commands) = (Vec::new(), Vec::<[f64; 2]>::new());
    let mut rows = Vec::with_capacity(steps / every + 1);
    for k in 0..=steps {
        let t = k as f64 * step;
        let state = stepper.state();
        let wanted = movement.reference(robot, t);
        let ahead = State { alpha: state.alpha, omega: wanted.omega };
        let forward = nominal.inverse(&ahead, wanted.acceleration);
        let moving = wanted.omega.map(|w| w != 0.0);
        let command = [0, 1].map(|i| {
            let error = wanted.omega[i] - state.omega[i];
            integral[i] += error * step;
            if !moving[i] && wanted.acceleration[i] == 0.0 {
                integral[i] = 0.0;
            }
            forward[i] + inertia * BANDWIDTH * (error + 0.25 * BANDWIDTH * integral[i])
        });
        times.push(t);
        commands.push(command);
        if k % every == 0 {
            rows.push((t, state, command));
        }
        let input = acting(truth, p, &times, &commands, step);
        let besides = disturbance(t, &state);
        let acting = [input[0] + besides[0], input[1] + besides[1]];
        stepper.advance(t, t + step, &acting, &acting, &mut ())?;
    }
    Ok(Drive(rows))
}

/// The present acting input: the input effects applied to the last part of the commands.
fn acting(truth: &Model, p: &[f64], t: &[f64], commands: &[[f64; 2]], step: f64) -> [f64; 2] {
    let last = commands.len() - 1;
    if !truth.acts_on_input() {
        return commands[last];
    }
    let from = commands.len().saturating_sub((MEMORY / step) as usize);
    // recordings begin at rest
    truth.input_after(from == 0, &t[from..], &commands[from..], p)[last - from]
}

fn noisy(
    name: &str,
    rows: &[(f64, State, [f64; 2])],
    recorder: &Recorder,
) -> Result<Recording, RecordingError> {
    let mut rng = ChaCha8Rng::seed_from_u64(recorder.seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let noise = recorder.noise;
    let tick = |angle: f64| match recorder.ticks {
        Some(ticks) => {
            let size = std::f64::consts::TAU / ticks;
            (angle / size).round() * size
        }
        None => angle,
    };
    let mut channels = Channels { alpha: Some(vec![]), omega: Some(vec![]), ..Channels::default() };
    let (mut alpha, mut omega) = (Vec::new(), Vec::new());
    for (t, state, command) in rows {
        channels.t.push(*t);
        alpha.push(state.alpha.map(|a| tick(a + noise.alpha * normal())));
        omega.push(state.omega.map(|w| w + noise.dalpha * normal()));
        channels.torque.push(command.map(|m| m + noise.torque * normal()));
    }
    (channels.alpha, channels.omega) = (Some(alpha), Some(omega));
    Recording::new(name, channels, DriveUnit::NewtonMetre)
}
