//! A constant bias of motor or torque sensor.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// The recorded torque exceeds the real one by a constant on each wheel.
///
/// ```text
/// o1   on wheel 1        (o = recorded minus real)
/// o2   on wheel 2
/// ```
/// Derived here: mass dω + ... = M_real = M_recorded - o, and o goes to the left-hand side.
#[derive(Clone, Debug, Default)]
pub struct TorqueOffset;

impl Physics for TorqueOffset {
    fn description(&self) -> Description {
        Description {
            id: "torque_offset".into(),
            title: "Torque offset".into(),
            equation: "o1 on wheel 1, o2 on wheel 2 (recorded minus real torque)".into(),
            cause: "bias of the torque sensor, the current sensor or the amplifier".into(),
            signature: "constant residual torque, the same at every speed and at rest".into(),
            excitation: "driving forward and backward; without reversals a4 and a5 absorb it"
                .into(),
            equivalent: vec!["coulomb_asymmetry".into()],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let range = (-1e3, 1e3);
        vec![
            ParameterSpec::linear("o1", "torque offset, wheel 1", "N m", range, 0.01),
            ParameterSpec::linear("o2", "torque offset, wheel 2", "N m", range, 0.01),
        ]
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn terms<T: Real>(&self, _x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: [p[0], p[1]], ..Terms::zero() }
    }
}
