//! Integration over one sample: Runge-Kutta 4 in a fixed contact state, with events located within the step.

use std::cell::Cell;

use super::SimulateError;
use super::event::{crossing, onset};
use super::forces::{CLEARLY, Departure, Forces, Vector};
use super::friction::{Contact, perpendicular};
use super::input_line::InputLine;
use crate::effects::along;
use crate::model::{Model, ModelError};
use crate::robot::State;

/// Longest internal step \[s\]; the input is smooth between samples, so this only limits the truncation error
/// of Runge-Kutta for slow recordings.
const LONGEST_STEP: f64 = 0.02;
/// Largest product of internal step and fastest rate of the model that is accurate (the error of a step of Runge-Kutta
/// 4 is 2.6e-4 of the distance from the equilibrium), and stable with a margin (limit of Runge-Kutta 4: 2.8).
const STIFF: f64 = 0.5;
const STABLE: f64 = 1.5;
/// Number of accurate steps per row above which the model is faster than the rows can resolve: its
/// transients decay between two rows, and the steps need only be stable.
const RESOLVED: f64 = 10.0;
/// Largest number of steps per row for torques that depend on the speed: parameters with a time constant below 1/150 of
/// a row are far from those of a robot that these rows describe, and their simulation diverges.
const MOST_STEPS: f64 = 100.0;
/// Factor of the speed after which the rate of torques that depend on it is computed anew.
const FASTER: f64 = 4.0;
/// Wheel speed that indicates divergence [rad/s].
pub(super) const SPEED_LIMIT: f64 = 1e6;
/// Directions whose speeds differ by less than this come to rest at the same event [rad/s]; an event is
/// located to 1e-12 of a step.
const TOGETHER: f64 = 1e-11;
/// More events than this within one step are a grazing contact: the direction is then held.
const MANY_EVENTS: usize = 24;

/// Observer of the integration steps: none, or the sensitivities of the state.
pub(super) trait StepObserver {
    /// One smooth step from `from` to the state `end` at `to`.
    fn smooth(&mut self, f: &Forces, from: &Departure, to: f64, end: &Vector, input: &InputLine);
    /// The contact changed to `after` when the speeds along the directions `arrived` reached zero; `before`
    /// computes the acceleration before the event.
    fn event(
        &mut self,
        arrived: [bool; 4],
        before: impl FnOnce() -> Result<[f64; 2], ModelError>,
        after: &Contact,
    ) -> Result<(), ModelError>;
}

impl StepObserver for () {
    #[inline]
    fn smooth(&mut self, _: &Forces, _: &Departure, _: f64, _: &Vector, _: &InputLine) {}
    #[inline]
    fn event(
        &mut self,
        _: [bool; 4],
        _: impl FnOnce() -> Result<[f64; 2], ModelError>,
        _: &Contact,
    ) -> Result<(), ModelError> {
        Ok(())
    }
}

/// The integrator: a model with parameters, and its present state.
#[derive(Clone)]
pub(super) struct Stepper<'m> {
    forces: Forces<'m>,
    y: Vector,
    /// [`Forces::damping_rate`] [1/s], the largest so far, and the speed up to which it is valid [rad/s].
    rate: (f64, f64),
}

impl<'m> Stepper<'m> {
    pub(super) fn new(model: &'m Model, p: &'m [f64], t0: f64, start: State) -> Self {
        let (forces, y) = (Forces::new(model, p, t0), at_rest_within(start));
        let mut stepper = Self { forces, y, rate: (0.0, 0.0) };
        stepper.begin(t0, start);
        stepper
    }

    /// Starts anew from a state; time-dependent effects remain relative to the same `t0`.
    pub(super) fn begin(&mut self, t0: f64, start: State) {
        self.y = at_rest_within(start);
        self.rate = (self.forces.damping_rate(t0, &self.y), FASTER * fastest(&self.y));
    }

