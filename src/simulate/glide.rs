//! A step in which all wheels slide, or both are at rest, throughout, with a constant mass matrix: the most
//! frequent kind of step.

use std::convert::Infallible;

use super::forces::{Departure, Forces, Vector};
use super::friction::{Contact, friction};
use super::input_line::InputLine;
use crate::effects::{Motion, along};
use crate::math::{runge_kutta_motion, sgn};
use crate::model::times;

/// A completed step.
pub(super) struct Glide {
    /// Friction signs; `None` if the wheels are at rest.
    sign: Option<[f64; 4]>,
    /// Acceleration at its start.
    first: [f64; 2],
    /// alpha1, alpha2, omega1, omega2 at its end.
    end: [f64; 4],
}

impl Glide {
    /// The state at its end, without a second mass.
    #[inline]
    pub(super) fn end(&self) -> Vector {
        let [a1, a2, w1, w2] = self.end;
        [a1, a2, w1, w2, w1, w2, 0.0, 0.0]
    }
}

impl Forces<'_> {
    /// The start of a completed step from `y` at `t`.
    #[inline]
    pub(super) fn start_of(&self, glide: &Glide, t: f64, y: &Vector) -> Departure {
        let a = glide.first;
        let sign = glide.sign.unwrap_or_default();
        let stuck = match glide.sign {
            Some(_) => [false; 4],
            None => self.level.map(|level| level > 0.0),
        };
        let contact = Contact { sign, stuck, acceleration: a };
        let freedom = glide.sign.is_none().then_some([0.0; 2]);
        let rate = [y[2], y[3], a[0], a[1], a[0], a[1], 0.0, 0.0];
        Departure { t, y: *y, contact, freedom, rate, resisting: self.resisting(&sign) }
    }

    /// One classical Runge-Kutta step from `y` at `from` to `to` \[s\]; `None` if the contact must be solved
    /// (one wheel rests while the other moves, breakaway, reversal) or the mass matrix varies.
    #[inline]
    pub(super) fn glide(&self, from: f64, to: f64, y: &Vector, input: &InputLine) -> Option<Glide> {
        let inverse = self.inverse.as_ref()?;
        if self.rough {
            let start = self.motion(from, y);
            let level = self.wheel.level(&start);
            let sign = signs(&level, y)?;
            let under = |x: &Motion<f64>, torque: [f64; 2], level: &[f64; 4]| {
                let friction = friction(level, &sign);
                let resting = self.wheel.constant.torque;
                let resisting = [resting[0] + friction[0], resting[1] + friction[1]];
                times(inverse, &self.remaining(x, torque, &resisting))
            };
            let first = under(&start, input.at(from), &level);
            return self.slide(from, to, y, input, (sign, first), |t, y, torque| {
                let x = self.motion(t, y);
                under(&x, torque, &self.wheel.level(&x))
            });
        }
        if y[2] == 0.0 && y[3] == 0.0 {
            return self.stand(from, to, y, input);
        }
        let sign = signs(&self.level, y)?;
        let resisting = self.resisting(&sign);
        if self.wheel.is_polynomial() {
            let at = |_: f64, y: &Vector, torque: [f64; 2]| {
                self.acceleration_at([y[2], y[3]], torque, &resisting)
            };
            let first = at(from, y, input.at(from));
            return self.slide(from, to, y, input, (sign, first), at);
        }
        let at = |t: f64, y: &Vector, torque: [f64; 2]| {
            times(inverse, &self.remaining(&self.motion(t, y), torque, &resisting))
        };
        let first = at(from, y, input.at(from));
        self.slide(from, to, y, input, (sign, first), at)
    }

    /// Acceleration if every varying torque is in the polynomial of the speeds.
    #[inline]
    pub(super) fn acceleration_at(
        &self,
        omega: [f64; 2],
        torque: [f64; 2],
        resisting: &[f64; 2],
    ) -> [f64; 2] {
        let inverse = self.inverse.as_ref().unwrap_or(&[0.0; 3]);
        let by_input = times(inverse, &[torque[0] - resisting[0], torque[1] - resisting[1]]);
        let by_speed = self.by_speed.rest(omega);
        [by_input[0] + by_speed[0], by_input[1] + by_speed[1]]
    }

    /// Both wheels at rest, held at both ends of the step.
    #[inline]
    fn stand(&self, from: f64, to: f64, y: &Vector, input: &InputLine) -> Option<Glide> {
        let held = |t: f64| {
            let b = self.remaining(&self.motion(t, y), input.at(t), &self.wheel.constant.torque);
            b[0].abs() <= self.level[0] && b[1].abs() <= self.level[1]
        };
        let rough = |j: usize| self.level[j] > 0.0;
        if !(rough(0) && rough(1) && held(from) && held(to)) {
            return None;
        }
        Some(Glide { sign: None, first: [0.0; 2], end: [y[0], y[1], 0.0, 0.0] })
    }

    /// A step of sliding wheels with these friction signs and known initial acceleration.
    #[inline]
    fn slide(
        &self,
        from: f64,
        to: f64,
        y: &Vector,
        input: &InputLine,
        (sign, first): ([f64; 4], [f64; 2]),
        acceleration: impl Fn(f64, &Vector, [f64; 2]) -> [f64; 2],
    ) -> Option<Glide> {
        let h = to - from;
        let [a1, a2, w1, w2, ..] = *y;
        let rate = |c: f64, [a1, a2]: &[f64; 2], [w1, w2]: &[f64; 2]| {
            let t = if c < 1.0 { from + c * h } else { to };
            let y = [*a1, *a2, *w1, *w2, *w1, *w2, 0.0, 0.0];
            Ok::<_, Infallible>(acceleration(t, &y, input.at(t)))
        };
        let Ok((alpha, omega)) = runge_kutta_motion(&[a1, a2], &[w1, w2], &first, h, rate);
        let goes_on = |j: usize| sign[j] * along(j, &omega) >= 0.0;
        // NaN is left to the contact solver, which returns the error
        let end = [alpha[0], alpha[1], omega[0], omega[1]];
        (goes_on(0) && goes_on(1) && goes_on(2) && goes_on(3)).then_some(Glide {
            sign: Some(sign),
            first,
            end,
        })
    }
}

