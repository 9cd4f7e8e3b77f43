//! Friction that decreases while the robot warms up.

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms, geometric};
use crate::math::Real;

/// A Coulomb level that decays from the start of the recording.
///
/// ```text
/// level of wheel i:  + (fw ± fwd) exp(-t/tw),   + on wheel 1, - on wheel 2
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
            equation: "level (fw +- fwd) exp(-t/tw) on wheel 1, 2".into(),
            cause: "cold grease and gears that warm up while driving".into(),
            signature: "friction decays from a higher initial value to a constant".into(),
            excitation: "a recording from a cold start, several times tw long".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        let (level, time) = ((0.0, 1e3), (1e-2, 1e5));
        vec![
            ParameterSpec::linear("fw", "extra level at the start", "N m", level, 0.03),
            ParameterSpec::shape("tw", "time constant of warming up", "s", time, 10.0),
            ParameterSpec::linear(
                "fwd",
                "half the difference of fw between wheels 1 and 2",
                "N m",
                (-1e3, 1e3),
                0.0,
            ),
        ]
    }

    /// From a transient at the start to a drift over the whole recording.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        geometric(0.07, 1.3, 5).into_iter().map(|share| vec![share * scale.duration]).collect()
    }

    /// A transient shorter than two hundredths of a recording is an artefact of its start, and one of ten
    /// times its length is not distinguishable from a constant and a line (judgement).
    fn limits(&self, scale: &Scale) -> Vec<(f64, f64)> {
        let mut limits: Vec<(f64, f64)> = self.parameters().iter().map(|s| s.range).collect();
        limits[1] = (0.02 * scale.duration, 10.0 * scale.duration);
        limits
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let (decay, zero) = ((-x.t / p[1]).exp(), T::from(0.0));
        let level = [(p[0] + p[2]) * decay, (p[0] - p[2]) * decay, zero, zero];
        Terms { level, ..Terms::zero() }
    }
}
