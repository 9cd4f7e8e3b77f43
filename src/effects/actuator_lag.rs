//! First-order lag between the recorded torque and the wheel.

use super::{Change, Description, Energy, ParameterSpec, Physics, Scale, geometric};
use crate::math::Real;

/// First-order lag of the input, exact for a piecewise linear torque.
///
/// ```text
/// tau dM/dt + M = M_recorded,   M(start) = M_recorded(start)
/// M[k+1] = e M[k] + (s - e) M_rec[k] + (1 - s) M_rec[k+1]
/// e = exp(-h/tau),  s = (1 - e) tau/h,  h = t[k+1] - t[k]
/// ```
/// Derived here: solution of the linear equation over one step with a linear right-hand side
/// (first-order hold). The steps may differ in length.
///
/// Deviation: the simulation also interpolates the lagged torque linearly between the samples.
#[derive(Clone, Debug, Default)]
pub struct ActuatorLag;

/// Number of time constants after which the earlier torque is negligible (e^-40 = 4e-18).
const FORGOTTEN: f64 = 40.0;

impl Physics for ActuatorLag {
    fn description(&self) -> Description {
        Description {
            id: "actuator_lag".into(),
            title: "Actuator lag".into(),
            equation: "tau dM/dt + M = recorded M".into(),
            cause: "motor inductance, current loop, a low-pass filter between recording and wheel"
                .into(),
            signature: "residual torque in proportion to the rate of change of the torque".into(),
            excitation: "quick changes of the torque (a lag below about 8 ms looks like a delay)"
                .into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![ParameterSpec::shape("tau", "time constant", "s", (0.0, 2.0), 0.03)]
    }

    fn change(&self) -> Change {
        Change::TimeShift
    }

    /// From a fraction of a sample to the time constant of a slow bus or a slow current loop.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let longest = 0.3_f64.max(4.0 * scale.step);
        geometric(0.25 * scale.step, longest, 6).into_iter().map(|time| vec![time]).collect()
    }

    fn energy(&self) -> Energy {
        Energy::Supplies
    }

    fn acts_on_input(&self) -> bool {
        true
    }

    fn input<T: Real>(&self, t: &[f64], m: &[[T; 2]], p: &[T]) -> Option<Vec<[T; 2]>> {
        let mut real: Vec<[T; 2]> = Vec::with_capacity(m.len());
        for (k, &end) in m.iter().enumerate() {
            let Some(&last) = real.last() else {
                real.push(end);
                continue;
            };
            let [left, mean] = decay(p[0], t[k] - t[k - 1]);
            let start = m[k - 1];
            real.push(
                [0, 1].map(|i| left * last[i] + (mean - left) * start[i] + (-mean + 1.0) * end[i]),
            );
        }
        Some(real)
    }
}

/// `[e, s]` of [`ActuatorLag`], continuous at tau = 0.
fn decay<T: Real>(tau: T, step: f64) -> [T; 2] {
    if tau.value() * FORGOTTEN <= step {
        return [T::from(0.0), tau / step];
    }
    let left = (T::from(-step) / tau).exp();
    [left, (-left + 1.0) * tau / step]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_samples_of_a_ramp_follow_the_exact_lagged_ramp() {
        let t = [0.0, 0.01, 0.013, 0.05, 0.4, 0.41];
        let m: Vec<_> = t.iter().map(|t| [3.0 * t + 0.2, -t]).collect();
        let tau = 0.03;
        let real = ActuatorLag.input(&t, &m, &[tau]).unwrap();
        for (k, t) in t.iter().enumerate() {
            // ramp of slope c: c (t - tau + tau exp(-t/tau)) above its start
            let ramp = t - tau + tau * (-t / tau).exp();
            assert!((real[k][0] - (0.2 + 3.0 * ramp)).abs() < 1e-15, "rounding of numbers near 1");
            assert!((real[k][1] + ramp).abs() < 1e-15);
        }
    }

    #[test]
    fn without_a_time_constant_the_torque_is_unchanged() {
        let m = vec![[0.1, 0.3], [0.4, -0.2], [0.0, 0.0]];
        assert_eq!(ActuatorLag.input(&[0.0, 0.1, 0.2], &m, &[0.0]).unwrap(), m);
    }
}
