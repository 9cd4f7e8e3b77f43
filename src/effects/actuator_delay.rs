//! Pure delay between the recorded torque and the wheel.

use super::{Change, Description, Energy, ParameterSpec, Physics, Scale, geometric};
use crate::math::{Real, interpolate_wheels};

/// The torque acts later than it was recorded.
///
/// ```text
/// M(t) = M_recorded(t - delay)
/// ```
/// Linear interpolation between the samples; before the start the first sample, after the end
/// (for a negative delay) the last.
///
/// Source: definition of a transport delay.
#[derive(Clone, Debug, Default)]
pub struct ActuatorDelay;

impl Physics for ActuatorDelay {
    fn description(&self) -> Description {
        Description {
            id: "actuator_delay".into(),
            title: "Actuator delay".into(),
            equation: "M(t) = recorded M(t - delay)".into(),
            cause: "bus and controller cycles between the recording and the motor".into(),
            signature: "residual torque in proportion to the rate of change of the torque".into(),
            excitation: "quick changes of the torque (a delay below about 8 ms looks like a lag)"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("delay", "delay", "s", (0.0, 1.0), 0.02)]
    }

    fn change(&self) -> Change {
        Change::TimeShift
    }

    fn is_delay(&self) -> bool {
        true
    }

    /// From a fraction of a sample to the delay of a slow bus or a slow current loop.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let longest = 0.15_f64.max(4.0 * scale.step);
        geometric(0.25 * scale.step, longest, 6).into_iter().map(|time| vec![time]).collect()
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn input<T: Real>(&self, t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let last = m.len().checked_sub(1)?;
        let mut k = 0;
        let delayed = t.iter().map(|&t_now| {
            let at = -p[0] + t_now;
            while k < last && t[k + 1] <= at.value() {
                k += 1;
            }
            if k == last || at.value() <= t[0] {
                return m[k];
            }
            interpolate_wheels([t[k], t[k + 1]], [m[k], m[k + 1]], at)
        });
        Some(delayed.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_samples_are_interpolated_and_the_start_is_held() {
        let t = [0.0, 0.1, 0.3, 0.4];
        let m = [[1.0, 0.0], [2.0, 0.0], [6.0, 0.0], [8.0, 0.0]];
        let real: Vec<f64> =
            ActuatorDelay.input(&t, &m, &[0.15]).unwrap().iter().map(|m| m[0]).collect();
        // at t - 0.15 = -0.15, -0.05, 0.15, 0.25
        for (found, expected) in real.iter().zip([1.0, 1.0, 3.0, 5.0]) {
            assert!((found - expected).abs() < 1e-14, "{real:?}");
        }
        assert_eq!(ActuatorDelay.input(&t, &m, &[0.0]).unwrap(), m.to_vec());
    }
}
