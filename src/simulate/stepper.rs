//! One sample forward: Runge-Kutta 4 in a fixed contact state, with events located inside.

use super::SimulateError;
use super::event::{crossing, onset};
use super::friction::{Contact, contact, perpendicular};
use crate::effects::{Coupling, DIRECTIONS, Energy, Motion, Terms, along};
use crate::model::{Model, solve_mass};
use crate::robot::State;

/// alpha1, alpha2, omega1, omega2, and behind a coupling: body speeds u1, u2, twists phi1, phi2.
pub(super) type Vector = [f64; 8];

/// Longest internal step [s]; the drive is smooth between samples, so this only bounds the
/// truncation error of Runge-Kutta for slow recordings.
const LONGEST_STEP: f64 = 0.02;
/// Largest product of internal step and fastest rate of a coupling that stays accurate.
const STIFF: f64 = 0.5;
/// Largest share of the robot's smallest inertia that the rotor of a coupling takes, so that the
/// body behind it keeps a positive mass.
const LARGEST_ROTOR: f64 = 0.9;
/// A speed that no wheel reaches [rad/s].
pub(super) const SPEED_LIMIT: f64 = 1e6;
/// More events than this within one step are grazing contacts: the direction is then held.
const MANY_EVENTS: usize = 24;

/// A straight line of the drive over one sample.
#[derive(Clone, Copy)]
pub(super) struct Drive {
    from: f64,
    to: f64,
    start: [f64; 2],
    end: [f64; 2],
}

impl Drive {
    pub(super) fn new(from: f64, to: f64, start: &[f64; 2], end: &[f64; 2]) -> Self {
        Self { from, to, start: *start, end: *end }
    }
    pub(super) fn share(&self, t: f64) -> f64 {
        (t - self.from) / (self.to - self.from)
    }
    pub(super) fn at(&self, t: f64) -> [f64; 2] {
        let c = self.share(t);
        [
            self.start[0] + c * (self.end[0] - self.start[0]),
            self.start[1] + c * (self.end[1] - self.start[1]),
        ]
    }
}

/// What rides along with the state: nothing, or its sensitivities.
pub(super) trait Passenger {
    /// One smooth Runge-Kutta step of length `h` from `y` in contact state `c`.
    fn smooth(&mut self, s: &Stepper, t: f64, h: f64, y: &Vector, drive: &Drive, c: &Contact);
    /// The contact changed to `after` where the speed along direction `j` reached zero; `before`
    /// is the acceleration that led there.
    fn event(&mut self, j: usize, before: &[f64; 2], after: &Contact);
}

impl Passenger for () {
    fn smooth(&mut self, _: &Stepper, _: f64, _: f64, _: &Vector, _: &Drive, _: &Contact) {}
    fn event(&mut self, _: usize, _: &[f64; 2], _: &Contact) {}
}

/// The integrator: model, parameters and the present state.
pub(super) struct Stepper<'m> {
    pub(super) model: &'m Model,
    pub(super) p: &'m [f64],
    t0: f64,
    y: Vector,
    coupled: bool,
    body: Vec<bool>,
}

impl<'m> Stepper<'m> {
    pub(super) fn new(model: &'m Model, p: &'m [f64], t0: f64, start: State) -> Self {
        let (a, w) = (start.alpha, start.omega);
        let y = [a[0], a[1], w[0], w[1], w[0], w[1], 0.0, 0.0];
        let energy = model.effects().iter().map(|e| e.energy());
        let body = energy.map(|e| matches!(e, Energy::Stores | Energy::DoesNoWork)).collect();
        let mut stepper = Self { model, p, t0, y, coupled: false, body };
        stepper.coupled = model.coupling(&stepper.motion(t0, &y), p).is_some();
        stepper
    }

    /// Puts the robot into another state.
    pub(super) fn place(&mut self, state: State) {
        let (a, w) = (state.alpha, state.omega);
        self.y = [a[0], a[1], w[0], w[1], w[0], w[1], 0.0, 0.0];
    }

