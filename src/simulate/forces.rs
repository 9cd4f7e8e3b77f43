//! Forces on the wheels of a model with given parameters, and the resulting rates.

use std::convert::Infallible;

use super::friction::{Contact, along_freedom, contact, friction};
use super::input_line::InputLine;
use super::steady::Steady;
use super::sum::Sum;
use crate::effects::{BASE, BodyState, DIRECTIONS, Effect, Motion, Terms, along};
use crate::math::{runge_kutta_from, runge_kutta_motion};
use crate::model::{Model, ModelError, SpeedPolynomial, inverse_mass, solve_mass, times};

/// alpha1, alpha2, omega1, omega2; for a two-mass drivetrain also body speeds u1, u2 and twists phi1, phi2.
pub(super) type Vector = [f64; 8];

/// Start of a step: the state, its contact state, and its rates.
pub(super) struct Departure {
    pub(super) t: f64,
    pub(super) y: Vector,
    pub(super) contact: Contact,
    /// [`Contact::freedom`] of `contact`.
    pub(super) freedom: Option<[f64; 2]>,
    pub(super) rate: Vector,
    /// Resisting torque on each wheel throughout the step [N m], if levels are constant.
    pub(super) resisting: [f64; 2],
}

/// Difference of the speeds for the slope of a torque, relative to 1 rad/s and the speed.
const DIFFERENCE: f64 = 1e-3;

/// A wheel is held without further checks if the holding torque is below its level by this share.
pub(super) const CLEARLY: f64 = 1.0 - 1e-9;

/// A model with parameter values, ready to be integrated.
#[derive(Clone)]
pub(super) struct Forces<'m> {
    pub(super) model: &'m Model,
    pub(super) p: &'m [f64],
    t0: f64,
    /// All effects; for a two-mass drivetrain those on the wheels only.
    pub(super) wheel: Sum<'m>,
    pub(super) behind: Option<Behind<'m>>,
    /// Inverse of the mass matrix, if it is constant.
    pub(super) inverse: Option<[f64; 3]>,
    /// Contribution of the polynomial of the speeds to the accelerations, for a constant mass matrix.
    pub(super) by_speed: SpeedPolynomial,
    /// Whether a level of dry friction varies, and the levels if none does.
    pub(super) rough: bool,
    pub(super) level: [f64; 4],
}

/// The second mass of a two-mass drivetrain.
#[derive(Clone)]
pub(super) struct Behind<'m> {
    pub(super) coupling: (&'m dyn Effect, &'m [f64]),
    pub(super) body: Sum<'m>,
    /// Both masses with their coupling, if they are constant.
    pub(super) steady: Option<Steady>,
}

/// Terms on the wheels at one instant; for a two-mass drivetrain also the terms of the body and the torques
/// transmitted to it.
struct Acting {
    terms: Terms<f64>,
    torque: [f64; 2],
    body: Option<(Terms<f64>, [f64; 2])>,
}

impl<'m> Forces<'m> {
    pub(super) fn new(model: &'m Model, p: &'m [f64], t0: f64) -> Self {
        let robot = model.robot();
        let x = Motion::at(0.0, [0.0; 2], [0.0; 2], robot);
        let places =
            || (0..model.effects().len()).map(|e| (&*model.effects()[e], &p[model.slots(e)]));
        let coupling = places().find(|(effect, p)| effect.coupling(&x, p).is_some());
        let of_body = |e: &dyn Effect| coupling.is_some() && e.energy().of_the_body();
        let wheel = Sum::new(model, p, &x, |e| !of_body(e));
        let behind = coupling.map(|coupling| {
            let body = Sum::new(model, p, &x, of_body);
            let steady = Steady::new(coupling.0.coupling(&x, coupling.1), &wheel, &body);
            Behind { coupling, body, steady }
        });
        let steady = behind.is_none() && wheel.has_constant_mass();
        let inverse = if steady { inverse_mass(&wheel.constant.mass).ok() } else { None };
        let (level, rough) = (wheel.level(&x), !wheel.has_constant_levels());
        let negative = inverse.unwrap_or([0.0; 3]).map(|i| -i);
        let by_speed = wheel.by_speed.mapped(|torque| times(&negative, torque));
        Self { model, p, t0, wheel, behind, inverse, by_speed, rough, level }
    }