/// The friction signs for these levels; `None` if a direction with friction is at rest.
#[inline]
fn signs(level: &[f64; 4], y: &Vector) -> Option<[f64; 4]> {
    let omega = [y[2], y[3]];
    let mut sign = [0.0; 4];
    for (j, sign) in sign.iter_mut().enumerate() {
        if level[j] > 0.0 {
            *sign = sgn(along(j, &omega));
            if *sign == 0.0 {
                return None;
            }
        }
    }
    Some(sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;

    #[test]
    fn a_step_is_that_of_the_contact_to_rounding() {
        let models: [&[&str]; 4] = [
            &[],
            &["viscous_friction", "yaw_viscous", "lateral_com"],
            &["quadratic_drag", "turning_scrub"],
            &["stribeck", "torque_ripple", "caster_drag"],
        ];
        let y = [0.1, -0.2, 1.3, -0.8, 1.3, -0.8, 0.0, 0.0];
        let input = InputLine::new(0.0, 0.01, &[0.3, -0.2], &[0.1, 0.2]);
        for ids in models {
            let model = Model::with_effects(Robot::amigobot(), ids).unwrap();
            let p = model.initial();
            let f = Forces::new(&model, &p, 0.0);
            let glide = f.glide(0.0, 0.01, &y, &input).unwrap();
            let (start, from) = (f.start_of(&glide, 0.0, &y), f.depart(0.0, &y, &input).unwrap());
            let end = f.step(&from, 0.01, &input).unwrap();
            assert_eq!(start.contact.sign, from.contact.sign);
            for i in 0..8 {
                assert!((glide.end()[i] - end[i]).abs() < 1e-13, "{ids:?} {i}");
                assert!((start.rate[i] - from.rate[i]).abs() < 1e-12, "{ids:?} {i}");
            }
        }
    }

    #[test]
    fn wheels_stand_while_both_are_held_at_both_ends() {
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let f = Forces::new(&model, &p, 0.0);
        let y = [0.4, 0.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let held = InputLine::new(0.0, 0.01, &[0.12, -0.1], &[-0.1, 0.125]);
        let glide = f.glide(0.0, 0.01, &y, &held).unwrap();
        let (start, from) = (f.start_of(&glide, 0.0, &y), f.depart(0.0, &y, &held).unwrap());
        assert_eq!((glide.end(), start.contact), (y, from.contact));
        assert_eq!(start.freedom, Some([0.0; 2]));
        for end in [[0.13, 0.0], [0.0, -0.13]] {
            let away = InputLine::new(0.0, 0.01, &[0.0; 2], &end);
            assert!(f.glide(0.0, 0.01, &y, &away).is_none());
        }
    }
}