    /// Puts the wheels into another state; a body behind them keeps its slip and twist.
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

    pub(super) fn motion(&self, t: f64, y: &Vector) -> Motion<'m, f64> {
        Motion {
            t: t - self.t0,
            alpha: [y[0], y[1]],
            omega: [y[2], y[3]],
            variance: [0.0; 4],
            robot: self.model.robot(),
        }
    }

    /// From `from` to `to` [s], the drive running straight from `start` to `end`.
    pub(super) fn advance(
        &mut self,
        from: f64,
        to: f64,
        start: &[f64; 2],
        end: &[f64; 2],
        passenger: &mut impl Passenger,
    ) -> Result<(), SimulateError> {
        let drive = Drive::new(from, to, start, end);
        let pieces = self.pieces(from, to);
        for piece in 0..pieces {
            let edge = |k: usize| from + (to - from) * k as f64 / pieces as f64;
            self.piece(edge(piece), edge(piece + 1), &drive, passenger)?;
        }
        if self.y[2].abs().max(self.y[3].abs()) < SPEED_LIMIT {
            Ok(())
        } else {
            Err(SimulateError::Diverged { t: to, limit: SPEED_LIMIT })
        }
    }

    /// How many internal steps one sample takes.
    fn pieces(&self, from: f64, to: f64) -> usize {
        match self.coupling_rate(from) {
            None => pieces_between(from, to),
            Some(rate) => divided(to - from, LONGEST_STEP.min(STIFF / rate)),
        }
    }

    /// The fastest rate of a coupling [1/s], set by the lighter of rotor and body.
    fn coupling_rate(&self, t: f64) -> Option<f64> {
        let x = self.motion(t, &self.y);
        let c = self.model.coupling(&x, self.p)?;
        let smallest = smallest_inertia(&self.model.terms(&x, self.p).mass);
        let rotor = c.rotor.min(LARGEST_ROTOR * smallest);
        let mobility = 1.0 / rotor + 1.0 / (smallest - rotor);
        Some((c.damping * mobility).max((c.stiffness * mobility).sqrt()))
    }

    /// One internal step, cut at its events.
    pub(super) fn piece(
        &mut self,
        from: f64,
        to: f64,
        drive: &Drive,
        passenger: &mut impl Passenger,
    ) -> Result<(), SimulateError> {
        let mut t = from;
        let mut contact = self.contact(t, &self.y, drive)?;
        for event in 0.. {
            let whole = self.rk4(t, to - t, &self.y, drive, &contact)?;
            if event >= MANY_EVENTS || !self.changed(to, &whole, drive, &contact)? {
                passenger.smooth(self, t, to - t, &self.y, drive, &contact);
                self.y = whole;
                if event >= MANY_EVENTS {
                    self.rest(&contact, &whole);
                }
                return Ok(());
            }
            let h = self.locate(t, to - t, drive, &contact)?;
            let after = self.rk4(t, h, &self.y, drive, &contact)?;
            passenger.smooth(self, t, h, &self.y, drive, &contact);
            t += h;
            self.y = after;
            let arrived = self.rest(&contact, &after);
            let before = self.acceleration(t, &self.y, drive, &contact)?;
            contact = self.contact(t, &self.y, drive)?;
            if let Some(j) = arrived {
                passenger.event(j, &before, &contact);
            }
        }
        Ok(())
    }

    /// Whether a sliding direction has reversed, or a sticking one no longer holds, at `y`.
    fn changed(
        &self,
        t: f64,
        y: &Vector,
        drive: &Drive,
        c: &Contact,
    ) -> Result<bool, SimulateError> {
        Ok(self.excess(t, y, drive, c)? > 0.0)
    }

    /// How far `y` is beyond the contact state: the speed of a sliding direction that has reversed
    /// [rad/s], or the acceleration of a sticking one that has broken away [rad/s^2]. Not positive
    /// within the contact state.
    fn excess(&self, t: f64, y: &Vector, drive: &Drive, c: &Contact) -> Result<f64, SimulateError> {
        let backward = fastest_backward(y, c);
        if backward > 0.0 || !c.stuck.contains(&true) {
            return Ok(backward);
        }
        let now = self.contact(t, y, drive)?;
        if now.stuck == c.stuck {
            return Ok(0.0);
        }
        let rates = (0..4).filter(|&j| c.stuck[j]).map(|j| along(j, &now.acceleration).abs());
        Ok(rates.fold(f64::MIN_POSITIVE, f64::max))
    }

    /// The shortest step after which [`Stepper::changed`] holds, to 1e-12 of `h`.
    fn locate(&self, t: f64, h: f64, drive: &Drive, c: &Contact) -> Result<f64, SimulateError> {
        let excess = |step| {
            let y = self.rk4(t, step, &self.y, drive, c)?;
            self.excess(t + step, &y, drive, c)
        };
        if c.stuck.contains(&true) { onset(h, excess) } else { crossing(h, excess) }
    }

    /// Sets directions that have passed through zero exactly to rest; returns the first of them.
    fn rest(&mut self, c: &Contact, y: &Vector) -> Option<usize> {
        let omega = [y[2], y[3]];
        let arrived = |j: usize| c.sign[j] * along(j, &omega) < 0.0;
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
        (0..4).find(|&j| arrived(j))
    }

    fn contact(&self, t: f64, y: &Vector, drive: &Drive) -> Result<Contact, SimulateError> {
        let (terms, moment, _) = self.wheel_side(t, y, drive);
        Ok(contact(&terms, &moment, &[y[2], y[3]])?)
    }

    /// What acts on the measured wheels: their terms, their moment, and the moment that goes on
    /// to a body behind them.
    fn wheel_side(&self, t: f64, y: &Vector, drive: &Drive) -> (Terms<f64>, [f64; 2], BodySide) {
        let x = self.motion(t, y);
        let moment = drive.at(t);
        if !self.coupled {
            return (self.model.terms(&x, self.p), moment, None);
        }
        let Some(coupling) = self.model.coupling(&x, self.p) else {
            return (self.model.terms(&x, self.p), moment, None);
        };
        let behind = Motion { alpha: [y[0] - y[6], y[1] - y[7]], omega: [y[4], y[5]], ..x };
        let (mut wheel, mut body) = (Terms::zero(), Terms::zero());
        for (e, effect) in self.model.effects().iter().enumerate() {
            let p = &self.p[self.model.slots(e)];
            if self.body[e] {
                body.add(&effect.terms(&behind, p));
            } else {
                wheel.add(&effect.terms(&x, p));
            }
        }
        let Coupling { rotor, stiffness, damping } = coupling;
        let rotor = rotor.min(LARGEST_ROTOR * smallest_inertia(&body.mass));
        wheel.mass = [rotor, 0.0, rotor];
        body.mass = [body.mass[0] - rotor, body.mass[1], body.mass[2] - rotor];
        let passed = [0, 1].map(|i| stiffness * y[6 + i] + damping * (y[2 + i] - y[4 + i]));
        let moment = [moment[0] - passed[0], moment[1] - passed[1]];
        (wheel, moment, Some((body, passed)))
    }

    /// Acceleration of the measured wheels in a fixed contact state.
    pub(super) fn acceleration(
        &self,
        t: f64,
        y: &Vector,
        drive: &Drive,
        c: &Contact,
    ) -> Result<[f64; 2], SimulateError> {
        let (terms, moment, _) = self.wheel_side(t, y, drive);
        Ok(constrained(&terms, &moment, c)?)
    }

    /// [`Stepper::rates`] where a state that has none (already refused by the step of the state
    /// itself) counts as standing still.
    pub(super) fn stage_rates(&self, t: f64, y: &Vector, drive: &Drive, c: &Contact) -> Vector {
        self.rates(t, y, drive, c).unwrap_or([0.0; 8])
    }

    fn rates(
        &self,
        t: f64,
        y: &Vector,
        drive: &Drive,
        c: &Contact,
    ) -> Result<Vector, SimulateError> {
        let (terms, moment, body) = self.wheel_side(t, y, drive);
        let a = constrained(&terms, &moment, c)?;
        let mut rates = [y[2], y[3], a[0], a[1], a[0], a[1], 0.0, 0.0];
        if let Some((terms, passed)) = body {
            let force = [passed[0] - terms.torque[0], passed[1] - terms.torque[1]];
            let du = solve_mass(&terms.mass, &force)?;
            rates[4..].copy_from_slice(&[du[0], du[1], y[2] - y[4], y[3] - y[5]]);
        }
        Ok(rates)
    }

    /// One classical Runge-Kutta step.
    pub(super) fn rk4(
        &self,
        t: f64,
        h: f64,
        y: &Vector,
        drive: &Drive,
        c: &Contact,
    ) -> Result<Vector, SimulateError> {
        let k1 = self.rates(t, y, drive, c)?;
        let k2 = self.rates(t + 0.5 * h, &plus(y, 0.5 * h, &k1), drive, c)?;
        let k3 = self.rates(t + 0.5 * h, &plus(y, 0.5 * h, &k2), drive, c)?;
        let k4 = self.rates(t + h, &plus(y, h, &k3), drive, c)?;
        Ok(std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])))
    }
}

