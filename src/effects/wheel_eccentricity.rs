//! A torque with one period per turn of the wheel.

use super::torque_ripple::periodic;
use super::wave::wheel_waves;
use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, Wave};
use crate::math::Real;

/// An eccentric or unbalanced wheel: a torque that varies sinusoidally once per turn.
///
/// ```text
/// es1 sin(alpha1) + ec1 cos(alpha1)   on wheel 1
/// es2 sin(alpha2) + ec2 cos(alpha2)   on wheel 2
/// ```
/// Derived here: a wheel whose axle lies e off its centre lifts the load N by e cos(alpha +
/// phase), which needs the torque -N e sin(alpha + phase) (first order in e; the speed terms of
/// order e w^2 are left out). The same columns as `torque_ripple` of order 1.
///
/// Where an angle is an estimate with variance P the factor exp(-P/2) takes the mean.
#[derive(Clone, Debug, Default)]
pub struct WheelEccentricity;

impl Physics for WheelEccentricity {
    fn description(&self) -> Description {
        Description {
            id: "wheel_eccentricity".into(),
            title: "Eccentric wheel".into(),
            equation: "es sin(alpha) + ec cos(alpha) on each wheel".into(),
            cause: "axle off the wheel's centre, unbalanced wheel, bent shaft".into(),
            signature: "residual torque that repeats once per turn of a wheel".into(),
            excitation: "slow driving over many turns; the same as a torque ripple of order 1"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let amplitude =
            |symbol, meaning| ParameterSpec::linear(symbol, meaning, "N m", (-1e3, 1e3), 0.01);
        vec![
            amplitude("es1", "sine amplitude, wheel 1"),
            amplitude("ec1", "cosine amplitude, wheel 1"),
            amplitude("es2", "sine amplitude, wheel 2"),
            amplitude("ec2", "cosine amplitude, wheel 2"),
        ]
    }

    /// With less than one period driven, the torque cannot be distinguished from an offset.
    fn admissible(&self, scale: &Scale) -> bool {
        scale.angle >= std::f64::consts::TAU
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn waves(&self, _p: &[f64]) -> Vec<Wave> {
        wheel_waves(1.0)
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        periodic(T::from(1.0), x, &[p[0], p[1], p[2], p[3]])
    }
}
