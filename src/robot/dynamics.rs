//! The equations of motion of the base model in closed form: the reference for everything else.

use std::ops::{Mul, Sub};

use serde::{Deserialize, Serialize};

use super::State;
use crate::math::sgn;

/// The five parameters of the base model: inertia, centrifugal coupling, Coulomb friction.
///
/// Source: the paper, eq. (14) and (15).
///
/// | symbol | here | meaning | unit |
/// |---|---|---|---|
/// | a1 | `a1` | effective inertia at a wheel that accelerates alone | kg m² |
/// | a2 | `a2` | inertia that couples the wheels | kg m² |
/// | a3 | `a3` | centrifugal coupling; positive if the centre of mass is behind the axle | kg m² |
/// | a4 | `a4` | friction torque of wheel 1 | N m |
/// | a5 | `a5` | friction torque of wheel 2 | N m |
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaseParameters {
    /// Own inertia of a wheel [kg m²].
    pub a1: f64,
    /// Inertia that couples the wheels [kg m²].
    pub a2: f64,
    /// Centrifugal coupling [kg m²].
    pub a3: f64,
    /// Friction torque of wheel 1, the right wheel [N m].
    pub a4: f64,
    /// Friction torque of wheel 2, the left wheel [N m].
    pub a5: f64,
}

impl BaseParameters {
    /// The parameters as an array in the order a1..a5.
    #[must_use]
    pub const fn to_array(self) -> [f64; 5] {
        [self.a1, self.a2, self.a3, self.a4, self.a5]
    }

    /// Determinant of the mass matrix, D = a1² - a2² [kg² m⁴].
    #[must_use]
    pub fn determinant(&self) -> f64 {
        // the product form keeps its digits when |a2| is close to a1
        (self.a1 - self.a2) * (self.a1 + self.a2)
    }

    /// Whether every motion has positive kinetic energy: a1 > |a2|.
    #[must_use]
    pub fn has_positive_mass(&self) -> bool {
        self.a1 > self.a2.abs()
    }

    /// Centrifugal torques [N m] of the left side of eq. (14) for wheel speeds [rad/s]: a3 w2 (w2 - w1) and a3 w1 (w1 -
    /// w2).
    #[must_use]
    pub fn centrifugal(&self, omega: [f64; 2]) -> [f64; 2] {
        centrifugal_torques(self.a3, omega)
    }

    /// Input torques [M1, M2] [N m] for wheel accelerations [rad/s²] in a state (inverse dynamics).
    ///
    /// ```text
    /// M1 = a1 dw1 + a2 dw2 + a3 w2² - a3 w1 w2 + a4 sgn(w1)
    /// M2 = a2 dw1 + a1 dw2 + a3 w1² - a3 w1 w2 + a5 sgn(w2)
    /// ```
    ///
    /// Source: the paper, eq. (14), with sgn(0) = 0.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::robot::{Construction, State};
    /// let a = Construction::amigobot().parameters();
    /// let straight = State { alpha: [0.0; 2], omega: [4.0, 4.0] };
    /// // at constant speed straight ahead the input torque overcomes friction alone
    /// assert_eq!(a.inverse(&straight, [0.0, 0.0]), [a.a4, a.a5]);
    /// ```
    #[must_use]
    pub fn inverse(&self, state: &State, acceleration: [f64; 2]) -> [f64; 2] {
        let [dw1, dw2] = acceleration;
        let [c1, c2] = self.centrifugal(state.omega);
        // eq. (14)
        [
            self.a1 * dw1 + self.a2 * dw2 + c1 + self.a4 * sgn(state.omega[0]),
            self.a2 * dw1 + self.a1 * dw2 + c2 + self.a5 * sgn(state.omega[1]),
        ]
    }
}

/// Centrifugal torques [N m] on the left side of eq. (14) for wheel speeds [rad/s], for one robot or for the
/// lanes of `T`.
///
/// ```text
/// c1 = a3 w2 (w2 - w1),  c2 = a3 w1 (w1 - w2)
/// ```
#[inline(always)]
pub(crate) fn centrifugal_torques<T>(a3: T, [w1, w2]: [T; 2]) -> [T; 2]
where
    T: Copy + Sub<Output = T> + Mul<Output = T>,
{
    [a3 * w2 * (w2 - w1), a3 * w1 * (w1 - w2)]
}

/// Reference for tests; simulations use the sum of effects instead.
#[cfg(test)]
impl BaseParameters {
    /// Kinetic energy of the robot \[J\] for wheel speeds [rad/s] without slip.
    ///
    /// ```text
    /// E = (a1 w1² + 2 a2 w1 w2 + a1 w2²) / 2
    /// ```
    pub(crate) fn kinetic_energy(&self, omega: [f64; 2]) -> f64 {
        let [w1, w2] = omega;
        0.5 * self.a1 * (w1 * w1 + w2 * w2) + self.a2 * w1 * w2
    }

