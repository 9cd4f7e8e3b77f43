//! The variational equation along a simulated motion, all columns together.

use std::convert::Infallible;

use wide::f64x4;

use super::forces::{Departure, Forces, Vector};
use super::forcing::{Forcing, LANES, Pair, quantities};
use super::friction::Contact;
use super::input_line::InputLine;
use super::stepper::StepObserver;
use crate::effects::{DIRECTIONS, along};
use crate::math::{runge_kutta_motion, runge_kutta_step};
use crate::model::{Linearisation, times};

/// Derivatives of (alpha1, alpha2, omega1, omega2) by four columns.
type Group = [f64x4; 4];

/// The variational equation at one instant, solved for the accelerations:
/// `dω' = by_state · (dα, dω) + forcing`.
#[derive(Clone)]
struct Node {
    /// Acceleration and friction signs for which it was solved.
    place: ([f64; 2], [f64; 4]),
    by_state: [[f64; 4]; 2],
    forcing: Vec<Pair>,
}

/// The sensitivities on their way. Their columns are the parameters, the initial speeds and the
/// initial angles: where nothing depends on the angles, those of the angles stay as they are.
pub(super) struct Variation {
    pub(super) groups: Vec<Group>,
    parameters: usize,
    /// Where the derivatives by the parameters could be compiled.
    forcing: Option<Forcing>,
    /// Derivative of the input by each parameter at both ends of the sample, where there is one.
    pub(super) input: Vec<(usize, [[f64; 2]; 2])>,
    /// At the start, in the middle and at the end of a step.
    nodes: [Node; 3],
    middle: Linearisation,
    /// What was evaluated at the end of the last step, and the state there.
    end: Linearisation,
    at_end: Option<(f64, Vector)>,
}

impl Variation {
    pub(super) fn new(f: &Forces) -> Self {
        let parameters = f.p.len();
        let count = (parameters + 4).div_ceil(LANES);
        let node = Node {
            place: ([f64::NAN; 2], [0.0; 4]),
            by_state: [[0.0; 4]; 2],
            forcing: vec![[f64x4::ZERO; 2]; count],
        };
        let mut variation = Self {
            groups: vec![[f64x4::ZERO; 4]; count],
            parameters,
            forcing: Forcing::new(f),
            input: vec![],
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
        for i in 0..4 {
            let column = self.place(self.parameters + i);
            self.groups[column / LANES][i].as_mut_array()[column % LANES] = 1.0;
        }
    }

    /// Where a column of (parameters, initial angles, initial speeds) is carried.
    #[inline]
    fn place(&self, column: usize) -> usize {
        match column.checked_sub(self.parameters) {
            Some(i) => self.parameters + (i + 2) % 4,
            None => column,
        }
    }

    /// Derivatives count from here on; `acting` are those of the input at both ends of the sample.
    pub(super) fn restart(&mut self, acting: &[(usize, [[f64; 2]; 2])]) {
        self.groups.iter_mut().for_each(|group| *group = [f64x4::ZERO; 4]);
        self.identity();
        self.input.clear();
        self.input.extend_from_slice(acting);
    }

    /// Derivative of state `i` by a column.
    #[inline]
    pub(super) fn at(&self, i: usize, column: usize) -> f64 {
        let column = self.place(column);
        self.groups[column / LANES][i].as_array()[column % LANES]
    }

    /// Writes all columns, one state after the other.
    pub(super) fn write(&self, values: &mut Vec<f64>) {
        let stride = LANES * self.groups.len();
        values.resize(4 * stride, 0.0);
        for (i, row) in values.chunks_exact_mut(stride).enumerate() {
            for (group, lanes) in self.groups.iter().zip(row.chunks_exact_mut(LANES)) {
                lanes.copy_from_slice(group[i].as_array());
            }
            row[self.parameters..self.parameters + 4].rotate_left(2);
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
        input: &InputLine,
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
        let mut set = |j: usize, torque: [f64; 2]| {
            let [first, second] = &mut node.forcing[j / LANES];
            let column = solved(torque);
            first.as_mut_array()[j % LANES] = column[0];
            second.as_mut_array()[j % LANES] = column[1];
        };
        for (j, torque) in linear.by_parameter.iter().enumerate() {
            set(j, *torque);
        }
        let share = input.share(t);
        for (j, [start, end]) in &self.input {
            let torque = linear.by_parameter[*j];
            set(*j, [0, 1].map(|i| torque[i] - start[i] - share * (end[i] - start[i])));
        }
    }

    /// The same where the derivatives by the parameters are compiled: all wheels slide.
    #[inline]
    fn solve_compiled(
        &mut self,
        f: &Forces,
        node: usize,
        (t, omega, a): Instant,
        input: &InputLine,
    ) {
        let Some(forcing) = &self.forcing else { return };
        let node = &mut self.nodes[node];
        forcing.write(&quantities(omega, a), &mut node.forcing);
        let [first, second] = f.by_speed.slope(omega);
        node.by_state = [[0.0, 0.0, first[0], first[1]], [0.0, 0.0, second[0], second[1]]];
        let (share, inverse) = (input.share(t), f.inverse.unwrap_or([0.0; 3]));
        for (j, [start, end]) in &self.input {
            let torque = [0, 1].map(|i| start[i] + share * (end[i] - start[i]));
            for (lanes, a) in node.forcing[j / LANES].iter_mut().zip(times(&inverse, &torque)) {
                lanes.as_mut_array()[j % LANES] += a;
            }
        }
    }

    /// A step of wheels that slide, with compiled derivatives.
    #[inline]
    fn slide(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, input: &InputLine) {
        let place = |a: [f64; 2]| (a, from.contact.sign);
        if let Some(forcing) = &mut self.forcing {
            forcing.turn(&from.contact.sign);
        }
        let goes_on = self.at_end == Some((from.t, from.y));
        if goes_on && self.input.is_empty() && self.nodes[2].holds(from) {
            self.nodes.swap(0, 2);
        } else {
            let (omega, a) = ([from.y[2], from.y[3]], [from.rate[2], from.rate[3]]);
            self.solve_compiled(f, 0, (from.t, omega, a), input);
        }
        let (h, t) = (to - from.t, 0.5 * (from.t + to));
        let (omega, resisting) = ([end[2], end[3]], &from.resisting);
        let a = f.acceleration_at(omega, input.at(to), resisting);
        self.solve_compiled(f, 2, (to, omega, a), input);
        self.nodes[2].place = place(a);
        self.at_end = Some((to, *end));
        let y = middle(h, (&from.y, &from.rate), (end, &a));
        let omega = [y[2], y[3]];
        let a = f.acceleration_at(omega, input.at(t), resisting);
        self.solve_compiled(f, 1, (t, omega, a), input);
        self.step_of_speeds(h);
    }

    /// Runge-Kutta 4 over a step of `h` with the nodes.
    fn step(&mut self, h: f64) {
        let angles = |node: &Node| node.by_state.iter().any(|row| row[0] != 0.0 || row[1] != 0.0);
        if !self.nodes.iter().any(angles) {
            return self.step_of_speeds(h);
        }
        let [start, middle, end] = &self.nodes;
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
                    let by_angles = x[0] * by[0] + x[1] * by[1];
                    node.forcing[n][i] + x[2] * by[2] + x[3] * by[3] + by_angles
                };
                Ok::<_, Infallible>([x[2], x[3], row(0), row(1)])
            });
            *group = after;
        }
    }

    /// A step without acceleration.
    fn rest(&mut self, h: f64) {
        for [a1, a2, w1, w2] in &mut self.groups {
            (*a1, *a2) = (*a1 + *w1 * h, *a2 + *w2 * h);
        }
    }

    /// The same where nothing depends on the angles, which follow from the speeds.
    #[inline]
    fn step_of_speeds(&mut self, h: f64) {
        let [start, middle, end] = &self.nodes;
        let moving = (self.parameters + 2).div_ceil(LANES);
        for (n, [a1, a2, w1, w2]) in self.groups.iter_mut().enumerate().take(moving) {
            let rate = |node: &Node, w: Pair| {
                let row = |i: usize| {
                    let [_, _, by_first, by_second] = node.by_state[i];
                    node.forcing[n][i] + w[0] * by_first + w[1] * by_second
                };
                [row(0), row(1)]
            };
            let (angles, speeds) = ([*a1, *a2], [*w1, *w2]);
            let Ok((angles, speeds)) =
                runge_kutta_motion(&angles, &speeds, &rate(start, speeds), h, |c, _, w| {
                    Ok::<_, Infallible>(rate(if c < 1.0 { middle } else { end }, *w))
                });
            ([*a1, *a2], [*w1, *w2]) = (angles, speeds);
        }
    }
}

