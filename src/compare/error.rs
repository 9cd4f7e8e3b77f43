//! The error of a model on a recording: the paper's index, and the error over short windows.

use std::ops::Range;

use crate::math::trapezoid;
use crate::recording::{Recording, slopes};
use crate::robot::State;
use crate::simulate::{Dynamics, Hold, Input, SimulateError, WINDOW};

/// A recording simulated by a model.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// Free simulation, one state per sample; restarted after a gap.
    pub free: Vec<State>,
    /// Simulation over windows of 2 s, each started from the local motion.
    pub windows: Vec<State>,
    /// Rows at which the windows start.
    pub window_starts: Vec<usize>,
    /// The states there.
    pub window_states: Vec<State>,
}

/// Simulates a recording freely and over windows.
///
/// # Errors
/// The mass matrix is not positive definite. A diverging simulation is not an error: its states are NaN.
pub fn simulate_recording(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    hold: Hold,
) -> Result<Simulated, SimulateError> {
    let input = Acting::new(dynamics, recording, recording.torque());
    let mut free = Vec::with_capacity(recording.len());
    let mut windows = Vec::with_capacity(recording.len());
    let mut window_starts = Vec::new();
    let mut window_states = Vec::new();
    for piece in recording.pieces() {
        free.extend(input.simulate_measured(std::slice::from_ref(piece), hold)?);
        let short = windows_of(recording, piece, WINDOW);
        window_starts.extend(short.iter().map(|window| window.start));
        window_states.extend(short.iter().map(|window| input.start(window)));
        windows.extend(input.simulate_measured(&short, hold)?);
    }
    Ok(Simulated { free, windows, window_starts, window_states })
}

/// The windows of `length` \[s\] of a piece; a short remainder is joined to the last one.
pub(super) fn windows_of(
    recording: &Recording,
    piece: &Range<usize>,
    length: f64,
) -> Vec<Range<usize>> {
    let t = recording.t();
    let mut out: Vec<Range<usize>> = Vec::new();
    let mut start = piece.start;
    for k in piece.clone() {
        if t[k] - t[start] >= length {
            out.push(start..k);
            start = k;
        }
    }
    match out.last_mut() {
        Some(last) if t[piece.end - 1] - t[start] < 0.5 * length => last.end = piece.end,
        _ => out.push(start..piece.end),
    }
    out
}

/// A model on a recording, with the acting input of the whole recording.
pub(crate) struct Acting<'a> {
    dynamics: &'a dyn Dynamics,
    recording: &'a Recording,
    input: Vec<[f64; 2]>,
}

impl<'a> Acting<'a> {
    pub(crate) fn new(
        dynamics: &'a dyn Dynamics,
        recording: &'a Recording,
        torque: &[[f64; 2]],
    ) -> Self {
        let input = dynamics.input_of(recording, torque);
        Self { dynamics, recording, input }
    }

    /// Simulated states in the rows of all windows, each from its own initial state, with speeds as the
    /// recording defines them; NaN if the simulation diverges.
    pub(crate) fn simulate(
        &self,
        windows: &[(Range<usize>, State)],
        hold: Hold,
    ) -> Result<Vec<State>, SimulateError> {
        let input = Input { t: self.recording.t(), torque: &self.input, hold };
        let piece = |window: &(Range<usize>, State)| self.recording.piece_of(window.0.start);
        let together = |a: &_, b: &_| piece(a) == piece(b);
        let mut out = Vec::with_capacity(self.recording.len());
        for stretch in windows.chunk_by(together) {
            let moved = self.dynamics.simulate_windows(&input, stretch)?;
            for ((rows, _), mut states) in stretch.iter().zip(moved) {
                self.as_recorded(rows, &mut states);
                out.extend(states);
            }
        }
        Ok(out)
    }

    /// Converts the speeds of the states at `rows` to those of the recording: if these are derivatives of
    /// measured angles, the simulated speeds are the measured ones plus the derivative of the angle error. A
    /// speed that changes within a row differs from the slope over the row. The speeds of a slow sensor keep the
    /// error of its last reading in rows that repeat it.
    fn as_recorded(&self, rows: &Range<usize>, states: &mut [State]) {
        let r = self.recording;
        if r.measured().omega {
            return self.repeat_readings(rows, states);
        }
        let error = |(m, s): (&[f64; 2], &State)| [0, 1].map(|i| m[i] - s.alpha[i]);
        let errors: Vec<_> = r.alpha()[rows.clone()].iter().zip(&*states).map(error).collect();
        let all = 0..rows.len();
        let (t, fresh) = (&r.t()[rows.clone()], &r.fresh()[rows.clone()]);
        let wrong = slopes(t, &errors, std::slice::from_ref(&all), fresh, r.reach());
        for ((state, m), wrong) in states.iter_mut().zip(&r.omega()[rows.clone()]).zip(wrong) {
            state.omega = [0, 1].map(|i| m[i] - wrong[i]);
        }
    }

