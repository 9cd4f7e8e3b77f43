//! The base model in the form that the paper uses for the emulator: x' = A x + B [f(x, a) + G(a) u].

use nalgebra::{Matrix2, Vector2};

use super::{BaseParameters, State};
use crate::math::sgn;

/// The state-space form of the base model.
///
/// ```text
/// x = [alpha1, alpha2, w1, w2],  u = [M1, M2]
/// x' = A x + B [f(x, a) + G(a) u]
/// ```
///
/// Source: the paper, eq. (16)-(18).
///
/// Deviation: eq. (16) numbers the states alpha1, w1, alpha2, w2, but A of eq. (18) needs the
/// order above; inside f3 and f4 the paper's x2 is w1 and its x4 is w2. The zero rows of f and G
/// are carried by B here.
///
/// # Examples
/// ```
/// use amigo_ident::robot::{Construction, State, StateSpace};
/// let model = StateSpace::new(Construction::amigobot().parameters());
/// let forward = State { alpha: [0.0; 2], omega: [4.0; 2] };
/// let f = model.f(&forward);
/// assert!(f[0] < 0.0 && f[0] == f[1]); // friction alone, straight ahead
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpace {
    parameters: BaseParameters,
}

impl StateSpace {
    /// The state-space form for a set of parameters.
    #[must_use]
    pub const fn new(parameters: BaseParameters) -> Self {
        Self { parameters }
    }

    /// Gain of the input [[G31, G32], [G41, G42]] of eq. (18) [1/(kg m²)].
    ///
    /// ```text
    /// G31 = G42 = a1 / (a1² - a2²),  G32 = G41 = -a2 / (a1² - a2²)
    /// ```
    ///
    /// Deviation: the transcription lost the minus sign of G32 and G41.
    #[must_use]
    pub fn g(&self) -> Matrix2<f64> {
        let BaseParameters { a1, a2, .. } = self.parameters;
        let d = self.parameters.determinant();
        Matrix2::new(a1 / d, -a2 / d, -a2 / d, a1 / d)
    }

    /// Nonlinear functions [f3, f4] of eq. (18) [rad/s²]: what the fuzzy systems approximate.
    ///
    /// ```text
    /// f3 = ( a2 a5 sgn(w2) + a2 a3 w1² - a2 a3 w1 w2 + a1 a3 w1 w2 - a1 a3 w2² - a1 a4 sgn(w1)) / D
    /// f4 = (-a1 a5 sgn(w2) - a1 a3 w1² + a1 a3 w1 w2 - a2 a3 w1 w2 + a2 a3 w2² + a2 a4 sgn(w1)) / D
    /// D = a1² - a2²
    /// ```
    ///
    /// Deviation: the transcription lost the leading minus of f4 and the sign of its last term.
    #[must_use]
    pub fn f(&self, state: &State) -> Vector2<f64> {
        let BaseParameters { a1, a2, a3, a4, a5 } = self.parameters;
        let [w1, w2] = state.omega;
        let d = self.parameters.determinant();
        // eq. (18)
        let f3 = (a2 * a5 * sgn(w2) + a2 * a3 * w1 * w1 - a2 * a3 * w1 * w2 + a1 * a3 * w1 * w2
            - a1 * a3 * w2 * w2
            - a1 * a4 * sgn(w1))
            / d;
        let f4 = (-a1 * a5 * sgn(w2) - a1 * a3 * w1 * w1 + a1 * a3 * w1 * w2 - a2 * a3 * w1 * w2
            + a2 * a3 * w2 * w2
            + a2 * a4 * sgn(w1))
            / d;
        Vector2::new(f3, f4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix4, Matrix4x2, Vector4};
    use proptest::prelude::*;

    impl StateSpace {
        /// Matrix A of eq. (18) [1/s]: the derivatives of the angles are the speeds.
        fn a() -> Matrix4<f64> {
            let mut a = Matrix4::zeros();
            a[(0, 2)] = 1.0;
            a[(1, 3)] = 1.0;
            a
        }

        /// Matrix B of eq. (18) \[1\]: f and the input act on the speeds.
        fn b() -> Matrix4x2<f64> {
            let mut b = Matrix4x2::zeros();
            b[(2, 0)] = 1.0;
            b[(3, 1)] = 1.0;
            b
        }

        /// Rate of change x' [rad/s, rad/s, rad/s², rad/s²] for input torques [N m], eq. (17).
        fn derivative(&self, state: &State, torque: [f64; 2]) -> Vector4<f64> {
            let x = Vector4::new(state.alpha[0], state.alpha[1], state.omega[0], state.omega[1]);
            let u = Vector2::from(torque);
            Self::a() * x + Self::b() * (self.f(state) + self.g() * u)
        }
    }

    proptest! {
        #[test]
        fn the_state_space_form_agrees_with_the_closed_form(
            a1 in 1e-4..1.0_f64, k2 in -0.9..0.9_f64, k3 in -0.5..0.5_f64,
            a4 in 0.0..1.0_f64, a5 in 0.0..1.0_f64,
            x in prop::array::uniform4(-30.0..30.0_f64),
            torque in prop::array::uniform2(-2.0..2.0_f64),
        ) {
            let a = BaseParameters { a1, a2: k2 * a1, a3: k3 * a1, a4, a5 };
            let state = State { alpha: [x[0], x[1]], omega: [x[2], x[3]] };
            let [dw1, dw2] = a.forward(&state, torque);
            let rate = StateSpace::new(a).derivative(&state, torque);
            prop_assert_eq!([rate[0], rate[1]], state.omega);
            // sums of twelve products of this size, divided by D >= 0.19 a1²
            let size = (a4 + a5 + 4.0 + a.a3.abs() * 4.0 * 900.0) * a1 / a.determinant();
            prop_assert!((rate[2] - dw1).abs() <= 4e-15 * size, "{} {}", rate[2], dw1);
            prop_assert!((rate[3] - dw2).abs() <= 4e-15 * size, "{} {}", rate[3], dw2);
        }
    }

    #[test]
    fn the_gain_is_the_inverse_of_the_mass_matrix() {
        let a = BaseParameters { a1: 0.03, a2: -0.01, a3: 0.0, a4: 0.0, a5: 0.0 };
        let mass = Matrix2::new(a.a1, a.a2, a.a2, a.a1);
        let identity = mass * StateSpace::new(a).g();
        // four products of numbers of size 1
        assert!((identity - Matrix2::identity()).abs().max() < 1e-15);
    }
}
