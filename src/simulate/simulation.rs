//! Free simulation: the motion that a model predicts from the input alone.

use super::input::{Hold, Input, RunIn, SimulateError};
use super::stepper::Stepper;
use crate::model::Model;
use crate::robot::State;

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
/// let torque = vec![[0.1, 0.1]; 101]; // below the friction of 0.125 N m
/// let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
/// let motion = simulate(&model, &model.initial(), &input, State::default()).unwrap();
/// assert_eq!(motion[100].omega, [0.0, 0.0]); // it does not creep
/// ```
pub fn simulate(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<Vec<State>, SimulateError> {
    let acting_torque = model.input(input.t, input.torque, p);
    let acting = Input { torque: &acting_torque, ..*input };
    simulate_acting(model, p, &acting, input.t[0], &RunIn::default(), start)
}

/// Simulates a part of a recording: as [`simulate`], but `input.torque` is the acting input,
/// effects applied over the whole recording, and effects count time from `origin` \[s\]. Behind the run-in,
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
    let acting_torque = input.torque;
    let first = if run_in.samples == 0 { start } else { run_in.start };
    let mut stepper = Stepper::new(model, p, origin, first);
    let mut motion = Vec::with_capacity(input.t.len() - run_in.samples);
    if run_in.samples == 0 {
        motion.push(start);
    }
    for k in 1..input.t.len() {
        let end = match input.hold {
            Hold::Linear => acting_torque[k],
            Hold::Constant => acting_torque[k - 1],
        };
        stepper.advance(input.t[k - 1], input.t[k], &acting_torque[k - 1], &end, &mut ())?;
        if k == run_in.samples {
            stepper.place_wheels(start);
        }
        if k >= run_in.samples {
            motion.push(stepper.state());
        }
    }
    Ok(motion)
}

/// Simulates the windows of a recording one after the other: at the first row of each, the wheels are put to
/// its start, and a body behind them keeps its slip and twist, so that no window needs a run-in of its own.
/// `input.torque` is the acting input; rows before the first window, and between pieces, are skipped.
///
/// # Errors
/// As [`simulate`].
pub(crate) fn simulate_windows(
    model: &Model,
    p: &[f64],
    input: &Input,
    windows: &[(std::ops::Range<usize>, State)],
) -> Result<Vec<Vec<State>>, SimulateError> {
    let mut out = Vec::with_capacity(windows.len());
    let mut stepper: Option<(usize, Stepper)> = None;
    for (rows, start) in windows {
        let follows = stepper.take().filter(|(end, _)| *end == rows.start);
        let mut now = match follows {
            // the last row of one window is one before the first of the next
            Some((_, mut stepper)) => {
                step(&mut stepper, input, rows.start)?;
                stepper.place_wheels(*start);
                stepper
            }
            None => Stepper::new(model, p, input.t[0], *start),
        };
        let mut states = vec![*start];
        for k in rows.start + 1..rows.end {
            step(&mut now, input, k)?;
            states.push(now.state());
        }
        out.push(states);
        stepper = Some((rows.end, now));
    }
    Ok(out)
}

/// From row `k - 1` to row `k`.
fn step(stepper: &mut Stepper, input: &Input, k: usize) -> Result<(), SimulateError> {
    let last = if input.hold == Hold::Linear { k } else { k - 1 };
    let (t, m) = (input.t, input.torque);
    stepper.advance(t[k - 1], t[k], &m[k - 1], &m[last], &mut ())
}
