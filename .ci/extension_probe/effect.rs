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
            equation: "k_probe1 w1^3, k_probe2 w2^3".into(),
            cause: "none: a test of the recipe".into(),
            signature: "residual torque that grows with the cube of the wheel speed".into(),
            excitation: "fast and slow driving".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let unit = "N m s^3/rad^3";
        let of = |symbol| ParameterSpec::linear(symbol, "drag coefficient", unit, (0.0, 1.0), 1e-5);
        vec![of("k_probe1"), of("k_probe2")]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        Terms {
            torque: [0, 1].map(|i| p[i] * x.omega[i] * x.omega[i] * x.omega[i]),
            ..Terms::zero()
        }
    }
}