/// How many internal steps a model without a body behind the wheels takes from `from` to `to` [s].
pub(super) fn pieces_between(from: f64, to: f64) -> usize {
    divided(to - from, LONGEST_STEP)
}

fn divided(length: f64, longest: f64) -> usize {
    ((length / longest) - 1e-9).ceil().clamp(1.0, 1e4) as usize
}

type BodySide = Option<(Terms<f64>, [f64; 2])>;

pub(super) fn plus(y: &Vector, h: f64, k: &Vector) -> Vector {
    std::array::from_fn(|i| y[i] + h * k[i])
}

/// The largest speed against the sign of its friction at `y` [rad/s]: positive where a sliding
/// direction has reversed, minus infinity where none slides.
fn fastest_backward(y: &Vector, c: &Contact) -> f64 {
    let omega = [y[2], y[3]];
    let sliding = (0..4).filter(|&j| c.sign[j] != 0.0);
    sliding.map(|j| -c.sign[j] * along(j, &omega)).fold(f64::NEG_INFINITY, f64::max)
}

/// The acceleration with the given signs, along the one free direction where others stick.
fn constrained(
    terms: &Terms<f64>,
    moment: &[f64; 2],
    c: &Contact,
) -> Result<[f64; 2], crate::model::ModelError> {
    let mut b = [moment[0] - terms.torque[0], moment[1] - terms.torque[1]];
    for (j, d) in DIRECTIONS.iter().enumerate() {
        for i in 0..2 {
            b[i] -= d[i] * terms.level[j].max(0.0) * c.sign[j];
        }
    }
    match c.freedom() {
        None => solve_mass(&terms.mass, &b),
        Some(n) => Ok(along_freedom(&terms.mass, &b, &n)),
    }
}

/// The smaller eigenvalue of a mass matrix [kg m^2].
fn smallest_inertia(mass: &[f64; 3]) -> f64 {
    let [m11, m12, m22] = *mass;
    0.5 * (m11 + m22) - (0.5 * (m11 - m22)).hypot(m12)
}

/// `n (n·b)/(n' A n)`, or zero where nothing is free.
pub(super) fn along_freedom(mass: &[f64; 3], b: &[f64; 2], n: &[f64; 2]) -> [f64; 2] {
    let [m11, m12, m22] = *mass;
    let inertia = m11 * n[0] * n[0] + 2.0 * m12 * n[0] * n[1] + m22 * n[1] * n[1];
    if inertia <= 0.0 {
        return [0.0; 2];
    }
    let q = (n[0] * b[0] + n[1] * b[1]) / inertia;
    [n[0] * q, n[1] * q]
}
