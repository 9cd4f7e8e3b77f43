//! Dry resistance to turning.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Coulomb resistance to yaw: tyres of finite width and a caster scrub over the floor in a turn.
///
/// ```text
/// f_t sgn(β_dot)    on wheel 1
/// -f_t sgn(β_dot)   on wheel 2      (set-valued while the robot does not turn)
/// ```
/// Derived here: a scrub torque T opposing β_dot = r/(2 l1) (w1 - w2) dissipates the power T |β_dot|,
/// so f_t = T r/(2 l1).
#[derive(Clone, Debug, Default)]
pub struct TurningScrub;

impl Physics for TurningScrub {
    fn description(&self) -> Description {
        Description {
            id: "turning_scrub".into(),
            title: "Turning scrub".into(),
            equation: "f_t sgn(beta_dot) on wheel 1, -f_t sgn(beta_dot) on wheel 2".into(),
            cause: "tyres or caster scrub sideways over the floor in turns".into(),
            signature:
                "residual torque of opposite sign on the two wheels that flips with the turn".into(),
            excitation: "curves to both sides and straight driving".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("f_t", "scrub level at each wheel", "N m", (0.0, 1e3), 0.02)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        let zero = T::from(0.0);
        Terms { level: [zero, zero, p[0], zero], ..Terms::zero() }
    }
}