    /// Gives rows without a new reading the speed error of the last one, or of the first of the window before it.
    fn repeat_readings(&self, rows: &Range<usize>, states: &mut [State]) {
        let (fresh, omega) =
            (&self.recording.fresh()[rows.clone()], &self.recording.omega()[rows.clone()]);
        let Some(first) = fresh.iter().position(|fresh| *fresh) else { return };
        let error = |k: usize, state: &State| [0, 1].map(|i| omega[k][i] - state.omega[i]);
        let mut last = error(first, &states[first]);
        for (k, state) in states.iter_mut().enumerate() {
            match fresh[k] {
                true => last = error(k, state),
                false => state.omega = [0, 1].map(|i| omega[k][i] - last[i]),
            }
        }
    }

    /// [`Self::simulate`] from the local motion at the start of each window.
    pub(crate) fn simulate_measured(
        &self,
        windows: &[Range<usize>],
        hold: Hold,
    ) -> Result<Vec<State>, SimulateError> {
        let from = |window: &Range<usize>| (window.clone(), self.start(window));
        self.simulate(&windows.iter().map(from).collect::<Vec<_>>(), hold)
    }

    /// Initial state of a window.
    fn start(&self, window: &Range<usize>) -> State {
        self.recording.start_at(window.start).state
    }
}

/// The paper's quality index per wheel, the integral of the squared wheel-speed error over the recording
/// (trapezoidal rule; gaps are excluded) [rad^2/s^2 · s = rad^2/s].
///
/// ```text
/// ISE = int (e_w1^2 + e_w2^2) dt
/// ```
/// Source: paper, section 4. Infinite if the simulation diverged.
#[must_use]
pub fn ise(recording: &Recording, states: &[State]) -> [f64; 2] {
    [0, 1].map(|i| {
        let square = |k: usize| (recording.omega()[k][i] - states[k].omega[i]).powi(2);
        let sum = trapezoid(recording.t(), recording.pieces(), square);
        if sum.is_nan() { f64::INFINITY } else { sum }
    })
}

/// Wheel-speed errors over windows, measured minus simulated [rad/s].
fn window_errors(recording: &Recording, windows: &[State]) -> Vec<[f64; 2]> {
    recording
        .omega()
        .iter()
        .zip(windows)
        .map(|(m, s)| [m[0] - s.omega[0], m[1] - s.omega[1]])
        .collect()
}

/// Root mean square of the 2 s simulation errors over both wheels [rad/s].
#[must_use]
pub fn window_rms(recording: &Recording, windows: &[State]) -> f64 {
    let errors = window_errors(recording, windows);
    let sum: f64 = errors.iter().map(|e| e[0] * e[0] + e[1] * e[1]).sum();
    let mean = sum / (2.0 * errors.len() as f64);
    if mean.is_nan() { f64::INFINITY } else { mean.sqrt() }
}

/// Number of initial samples that [`angle_rms`] excludes.
const TRANSIENT: usize = 20;

