//! Simulation with exact sensitivities: how the motion changes with every parameter and with the
//! initial state, in the same pass.

use std::convert::Infallible;

use wide::f64x4;

use super::drive::Drive;
use super::forces::{Departure, Forces, Vector, times};
use super::friction::Contact;
use super::stepper::{StepObserver, Stepper};
use super::{Hold, Input, SimulateError, simulate};
use crate::effects::{DIRECTIONS, along};
use crate::math::runge_kutta_step;
use crate::model::{Linearisation, Model};
use crate::robot::State;

/// Derivatives of a simulated motion.
#[derive(Clone, Debug)]
pub struct Sensitivities {
    /// Parameters of the model plus the four initial states (alpha1, alpha2, omega1, omega2).
    pub columns: usize,
    /// Columns with the space of those that fill up the last lanes.
    stride: usize,
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
        let start = (k * 4 + i) * self.stride;
        &self.values[start..start + self.columns]
    }
}

/// Simulates as [`simulate`] and returns the exact derivatives of the motion.
///
/// ```text
/// S' = f_x S + f_p           between events (Runge-Kutta 4 along the motion)
/// S+ = S- + (f- - f+) dt/dp  where a speed d·ω reaches zero, dt/dp = -(d·S-)/(d·f-)
/// ```
/// Source: forward sensitivity analysis of hybrid systems (saltation matrix). The jump is what
/// makes the derivative right through reversals and stops.
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
    let mut values = Vec::with_capacity(input.t.len() * 4 * stride);
    follow(model, p, input, start, &mut |_, state, derivatives| {
        motion.push(*state);
        values.extend_from_slice(derivatives);
    })?;
    Ok((motion, Sensitivities { columns, stride, values }))
}

/// What [`follow`] calls at every sample: with its number, the state, and the derivatives of
/// (alpha1, alpha2, omega1, omega2), each a row of all columns filled up with zeros to a multiple
/// of [`LANES`].
pub(crate) type Visit<'a> = &'a mut dyn FnMut(usize, &State, &[f64]);

/// [`simulate_with_sensitivities`] for one who keeps only what he needs.
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
    let (acting, derivatives) = model.drive_derivatives(input.t, input.moment, p);
    let (t, hold) = (input.t, input.hold);
    let acting = ActingInput { t, acting: &acting, derivatives: &derivatives, hold };
    follow_part(model, p, &acting, 0..t.len(), start, visit)
}

/// The input of a whole recording as the effects of a model change it.
#[derive(Clone, Copy)]
pub(crate) struct ActingInput<'a> {
    /// Time [s]; effects that depend on time count from the first row.
    pub(crate) t: &'a [f64],
    /// The torque that acts [N m].
    pub(crate) acting: &'a [[f64; 2]],
    /// Its derivatives, [`Model::drive_derivatives`].
    pub(crate) derivatives: &'a [Vec<[f64; 2]>],
    /// Between the rows.
    pub(crate) hold: Hold,
}

/// [`follow`] over the rows of `range` alone, from `start` at the first; rows are counted from it. The model
/// must be without a second body.
///
/// # Errors
/// As [`simulate`].
pub(crate) fn follow_part(
    model: &Model,
    p: &[f64],
    input: &ActingInput,
    range: std::ops::Range<usize>,
    start: State,
    visit: Visit,
) -> Result<(), SimulateError> {
    let mut stepper = Stepper::new(model, p, input.t[0], start);
    let mut variation = Variation::new(p.len());
    let mut values = Vec::with_capacity(4 * LANES * variation.groups.len());
    variation.write(&mut values);
    visit(0, &start, &values);
    for k in range.start + 1..range.end {
        let last = match input.hold {
            Hold::Linear => k,
            Hold::Constant => k - 1,
        };
        let by_input = input.derivatives.iter().enumerate().filter(|(_, d)| !d.is_empty());
        variation.drive.clear();
        variation.drive.extend(by_input.map(|(j, d)| (j, [d[k - 1], d[last]])));
        let (from, to) = (input.t[k - 1], input.t[k]);
        stepper.advance(from, to, &input.acting[k - 1], &input.acting[last], &mut variation)?;
        variation.write(&mut values);
        visit(k - range.start, &stepper.state(), &values);
    }
    Ok(())
}

/// Columns that are carried together in the lanes of the processor.
pub(crate) const LANES: usize = 4;
/// Derivatives of (alpha1, alpha2, omega1, omega2) by four columns.
type Group = [f64x4; 4];

