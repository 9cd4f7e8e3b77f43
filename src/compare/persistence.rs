//! Constant speeds as the reference for the skill of a simulation.

use super::error::{simulate_recording, window_rms};
use crate::recording::Recording;
use crate::robot::State;
use crate::simulate::{Dynamics, Hold, Input, SimulateError};

/// Wheels that keep their speed, whatever acts on them.
struct ConstantSpeed;

impl Dynamics for ConstantSpeed {
    fn acceleration(
        &self,
        _t: f64,
        _state: &State,
        _torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError> {
        Ok([0.0; 2])
    }

    fn simulate(&self, input: &Input, start: State) -> Result<Vec<State>, SimulateError> {
        let first = input.t.first().copied().unwrap_or_default();
        let at = |t: &f64| {
            let alpha = [0, 1].map(|i| start.alpha[i] + start.omega[i] * (t - first));
            State { alpha, ..start }
        };
        Ok(input.t.iter().map(at).collect())
    }
}

/// Root mean square error of the speeds over windows of 2 s if they stayed as they are at the start of each window
/// [rad/s]: what a model must beat to have predicted anything. Zero without windows.
///
/// Source: the persistence forecast, the usual reference of skill scores (Murphy, Mon. Weather Rev. 116, 1988).
#[must_use]
pub fn persistence_rms(recording: &Recording, hold: Hold) -> f64 {
    let simulated = simulate_recording(&ConstantSpeed, recording, hold);
    simulated.map_or(0.0, |s| window_rms(recording, &s.windows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn speeds_that_change_evenly_differ_from_constant_ones_by_their_slope() {
        // w = 3 t over windows of 2 s: the error is 3 τ, its root mean square 3·2/√3
        let t: Vec<f64> = (0..=600).map(|k| 0.01 * f64::from(k)).collect();
        let omega: Vec<[f64; 2]> = t.iter().map(|t| [3.0 * t; 2]).collect();
        let alpha: Vec<[f64; 2]> = t.iter().map(|t| [1.5 * t * t; 2]).collect();
        let torque = vec![[0.1; 2]; t.len()];
        for (alpha, omega) in [(Some(alpha.clone()), Some(omega)), (Some(alpha), None)] {
            let channels = Channels { t: t.clone(), alpha, omega, torque: torque.clone() };
            let r = Recording::new("ramp", channels, DriveUnit::NewtonMetre).unwrap();
            let rms = persistence_rms(&r, Hold::Linear);
            // the start is smoothed over a few rows, of 0.03 rad/s each
            assert!((rms - 6.0 / 3.0_f64.sqrt()).abs() < 0.06, "{rms}");
        }
    }
}
