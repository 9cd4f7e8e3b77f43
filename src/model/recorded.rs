//! The acting input of a recording, including the input before its first row.

use super::Model;
use crate::recording::Recording;

/// Ratio of wheel speed to top speed up to which a recording begins at rest (judgement: after a step from rest
/// the speed exceeds this within a few rows).
const AT_REST: f64 = 0.02;

impl Model {
    /// [`Model::input`] for the rows of a recording. If the recording begins at rest, the input before it is
    /// zero: otherwise a lag or a delay would be in steady state at the first row, although the response to
    /// an initial step contains information on it.
    #[must_use]
    pub fn input_of(&self, recording: &Recording, input: &[[f64; 2]], p: &[f64]) -> Vec<[f64; 2]> {
        self.input_after(begins_at_rest(recording), recording.t(), input, p)
    }

    /// [`Model::input_derivatives`] for the rows of a recording.
    #[must_use]
    pub fn input_derivatives_of(
        &self,
        recording: &Recording,
        input: &[[f64; 2]],
        p: &[f64],
    ) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
        self.input_derivatives_after(begins_at_rest(recording), recording.t(), input, p)
    }

    /// [`Model::input`], with zero input before the first row if the wheels are at rest there.
    #[must_use]
    pub fn input_after(
        &self,
        rest: bool,
        t: &[f64],
        input: &[[f64; 2]],
        p: &[f64],
    ) -> Vec<[f64; 2]> {
        match self.with_row_before(rest, t, input) {
            Some((t, input)) => self.input(&t, &input, p).split_off(1),
            None => self.input(t, input, p),
        }
    }

    /// [`Model::input_derivatives`], with zero input before the first row if the wheels are at rest there.
    #[must_use]
    pub fn input_derivatives_after(
        &self,
        rest: bool,
        t: &[f64],
        input: &[[f64; 2]],
        p: &[f64],
    ) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
        let Some((t, input)) = self.with_row_before(rest, t, input) else {
            return self.input_derivatives(t, input, p);
        };
        let (mut acting, mut by_parameter) = self.input_derivatives(&t, &input, p);
        let behind = |rows: &mut Vec<[f64; 2]>| drop(rows.drain(..rows.len().min(1)));
        by_parameter.iter_mut().chain([&mut acting]).for_each(behind);
        (acting, by_parameter)
    }

    /// Times and input with a preceding row of zero input, if it matters.
    fn with_row_before(
        &self,
        rest: bool,
        t: &[f64],
        input: &[[f64; 2]],
    ) -> Option<(Vec<f64>, Vec<[f64; 2]>)> {
        if !rest || !self.shifts_input() || t.len() < 2 || input[0] == [0.0; 2] {
            return None;
        }
        let t = std::iter::once(2.0 * t[0] - t[1]).chain(t.iter().copied()).collect();
        Some((t, std::iter::once([0.0; 2]).chain(input.iter().copied()).collect()))
    }
}

/// Whether the wheels are at rest in the first row.
fn begins_at_rest(recording: &Recording) -> bool {
    let slow = AT_REST * recording.top_speed();
    recording.omega().first().is_some_and(|w| w.iter().all(|w| w.abs() <= slow))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::Robot;

    fn from(speed: f64) -> Recording {
        let t: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
        let omega = Some(t.iter().map(|t| [speed + 10.0 * t; 2]).collect());
        let channels = Channels { torque: vec![[2.0, 1.0]; 50], alpha: None, omega, t };
        Recording::new("step", channels, DriveUnit::NewtonMetre).unwrap()
    }

    #[test]
    fn a_lag_acts_from_nothing_where_a_recording_begins_at_rest() {
        let model = Model::with_effects(Robot::amigobot(), &["actuator_lag"]).unwrap();
        let mut p = model.initial();
        let tau = model.index_of("tau").unwrap();
        p[tau] = 0.05;
        let acting = |recording: &Recording| model.input_of(recording, recording.torque(), &p);
        let (rest, moving) = (acting(&from(0.0)), acting(&from(3.0)));
        assert_eq!(moving, from(3.0).torque());
        // behind a line from nothing to the first row in h: u (1 - tau/h (1 - exp(-h/tau))), then towards u
        let first = 1.0 - 5.0 * (1.0 - (-0.2_f64).exp());
        for (k, m) in rest.iter().enumerate() {
            let share = 1.0 - (1.0 - first) * (-0.2 * k as f64).exp();
            assert!((m[0] - 2.0 * share).abs() < 1e-12 && (m[1] - share).abs() < 1e-12, "{k}");
        }
        let recording = from(0.0);
        let (values, by_parameter) = model.input_derivatives_of(&recording, recording.torque(), &p);
        assert_eq!(values, rest);
        let near = |step: f64| {
            let mut p = p.clone();
            p[tau] += step;
            model.input_of(&recording, recording.torque(), &p)
        };
        for (k, (up, down)) in near(1e-6).iter().zip(near(-1e-6)).enumerate() {
            let slope = (up[0] - down[0]) / 2e-6;
            assert!((by_parameter[tau][k][0] - slope).abs() < 1e-6 * 40.0, "{k}"); // eps/h
        }
    }
}
