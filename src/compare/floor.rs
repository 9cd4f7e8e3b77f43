//! The noise floor: the error that remains for the correct model.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::runs::{Apart, Reach, Runs};
use crate::recording::Recording;
use crate::simulate::{BETWEEN_ROWS, Dynamics, Hold, SimulateError};

/// The error of the correct model on one recording.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Floor {
    /// Of the free simulation, per wheel [rad^2/s].
    pub ise: [f64; 2],
    /// Of the windows, root mean square over both wheels [rad/s].
    pub window_rms: f64,
    /// The same with the largest possible effect of the unknown input between the rows.
    pub window_most: f64,
    /// Contribution of slow noise of the input, root mean square [rad/s].
    pub window_slow: f64,
}

/// The error of the correct model over windows of 2 s, root mean square [rad/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindowFloor {
    /// Expected value.
    pub expected: f64,
    /// With the largest possible effect of the unknown input between the rows.
    pub most: f64,
    /// Contribution of slow noise of the input.
    pub slow: f64,
}

impl WindowFloor {
    /// Whether slow noise of the input causes the larger part of the squared error. The floor is then
    /// uncertain by a factor of two or more, because such noise is estimated from rests that last only a few
    /// of its correlation times, and tests that treat rows or windows as independent are not valid.
    #[must_use]
    pub fn is_slow(&self) -> bool {
        2.0 * self.slow.powi(2) > self.expected.powi(2)
    }
}

/// The error that remains for a perfect model. It has three contributions: noise of the measured speeds, the
/// effect of noise in the initial state on a simulation, and the larger of the effects of input noise
/// (estimated from differences) and of the unknown input between the rows.
///
/// ```text
/// floor = ∫ σ_w² dt + mean over 8 draws of ∫ (w(M, x0 + noise) - w(M, x0))² dt
///         + max(N, n H + (1 - n) H/3) + S
/// N = mean over 8 draws of ∫ (w(M + noise, x0) - w(M, x0))² dt
/// H = mean over both phases of ∫ (w(every other row of M, x0) - w(M, x0))² dt
/// S = mean over 8 draws of ∫ (w(M + slow noise, x0) - w(M, x0))² dt,   autocorrelated noise, estimated from rests
/// ```
/// n is the share of the variance of the input's differences that is noise, to which the robot does not
/// respond. For a step of the input at a uniformly distributed time between two rows, linear interpolation
/// has a mean square error of h² step²/12, and with every other row h² step²/4, so the error is a third of H.
/// For a smooth input it is a ninth of H, and for changes within a row that return it is all of H. The rows
/// do not determine which case applies; H is the upper bound. An input that is held between its rows is known
/// there, and H is zero.
/// Of an input that was interpolated since it was recorded, for example shifted, the rows are the recorded ones.
/// For an input with independent noise, omitting every other row changes the simulation by as much as the
/// noise does, so H includes N. `dynamics` represents the correct model; any similar model can be used,
/// because only the differences of simulations enter.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn noise_floor(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    hold: Hold,
    seed: u64,
) -> Result<Floor, SimulateError> {
    floor(&Runs::with_every_other_row(dynamics, recording, hold, Reach::FreeAndWindows)?, seed)
}

/// [`noise_floor`] over windows alone, with half as many simulations; `ise` is not computed (NaN).
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn window_floor(
    dynamics: &dyn Dynamics,
    recording: &Recording,
    hold: Hold,
    seed: u64,
) -> Result<Floor, SimulateError> {
    let runs = Runs::with_every_other_row(dynamics, recording, hold, Reach::Windows)?;
    let floor = floor(&runs, seed)?;
    Ok(Floor { ise: [f64::NAN; 2], ..floor })
}

/// [`noise_floor`] from simulations and the effect of every other row of the input.
fn floor((runs, half): &(Runs, Apart), seed: u64) -> Result<Floor, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let recording = runs.recording;
    let jumps = runs.by_input_jumps(&mut rng)?;
    let start = runs.by_start_noise(&mut rng)?;
    let slow = runs.by_slow_input_noise(&mut rng)?;
    let noise = recording.noise_of_jumps().powi(2);
    let share = noise + STEPS * (1.0 - noise);
    let input = |jumps: f64, half: f64| f64::max(noise * jumps, share * half);
    let covered = recording.covered();
    let speed = recording.motion_noise().omega.map(|s| s * s);
    let ise = [0, 1].map(|i| {
        speed[i] * covered + start.ise[i] + slow.ise[i] + input(jumps.ise[i], half.ise[i])
    });
    let known = sensors(recording, start.square) + slow.square;
    let window_rms = (known + input(jumps.square, half.square)).sqrt();
    let window_most = (known + f64::max(noise * jumps.square, half.square)).sqrt();
    Ok(Floor { ise, window_rms, window_most, window_slow: slow.square.sqrt() })
}