    #[inline]
    pub(super) fn motion(&self, t: f64, y: &Vector) -> Motion<'m, f64> {
        Motion::at(t - self.t0, [y[0], y[1]], [y[2], y[3]], self.model.robot())
    }

    /// The fastest rate of a coupling [1/s], determined by the lighter of rotor and body.
    pub(super) fn coupling_rate(&self, t: f64, y: &Vector) -> Option<f64> {
        let Behind { coupling: (effect, p), body, .. } = self.behind.as_ref()?;
        let x = self.motion(t, y);
        Some(effect.coupling(&x, p)?.fastest_rate(&body.at(&x).mass))
    }

    /// The fastest rate at which torques that depend on the speeds change them at `y` [1/s], such as 1/τ of a motor
    /// with back-EMF: the largest row sum of `A⁻¹ ∂τ/∂ω`, with one-sided differences of `τ`. Dry friction has no rate
    /// of its own, and that of the centrifugal torques of the base model (a3 ω/a1) is too low to matter.
    pub(super) fn damping_rate(&self, t: f64, y: &Vector) -> f64 {
        if self.model.effects().len() == BASE.len() {
            return 0.0;
        }
        let none = InputLine::new(t, t + 1.0, &[0.0; 2], &[0.0; 2]);
        let now = self.acting(t, y, &none).terms;
        let step = DIFFERENCE * (1.0 + y[2].abs().max(y[3].abs()));
        let mut sums = [0.0; 2];
        for wheel in 0..2 {
            let mut moved = *y;
            moved[2 + wheel] += step;
            let torque = self.acting(t, &moved, &none).terms.torque;
            let slope = [0, 1].map(|i| (torque[i] - now.torque[i]) / step);
            let Ok(rates) = solve_mass(&now.mass, &slope) else { return 0.0 };
            (0..2).for_each(|i| sums[i] += rates[i].abs());
        }
        sums[0].max(sums[1])
    }

    #[inline]
    fn acting(&self, t: f64, y: &Vector, input: &InputLine) -> Acting {
        let (x, torque) = (self.motion(t, y), input.at(t));
        match &self.behind {
            None => Acting { terms: self.wheel.at(&x), torque, body: None },
            Some(behind) => self.coupled(behind, &x, y, torque),
        }
    }

    fn coupled(&self, behind: &Behind, x: &Motion<f64>, y: &Vector, torque: [f64; 2]) -> Acting {
        let (mut wheel, (effect, p)) = (self.wheel.at(x), behind.coupling);
        let Some(coupling) = effect.coupling(x, p) else {
            return Acting { terms: wheel, torque, body: None };
        };
        let state = BodyState { speed: [y[4], y[5]], twist: [y[6], y[7]] };
        let mut body = behind.body.at(&x.of_body(&state));
        coupling.separate(&mut wheel, &mut body);
        let passed = coupling.passed(&x.omega, &state);
        let torque = [torque[0] - passed[0], torque[1] - passed[1]];
        Acting { terms: wheel, torque, body: Some((body, passed)) }
    }

    /// The start of a step from the state at `t`.
    pub(super) fn depart(
        &self,
        t: f64,
        y: &Vector,
        input: &InputLine,
    ) -> Result<Departure, ModelError> {
        let acting = self.acting(t, y, input);
        let contact = contact(&acting.terms, &acting.torque, &[y[2], y[3]])?;
        let rate = with_body(y, contact.acceleration, &acting)?;
        let resisting = self.resisting(&self.level, &contact.sign);
        Ok(Departure { t, y: *y, freedom: contact.freedom(), contact, rate, resisting })
    }

    /// The torque that resists motion with these levels and signs of dry friction, without torques that vary
    /// [N m].
    #[inline]
    pub(super) fn resisting(&self, level: &[f64; 4], sign: &[f64; 4]) -> [f64; 2] {
        let (torque, friction) = (self.wheel.constant.torque, friction(level, sign));
        [torque[0] + friction[0], torque[1] + friction[1]]
    }

    /// The remaining torque that accelerates the wheels, if only torques vary.
    #[inline]
    pub(super) fn remaining(
        &self,
        x: &Motion<f64>,
        torque: [f64; 2],
        resisting: &[f64; 2],
    ) -> [f64; 2] {
        let b = self.remaining_by_speed(x.omega, torque, resisting);
        let varying = self.wheel.varying_torque(x);
        [b[0] - varying[0], b[1] - varying[1]]
    }

    /// [`Forces::remaining`] if every varying torque is in the polynomial of the speeds.
    #[inline]
    fn remaining_by_speed(
        &self,
        omega: [f64; 2],
        torque: [f64; 2],
        resisting: &[f64; 2],
    ) -> [f64; 2] {
        let by_speed = self.wheel.by_speed.rest(omega);
        let left = |i: usize| torque[i] - resisting[i] - by_speed[i];
        [left(0), left(1)]
    }

    /// The acceleration that the directions that stick in the contact state of `from` must prevent at `y`, where no
    /// direction has reversed, and the one that their friction can prevent [rad/s²]: of a single direction, or of
    /// the wheel nearer to breakaway by its own friction alone (further friction can only help). `None` for other
    /// contact states, and for two-mass drivetrains.
    #[inline]
    pub(super) fn held(
        &self,
        t: f64,
        y: &Vector,
        input: &InputLine,
        from: &Departure,
    ) -> Option<(f64, f64)> {
        let inverse = self.inverse.as_ref()?;
        let (x, stuck) = (self.motion(t, y), from.contact.stuck);
        let level = self.level_at(&x);
        let b = self.remaining(&x, input.at(t), &self.resisting(&level, &from.contact.sign));
        if stuck[0] && stuck[1] {
            let [m11, _, m22] = self.wheel.constant.mass;
            let (first, second) =
                ((b[0].abs() / m11, level[0] / m11), (b[1].abs() / m22, level[1] / m22));
            return Some(if first.0 - first.1 > second.0 - second.1 { first } else { second });
        }
        let j = stuck.iter().position(|stuck| *stuck)?;
        let moves = |k: usize| level[k] <= 0.0 || along(k, &x.omega) != 0.0;
        (0..4).all(|k| k == j || moves(k)).then(|| hold(inverse, j, level[j], &b))
    }

    /// The levels of dry friction at one instant [N m].
    #[inline]
    pub(super) fn level_at(&self, x: &Motion<f64>) -> [f64; 4] {
        if self.rough { self.wheel.level(x) } else { self.level }
    }

    pub(super) fn contact(
        &self,
        t: f64,
        y: &Vector,
        input: &InputLine,
    ) -> Result<Contact, ModelError> {
        let acting = self.acting(t, y, input);
        contact(&acting.terms, &acting.torque, &[y[2], y[3]])
    }

    /// Acceleration of the measured wheels in the contact state of `from`.
    pub(super) fn acceleration(
        &self,
        t: f64,
        y: &Vector,
        input: &InputLine,
        from: &Departure,
    ) -> Result<[f64; 2], ModelError> {
        let acting = self.acting(t, y, input);
        self.constrained(&acting.terms, &acting.torque, from)
    }

    /// The acceleration with the friction signs of `from`, along the one free direction if others stick.
    #[inline]
    pub(super) fn constrained(
        &self,
        terms: &Terms<f64>,
        torque: &[f64; 2],
        from: &Departure,
    ) -> Result<[f64; 2], ModelError> {
        let friction = friction(&terms.level, &from.contact.sign);
        let left = |i: usize| torque[i] - terms.torque[i] - friction[i];
        let b = [left(0), left(1)];
        match (from.freedom, self.inverse) {
            (None, Some(inverse)) => Ok(times(&inverse, &b)),
            (None, None) => solve_mass(&terms.mass, &b),
            (Some(n), _) => Ok(along_freedom(&terms.mass, &b, &n)),
        }
    }

    /// Inverse of the mass matrix, along the one free direction if others stick.
    pub(super) fn mobility(
        &self,
        mass: &[f64; 3],
        from: &Departure,
    ) -> Result<[f64; 3], ModelError> {
        match (from.freedom, self.inverse) {
            (None, Some(inverse)) => Ok(inverse),
            (None, None) => inverse_mass(mass),
            (Some(n), _) => {
                let [m1, m2] = [[1.0, 0.0], [0.0, 1.0]].map(|b| along_freedom(mass, &b, &n));
                Ok([m1[0], m1[1], m2[1]])
            }
        }
    }

    /// One classical Runge-Kutta step to `to` \[s\] in the contact state of its start.
    pub(super) fn step(
        &self,
        from: &Departure,
        to: f64,
        input: &InputLine,
    ) -> Result<Vector, ModelError> {
        let (t, h) = (from.t, to - from.t);
        if self.behind.is_none() {
            return self.rigid_step(from, to, input);
        }
        runge_kutta_from(&from.y, &from.rate, h, |c, y| {
            let acting = self.acting(instant(t, to, c), y, input);
            with_body(y, self.constrained(&acting.terms, &acting.torque, from)?, &acting)
        })
    }

    fn rigid_step(
        &self,
        from: &Departure,
        to: f64,
        input: &InputLine,
    ) -> Result<Vector, ModelError> {
        let (t, [a1, a2, w1, w2, ..]) = (from.t, from.y);
        if from.freedom == Some([0.0; 2]) {
            // nothing accelerates
            let h = to - t;
            return Ok([a1 + h * w1, a2 + h * w2, w1, w2, w1, w2, 0.0, 0.0]);
        }
        let (alpha, omega, first) = ([a1, a2], [w1, w2], [from.rate[2], from.rate[3]]);
        let robot = self.model.robot();
        let at = |c: f64, alpha: &[f64; 2], omega: &[f64; 2]| {
            let t = instant(t, to, c);
            let (alpha, omega) = (*alpha, *omega);
            (Motion::at(t - self.t0, alpha, omega, robot), input.at(t))
        };
        let h = to - t;
        let ([a1, a2], [w1, w2]) = match self.freed(from) {
            Some(mobility) if self.wheel.is_polynomial() && !self.rough => {
                let Ok(end) = runge_kutta_motion(&alpha, &omega, &first, h, |c, _, omega| {
                    let torque = input.at(instant(t, to, c));
                    let left = self.remaining_by_speed(*omega, torque, &from.resisting);
                    Ok::<_, Infallible>(times(&mobility, &left))
                });
                end
            }
            // masses are the same throughout
            Some(mobility) => {
                let sign = &from.contact.sign;
                let Ok(end) = runge_kutta_motion(&alpha, &omega, &first, h, |c, alpha, omega| {
                    let (x, torque) = at(c, alpha, omega);
                    let resisting = self.resisting(&self.level_at(&x), sign);
                    Ok::<_, Infallible>(times(&mobility, &self.remaining(&x, torque, &resisting)))
                });
                end
            }
            None => runge_kutta_motion(&alpha, &omega, &first, h, |c, alpha, omega| {
                let (x, torque) = at(c, alpha, omega);
                self.constrained(&self.wheel.at(&x), &torque, from)
            })?,
        };
        Ok([a1, a2, w1, w2, w1, w2, 0.0, 0.0])
    }

    /// The accelerations due to unit torques in the contact state of `from`, if the mass matrix is constant.
    #[inline]
    fn freed(&self, from: &Departure) -> Option<[f64; 3]> {
        let inverse = self.inverse?;
        Some(from.freedom.map_or(inverse, |n| self.freed_along(n)))
    }

    /// The accelerations due to unit torques along the one free direction `n`, for a constant mass matrix.
    #[inline]
    pub(super) fn freed_along(&self, n: [f64; 2]) -> [f64; 3] {
        let [m11, m12, m22] = self.wheel.constant.mass;
        let inertia = m11 * n[0] * n[0] + 2.0 * m12 * n[0] * n[1] + m22 * n[1] * n[1];
        let share = if inertia > 0.0 { 1.0 / inertia } else { 0.0 };
        [n[0] * n[0] * share, n[0] * n[1] * share, n[1] * n[1] * share]
    }
}

