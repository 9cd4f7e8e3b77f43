//! Simulation with exact sensitivities to every parameter and to the initial state, in one pass.

use super::stepper::Stepper;
use super::variation::{Variation, column_of_start};
use super::{Hold, Input, LANES, SimulateError, simulate};
use crate::model::Model;
use crate::robot::State;

/// Derivatives of a simulated motion.
#[derive(Clone, Debug)]
pub struct Sensitivities {
    /// Parameters of the model plus the four initial states (alpha1, alpha2, omega1, omega2).
    pub columns: usize,
    /// `[k][i][j]` flattened: state i (alpha1, alpha2, omega1, omega2) at sample k by column j.
    values: Vec<f64>,
}

impl Sensitivities {
    /// Derivative of state `i` (alpha1, alpha2, omega1, omega2) at sample `k` by column `j`.
    #[must_use]
    pub fn at(&self, k: usize, i: usize, j: usize) -> f64 {
        self.row(k, i)[j]
    }

    /// All columns of state `i` at sample `k`.
    #[must_use]
    pub fn row(&self, k: usize, i: usize) -> &[f64] {
        &self.values[(k * 4 + i) * self.columns..][..self.columns]
    }
}

/// Simulates like [`simulate`] and returns the exact derivatives of the motion.
///
/// ```text
/// S' = f_x S + f_p           between events (Runge-Kutta 4 along the motion)
/// S+ = S- + (f- - f+) dt/dp  where a speed d·ω reaches zero, dt/dp = -(d·S-)/(d·f-)
/// ```
/// Source: forward sensitivity analysis of hybrid systems (saltation matrix). The jump is
/// required for exact derivatives through reversals and stops.
/// Deviation: models with a two-mass drivetrain are differentiated by central differences.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_with_sensitivities(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
) -> Result<(Vec<State>, Sensitivities), SimulateError> {
    let columns = p.len() + 4;
    let stride = columns.next_multiple_of(LANES);
    let mut motion = Vec::with_capacity(input.t.len());
    let mut values = Vec::with_capacity(input.t.len() * 4 * columns);
    follow(model, p, input, start, &mut |_, state, derivatives| {
        motion.push(*state);
        for row in derivatives.chunks_exact(stride) {
            values.extend_from_slice(&row[..p.len()]);
            values.extend((0..4).map(|i| row[column_of_start(p.len(), i)]));
        }
        true
    })?;
    Ok((motion, Sensitivities { columns, values }))
}

/// Callback of [`follow`] at every sample: its number, the state, and the derivatives of (alpha1, alpha2,
/// omega1, omega2), each a row of all columns (those of the initial state at [`column_of_start`]) padded with
/// zeros to a multiple of [`LANES`]. It returns whether the next sample is needed.
pub(crate) type Visit<'a> = &'a mut dyn FnMut(usize, &State, &[f64]) -> bool;

/// [`simulate_with_sensitivities`] with a callback in place of stored results.
///
/// # Errors
/// As [`simulate`].
pub(crate) fn follow(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
    visit: Visit,
) -> Result<(), SimulateError> {
    if model.is_coupled() {
        return by_differences(model, p, input, start, visit);
    }
    let (acting, derivatives) = model.input_derivatives(input.t, input.torque, p);
    let (t, hold) = (input.t, input.hold);
    let acting = ActingInput { t, acting: &acting, derivatives: &derivatives, hold };
    Follower::new(model, p, t[0], Asked::All).follow(&acting, (0..t.len(), start), visit)
}

/// Columns computed by a [`Follower`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Columns of the parameters and of the initial state.
    All,
    /// Columns of the parameters only; the others are undefined.
    Parameters,
}

/// The input of a whole recording after the input effects of a model.
#[derive(Clone, Copy)]
pub(crate) struct ActingInput<'a> {
    /// Time \[s\]; time-dependent effects are relative to the first row.
    pub(crate) t: &'a [f64],
    /// The acting torque [N m].
    pub(crate) acting: &'a [[f64; 2]],
    /// Its derivatives, [`Model::input_derivatives`].
    pub(crate) derivatives: &'a [Vec<[f64; 2]>],
    /// Between the rows.
    pub(crate) hold: Hold,
}

