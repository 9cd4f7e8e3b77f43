//! A dead zone of the moment.

use super::{Description, Energy, ParameterSpec, Physics};
use crate::math::{Real, sgn};

/// Small moments do not reach the wheel, larger ones arrive diminished.
///
/// ```text
/// M = sgn(M_recorded) max(|M_recorded| - d, 0)   on each wheel
/// ```
/// Source: the usual quasi-static dead zone, which stands for a gear play whose width in angle is
/// crossed at once.
///
/// Deviation: the hysteresis of real backlash (the angle of the play) is not modelled.
#[derive(Clone, Debug, Default)]
pub struct BacklashDeadzone;

impl Physics for BacklashDeadzone {
    fn description(&self) -> Description {
        Description {
            id: "backlash_deadzone".into(),
            title: "Dead zone of the moment".into(),
            equation: "M = sgn(recorded M) max(|recorded M| - d, 0)".into(),
            cause: "gear play, dead band of the amplifier".into(),
            signature: "missing moment that steps where the moment changes sign".into(),
            excitation: "hard braking, so that moment and speed have opposite signs; otherwise it \
                         hides in a4 and a5"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("d", "half width of the dead zone", "N m", (0.0, 1e3), 0.02)]
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_drive(&self) -> bool {
        true
    }

    fn drive<T: Real>(&self, _t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let pass = |m: T| {
            if m.value().abs() > p[0].value() { m - p[0] * sgn(m.value()) } else { T::from(0.0) }
        };
        Some(m.iter().map(|row| row.map(pass)).collect())
    }
}
