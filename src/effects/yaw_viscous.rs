//! Yaw resistance proportional to the turn rate.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Resistance to turning in proportion to the turn rate.
///
/// ```text
/// d_y (w1 - w2)    on wheel 1
/// -d_y (w1 - w2)   on wheel 2
/// ```
/// Derived here: a torque D β_dot against β_dot = r/(2 l1) (w1 - w2) takes the power D β_dot^2,
/// so d_y = D r^2/(4 l1^2).
#[derive(Clone, Debug, Default)]
pub struct YawViscous;

impl Physics for YawViscous {
    fn description(&self) -> Description {
        Description {
            id: "yaw_viscous".into(),
            title: "Viscous yaw resistance".into(),
            equation: "d_y (w1 - w2) on wheel 1, -d_y (w1 - w2) on wheel 2".into(),
            cause: "creep of the tyres in turns, a greased caster swivel".into(),
            signature: "residual torque of opposite sign on the wheels, in proportion to turn rate"
                .into(),
            excitation: "curves and pivots at several turn rates".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear("d_y", "yaw resistance", "N m s/rad", (0.0, 1e3), 0.002)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let torque = p[0] * (x.omega[0] - x.omega[1]);
        Terms { torque: [torque, -torque], ..Terms::zero() }
    }
}