/// A simulation with derivatives that is about to begin: what depends on the parameters alone, and not on the initial
/// state or on the input, is computed once for all parts of a recording that a copy follows.
#[derive(Clone)]
pub(crate) struct Follower<'m> {
    stepper: Stepper<'m>,
    variation: Variation,
}

impl<'m> Follower<'m> {
    /// The model must not have a two-mass drivetrain. Time-dependent effects are relative to `t0` \[s\], the first row.
    pub(crate) fn new(model: &'m Model, p: &'m [f64], t0: f64, asked: Asked) -> Self {
        let stepper = Stepper::new(model, p, t0, State::default());
        let variation = Variation::new(stepper.forces());
        let variation = match asked {
            Asked::All => variation,
            Asked::Parameters => variation.without_start(),
        };
        Self { stepper, variation }
    }

    /// [`follow`] over a range of rows, from a state at the first of them; rows are counted from it.
    ///
    /// # Errors
    /// As [`simulate`].
    pub(crate) fn follow(
        self,
        input: &ActingInput,
        (range, start): (std::ops::Range<usize>, State),
        visit: Visit,
    ) -> Result<(), SimulateError> {
        let Self { mut stepper, mut variation } = self;
        stepper.begin(input.t[0], start);
        if !visit(0, &start, variation.values()) {
            return Ok(());
        }
        let moved = input.derivatives.iter().enumerate().filter(|(_, d)| !d.is_empty());
        let moved: Vec<(usize, &[[f64; 2]])> = moved.map(|(j, d)| (j, &d[..])).collect();
        for k in range.start + 1..range.end {
            let last = match input.hold {
                Hold::Linear => k,
                Hold::Constant => k - 1,
            };
            variation.next_input(moved.iter().map(|(j, d)| (*j, [d[k - 1], d[last]])));
            let (from, to) = (input.t[k - 1], input.t[k]);
            stepper.advance(from, to, &input.acting[k - 1], &input.acting[last], &mut variation)?;
            if !visit(k - range.start, &stepper.state(), variation.values()) {
                break;
            }
        }
        Ok(())
    }
}

/// Central differences, for models with internal states that have no variational equation here.
fn by_differences(
    model: &Model,
    p: &[f64],
    input: &Input,
    start: State,
    visit: Visit,
) -> Result<(), SimulateError> {
    let motion = simulate(model, p, input, start)?;
    let columns = p.len() + 4;
    let stride = columns.next_multiple_of(LANES);
    let mut values = vec![0.0; motion.len() * 4 * stride];
    for j in 0..columns {
        let at = |sign: f64| {
            let (mut p, mut start) = (p.to_vec(), start);
            let x = match j.checked_sub(p.len()) {
                None => &mut p[j],
                Some(i @ 0..2) => &mut start.alpha[i],
                Some(i) => &mut start.omega[i - 2],
            };
            let h = 1e-5 * x.abs().max(1e-4);
            *x += sign * h;
            simulate(model, &p, input, start).map(|motion| (motion, h))
        };
        let ((up, h), (down, _)) = (at(1.0)?, at(-1.0)?);
        let j = j.checked_sub(p.len()).map_or(j, |i| column_of_start(p.len(), i));
        for (k, (u, d)) in up.iter().zip(&down).enumerate() {
            for i in 0..2 {
                values[(k * 4 + i) * stride + j] = (u.alpha[i] - d.alpha[i]) / (2.0 * h);
                values[(k * 4 + 2 + i) * stride + j] = (u.omega[i] - d.omega[i]) / (2.0 * h);
            }
        }
    }
    for (k, (state, derivatives)) in motion.iter().zip(values.chunks(4 * stride)).enumerate() {
        if !visit(k, state, derivatives) {
            break;
        }
    }
    Ok(())
}
