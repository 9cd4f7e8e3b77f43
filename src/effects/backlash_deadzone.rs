//! A dead zone of the torque.

use super::{Description, Energy, ParameterSpec, Physics, Scale, geometric};
use crate::math::Real;

/// Dead zone of the input: small torques do not reach the wheel, larger ones are reduced.
///
/// ```text
/// M = sgn(M_recorded) max(|M_recorded| - d, 0)   on each wheel
///   = M_recorded - clip(M_recorded, -d, d)
/// ```
/// Source: the usual quasi-static dead zone, an approximation of gear backlash that is
/// traversed instantaneously.
///
/// Deviation: the hysteresis of real backlash (the angle of the play) is not modelled.
#[derive(Clone, Debug, Default)]
pub struct BacklashDeadzone;

impl Physics for BacklashDeadzone {
    fn description(&self) -> Description {
        Description {
            id: "backlash_deadzone".into(),
            title: "Dead zone of the torque".into(),
            equation: "M = sgn(recorded M) max(|recorded M| - d, 0)".into(),
            cause: "gear play, dead band of the amplifier".into(),
            signature: "residual torque that steps where the torque changes sign".into(),
            excitation: "hard braking, so that torque and speed have opposite signs; otherwise \
                         a4 and a5 absorb it"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("d", "half width of the dead zone", "N m", (0.0, 1e3), 0.02)]
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let shares = geometric(0.02, 0.8, 5).into_iter();
        shares.map(|share| vec![share * scale.torque_rms()]).collect()
    }

    fn several_starts(&self) -> bool {
        true
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn input<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let pass = |m: T| m - m.max(-p[0]).min(p[0]);
        Some(m.iter().map(|row| row.map(pass)).collect())
    }
}
