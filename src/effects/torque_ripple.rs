//! Cogging: a torque that is periodic in the wheel angle.

use super::wave::wheel_waves;
use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, Wave};
use crate::math::Real;

/// A torque with n periods per turn of the wheel, with separate phases on the two wheels.
///
/// ```text
/// rs1 sin(n alpha1) + rc1 cos(n alpha1)   on wheel 1
/// rs2 sin(n alpha2) + rc2 cos(n alpha2)   on wheel 2
/// ```
/// Amplitude sqrt(rs^2 + rc^2), phase atan2(rc, rs). The order n is an integer of at least 2: it
/// is rounded, follows the four amplitudes and has no derivative. Order 1 is
/// `wheel_eccentricity`.
///
/// Source: Fourier series of cogging and commutation ripple. For an estimated angle with
/// variance P the mean over N(alpha, P) is used: the factor exp(-n^2 P/2).
#[derive(Clone, Debug, Default)]
pub struct TorqueRipple;

impl Physics for TorqueRipple {
    fn description(&self) -> Description {
        Description {
            id: "torque_ripple".into(),
            title: "Torque ripple".into(),
            equation: "rs sin(n alpha) + rc cos(n alpha) on each wheel, n a whole number above 1"
                .into(),
            cause: "cogging and commutation of the motor, teeth of the gear".into(),
            signature: "residual torque that repeats n times per turn of a wheel".into(),
            excitation: "slow driving over many turns; n = 1 is wheel_eccentricity".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let amplitude =
            |symbol, meaning| ParameterSpec::linear(symbol, meaning, "N m", (-1e3, 1e3), 0.01);
        vec![
            amplitude("rs1", "sine amplitude, wheel 1"),
            amplitude("rc1", "cosine amplitude, wheel 1"),
            amplitude("rs2", "sine amplitude, wheel 2"),
            amplitude("rc2", "cosine amplitude, wheel 2"),
            ParameterSpec::whole("n", "order, a whole number", (2.0, 60.0), 6.0),
        ]
    }

    /// Orders of which at least one full period was driven, and whose half periods are resolved by the rows
    /// at a quarter of the top speed: a wheel at low speed is affected most, and the simulation interpolates
    /// the angle.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let resolved = |n: f64| n * 0.25 * scale.speed * scale.step < std::f64::consts::PI;
        let driven = |n: f64| n * scale.angle >= std::f64::consts::TAU;
        let orders = (2..=60).map(f64::from).filter(|n| resolved(*n) && driven(*n));
        orders.map(|n| vec![n]).collect()
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn waves(&self, p: &[f64]) -> Vec<Wave> {
        wheel_waves(p[4].round())
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        periodic(p[4].round(), x, &[p[0], p[1], p[2], p[3]])
    }
}

/// The torques of one order; `p`: sine and cosine amplitude of wheel 1, then of wheel 2.
pub(super) fn periodic<T: Real>(order: T, x: &Motion<T>, p: &[T; 4]) -> Terms<T> {
    let mut terms = Terms::zero();
    for i in 0..2 {
        let angle = x.alpha[i] * order;
        let (sin, cos) = angle.sin_cos();
        let wave = p[2 * i] * sin + p[2 * i + 1] * cos;
        terms.torque[i] = if x.variance[i] == 0.0 {
            wave
        } else {
            wave * (order.squared() * (-0.5 * x.variance[i])).exp()
        };
    }
    terms
}