/// Ratio of the squared error of linear interpolation between all rows to that between every other row, for
/// steps of the input.
const STEPS: f64 = 1.0 / 3.0;

/// Root mean square error over windows of 2 s [rad/s] of a correct model on recordings, due to the unknown
/// input between their rows: a third of the root mean square difference that omitting every other row causes,
/// because the error of linear interpolation is proportional to the square of the interval. A smaller change
/// of the error contains no information on the robot.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn unresolved(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
) -> Result<f64, SimulateError> {
    let square = |recording: &Recording| {
        Ok(Runs::with_every_other_row(dynamics, recording, hold, Reach::Windows)?.1.square)
    };
    Ok(pooled(recordings, square)? * BETWEEN_ROWS)
}

/// Root mean square error over windows of 2 s [rad/s] of a correct model on recordings, by the noise of their speeds and
/// of the initial states alone: the [`noise_floor`] for an input that is known at all times.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn sensor_floor(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
    seed: u64,
) -> Result<f64, SimulateError> {
    let square = |recording: &Recording| {
        let runs = Runs::new(dynamics, recording, hold, Reach::Windows)?;
        let start = runs.by_start_noise(&mut ChaCha8Rng::seed_from_u64(seed))?;
        Ok(sensors(recording, start.square))
    };
    pooled(recordings, square)
}

/// Mean square over both wheels [rad^2/s^2] of noise of the speeds, and of what noise of the initial state causes.
fn sensors(recording: &Recording, start: f64) -> f64 {
    let speed = recording.motion_noise().omega;
    0.5 * (speed[0].powi(2) + speed[1].powi(2)) + start
}

/// [`noise_floor`] over the windows of all recordings.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn pooled_floor(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
    seed: u64,
) -> Result<WindowFloor, SimulateError> {
    let one = |recording: &Recording| {
        floor(&Runs::with_every_other_row(dynamics, recording, hold, Reach::Windows)?, seed)
    };
    let floors: Vec<Floor> =
        recordings.par_iter().map(one).collect::<Result<_, SimulateError>>()?;
    let of = |value: fn(&Floor) -> f64| {
        mean_over_rows(recordings, floors.iter().map(|f| value(f).powi(2))).sqrt()
    };
    Ok(WindowFloor {
        expected: of(|f| f.window_rms),
        most: of(|f| f.window_most),
        slow: of(|f| f.window_slow),
    })
}

/// Root of the mean over all rows of a mean square of each recording.
fn pooled(
    recordings: &[Recording],
    square: impl Fn(&Recording) -> Result<f64, SimulateError> + Send + Sync,
) -> Result<f64, SimulateError> {
    let squares: Vec<f64> = recordings.par_iter().map(square).collect::<Result<_, _>>()?;
    Ok(mean_over_rows(recordings, squares.into_iter()).sqrt())
}

/// The mean of a value of each recording, weighted by its number of rows.
fn mean_over_rows(recordings: &[Recording], values: impl Iterator<Item = f64>) -> f64 {
    let rows = || recordings.iter().map(|r| r.len() as f64);
    let sum: f64 = values.zip(rows()).map(|(value, rows)| rows * value).sum();
    sum / f64::max(rows().sum(), 1.0)
}

#[cfg(test)]
mod tests {
    use super::super::error::{simulate_recording, window_rms};
    use super::*;
    use crate::model::Model;
    use crate::robot::Robot;
    use crate::simulate::{Movement, NoiseLevel, PhysicalDynamics, Recorder, record};

    #[test]
    fn the_floor_is_the_error_of_the_true_parameters() {
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let dynamics = PhysicalDynamics { model: model.clone(), p: p.clone() };
        // speeds that are noisier than the torques make them, and the other way round
        for (dalpha, torque) in [(0.05, 1e-4), (0.002, 0.02)] {
            let (mut error, mut floor) = (0.0, 0.0);
            for seed in 0..8 {
                let movement = Movement::rich(model.robot(), seed, 20.0, 12.0);
                let noise = NoiseLevel { alpha: 1e-4, dalpha, torque };
                let recorder =
                    Recorder { rate: 200.0, control_rate: 1000.0, noise, ticks: None, seed };
                let recording = record("true", &model, &p, &movement, &recorder).unwrap();
                let run = simulate_recording(&dynamics, &recording, Hold::Linear).unwrap();
                error += window_rms(&recording, &run.windows).powi(2);
                let found = noise_floor(&dynamics, &recording, Hold::Linear, seed).unwrap();
                floor += found.window_rms.powi(2);
            }
            let ratio = (error / floor).sqrt();
            // eighty windows of two wheels, whose errors follow the noise of the input like a random walk, leave
            // 8 % of the root; the sampling of the input stands in the floor with more than it does
            assert!((0.75..1.15).contains(&ratio), "{dalpha} {torque}: {ratio}");
        }
    }
}
