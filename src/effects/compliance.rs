//! A torsional spring between motor and wheel.

use super::{Coupling, Description, Energy, Motion, ParameterSpec, Physics};
use crate::math::Real;

/// An elastic shaft, belt or tyre between the measured motor side and the rest of the robot.
///
/// ```text
/// Iz1 dw_i + friction = M_i - kt φ_i - dt (w_i - u_i),   dφ_i/dt = w_i - u_i
/// body (a1 - Iz1, a2, a3) at u = kt φ + dt (w - u)
/// ```
/// w is measured, u is the wheel speed behind the spring, φ its twist. Iz1 is the construction's
/// inertia of the wheel with all that turns behind the gear, nearly all of which is on the
/// motor's side.
///
/// Source: two-inertia drive with elastic shaft (Voigt element). Undamped frequency straight
/// ahead: sqrt(kt (1/Iz1 + 1/(a1 + a2 - Iz1))) rad/s.
#[derive(Clone, Debug, Default)]
pub struct Compliance;

impl Physics for Compliance {
    fn description(&self) -> Description {
        Description {
            id: "compliance".into(),
            title: "Compliant drive".into(),
            equation: "kt phi + dt (w - u) between motor side and body, dphi/dt = w - u".into(),
            cause: "elastic shaft, belt or tyre between the encoder and the floor".into(),
            signature: "wheel speed oscillates after steps of the moment".into(),
            excitation: "steps of the moment, a sampling rate well above the oscillation".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (spring, damper) = ((0.1, 1e3), (1e-4, 20.0));
        vec![
            ParameterSpec::shape("kt", "torsional stiffness", "N m/rad", spring, 5.0),
            ParameterSpec::shape("dt", "torsional damping", "N m s/rad", damper, 0.03),
        ]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn coupling<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Option<Coupling<T>> {
        let rotor = T::from(x.robot.construction.iz1_kg_m2);
        Some(Coupling { rotor, stiffness: p[0], damping: p[1] })
    }
}