    pub(super) fn forces(&self) -> &Forces<'m> {
        &self.forces
    }

    /// [`Forces::damping_rate`], the largest so far [1/s].
    pub(super) fn damping_rate(&self) -> f64 {
        self.rate.0
    }

    /// Sets the state of the robot.
    pub(super) fn place(&mut self, state: State) {
        self.y = at_rest_within(state);
    }

    /// Sets the state of the wheels; a second mass keeps its slip and twist.
    pub(super) fn place_wheels(&mut self, state: State) {
        let y = &mut self.y;
        for i in 0..2 {
            y[4 + i] += state.omega[i] - y[2 + i];
            (y[i], y[2 + i]) = (state.alpha[i], state.omega[i]);
        }
    }

    pub(super) fn state(&self) -> State {
        State { alpha: [self.y[0], self.y[1]], omega: [self.y[2], self.y[3]] }
    }

    /// Integrates from `from` to `to` \[s\], with the input varying linearly from `start` to `end`.
    pub(super) fn advance(
        &mut self,
        from: f64,
        to: f64,
        start: &[f64; 2],
        end: &[f64; 2],
        observer: &mut impl StepObserver,
    ) -> Result<(), SimulateError> {
        let input = InputLine::new(from, to, start, end);
        let pieces = self.pieces(from, to);
        let mut start = from;
        for piece in 1..=pieces {
            let end = edge(from, to, (piece, pieces));
            self.piece(start, end, &input, observer)?;
            start = end;
        }
        if self.y[2].abs().max(self.y[3].abs()) < SPEED_LIMIT {
            Ok(())
        } else {
            Err(SimulateError::Diverged { t: to, limit: SPEED_LIMIT })
        }
    }

    /// Number of internal steps per sample.
    fn pieces(&mut self, from: f64, to: f64) -> usize {
        let speed = fastest(&self.y);
        if speed > self.rate.1 {
            let rate = self.forces.damping_rate(from, &self.y);
            self.rate = (self.rate.0.max(rate), FASTER * speed);
        }
        let coupling = self.forces.coupling_rate(from, &self.y).unwrap_or(0.0);
        let damping = (to - from) * self.rate.0;
        let turns = ((to - from) * coupling).max(damping.min(STABLE * MOST_STEPS));
        if turns <= STIFF {
            return pieces_between(from, to);
        }
        let count = (turns / STIFF).min((turns / STABLE).max(RESOLVED));
        divided(to - from, LONGEST_STEP.min((to - from) / count))
    }

    /// One internal step, divided at its events.
    pub(super) fn piece(
        &mut self,
        from: f64,
        to: f64,
        input: &InputLine,
        observer: &mut impl StepObserver,
    ) -> Result<(), SimulateError> {
        if let Some(glide) = self.forces.glide(from, to, &self.y, input) {
            let (start, end) = (self.forces.start_of(&glide, from, &self.y), glide.end());
            observer.smooth(&self.forces, &start, to, &end, input);
            self.y = end;
            return Ok(());
        }
        if let Some((start, end)) = self.forces.glide_coupled(from, to, &self.y, input) {
            observer.smooth(&self.forces, &start, to, &end, input);
            self.y = end;
            return Ok(());
        }
        let mut start = self.forces.depart(from, &self.y, input)?;
        for event in 0.. {
            let whole = self.forces.step(&start, to, input)?;
            let beyond = self.excess(&start, to, &whole, input)?;
            if event >= MANY_EVENTS || !(beyond > 0.0) {
                observer.smooth(&self.forces, &start, to, &whole, input);
                self.y = whole;
                if event >= MANY_EVENTS {
                    self.rest(&start.contact, &whole);
                }
                return Ok(());
            }
            let (t, after) = self.locate(&start, to, (&whole, beyond), input)?;
            observer.smooth(&self.forces, &start, t, &after, input);
            self.y = after;
            let arrived = self.rest(&start.contact, &after);
            let next = self.forces.depart(t, &self.y, input)?;
            let before = || self.forces.acceleration(t, &self.y, input, &start);
            observer.event(arrived, before, &next.contact)?;
            start = next;
        }
        Ok(())
    }

    /// Distance of the state `y` at `t` from the contact state at the start: the speed of a sliding direction
    /// that has reversed [rad/s], or the acceleration of a sticking direction that has broken away [rad/s^2].
    /// Not positive within the contact state.
    fn excess(
        &self,
        start: &Departure,
        t: f64,
        y: &Vector,
        input: &InputLine,
    ) -> Result<f64, SimulateError> {
        let c = &start.contact;
        let backward = fastest_backward(y, c);
        if backward > 0.0 || start.freedom.is_none() {
            return Ok(backward);
        }
        let held = self.forces.held(t, y, input, start);
        if let Some((needed, available)) = held
            && needed < available * CLEARLY
        {
            return Ok(needed - available);
        }
        let now = self.forces.contact(t, y, input)?;
        if now.stuck == c.stuck {
            return Ok(held.map_or(0.0, |(needed, available)| (needed - available).min(0.0)));
        }
        let rates = (0..4).filter(|&j| c.stuck[j]).map(|j| along(j, &now.acceleration).abs());
        Ok(rates.fold(f64::MIN_POSITIVE, f64::max))
    }

    /// The instant from which on [`Stepper::excess`] is positive, to 1e-12 of the whole, and the state there; at
    /// `end`, the state at `to`, it is `beyond`.
    fn locate(
        &self,
        start: &Departure,
        to: f64,
        (end, beyond): (&Vector, f64),
        input: &InputLine,
    ) -> Result<(f64, Vector), SimulateError> {
        // the last trial beyond the event is the result of the search
        let last = Cell::new((f64::NAN, start.y));
        let excess = |step: f64| {
            let t = start.t + step;
            let y = self.forces.step(start, t, input)?;
            let excess = self.excess(start, t, &y, input)?;
            if excess > 0.0 {
                last.set((step, y));
            }
            Ok::<_, SimulateError>(excess)
        };
        let h = to - start.t;
        let before = match start.freedom {
            // at a breakaway the excess is an acceleration on both sides, at a reversal of another direction not
            Some(_) if fastest_backward(end, &start.contact) > 0.0 => 0.0,
            Some(_) => self.excess(start, start.t, &start.y, input)?,
            None => fastest_backward(&start.y, &start.contact),
        };
        let step = if start.freedom.is_none() || before < 0.0 {
            crossing(h, [before, beyond], excess)?
        } else {
            onset(h, beyond, excess)?
        };
        let (t, (tried, y)) = (start.t + step, last.get());
        let y = if tried == step { y } else { self.forces.step(start, t, input)? };
        Ok((t, y))
    }

    /// Sets directions that have passed through zero exactly to rest, and returns them.
    fn rest(&mut self, c: &Contact, y: &Vector) -> [bool; 4] {
        let omega = [y[2], y[3]];
        let beyond = |j: usize, speed: f64| c.sign[j] * along(j, &omega) < speed;
        // directions that arrive simultaneously must not differ by rounding, which would determine their
        // order
        let together = if (0..4).any(|j| beyond(j, 0.0)) { TOGETHER } else { 0.0 };
        let arrived = |j: usize| c.sign[j] != 0.0 && beyond(j, together);
        let mut still = (0..4).filter(|&j| c.stuck[j] || arrived(j));
        let (first, second) = (still.next(), still.next());
        match (first, second) {
            (None, _) => {}
            (Some(j), None) => {
                let n = perpendicular(j);
                let q = (n[0] * omega[0] + n[1] * omega[1]) / (n[0] * n[0] + n[1] * n[1]);
                (self.y[2], self.y[3]) = (n[0] * q, n[1] * q);
            }
            _ => (self.y[2], self.y[3]) = (0.0, 0.0),
        }
        [0, 1, 2, 3].map(arrived)
    }
}

