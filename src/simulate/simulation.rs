//! Free simulation: the motion that a model predicts from the input alone.

use std::ops::Range;

use super::input::{Hold, Input, SimulateError};
use super::stepper::Stepper;
use crate::model::Model;
use crate::robot::State;

/// Simulates the model from `start`; one state per sample of `input`, the first being `start`.
///
/// Runge-Kutta 4 within a contact state (sliding and sticking directions); the instants at which a wheel
/// comes to rest, reverses or breaks away are located within the step. Time-dependent effects are relative to
/// the first sample.
///
/// # Errors
/// The mass matrix is not positive definite, or the motion diverges.
///
/// # Examples
/// ```
/// use amigo_ident::{model::Model, robot::{Robot, State}, simulate::{simulate, Hold, Input}};
/// let model = Model::base(Robot::amigobot());
/// let t: Vec<f64> = (0..101).map(|k| 0.01 * k as f64).collect();
/// let torque = vec![[0.1, 0.1]; 101]; // below the friction of 0.125 N m
/// let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
/// let motion = simulate(&model, &model.initial(), &input, State::default()).unwrap();
/// assert_eq!(motion[100].omega, [0.0, 0.0]); // exact stiction, no creep
/// ```
pub fn simulate(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<Vec<State>, SimulateError> {
    let acting = Input { torque: &model.input(input.t, input.torque, p), ..*input };
    follow(&mut Stepper::new(model, p, input.t[0], start), &acting, &(0..input.t.len()), start)
}

/// Length of a window of the 2 s simulation error \[s\].
pub(crate) const WINDOW: f64 = 2.0;

/// Simulates windows of a stretch of a recording without gaps, each from its own initial state;
/// time-dependent effects are relative to `origin` \[s\], and `input.torque` is the acting input. The body of
/// a two-mass drivetrain keeps its slip and twist from one window to the next, so that windows need no
/// transient phase. States of a window that diverges are NaN.
///
/// # Errors
/// The mass matrix is not positive definite.
pub(crate) fn simulate_windows(
    model: &Model,
    p: &[f64],
    input: &Input,
    origin: f64,
    windows: &[(Range<usize>, State)],
) -> Result<Vec<Vec<State>>, SimulateError> {
    let mut out = Vec::with_capacity(windows.len());
    let mut before: Option<(usize, Stepper)> = None;
    for (rows, start) in windows {
        // without a second mass, the previous window has no influence
        let before_it = before.take().filter(|(end, _)| *end == rows.start && model.is_coupled());
        let mut stepper = match before_it {
            Some((_, stepper)) => with_wheels_at(stepper, input, rows.start, *start)?,
            None => Stepper::new(model, p, origin, *start),
        };
        match follow(&mut stepper, input, rows, *start) {
            Ok(states) => {
                out.push(states);
                before = Some((rows.end, stepper));
            }
            Err(SimulateError::Diverged { .. }) => out.push(vec![NOWHERE; rows.len()]),
            Err(other) => return Err(other),
        }
    }
    Ok(out)
}

/// The state of a diverged simulation.
pub(super) const NOWHERE: State = State { alpha: [f64::NAN; 2], omega: [f64::NAN; 2] };

/// Advances one row, to the first row of the next window, where the wheels are set to its initial state.
fn with_wheels_at<'m>(
    mut stepper: Stepper<'m>,
    input: &Input,
    row: usize,
    start: State,
) -> Result<Stepper<'m>, SimulateError> {
    step(&mut stepper, input, row)?;
    stepper.place_wheels(start);
    Ok(stepper)
}

/// The states in the rows of a range, starting at its first row.
fn follow(
    stepper: &mut Stepper,
    input: &Input,
    rows: &Range<usize>,
    start: State,
) -> Result<Vec<State>, SimulateError> {
    let mut states = Vec::with_capacity(rows.len());
    states.push(start);
    for k in rows.start + 1..rows.end {
        step(stepper, input, k)?;
        states.push(stepper.state());
    }
    Ok(states)
}

/// From row `k - 1` to row `k`.
fn step(stepper: &mut Stepper, input: &Input, k: usize) -> Result<(), SimulateError> {
    let last = if input.hold == Hold::Linear { k } else { k - 1 };
    let (t, m) = (input.t, input.torque);
    stepper.advance(t[k - 1], t[k], &m[k - 1], &m[last], &mut ())
}
