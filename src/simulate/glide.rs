//! A step in which all directions of dry friction slide, all but one, or both wheels are at rest, throughout, with
//! a constant mass matrix: the most frequent kinds of step.

use std::convert::Infallible;

use super::forces::{CLEARLY, Departure, Forces, Vector, hold};
use super::friction::{Contact, perpendicular};
use super::input_line::InputLine;
use crate::effects::{Motion, along};
use crate::math::{runge_kutta_motion, sgn};
use crate::model::times;

/// A completed step.
pub(super) struct Glide {
    /// Friction signs, and the direction that sticks if any does; `None` if the wheels are at rest.
    sliding: Option<Sliding>,
    /// Acceleration at its start.
    first: [f64; 2],
    /// alpha1, alpha2, omega1, omega2 at its end.
    end: [f64; 4],
}

/// Friction signs of directions that move, and the one that sticks.
#[derive(Clone, Copy)]
pub(super) struct Sliding {
    pub(super) sign: [f64; 4],
    pub(super) stuck: Option<usize>,
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
    #[inline(always)]
    pub(super) fn start_of(&self, glide: &Glide, t: f64, y: &Vector) -> Departure {
        let a = glide.first;
        let sign = glide.sliding.map_or([0.0; 4], |sliding| sliding.sign);
        let stuck = match glide.sliding {
            Some(Sliding { stuck, .. }) => [0, 1, 2, 3].map(|j| stuck == Some(j)),
            None => self.level.map(|level| level > 0.0),
        };
        let contact = Contact { sign, stuck, acceleration: a };
        let freedom = match glide.sliding {
            Some(Sliding { stuck, .. }) => stuck.map(perpendicular),
            None => Some([0.0; 2]),
        };
        let rate = [y[2], y[3], a[0], a[1], a[0], a[1], 0.0, 0.0];
        Departure {
            t,
            y: *y,
            contact,
            freedom,
            rate,
            resisting: self.resisting(&self.level, &sign),
        }
    }

    /// One classical Runge-Kutta step from `y` at `from` to `to` \[s\]; `None` if the contact must be solved
    /// (breakaway, reversal, a direction that is not clearly held) or the mass matrix varies.
    #[inline]
    pub(super) fn glide(&self, from: f64, to: f64, y: &Vector, input: &InputLine) -> Option<Glide> {
        let inverse = self.inverse.as_ref()?;
        if y[2] == 0.0 && y[3] == 0.0 {
            return self.stand(from, to, y, input);
        }
        let level = self.level_at(&self.motion(from, y));
        let sliding = Self::sliding(&level, y)?;
        if let Some(j) = sliding.stuck {
            return self.glide_beside(j, &sliding, (from, to), y, input);
        }
        let sign = sliding.sign;
        if self.rough {
            let at = |t: f64, y: &Vector, torque: [f64; 2]| {
                times(inverse, &self.remaining_rough(&self.motion(t, y), torque, &sign))
            };
            let resisting = self.resisting(&level, &sign);
            let left = self.remaining(&self.motion(from, y), input.at(from), &resisting);
            return self.slide(from, to, y, input, (sliding, times(inverse, &left)), at);
        }
        let resisting = self.resisting(&level, &sign);
        if self.wheel.is_polynomial() {
            let at = |_: f64, y: &Vector, torque: [f64; 2]| {
                self.acceleration_at([y[2], y[3]], torque, &resisting)
            };
            let first = at(from, y, input.at(from));
            return self.slide(from, to, y, input, (sliding, first), at);
        }
        let at = |t: f64, y: &Vector, torque: [f64; 2]| {
            times(inverse, &self.remaining(&self.motion(t, y), torque, &resisting))
        };
        let first = at(from, y, input.at(from));
        self.slide(from, to, y, input, (sliding, first), at)
    }

    /// [`Forces::remaining`] with the levels of the instant.
    #[inline]
    fn remaining_rough(&self, x: &Motion<f64>, torque: [f64; 2], sign: &[f64; 4]) -> [f64; 2] {
        self.remaining(x, torque, &self.resisting(&self.level_at(x), sign))
    }