/// Speed of the faster wheel [rad/s].
fn fastest(y: &Vector) -> f64 {
    y[2].abs().max(y[3].abs())
}

/// Initial state of a two-mass drivetrain: body speeds equal to wheel speeds, no twist.
fn at_rest_within(state: State) -> Vector {
    let (a, w) = (state.alpha, state.omega);
    [a[0], a[1], w[0], w[1], w[0], w[1], 0.0, 0.0]
}

/// Number of internal steps from `from` to `to` \[s\] for a model without a two-mass drivetrain.
pub(super) fn pieces_between(from: f64, to: f64) -> usize {
    divided(to - from, LONGEST_STEP)
}

/// The end of internal step `piece`, counted from one, of `pieces` from `from` to `to` \[s\].
#[inline]
pub(super) fn edge(from: f64, to: f64, (piece, pieces): (usize, usize)) -> f64 {
    if piece < pieces { from + (to - from) * (piece as f64 / pieces as f64) } else { to }
}

fn divided(length: f64, longest: f64) -> usize {
    if length <= longest {
        return 1;
    }
    ((length / longest) - 1e-9).ceil().clamp(1.0, 1e4) as usize
}

/// The largest speed against the sign of its friction at `y` [rad/s]: positive if a sliding direction has
/// reversed, minus infinity if none slides.
fn fastest_backward(y: &Vector, c: &Contact) -> f64 {
    let omega = [y[2], y[3]];
    let sliding = (0..4).filter(|&j| c.sign[j] != 0.0);
    sliding.map(|j| -c.sign[j] * along(j, &omega)).fold(f64::NEG_INFINITY, f64::max)
}
