//! Free simulation: the motion that a model predicts from the drive alone.

use super::RunIn;
use super::stepper::Stepper;
use crate::model::{Model, ModelError};
use crate::recording::RecordingError;
use crate::robot::State;

/// What the drive does between two samples.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// Runs in a straight line from sample to sample (first-order hold).
    #[default]
    Linear,
    /// Keeps the value of the earlier sample (zero-order hold).
    Constant,
}

/// The drive of a simulation: one row a sample.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// Time [s], strictly increasing.
    pub t: &'a [f64],
    /// Recorded drive [N m]; drive effects of the model are applied to it.
    pub moment: &'a [[f64; 2]],
    /// Between the samples.
    pub hold: Hold,
}

/// Why a simulation stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulateError {
    /// The model has no acceleration.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// What was simulated is no recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The motion left all bounds.
    #[error("the simulated motion diverges at t = {t:.3} s (wheel speed above {limit:.0e} rad/s)")]
    Diverged {
        /// When [s].
        t: f64,
        /// Bound [rad/s].
        limit: f64,
    },
}

/// Simulates the model from `start`; one state a sample of `input`, the first being `start`.
///
/// Runge-Kutta 4 within a contact state (which directions slide and which stick), with the
/// instants at which a wheel comes to rest, reverses or breaks away located inside the step.
/// Time-dependent effects count time from the first sample.
///
/// # Errors
/// A mass matrix that is not positive definite, or a diverging motion.
///
/// # Examples
/// ```
/// use amigo_ident::{model::Model, robot::{Robot, State}, simulate::{simulate, Hold, Input}};
/// let model = Model::base(Robot::amigobot());
/// let t: Vec<f64> = (0..101).map(|k| 0.01 * k as f64).collect();
/// let moment = vec![[0.1, 0.1]; 101]; // below the friction of 0.125 N m
/// let input = Input { t: &t, moment: &moment, hold: Hold::Linear };
/// let motion = simulate(&model, &model.initial(), &input, State::default()).unwrap();
/// assert_eq!(motion[100].omega, [0.0, 0.0]); // it does not creep
/// ```
pub fn simulate(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<Vec<State>, SimulateError> {
    let drive = model.drive(input.t, input.moment, p);
    let acting = Input { moment: &drive, ..*input };
    simulate_acting(model, p, &acting, input.t[0], &RunIn::default(), start)
}

/// Simulates a part of a recording: as [`simulate`], but `input.moment` is the acting drive, drive
/// effects applied over the whole recording, and effects count time from `origin` [s]. Behind the run-in,
/// whose states are not returned, the wheels are put to `start`; a body behind them keeps its slip
/// and twist.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_acting(
    model: &Model,
    p: &[f64],
    input: &Input,
    origin: f64,
    run_in: &RunIn,
    start: State,
) -> Result<Vec<State>, SimulateError> {
    let drive = input.moment;
    let first = if run_in.samples == 0 { start } else { run_in.start };
    let mut stepper = Stepper::new(model, p, origin, first);
    let mut motion = Vec::with_capacity(input.t.len() - run_in.samples);
    if run_in.samples == 0 {
        motion.push(start);
    }
    for k in 1..input.t.len() {
        let end = match input.hold {
            Hold::Linear => drive[k],
            Hold::Constant => drive[k - 1],
        };
        stepper.advance(input.t[k - 1], input.t[k], &drive[k - 1], &end, &mut ())?;
        if k == run_in.samples {
            stepper.place_wheels(start);
        }
        if k >= run_in.samples {
            motion.push(stepper.state());
        }
    }
    Ok(motion)
}
