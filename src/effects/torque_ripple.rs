//! Cogging: a torque that repeats several times a turn.

use super::wave::wheel_waves;
use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, Wave};
use crate::math::Real;

/// A torque that repeats n times per turn of the wheel, with its own phase on each wheel.
///
/// ```text
/// rs1 sin(n alpha1) + rc1 cos(n alpha1)   on wheel 1
/// rs2 sin(n alpha2) + rc2 cos(n alpha2)   on wheel 2
/// ```
/// Amplitude sqrt(rs^2 + rc^2), phase atan2(rc, rs). The order n is a whole number from 2 up: it
/// is rounded, stands behind the four amplitudes and has no derivative. Order 1 is
/// `wheel_eccentricity`.
///
/// Source: Fourier series of cogging and commutation ripple. Where an angle is an estimate with
/// variance P the mean over N(alpha, P) is taken: the factor exp(-n^2 P/2).
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

    /// Orders of which a whole wave was driven, and of which rows at a quarter of the top speed see both halves:
    /// a wave moves a slow wheel most, and in between the simulation follows the angle.
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
        let wave = p[2 * i] * angle.sin() + p[2 * i + 1] * angle.cos();
        terms.torque[i] = if x.variance[i] == 0.0 {
            wave
        } else {
            wave * (order.squared() * (-0.5 * x.variance[i])).exp()
        };
    }
    terms
}