/// The acceleration along direction `j` that the torques `b` would cause without friction along it, and the one
/// that friction of this level can prevent [rad/s²], while the other directions with friction move.
#[inline]
pub(super) fn hold(inverse: &[f64; 3], j: usize, level: f64, b: &[f64; 2]) -> (f64, f64) {
    let (free, slowed) = (times(inverse, b), times(inverse, &DIRECTIONS[j]));
    (along(j, &free).abs(), level * along(j, &slowed))
}

/// All rates from the acceleration of the wheels.
#[inline]
fn with_body(y: &Vector, a: [f64; 2], acting: &Acting) -> Result<Vector, ModelError> {
    let mut rates = [y[2], y[3], a[0], a[1], a[0], a[1], 0.0, 0.0];
    if let Some((terms, passed)) = &acting.body {
        let force = [passed[0] - terms.torque[0], passed[1] - terms.torque[1]];
        let du = solve_mass(&terms.mass, &force)?;
        rates[4..].copy_from_slice(&[du[0], du[1], y[2] - y[4], y[3] - y[5]]);
    }
    Ok(rates)
}

/// The instant at share `c` of the interval from `t` to `to`; at the end exactly `to`.
pub(super) fn instant(t: f64, to: f64, c: f64) -> f64 {
    if c < 1.0 { t + c * (to - t) } else { to }
}
