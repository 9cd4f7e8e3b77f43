//! How an unmodelled torque acts: as an independent torque, as a resistance or in proportion to the input.

use super::unexplained_torque::Variable;

/// How an unmodelled torque acts on a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Acting {
    /// An independent torque.
    Torque,
    /// Resistance: the sign of the torque changes with that of the wheel speed.
    Resistance,
    /// The torque is proportional to the input.
    Gain,
}

impl Acting {
    /// The ways in which a torque that depends on `variable` may act. For speeds, turn rates and inputs a
    /// change of sign is visible in the curve itself; for angles and time it is not.
    pub(super) const fn of(variable: Variable) -> &'static [Self] {
        match variable {
            Variable::Heading | Variable::Alpha1 | Variable::Alpha2 => {
                &[Self::Torque, Self::Resistance]
            }
            Variable::Time => &[Self::Torque, Self::Resistance, Self::Gain],
            _ => &[Self::Torque],
        }
    }

    /// Factor of the torque on a wheel with this speed [rad/s] and input [N m]: 1, sgn ω or M.
    pub(super) fn per(self, omega: f64, input: f64) -> f64 {
        match self {
            Self::Torque => 1.0,
            Self::Resistance => omega.signum(),
            Self::Gain => input,
        }
    }
}
