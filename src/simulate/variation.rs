//! The variational equation along a simulated motion, for all columns together.

use super::carry::{Carry, InputSlope, Node, Slide, Turn};
use super::forces::{Departure, Forces, Vector};
use super::forcing::{Forcing, LANES, Pair, quantities};
use super::friction::{Contact, along_freedom};
use super::input_line::InputLine;
use super::stepper::StepObserver;
use crate::effects::{DIRECTIONS, along};
use crate::math::in_lanes;
use crate::model::{Linearisation, ModelError, times};

/// Share of its friction below which a direction counts as held at the start of a simulation: a small speed along it
/// then ends within a few rows. Nearer to breakaway it may last until then, and its derivatives go on.
const FIRM: f64 = 0.5;

/// The present sensitivities. Their columns are the parameters, the initial speeds and the initial angles: if
/// nothing depends on the angles, those of the angles are constant.
#[derive(Clone)]
pub(super) struct Variation {
    /// Derivatives of (alpha1, alpha2, omega1, omega2), each a row of all columns, padded with zeros to a multiple
    /// of [`LANES`].
    values: Vec<f64>,
    parameters: usize,
    /// Compiled derivatives with respect to the parameters, if possible.
    forcing: Option<Forcing>,
    /// Derivative of the input with respect to each parameter that acts on it, at both ends of the sample.
    input: Vec<InputSlope>,
    /// Whether the last node is still valid at the start of the next step.
    joined: bool,
    /// Number of columns to integrate if nothing depends on the angles, and if something does; the others are
    /// constant.
    moving: usize,
    turning: usize,
    /// At both ends of a step, with its middle between them.
    nodes: [Node; 3],
    /// The place of the node at the start of the next step: the first or the last.
    start: usize,
    middle: Linearisation,
    /// Derivatives at the end of the last step, and the state there.
    end: Linearisation,
    at_end: Option<(f64, Vector)>,
    /// Whether the first step of a simulation is still to come: its contact may hold initial speeds.
    begins: bool,
}

impl Variation {
    pub(super) fn new(f: &Forces) -> Self {
        let parameters = f.p.len();
        let count = (parameters + 4).div_ceil(LANES);
        let node = Node {
            place: ([f64::NAN; 2], [0.0; 4]),
            by_state: [[0.0; 4]; 2],
            forcing: vec![Pair::default(); count],
        };
        let mut variation = Self {
            values: vec![0.0; 4 * LANES * count],
            parameters,
            forcing: Forcing::new(f),
            input: vec![],
            joined: false,
            moving: parameters + 2,
            turning: parameters + 4,
            nodes: std::array::from_fn(|_| node.clone()),
            start: 0,
            middle: Linearisation::new(parameters),
            end: Linearisation::new(parameters),
            at_end: None,
            begins: true,
        };
        variation.identity();
        variation
    }

    /// Sets the derivatives of the four initial states with respect to themselves.
    fn identity(&mut self) {
        let stride = self.values.len() / 4;
        for i in 0..4 {
            self.values[i * stride + column_of_start(self.parameters, i)] = 1.0;
        }
    }

    /// The present derivatives: four rows.
    #[inline]
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Starts the derivatives anew; `acting` are those of the input at both ends of the sample.
    pub(super) fn restart(&mut self, acting: &[InputSlope]) {
        self.values.fill(0.0);
        self.identity();
        self.input.clear();
        self.input.extend_from_slice(acting);
        self.joined = false;
        self.begins = false;
    }

    /// Derivatives of the four states with respect to a column.
    #[inline]
    pub(super) fn by(&self, column: usize) -> [f64; 4] {
        let stride = self.values.len() / 4;
        [0, 1, 2, 3].map(|i| self.values[i * stride + column])
    }

    /// Does not integrate the columns of the initial state.
    pub(super) fn without_start(mut self) -> Self {
        (self.moving, self.turning) = (self.parameters, self.parameters);
        self
    }

    /// Sets the derivatives of the input for the next sample. If they are continuous with those of the last
    /// one, the node at its end is valid at the start of this one.
    #[inline]
    pub(super) fn next_input(&mut self, next: impl Iterator<Item = InputSlope>) {
        let mut count = 0;
        let mut joined = true;
        for (n, (j, ends)) in next.enumerate() {
            match self.input.get_mut(n) {
                Some(before) => {
                    joined &= before.0 == j && before.1[1] == ends[0];
                    *before = (j, ends);
                }
                None => {
                    joined = false;
                    self.input.push((j, ends));
                }
            }
            count = n + 1;
        }
        joined &= count == self.input.len();
        self.input.truncate(count);
        self.joined = joined;
    }