    /// A step with direction `j` clearly held at both ends, along the direction that remains.
    fn glide_beside(
        &self,
        j: usize,
        sliding: &Sliding,
        (from, to): (f64, f64),
        y: &Vector,
        input: &InputLine,
    ) -> Option<Glide> {
        let inverse = self.inverse.as_ref()?;
        let mobility = self.freed_along(perpendicular(j));
        let left = |t: f64, y: &Vector, torque: [f64; 2]| {
            self.remaining_rough(&self.motion(t, y), torque, &sliding.sign)
        };
        let held = |t: f64, y: &Vector, b: &[f64; 2]| {
            let (needed, available) = hold(inverse, j, self.level_at(&self.motion(t, y))[j], b);
            needed < available * CLEARLY
        };
        let b = left(from, y, input.at(from));
        if !held(from, y, &b) {
            return None;
        }
        let first = times(&mobility, &b);
        let glide = self.slide(from, to, y, input, (*sliding, first), |t, y, torque| {
            times(&mobility, &left(t, y, torque))
        })?;
        let end = glide.end();
        held(to, &end, &left(to, &end, input.at(to))).then_some(glide)
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
            let x = self.motion(t, y);
            let b = self.remaining(&x, input.at(t), &self.wheel.constant.torque);
            let level = self.level_at(&x);
            (0..2).all(|i| level[i] > 0.0 && b[i].abs() <= level[i])
        };
        let end = [y[0], y[1], 0.0, 0.0];
        (held(from) && held(to)).then_some(Glide { sliding: None, first: [0.0; 2], end })
    }

    /// The friction signs for these levels; `None` if two directions with friction are at rest.
    #[inline]
    pub(super) fn sliding(level: &[f64; 4], y: &Vector) -> Option<Sliding> {
        let omega = [y[2], y[3]];
        let (mut sign, mut stuck) = ([0.0; 4], None);
        for (j, sign) in sign.iter_mut().enumerate() {
            if level[j] > 0.0 {
                *sign = sgn(along(j, &omega));
                if *sign == 0.0 && stuck.replace(j).is_some() {
                    return None;
                }
            }
        }
        Some(Sliding { sign, stuck })
    }

    /// A step with these friction signs and known initial acceleration.
    #[inline]
    fn slide(
        &self,
        from: f64,
        to: f64,
        y: &Vector,
        input: &InputLine,
        (sliding, first): (Sliding, [f64; 2]),
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
        let goes_on = |j: usize| sliding.sign[j] * along(j, &omega) >= 0.0;
        // NaN is left to the contact solver, which returns the error
        let end = [alpha[0], alpha[1], omega[0], omega[1]];
        (goes_on(0) && goes_on(1) && goes_on(2) && goes_on(3)).then_some(Glide {
            sliding: Some(sliding),
            first,
            end,
        })
    }
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

    #[test]
    fn a_step_beside_a_held_direction_is_that_of_the_contact_to_rounding() {
        let cases: [(&[&str], [f64; 2], usize); 4] = [
            (&[], [0.0, 1.3], 0),
            (&["stribeck", "viscous_friction"], [-1.3, 0.0], 1),
            (&["turning_scrub", "quadratic_drag"], [2.0, 2.0], 2),
            (&["caster_drag", "stribeck"], [2.0, -2.0], 3),
        ];
        for (ids, [w1, w2], stuck) in cases {
            let model = Model::with_effects(Robot::amigobot(), ids).unwrap();
            let p = model.initial();
            let f = Forces::new(&model, &p, 0.0);
            let y = [0.1, -0.2, w1, w2, w1, w2, 0.0, 0.0];
            let input = InputLine::new(0.0, 0.01, &[0.0, 0.0], &[0.005, -0.004]);
            let glide = f.glide(0.0, 0.01, &y, &input).unwrap();
            let (start, from) = (f.start_of(&glide, 0.0, &y), f.depart(0.0, &y, &input).unwrap());
            let end = f.step(&from, 0.01, &input).unwrap();
            assert!(start.contact.stuck[stuck]);
            assert_eq!(start.contact.stuck, from.contact.stuck);
            assert_eq!((start.contact.sign, start.freedom), (from.contact.sign, from.freedom));
            assert_eq!(along(stuck, &[glide.end()[2], glide.end()[3]]), 0.0);
            for i in 0..8 {
                assert!((glide.end()[i] - end[i]).abs() < 1e-13, "{ids:?} {i}");
                assert!((start.rate[i] - from.rate[i]).abs() < 1e-12, "{ids:?} {i}");
            }
            let away = InputLine::new(0.0, 0.01, &[0.0, 0.0], &[0.9, 0.2]);
            assert!(f.glide(0.0, 0.01, &y, &away).is_none(), "{ids:?}");
        }
    }
}