/// The variational equation at one instant, solved for the accelerations:
/// `dω' = by_state · (dα, dω) + forcing`.
#[derive(Clone)]
struct Node {
    /// Acceleration and friction signs for which it was solved.
    place: ([f64; 2], [f64; 4]),
    by_state: [[f64; 4]; 2],
    forcing: Vec<[f64x4; 2]>,
}

/// The sensitivities on their way.
pub(super) struct Variation {
    groups: Vec<Group>,
    /// Derivative of the input by each parameter at both ends of the sample, where there is one.
    drive: Vec<(usize, [[f64; 2]; 2])>,
    /// At the start, in the middle and at the end of a step.
    nodes: [Node; 3],
    middle: Linearisation,
    /// What was evaluated at the end of the last step, and the state there.
    end: Linearisation,
    at_end: Option<(f64, Vector)>,
}

impl Variation {
    pub(super) fn new(parameters: usize) -> Self {
        let count = (parameters + 4).div_ceil(LANES);
        let node = Node {
            place: ([f64::NAN; 2], [0.0; 4]),
            by_state: [[0.0; 4]; 2],
            forcing: vec![[f64x4::ZERO; 2]; count],
        };
        let mut variation = Self {
            groups: vec![[f64x4::ZERO; 4]; count],
            drive: vec![],
            nodes: std::array::from_fn(|_| node.clone()),
            middle: Linearisation::new(parameters),
            end: Linearisation::new(parameters),
            at_end: None,
        };
        variation.identity();
        variation
    }

    /// The four initial states by themselves.
    fn identity(&mut self) {
        let parameters = self.middle.by_parameter.len();
        for i in 0..4 {
            let column = parameters + i;
            self.groups[column / LANES][i].as_mut_array()[column % LANES] = 1.0;
        }
    }

    /// Derivatives count from here on; `acting` are those of the drive at both ends of the sample.
    pub(super) fn restart(&mut self, acting: &[(usize, [[f64; 2]; 2])]) {
        self.groups.iter_mut().for_each(|group| *group = [f64x4::ZERO; 4]);
        self.identity();
        self.drive.clear();
        self.drive.extend_from_slice(acting);
    }

    /// Derivative of state `i` by a column.
    #[inline]
    pub(super) fn at(&self, i: usize, column: usize) -> f64 {
        self.groups[column / LANES][i].as_array()[column % LANES]
    }

    /// Writes all columns, one state after the other.
    fn write(&self, values: &mut Vec<f64>) {
        values.clear();
        for i in 0..4 {
            self.groups.iter().for_each(|group| values.extend(group[i].to_array()));
        }
    }

    /// Derivatives of the acceleration at `t`, where it is `a`, into a node, from what was
    /// evaluated there: `self.middle` for that in the middle, `self.end` for the others.
    fn solve(
        &mut self,
        f: &Forces,
        node: usize,
        (t, a): (f64, [f64; 2]),
        from: &Departure,
        drive: &Drive,
    ) {
        let linear = if node == 1 { &mut self.middle } else { &mut self.end };
        let node = &mut self.nodes[node];
        node.place = (a, from.contact.sign);
        f.model.differentiate(&a, &from.contact.sign, linear);
        // a mass matrix that cannot be inverted was refused by the step of the state itself
        let mobility = f.mobility(&linear.terms.mass, from).unwrap_or([0.0; 3]);
        let solved = |b: [f64; 2]| times(&mobility, &[-b[0], -b[1]]);
        for k in 0..4 {
            let column = solved([linear.by_state[0][k], linear.by_state[1][k]]);
            (node.by_state[0][k], node.by_state[1][k]) = (column[0], column[1]);
        }
        let mut set = |j: usize, moment: [f64; 2]| {
            let [first, second] = &mut node.forcing[j / LANES];
            let column = solved(moment);
            first.as_mut_array()[j % LANES] = column[0];
            second.as_mut_array()[j % LANES] = column[1];
        };
        for (j, moment) in linear.by_parameter.iter().enumerate() {
            set(j, *moment);
        }
        let share = drive.share(t);
        for (j, [start, end]) in &self.drive {
            let moment = linear.by_parameter[*j];
            set(*j, [0, 1].map(|i| moment[i] - start[i] - share * (end[i] - start[i])));
        }
    }

