//! Recordings whose sensors show no motion that a model could be fitted to.

use std::fmt;

use crate::math::Moments;
use crate::recording::{Recording, shows_no_motion};

/// Standard deviations by which the mean of a speed differs from zero if the wheel turns: noise at rest is about zero.
const TURNS: f64 = 3.0;

/// Why recordings show no motion: the sensors of both wheels are constant, or noise that is not correlated with the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoMotion {
    /// About zero: the wheels do not move.
    Rest,
    /// About a speed: at least one wheel turns steadily in a recording.
    Steady,
}

impl NoMotion {
    /// `None` if a wheel shows a motion in any recording.
    pub(super) fn of<'a>(recordings: impl Iterator<Item = &'a Recording>) -> Option<Self> {
        let mut found = Self::Rest;
        for recording in recordings {
            if !(0..2).all(|i| shows_no_motion(recording, i)) {
                return None;
            }
            if (0..2).any(|i| turns(recording, i)) {
                found = Self::Steady;
            }
        }
        Some(found)
    }
}

/// Whether a wheel turns at a speed that hardly changes.
fn turns(recording: &Recording, i: usize) -> bool {
    let Moments { mean, variance, .. } = Moments::of(recording.omega().iter().map(|w| w[i]));
    mean.abs() > TURNS * variance.sqrt()
}

impl fmt::Display for NoMotion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Rest => {
                "the wheels do not move in any training recording: their angles and speeds are constant, or noise that is \
                 not correlated with the input. Record a motion of both wheels; if they did move, check which columns are \
                 assigned to alpha1, alpha2, dalpha1 and dalpha2, and the sensors"
            }
            Self::Steady => {
                "the speeds hardly change in any training recording: the wheels turn steadily, and what changes is noise that \
                 is not correlated with the input. Without acceleration there is nothing to identify inertia and friction \
                 from: record starts, stops and turns"
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn a_steady_speed_is_no_rest_and_neither_is_a_motion_to_identify_from() {
        let noise = |t: f64| (1e4 * t * t).sin();
        let of = |speed: &dyn Fn(f64) -> f64| {
            let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
            let omega = t.iter().map(|&t| [speed(t), speed(t + 3.0)]).collect();
            let torque = t.iter().map(|t| [0.5 + 0.1 * t.sin(), 0.5 + 0.1 * t.cos()]).collect();
            let channels = Channels { t, alpha: None, omega: Some(omega), torque };
            Recording::new("run.csv", channels, DriveUnit::Ampere).unwrap()
        };
        let rest = of(&|t| 0.02 * noise(t));
        let steady = of(&|t| 3.5 + 0.5 * noise(t));
        let driven = of(&|t| 3.5 + 0.5 * t.sin());
        assert_eq!(NoMotion::of([&rest].into_iter()), Some(NoMotion::Rest));
        assert_eq!(NoMotion::of([&rest, &steady].into_iter()), Some(NoMotion::Steady));
        assert_eq!(NoMotion::of([&steady, &driven].into_iter()), None);
    }
}
