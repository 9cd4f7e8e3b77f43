//! Friction that falls while the robot warms up.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Terms};
use crate::math::Real;

/// A Coulomb level that decays from the start of the recording.
///
/// ```text
/// level of wheel i:  + fw exp(-t/tw)
/// ```
/// Source: first-order warm-up of the lubricant (Newton's law of cooling), the viscosity taken as
/// linear in the temperature. Time counts from the first sample of each recording.
#[derive(Clone, Debug, Default)]
pub struct FrictionWarmup;

impl Physics for FrictionWarmup {
    fn description(&self) -> Description {
        Description {
            id: "friction_warmup".into(),
            title: "Warm-up of friction".into(),
            equation: "level fw exp(-t/tw) on each wheel".into(),
            cause: "cold grease and gears that warm up while driving".into(),
            signature: "friction is higher at the start of the recording and settles".into(),
            excitation: "a recording from a cold start, several times tw long".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (level, time) = ((0.0, 1e3), (0.5, 1e3));
        vec![
            ParameterSpec::linear("fw", "extra level at the start", "N m", level, 0.03),
            ParameterSpec::shape("tw", "time constant of warming up", "s", time, 10.0),
        ]
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let level = p[0] * (-x.t / p[1]).exp();
        let zero = T::from(0.0);
        Terms { level: [level, level, zero, zero], ..Terms::zero() }
    }
}