/// Root mean square error of the angles of a free simulation over both wheels, without the first 20 samples
/// \[rad\]; infinite where it diverges.
///
/// Source: score of the nonlinear system identification benchmarks (nonlinearbenchmark.org).
#[must_use]
pub fn angle_rms(recording: &Recording, free: &[State]) -> f64 {
    let rows = recording.alpha().iter().zip(free).skip(TRANSIENT);
    let square =
        |(m, s): (&[f64; 2], &State)| (0..2).map(|i| (m[i] - s.alpha[i]).powi(2)).sum::<f64>();
    let count = recording.len().saturating_sub(TRANSIENT).max(1);
    let mean = rows.map(square).sum::<f64>() / (2 * count) as f64;
    if mean.is_nan() { f64::INFINITY } else { mean.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::recording::{Channels, DriveUnit};
    use crate::robot::Robot;
    use crate::simulate::{PhysicalDynamics, simulate};

    #[test]
    fn the_error_of_the_angles_leaves_the_first_samples_out() {
        let rows = 40;
        let t: Vec<f64> = (0..rows).map(|k| 0.01 * f64::from(k)).collect();
        let alpha = vec![[1.0, 2.0]; rows as usize];
        let channels = Channels {
            t,
            alpha: Some(alpha),
            omega: Some(vec![[0.0; 2]; rows as usize]),
            torque: vec![[0.0; 2]; rows as usize],
        };
        let recording = Recording::new("made", channels, DriveUnit::NewtonMetre).unwrap();
        // errors 3 and 4 from sample 20 on, 100 before
        let free: Vec<State> = (0..rows)
            .map(|k| if k < 20 { [101.0, 102.0] } else { [4.0, 6.0] })
            .map(|alpha| State { alpha, omega: [0.0; 2] })
            .collect();
        assert!((angle_rms(&recording, &free) - 12.5_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn slopes_of_angles_are_compared_with_slopes_of_simulated_angles() {
        // held torques that jump from row to row, at 20 Hz
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let t: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
        let jump = |k: u32| 0.25 + 0.25 * (f64::from(k * k)).sin();
        let torque: Vec<[f64; 2]> = (0..200).map(|k| [jump(k), jump(k + 5)]).collect();
        let hold = Hold::Constant;
        let input = Input { t: &t, torque: &torque, hold };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let alpha = Some(states.iter().map(|s| s.alpha).collect());
        let channels = Channels { t, alpha, omega: None, torque };
        let recording = Recording::new("angles", channels, DriveUnit::NewtonMetre).unwrap();
        let wrong = |k: usize| (recording.omega()[k][0] - states[k].omega[0]).abs();
        assert!((20..150).any(|k| wrong(k) > 0.1));
        let dynamics = PhysicalDynamics { model, p };
        let acting = Acting::new(&dynamics, &recording, recording.torque());
        let windows = [(20..60, states[20]), (60..150, states[60])];
        let simulated = acting.simulate(&windows, hold).unwrap();
        for (k, simulated) in (20..150).zip(&simulated) {
            assert!((recording.omega()[k][0] - simulated.omega[0]).abs() < 1e-9, "{k}");
        }
    }

    #[test]
    fn a_slow_sensor_is_compared_with_its_readings() {
        // readings every 90 ms in rows of 10 ms
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let t: Vec<f64> = (0..900).map(|k| 0.01 * f64::from(k)).collect();
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [0.3 + 0.3 * t.sin(), 0.3]).collect();
        let hold = Hold::Linear;
        let input = Input { t: &t, torque: &torque, hold };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let omega = Some((0..900).map(|k| states[k - k % 9].omega).collect());
        let channels = Channels { t, alpha: None, omega, torque };
        let recording = Recording::new("slow", channels, DriveUnit::NewtonMetre).unwrap();
        let held = |k: usize| (recording.omega()[k][0] - states[k].omega[0]).abs();
        assert!((0..900).any(|k| held(k) > 0.3));
        let dynamics = PhysicalDynamics { model, p };
        let acting = Acting::new(&dynamics, &recording, recording.torque());
        let windows = [(0..450, states[0]), (450..900, states[450])];
        let simulated = acting.simulate(&windows, hold).unwrap();
        assert!(window_rms(&recording, &simulated) < 1e-9);
    }

    #[test]
    fn a_window_may_start_between_two_readings_of_slow_angles() {
        // readings every 20 ms in rows of 5 ms; windows start one to three rows after one
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let t: Vec<f64> = (0..900).map(|k| 0.005 * f64::from(k)).collect();
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [0.3 + 0.3 * t.sin(), 0.3]).collect();
        let hold = Hold::Linear;
        let input = Input { t: &t, torque: &torque, hold };
        let states = simulate(&model, &p, &input, State::default()).unwrap();
        let alpha = Some((0..900).map(|k| states[k - k % 4].alpha).collect());
        let channels = Channels { t, alpha, omega: None, torque };
        let recording = Recording::new("slow", channels, DriveUnit::NewtonMetre).unwrap();
        assert!(recording.repeats_readings());
        let dynamics = PhysicalDynamics { model, p };
        let acting = Acting::new(&dynamics, &recording, recording.torque());
        let starts = [0, 301, 602, 803, 900];
        let windows: Vec<_> = starts.windows(2).map(|w| (w[0]..w[1], states[w[0]])).collect();
        let simulated = acting.simulate(&windows, hold).unwrap();
        assert!(window_rms(&recording, &simulated) < 1e-9);
    }

    #[test]
    fn the_index_of_a_known_error_is_its_integral() {
        // errors 2t on wheel 1 and 1 on wheel 2 over 1 s: 4/3 and 1
        let t: Vec<f64> = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        let omega = t.iter().map(|t| [2.0 * t, 1.0]).collect();
        let c = Channels { torque: vec![[0.0; 2]; 101], alpha: None, omega: Some(omega), t };
        let r = Recording::new("a", c, DriveUnit::NewtonMetre).unwrap();
        let zero = vec![State::default(); 101];
        let [one, two] = ise(&r, &zero);
        // trapezoid of a parabola: h²/12 · f'' · T = 6.7e-5
        assert!((one - 4.0 / 3.0).abs() < 1e-4 && (two - 1.0).abs() < 1e-12);
        assert!((window_rms(&r, &zero).powi(2) - 0.5 * (4.0 * 0.335 + 1.0)).abs() < 1e-3);
    }
}
