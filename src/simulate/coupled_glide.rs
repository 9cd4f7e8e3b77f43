//! A step of a two-mass drivetrain in which all directions of dry friction slide throughout, with constant mass
//! matrices: the most frequent kind, of which a stiff coupling needs many in each row.

use super::forces::{Behind, Departure, Forces, Vector, instant};
use super::friction::Contact;
use super::glide::Sliding;
use super::input_line::InputLine;
use super::steady::Steady;
use super::sum::Sum;
use crate::effects::{BodyState, Motion, along};
use crate::math::runge_kutta_from;
use crate::model::times;

impl Forces<'_> {
    /// One classical Runge-Kutta step from `y` at `from` to `to` \[s\]: its start and end. `None` if the contact must
    /// be solved (a direction at rest, reversal), if a mass, a level or the coupling varies, and without a coupling.
    pub(super) fn glide_coupled(
        &self,
        from: f64,
        to: f64,
        y: &Vector,
        input: &InputLine,
    ) -> Option<(Departure, Vector)> {
        let behind = self.behind.as_ref()?;
        let steady = behind.steady.as_ref().filter(|_| !self.rough)?;
        let Sliding { sign, stuck: None } = Self::sliding(&self.level, y)? else { return None };
        let resisting = self.resisting(&self.level, &sign);
        let rate =
            |t: f64, y: &Vector| self.coupled_rate(behind, steady, (t, y), input, &resisting);
        let first = rate(from, y)?;
        let at = |c: f64, y: &Vector| rate(instant(from, to, c), y).ok_or(());
        let end = runge_kutta_from(y, &first, to - from, at).ok()?;
        let omega = [end[2], end[3]];
        // NaN is left to the contact solver, which returns the error
        if !(0..4).all(|j| sign[j] * along(j, &omega) >= 0.0) {
            return None;
        }
        let contact = Contact { sign, stuck: [false; 4], acceleration: [first[2], first[3]] };
        let start = Departure { t: from, y: *y, contact, freedom: None, rate: first, resisting };
        Some((start, end))
    }

    /// The rates of all states; `None` if the coupling has changed.
    #[inline]
    fn coupled_rate(
        &self,
        behind: &Behind,
        steady: &Steady,
        (t, y): (f64, &Vector),
        input: &InputLine,
        resisting: &[f64; 2],
    ) -> Option<Vector> {
        let (x, (effect, p)) = (self.motion(t, y), behind.coupling);
        if effect.coupling(&x, p) != Some(steady.coupling) {
            return None;
        }
        let state = BodyState { speed: [y[4], y[5]], twist: [y[6], y[7]] };
        let passed = steady.coupling.passed(&x.omega, &state);
        let left = self.remaining(&x, input.at(t), resisting);
        let a = [0, 1].map(|i| (left[i] - passed[i]) * steady.rotor);
        let du = times(&steady.body, &left_of(&behind.body, &x, &state, &passed));
        let twist = [y[2] - y[4], y[3] - y[5]];
        Some([y[2], y[3], a[0], a[1], du[0], du[1], twist[0], twist[1]])
    }
}

/// The torque that accelerates the body [N m].
#[inline]
fn left_of(body: &Sum, x: &Motion<f64>, state: &BodyState<f64>, passed: &[f64; 2]) -> [f64; 2] {
    let (constant, by_speed) = (body.constant.torque, body.by_speed.rest(state.speed));
    let varying =
        if body.is_polynomial() { [0.0; 2] } else { body.varying_torque(&x.of_body(state)) };
    [0, 1].map(|i| passed[i] - constant[i] - by_speed[i] - varying[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;

    #[test]
    fn a_step_is_that_of_the_contact_to_rounding() {
        let models: [&[&str]; 4] = [
            &["compliance"],
            &["wheel_slip", "viscous_friction", "yaw_viscous"],
            &["compliance", "quadratic_drag", "turning_scrub", "slope"],
            &["wheel_slip", "torque_ripple", "lateral_com", "torque_offset"],
        ];
        let y = [0.1, -0.2, 1.3, -0.8, 1.2, -0.7, 0.01, -0.02];
        let input = InputLine::new(0.0, 0.002, &[0.3, -0.2], &[0.1, 0.2]);
        for ids in models {
            let model = Model::with_effects(Robot::amigobot(), ids).unwrap();
            let p = model.initial();
            let f = Forces::new(&model, &p, 0.0);
            let (start, end) = f.glide_coupled(0.0, 0.002, &y, &input).unwrap();
            let from = f.depart(0.0, &y, &input).unwrap();
            let expected = f.step(&from, 0.002, &input).unwrap();
            assert_eq!(start.contact.sign, from.contact.sign);
            for i in 0..8 {
                // accelerations of some 10 rad/s²
                assert!((start.rate[i] - from.rate[i]).abs() < 1e-12, "{ids:?} {i}");
                assert!((end[i] - expected[i]).abs() < 1e-14, "{ids:?} {i}");
            }
        }
    }

    #[test]
    fn rest_and_reversal_are_left_to_the_contact() {
        let model = Model::with_effects(Robot::amigobot(), &["compliance"]).unwrap();
        let p = model.initial();
        let f = Forces::new(&model, &p, 0.0);
        let input = InputLine::new(0.0, 0.01, &[-0.5, -0.5], &[-0.5, -0.5]);
        for w1 in [0.0, 1e-3] {
            let y = [0.0, 0.0, w1, 1.0, w1, 1.0, 0.0, 0.0];
            assert!(f.glide_coupled(0.0, 0.01, &y, &input).is_none(), "{w1}");
        }
    }
}
