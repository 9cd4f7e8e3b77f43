//! Viscous friction that differs between forward and backward.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms};
use crate::math::Real;

/// Viscous friction whose constant differs between the two directions of a wheel.
///
/// ```text
/// ba1 |w1|   on wheel 1
/// ba2 |w2|   on wheel 2
/// ```
/// Half the difference of the two constants: with `viscous_friction` the constant is b + ba forward and
/// b - ba backward.
///
/// Source: direction-dependent friction of the EMPS benchmark, Janot, Gautier and Brunot (2019).
#[derive(Clone, Debug, Default)]
pub struct ViscousAsymmetry;

/// Smallest share of the moving rows in the less frequent direction: with fewer rows the two constants are
/// not distinguishable.
const BOTH_WAYS: f64 = 0.05;

impl Physics for ViscousAsymmetry {
    fn description(&self) -> Description {
        Description {
            id: "viscous_asymmetry".into(),
            title: "Direction-dependent viscous friction".into(),
            equation: "ba1 |w1| on wheel 1, ba2 |w2| on wheel 2".into(),
            cause: "gears, seals or cables that resist more in one direction".into(),
            signature:
                "residual torque that grows with the speed and keeps its sign when the wheel \
                        reverses"
                    .into(),
            excitation: "different steady speeds in both directions".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let linear = |symbol, meaning| {
            ParameterSpec::linear(symbol, meaning, "N m s/rad", (-1e3, 1e3), 0.001)
        };
        vec![
            linear("ba1", "half the difference of the constants, wheel 1"),
            linear("ba2", "half the difference of the constants, wheel 2"),
        ]
    }

    /// Without reversals it is another viscous friction.
    fn admissible(&self, scale: &Scale) -> bool {
        scale.backward > BOTH_WAYS
    }

    /// Backward it drives the wheel; it is dissipative only together with a viscous constant above |ba|.
    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: [p[0] * x.omega[0].abs(), p[1] * x.omega[1].abs()], ..Terms::zero() }
    }
}