    /// Runge-Kutta 4 over a step of `h` with the nodes.
    fn step(&mut self, h: f64) {
        let [start, middle, end] = &self.nodes;
        let angles = self
            .nodes
            .iter()
            .any(|node| node.by_state.iter().any(|row| row[0] != 0.0 || row[1] != 0.0));
        for (n, group) in self.groups.iter_mut().enumerate() {
            let Ok(after) = runge_kutta_step(group, h, |c, x| {
                let node = if c == 0.0 {
                    start
                } else if c < 1.0 {
                    middle
                } else {
                    end
                };
                let row = |i: usize| {
                    let by = node.by_state[i];
                    let mut out = node.forcing[n][i] + x[2] * by[2] + x[3] * by[3];
                    if angles {
                        out += x[0] * by[0] + x[1] * by[1];
                    }
                    out
                };
                Ok::<_, Infallible>([x[2], x[3], row(0), row(1)])
            });
            *group = after;
        }
    }
}

/// The state in the middle of a step from its ends and the rates there, by Hermite's cubic.
fn middle(h: f64, (y, rate): (&Vector, &Vector), (end, a): (&Vector, &[f64; 2])) -> Vector {
    let end_rate = [end[2], end[3], a[0], a[1], 0.0, 0.0, 0.0, 0.0];
    std::array::from_fn(|i| 0.5 * (y[i] + end[i]) + 0.125 * h * (rate[i] - end_rate[i]))
}

/// Accelerations that differ by less than this share differ by rounding.
const ROUNDING: f64 = 1e-9;

impl Node {
    /// Whether it holds at the start of a step that begins where it was solved.
    fn holds(&self, from: &Departure) -> bool {
        let (a, sign) = self.place;
        let close = |i: usize| {
            let now = from.rate[2 + i];
            (now - a[i]).abs() <= ROUNDING * (1.0 + now.abs())
        };
        sign == from.contact.sign && close(0) && close(1)
    }
}

impl StepObserver for Variation {
    fn smooth(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, drive: &Drive) {
        let goes_on = self.at_end == Some((from.t, from.y));
        if goes_on && from.freedom.is_none() && self.drive.is_empty() && self.nodes[2].holds(from) {
            self.nodes.swap(0, 2);
        } else {
            if !goes_on {
                f.model.evaluate(&f.motion(from.t, &from.y), f.p, &mut self.end);
            }
            let a = [from.rate[2], from.rate[3]];
            self.solve(f, 0, (from.t, a), from, drive);
        }
        let acceleration = |t: f64, linear: &Linearisation| {
            f.constrained(&linear.terms, &drive.at(t), from).unwrap_or([0.0; 2])
        };
        f.model.evaluate(&f.motion(to, end), f.p, &mut self.end);
        self.at_end = Some((to, *end));
        let a = acceleration(to, &self.end);
        self.solve(f, 2, (to, a), from, drive);
        let (h, t) = (to - from.t, 0.5 * (from.t + to));
        let y = middle(h, (&from.y, &from.rate), (end, &a));
        f.model.evaluate(&f.motion(t, &y), f.p, &mut self.middle);
        let a = acceleration(t, &self.middle);
        self.solve(f, 1, (t, a), from, drive);
        self.step(h);
    }

    fn event(&mut self, arrived: [bool; 4], before: &[f64; 2], after: &Contact) {
        let Some(first) = arrived.iter().position(|arrived| *arrived) else { return };
        // of two wheels that arrive together each jumps at its own time
        let second = if arrived[..2] == [true; 2] { 1 } else { first };
        let freedom = after.freedom();
        for [_, _, w1, w2] in &mut self.groups {
            let time = [first, second].map(|j| {
                let ([d1, d2], rate) = (DIRECTIONS[j], along(j, before));
                let delay = if rate == 0.0 { 0.0 } else { -1.0 / rate };
                (*w1 * d1 + *w2 * d2) * delay
            });
            *w1 += time[0] * (before[0] - after.acceleration[0]);
            *w2 += time[1] * (before[1] - after.acceleration[1]);
            if let Some(n) = freedom {
                let square = (n[0] * n[0] + n[1] * n[1]).max(f64::MIN_POSITIVE);
                let q = (*w1 * n[0] + *w2 * n[1]) * (1.0 / square);
                (*w1, *w2) = (q * n[0], q * n[1]);
            }
        }
    }
}

/// Central differences, for models whose internal states have no variational equation here.
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
        for (k, (u, d)) in up.iter().zip(&down).enumerate() {
            for i in 0..2 {
                values[(k * 4 + i) * stride + j] = (u.alpha[i] - d.alpha[i]) / (2.0 * h);
                values[(k * 4 + 2 + i) * stride + j] = (u.omega[i] - d.omega[i]) / (2.0 * h);
            }
        }
    }
    for (k, (state, derivatives)) in motion.iter().zip(values.chunks(4 * stride)).enumerate() {
        visit(k, state, derivatives);
    }
    Ok(())
}
