//! The centre of mass off the centre line.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// A centre of mass to the side of the centre line: the wheels have unequal inertias.
///
/// ```text
/// m dw1    on wheel 1
/// -m dw2   on wheel 2,     m = m4 e r^2/(2 l1), e distance of S to the right of the centre line
/// ```
/// Derived here: S moves along the heading at v_A + e β_dot, so the kinetic energy has the term
/// m4 e v_A β_dot = m4 e r^2/(4 l1) (w1^2 - w2^2). No velocity term follows from e: the torque
/// about A of the inertial force at S has only e dv_A/dt in addition to the base model. The e^2 in the yaw
/// inertia is part of a1 and a2.
#[derive(Clone, Debug, Default)]
pub struct LateralCom;

impl Physics for LateralCom {
    fn description(&self) -> Description {
        Description {
            id: "lateral_com".into(),
            title: "Lateral centre of mass".into(),
            equation: "m dw1 on wheel 1, -m dw2 on wheel 2".into(),
            cause: "the centre of mass lies to the right (m > 0) or left of the centre line".into(),
            signature: "residual torque in proportion to acceleration, of opposite sign on the \
                        wheels"
                .into(),
            excitation: "hard starts and brakes, 35 rad/s^2 and more".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::linear(
            "m",
            "difference of the wheels' inertias, halved",
            "kg m^2",
            (-1e2, 1e2),
            5e-4,
        )]
    }

    fn energy(&self) -> Energy {
        Energy::Stores
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { mass: [p[0], T::from(0.0), -p[0]], ..Terms::zero() }
    }
}
