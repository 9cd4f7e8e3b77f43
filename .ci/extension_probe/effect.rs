//! A dummy effect, by the recipe of CONTRIBUTING.md; `.ci/extension` adds it to a scratch copy.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// Drag that grows with the cube of the wheel speed.
#[derive(Default)]
pub struct ExtensionProbe;

impl Physics for ExtensionProbe {
    fn description(&self) -> Description {
        Description {
            id: "extension_probe".into(),
            title: "cubic drag".into(),
            equation: "k_probe w^3 on each wheel".into(),
            cause: "none: a test of the recipe".into(),
            signature: "residual torque that grows with the cube of the wheel speed".into(),
            excitation: "fast and slow driving".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let unit = "N m s^3/rad^3";
        vec![ParameterSpec::linear("k_probe", "drag coefficient", unit, (0.0, 1.0), 1e-5)]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms { torque: x.omega.map(|w| p[0] * w * w * w), ..Terms::zero() }
    }
}
