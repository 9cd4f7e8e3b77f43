//! How a torque that the model lacks may act.

use super::unexplained_torque::Variable;

/// How a torque that the model lacks may act on a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Acting {
    /// As a torque of its own.
    Torque,
    /// Against the motion: the torque changes its sign with the speed of the wheel.
    Resistance,
    /// As a share of the input: the torque is proportional to it.
    Gain,
}

impl Acting {
    /// How a torque may act that depends on `variable`. What depends on a speed, a turn rate or an input is seen over
    /// them whatever its sign; what depends on the place or the time may change it with the direction of the motion.
    pub(super) const fn of(variable: Variable) -> &'static [Self] {
        match variable {
            Variable::Heading | Variable::Alpha1 | Variable::Alpha2 => {
                &[Self::Torque, Self::Resistance]
            }
            Variable::Time => &[Self::Torque, Self::Resistance, Self::Gain],
            _ => &[Self::Torque],
        }
    }

    /// What the torque on a wheel of this speed [rad/s] and input [N m] is proportional to.
    pub(super) fn per(self, omega: f64, input: f64) -> f64 {
        match self {
            Self::Torque => 1.0,
            Self::Resistance => omega.signum(),
            Self::Gain => input,
        }
    }
}