    /// Wheel accelerations [dw1, dw2] [rad/s²] for input torques [N m] in a state (forward dynamics).
    ///
    /// Source: the paper, eq. (14) solved for the accelerations, with sgn(0) = 0: no stiction, so it is not
    /// suitable for simulation.
    pub(crate) fn forward(&self, state: &State, torque: [f64; 2]) -> [f64; 2] {
        let [c1, c2] = self.centrifugal(state.omega);
        let t1 = torque[0] - self.a4 * sgn(state.omega[0]) - c1;
        let t2 = torque[1] - self.a5 * sgn(state.omega[1]) - c2;
        let d = self.determinant();
        [(self.a1 * t1 - self.a2 * t2) / d, (self.a1 * t2 - self.a2 * t1) / d]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Construction;
    use proptest::prelude::*;

    fn parameters() -> impl Strategy<Value = BaseParameters> {
        (1e-5..1.0, -0.95..0.95, -0.5..0.5, 0.0..1.0, 0.0..1.0).prop_map(|(a1, k2, k3, a4, a5)| {
            BaseParameters { a1, a2: k2 * a1, a3: k3 * a1, a4, a5 }
        })
    }

    fn states() -> impl Strategy<Value = State> {
        prop::array::uniform4(-30.0..30.0)
            .prop_map(|[a1, a2, w1, w2]| State { alpha: [a1, a2], omega: [w1, w2] })
    }

    proptest! {
        #[test]
        fn forward_after_inverse_is_the_identity(
            a in parameters(), state in states(), dw in prop::array::uniform2(-50.0..50.0_f64)
        ) {
            let torque = a.inverse(&state, dw);
            let back = a.forward(&state, torque);
            // terms of size a3 w² and a4 cancel; the condition of the mass matrix is below 39
            let size = torque[0].abs() + torque[1].abs() + a.a4 + a.a5 + a.a1 * 1000.0;
            for i in 0..2 {
                prop_assert!((back[i] - dw[i]).abs() <= 1e-13 * size / a.a1 * 40.0);
            }
        }

        #[test]
        fn the_power_of_the_input_is_what_the_energy_gains_and_friction_takes(
            a in parameters(), state in states(), dw in prop::array::uniform2(-50.0..50.0_f64)
        ) {
            let [w1, w2] = state.omega;
            let [m1, m2] = a.inverse(&state, dw);
            let gained = a.a1 * (w1 * dw[0] + w2 * dw[1]) + a.a2 * (w1 * dw[1] + w2 * dw[0]);
            let taken = a.a4 * w1.abs() + a.a5 * w2.abs();
            let driven = m1 * w1 + m2 * w2;
            // the centrifugal terms do no work; they are of size a3 w³ each and cancel
            let size = driven.abs() + taken + a.a1 * 30.0 * 50.0 + a.a3.abs() * 3e4;
            prop_assert!((driven - gained - taken).abs() <= 1e-14 * size);
        }

        #[test]
        fn exchanging_the_wheels_exchanges_the_torques(
            a in parameters(), state in states(), dw in prop::array::uniform2(-50.0..50.0_f64)
        ) {
            let mirror = BaseParameters { a4: a.a5, a5: a.a4, ..a };
            let State { alpha: [a1, a2], omega: [w1, w2] } = state;
            let exchanged = State { alpha: [a2, a1], omega: [w2, w1] };
            let [m1, m2] = a.inverse(&state, dw);
            let [n1, n2] = mirror.inverse(&exchanged, [dw[1], dw[0]]);
            // the same products are added in another order
            prop_assert!((m1 - n2).abs() <= 1e-13 * (1.0 + m1.abs()));
            prop_assert!((m2 - n1).abs() <= 1e-13 * (1.0 + m2.abs()));
        }
    }

    #[test]
    fn a_wheel_at_rest_feels_no_friction() {
        let a = Construction::amigobot().parameters();
        assert_eq!(a.forward(&State::default(), [0.0, 0.0]), [0.0, 0.0]);
        assert_eq!(a.inverse(&State::default(), [0.0, 0.0]), [0.0, 0.0]);
    }

    #[test]
    fn the_centrifugal_torques_hold_the_frame_on_its_circle() {
        // Force balance of a steady left turn, worked out on its own: S lies l2 behind A, so the
        // frame needs m4 l2 beta_dot² forward (half from each wheel) and m4 v beta_dot to the
        // left at S, whose torque about A is -l2 m4 v beta_dot (from the wheels at +-l1).
        let c = Construction::amigobot();
        let a = c.parameters();
        let (w1, w2) = (6.0, 2.0);
        let v = c.r_m / 2.0 * (w1 + w2);
        let beta_dot = c.r_m / (2.0 * c.l1_m) * (w1 - w2);
        let forward = c.r_m / 2.0 * c.m4_kg * c.l2_m * beta_dot * beta_dot;
        let turning = c.r_m / (2.0 * c.l1_m) * c.m4_kg * c.l2_m * v * beta_dot;
        let state = State { alpha: [0.0; 2], omega: [w1, w2] };
        let [m1, m2] = a.inverse(&state, [0.0, 0.0]);
        // rounding of sums of size 0.1
        assert!((m1 - (forward - turning + a.a4)).abs() < 1e-15, "{m1}");
        assert!((m2 - (forward + turning + a.a5)).abs() < 1e-15, "{m2}");
    }

    #[test]
    fn the_mass_is_positive_where_a1_exceeds_a2() {
        let a = Construction::amigobot().parameters();
        assert!(a.has_positive_mass());
        assert!(!BaseParameters { a2: -1.01 * a.a1, ..a }.has_positive_mass());
        assert!(!BaseParameters { a2: f64::NAN, ..a }.has_positive_mass());
        // D = a1² - a2² by hand: 0.0318550347² - 0.0024175347² = 1.0088988e-3
        assert!((a.determinant() - 1.008_898_8e-3).abs() < 1e-9, "{}", a.determinant());
    }
}