    /// Computes a node from the derivatives of the acceleration `a` at `t`, evaluated in `self.middle` for
    /// the midpoint and in `self.end` for the ends.
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
        // a singular mass matrix was already refused by the step of the state
        let mobility = f.mobility(&linear.terms.mass, from).unwrap_or([0.0; 3]);
        let solved = |b: [f64; 2]| times(&mobility, &[-b[0], -b[1]]);
        for k in 0..4 {
            let column = solved([linear.by_state[0][k], linear.by_state[1][k]]);
            (node.by_state[0][k], node.by_state[1][k]) = (column[0], column[1]);
        }
        let mut set = |j: usize, torque: [f64; 2]| {
            let [first, second] = &mut node.forcing[j / LANES];
            let column = solved(torque);
            (first[j % LANES], second[j % LANES]) = (column[0], column[1]);
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

    /// A step of sliding wheels with compiled derivatives.
    #[inline]
    fn slide(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, input: &InputLine) {
        let Self { forcing: Some(forcing), .. } = self else { return };
        let nodes = in_order(&mut self.nodes, self.start);
        let sign = from.contact.sign;
        forcing.turn(&sign);
        let goes_on = self.at_end == Some((from.t, from.y));
        let known = goes_on && (self.joined || self.input.is_empty()) && nodes[0].holds(from);
        let (h, t, resisting) = (to - from.t, 0.5 * (from.t + to), &from.resisting);
        let at_start = ([from.y[2], from.y[3]], [from.rate[2], from.rate[3]]);
        let omega = [end[2], end[3]];
        let at_end = (omega, f.acceleration_at(omega, input.at(to), resisting));
        let y = middle(h, (&from.y, &from.rate), (end, &at_end.1));
        let omega = [y[2], y[3]];
        let in_middle = (omega, f.acceleration_at(omega, input.at(t), resisting));
        let mut solve = |n: usize, t: f64, (omega, a): ([f64; 2], [f64; 2])| {
            let [first, second] = f.by_speed.slope(omega);
            nodes[n].by_state = [[0.0, 0.0, first[0], first[1]], [0.0, 0.0, second[0], second[1]]];
            (quantities(omega, a), input.share(t))
        };
        let start = (!known).then(|| solve(0, from.t, at_start));
        let later = [solve(1, t, in_middle), solve(2, to, at_end)];
        nodes[2].place = (at_end.1, sign);
        (self.at_end, self.joined, self.start) = (Some((to, *end)), true, 2 - self.start);
        let (rows, columns) = (rows(&mut self.values), self.moving);
        let carry = &mut Carry { nodes, rows, h, columns };
        let input = (&self.input[..], f.inverse.as_ref().unwrap_or(&[0.0; 3]));
        in_lanes(&mut Slide { forcing, start: start.as_ref(), later: &later, input, carry });
    }

    /// Runge-Kutta 4 over a step of `h` with the nodes.
    fn step(&mut self, h: f64) {
        let by_angles =
            |node: &Node| node.by_state.iter().any(|row| row[0] != 0.0 || row[1] != 0.0);
        let turning = self.nodes.iter().any(by_angles);
        let nodes = in_order(&mut self.nodes, self.start);
        let rows = rows(&mut self.values);
        self.start = 2 - self.start;
        if turning {
            in_lanes(Turn(Carry { nodes, rows, h, columns: self.turning }));
        } else {
            in_lanes(&mut Carry { nodes, rows, h, columns: self.moving });
        }
    }

    /// What is left of initial speeds if only direction `n` is free: friction stops the rest at once, and the momentum
    /// along `n` stays. Without this the speed of a wheel that begins at rest would act on all later rows, which no
    /// simulation shows, and a descent over initial speeds would go to and fro between zero and a speed near it.
    ///
    /// ```text
    /// S+ = n (n'A S-)/(n'A n)   of the speeds
    /// ```
    fn hold(&mut self, f: &Forces, from: &Departure, n: &[f64; 2]) {
        let mass = f.wheel.at(&f.motion(from.t, &from.y)).mass;
        let [_, _, w1, w2] = rows(&mut self.values);
        for (w1, w2) in w1.iter_mut().zip(w2) {
            [*w1, *w2] = along_freedom(&mass, &times(&mass, &[*w1, *w2]), n);
        }
    }

    /// A step without acceleration.
    fn rest(&mut self, h: f64) {
        let half = self.values.len() / 2;
        let (angles, speeds) = self.values.split_at_mut(half);
        angles.iter_mut().zip(speeds).for_each(|(angle, speed)| *angle += *speed * h);
    }
}

/// The column of initial state `i` (alpha1, alpha2, omega1, omega2) behind those of the parameters.
pub(crate) fn column_of_start(parameters: usize, i: usize) -> usize {
    parameters + (i + 2) % 4
}

/// The nodes at the start, in the middle and at the end of a step that starts with node `start`.
#[inline]
fn in_order(nodes: &mut [Node; 3], start: usize) -> [&mut Node; 3] {
    let [first, middle, last] = nodes;
    if start == 0 { [first, middle, last] } else { [last, middle, first] }
}

/// The derivatives of the four states.
#[inline]
fn rows(values: &mut [f64]) -> [&mut [f64]; 4] {
    let half = values.len() / 2;
    let (angles, speeds) = values.split_at_mut(half);
    let ((a1, a2), (w1, w2)) = (angles.split_at_mut(half / 2), speeds.split_at_mut(half / 2));
    [a1, a2, w1, w2]
}

/// The state at the midpoint of a step from its ends and the rates there, by Hermite's cubic.
fn middle(h: f64, (y, rate): (&Vector, &Vector), (end, a): (&Vector, &[f64; 2])) -> Vector {
    let at = |i: usize, end_rate: f64| 0.5 * (y[i] + end[i]) + 0.125 * h * (rate[i] - end_rate);
    let (alpha, omega) = ([at(0, end[2]), at(1, end[3])], [at(2, a[0]), at(3, a[1])]);
    [alpha[0], alpha[1], omega[0], omega[1], omega[0], omega[1], 0.0, 0.0]
}

impl StepObserver for Variation {
    fn smooth(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, input: &InputLine) {
        if std::mem::take(&mut self.begins)
            && let (Some(n), Some(held)) = (from.freedom, f.held(from.t, &from.y, input, from))
            && held.0 < FIRM * held.1
        {
            self.hold(f, from, &n);
        }
        if self.forcing.is_some() && from.freedom.is_none() {
            return self.slide(f, from, to, end, input);
        }
        if from.freedom == Some([0.0; 2]) {
            return self.rest(to - from.t);
        }
        let goes_on = self.forcing.is_none() && self.at_end == Some((from.t, from.y));
        let same_input = self.joined || self.input.is_empty();
        let known = goes_on && from.freedom.is_none() && same_input;
        if !(known && self.nodes[self.start].holds(from)) {
            if !goes_on {
                f.model.evaluate(&f.motion(from.t, &from.y), f.p, &mut self.end);
            }
            let a = [from.rate[2], from.rate[3]];
            self.solve(f, self.start, (from.t, a), from, input);
        }
        let acceleration = |t: f64, linear: &Linearisation| {
            f.constrained(&linear.terms, &input.at(t), from).unwrap_or([0.0; 2])
        };
        f.model.evaluate(&f.motion(to, end), f.p, &mut self.end);
        self.at_end = Some((to, *end));
        let a = acceleration(to, &self.end);
        self.solve(f, 2 - self.start, (to, a), from, input);
        self.joined = true;
        let (h, t) = (to - from.t, 0.5 * (from.t + to));
        let y = middle(h, (&from.y, &from.rate), (end, &a));
        f.model.evaluate(&f.motion(t, &y), f.p, &mut self.middle);
        let a = acceleration(t, &self.middle);
        self.solve(f, 1, (t, a), from, input);
        self.step(h);
    }

    fn event(
        &mut self,
        arrived: [bool; 4],
        before: impl FnOnce() -> Result<[f64; 2], ModelError>,
        after: &Contact,
    ) -> Result<(), ModelError> {
        let Some(first) = arrived.iter().position(|arrived| *arrived) else { return Ok(()) };
        let before = before()?;
        // of two wheels that arrive together each jumps at its own time
        let second = if arrived[..2] == [true; 2] { 1 } else { first };
        let freedom = after.freedom();
        let [_, _, w1, w2] = rows(&mut self.values);
        for (w1, w2) in w1.iter_mut().zip(w2) {
            let time = [first, second].map(|j| {
                let ([d1, d2], rate) = (DIRECTIONS[j], along(j, &before));
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
        Ok(())
    }
}