/// An instant of sliding wheels: time, speeds, accelerations.
type Instant = (f64, [f64; 2], [f64; 2]);

/// The state in the middle of a step from its ends and the rates there, by Hermite's cubic.
fn middle(h: f64, (y, rate): (&Vector, &Vector), (end, a): (&Vector, &[f64; 2])) -> Vector {
    let at = |i: usize, end_rate: f64| 0.5 * (y[i] + end[i]) + 0.125 * h * (rate[i] - end_rate);
    let (alpha, omega) = ([at(0, end[2]), at(1, end[3])], [at(2, a[0]), at(3, a[1])]);
    [alpha[0], alpha[1], omega[0], omega[1], omega[0], omega[1], 0.0, 0.0]
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
    fn smooth(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, input: &InputLine) {
        if self.forcing.is_some() && from.freedom.is_none() {
            return self.slide(f, from, to, end, input);
        }
        if from.freedom == Some([0.0; 2]) {
            return self.rest(to - from.t);
        }
        let goes_on = self.forcing.is_none() && self.at_end == Some((from.t, from.y));
        if goes_on && from.freedom.is_none() && self.input.is_empty() && self.nodes[2].holds(from) {
            self.nodes.swap(0, 2);
        } else {
            if !goes_on {
                f.model.evaluate(&f.motion(from.t, &from.y), f.p, &mut self.end);
            }
            let a = [from.rate[2], from.rate[3]];
            self.solve(f, 0, (from.t, a), from, input);
        }
        let acceleration = |t: f64, linear: &Linearisation| {
            f.constrained(&linear.terms, &input.at(t), from).unwrap_or([0.0; 2])
        };
        f.model.evaluate(&f.motion(to, end), f.p, &mut self.end);
        self.at_end = Some((to, *end));
        let a = acceleration(to, &self.end);
        self.solve(f, 2, (to, a), from, input);
        let (h, t) = (to - from.t, 0.5 * (from.t + to));
        let y = middle(h, (&from.y, &from.rate), (end, &a));
        f.model.evaluate(&f.motion(t, &y), f.p, &mut self.middle);
        let a = acceleration(t, &self.middle);
        self.solve(f, 1, (t, a), from, input);
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
