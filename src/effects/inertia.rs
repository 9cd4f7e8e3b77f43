//! Inertia of wheels and body: the base of every model.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Inertia of the two wheels and the body they carry.
///
/// ```text
/// a1 dw1 + a2 dw2   on wheel 1
/// a2 dw1 + a1 dw2   on wheel 2
/// ```
/// Source: paper, eq. (14).
#[derive(Clone, Debug, Default)]
pub struct Inertia;

impl Physics for Inertia {
    fn description(&self) -> Description {
        Description {
            id: "inertia".into(),
            title: "Inertia".into(),
            equation: "a1 dw1 + a2 dw2 on wheel 1, a2 dw1 + a1 dw2 on wheel 2".into(),
            cause: "mass and moments of inertia of wheels and body, seen at the wheels".into(),
            signature: "torque in proportion to acceleration; a2 couples the wheels".into(),
            excitation: "speeding up and braking; a1 + a2 straight, a1 - a2 in pivots".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![
            ParameterSpec::linear("a1", "own inertia of a wheel", "kg m^2", (0.0, 1e4), 0.03),
            ParameterSpec::linear("a2", "coupling inertia", "kg m^2", (-1e4, 1e4), -0.002),
        ]
    }

    /// Keeps a1 above |a2|, so that every motion has positive kinetic energy. Straight driving identifies
    /// only a1 + a2, pivots a1 - a2: the larger of the two is kept if both are free.
    fn start(&self, p: &mut [f64], free: &[bool]) {
        if p[0] > 1.05 * p[1].abs() {
            return;
        }
        let larger = p[0] + p[1].abs();
        if free[1] && larger > 0.0 {
            (p[0], p[1]) = (larger * 1.1 / 2.1, larger / 2.1 * p[1].signum());
        } else {
            p[0] = (1.1 * p[1].abs()).max(1e-6);
        }
    }

    fn energy(&self) -> Energy {
        Energy::Stores
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { mass: [p[0], p[1], p[0]], ..Terms::zero() } // eq. (14)
    }
}
