//! The noise floor: the error that remains for the correct model.

use std::ops::Range;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::error::{Acting, WINDOW, start_of, windows_of};
use super::input_noise::{noisier_input, normal, slowly_noisier_input};
use crate::math::trapezoid;
use crate::recording::{LocalMotion, Recording};
use crate::robot::State;
use crate::simulate::{BETWEEN_ROWS, Dynamics, Hold, SimulateError, every_other};

/// Number of noise realisations.
const DRAWS: usize = 8;

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
    floor(&Runs::new(dynamics, recording, hold, Reach::FreeAndWindows)?, seed)
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
    let floor = floor(&Runs::new(dynamics, recording, hold, Reach::Windows)?, seed)?;
    Ok(Floor { ise: [f64::NAN; 2], ..floor })
}

/// [`noise_floor`] from the simulations of `runs`.
fn floor(runs: &Runs, seed: u64) -> Result<Floor, SimulateError> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let recording = runs.recording;
    let jumps = runs.by_input_jumps(&mut rng)?;
    let start = runs.by_start_noise(&mut rng)?;
    let half = runs.by_every_other_row()?;
    let slow = runs.by_slow_input_noise(&mut rng)?;
    let noise = recording.noise_of_jumps().powi(2);
    let share = noise + STEPS * (1.0 - noise);
    let input = |jumps: f64, half: f64| f64::max(noise * jumps, share * half);
    let covered: f64 = recording.pieces().iter().map(|p| length(recording, p)).sum();
    let speed = recording.motion_noise().omega.map(|s| s * s);
    let ise = [0, 1].map(|i| {
        speed[i] * covered + start.ise[i] + slow.ise[i] + input(jumps.ise[i], half.ise[i])
    });
    let known = 0.5 * (speed[0] + speed[1]) + start.square + slow.square;
    let window_rms = (known + input(jumps.square, half.square)).sqrt();
    let window_most = (known + f64::max(noise * jumps.square, half.square)).sqrt();
    Ok(Floor { ise, window_rms, window_most, window_slow: slow.square.sqrt() })
}

/// Ratio of the squared error of linear interpolation between all rows to that between every other row, for
/// steps of the input.
const STEPS: f64 = 1.0 / 3.0;

/// Root mean square error over windows of 2 s [rad/s] of a correct model on recordings, due to the unknown
/// input between their rows: a third of the mean square difference that omitting every other row causes,
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
        let runs = Runs::new(dynamics, recording, hold, Reach::Windows)?;
        Ok(runs.by_every_other_row()?.square)
    };
    Ok(pooled(recordings, square)? * BETWEEN_ROWS)
}

/// Root mean square difference over windows of 2 s [rad/s] caused by omitting every other row of the input,
/// minus the part that noise of the recorded input causes.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn between_rows(
    dynamics: &dyn Dynamics,
    recordings: &[Recording],
    hold: Hold,
) -> Result<f64, SimulateError> {
    let square = |recording: &Recording| {
        let runs = Runs::new(dynamics, recording, hold, Reach::Windows)?;
        let jumps = runs.by_input_jumps(&mut ChaCha8Rng::seed_from_u64(0))?.square;
        let noise = recording.noise_of_jumps().powi(2) * jumps;
        Ok((runs.by_every_other_row()?.square - noise).max(0.0))
    };
    pooled(recordings, square)
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
        let runs = Runs::new(dynamics, recording, hold, Reach::Windows)?;
        floor(&runs, seed)
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

/// Which simulations of a recording are computed.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    Windows,
    FreeAndWindows,
}

/// Simulations of a recording with an input or an initial state that differ from the recorded ones.
struct Runs<'a> {
    dynamics: &'a dyn Dynamics,
    recording: &'a Recording,
    hold: Hold,
    reach: Reach,
    /// Rows of the windows of 2 s.
    short: Vec<Range<usize>>,
    /// The simulation with the recorded input and initial state.
    plain: Run,
}

/// The states of a free simulation, if there is one, and of windows of 2 s.
struct Run {
    free: Option<Vec<State>>,
    windows: Vec<State>,
}

/// Difference between simulations and the one with recorded input and initial state.
#[derive(Clone, Copy, Default)]
struct Apart {
    /// Of the free simulation, per wheel [rad^2/s].
    ise: [f64; 2],
    /// Of the windows, mean over rows and wheels [rad^2/s^2].
    square: f64,
}

impl<'a> Runs<'a> {
    fn new(
        dynamics: &'a dyn Dynamics,
        recording: &'a Recording,
        hold: Hold,
        reach: Reach,
    ) -> Result<Self, SimulateError> {
        let whole = recording.pieces().iter();
        let short = whole.flat_map(|p| windows_of(recording, p, WINDOW)).collect();
        let plain = Run { free: None, windows: vec![] };
        let mut runs = Self { dynamics, recording, hold, reach, short, plain };
        runs.plain = runs.run(recording.torque(), None)?;
        Ok(runs)
    }

    fn run(
        &self,
        torque: &[[f64; 2]],
        mut rng: Option<&mut ChaCha8Rng>,
    ) -> Result<Run, SimulateError> {
        let acting = Acting::new(self.dynamics, self.recording, torque);
        let (whole, motion) = (self.recording.pieces(), self.recording.local_motion());
        let mut starts = |ranges: &[Range<usize>]| -> Vec<State> {
            ranges.iter().map(|range| start(&motion[range.start], rng.as_deref_mut())).collect()
        };
        // starts of the windows are the same draws with a free simulation and without
        let (first, of_windows) = (starts(whole), starts(&self.short));
        let free = match self.reach {
            Reach::Windows => None,
            Reach::FreeAndWindows => Some(self.all(&acting, whole, &first)?),
        };
        Ok(Run { free, windows: self.all(&acting, &self.short, &of_windows)? })
    }

    fn all(
        &self,
        acting: &Acting,
        ranges: &[Range<usize>],
        starts: &[State],
    ) -> Result<Vec<State>, SimulateError> {
        let windows: Vec<_> = ranges.iter().cloned().zip(starts.iter().copied()).collect();
        acting.simulate(&windows, self.hold)
    }

    /// The mean over realisations of input noise with the variance of the input's differences.
    fn by_input_jumps(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        let sigma = self.recording.input_jumps();
        self.mean(DRAWS, |_| self.run(&noisier_input(self.recording, sigma, rng), None))
    }

    /// The mean over realisations of slow (autocorrelated) input noise.
    fn by_slow_input_noise(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        if self.recording.slow_input_noise().iter().all(|n| n.sigma == 0.0) {
            return Ok(Apart::default());
        }
        self.mean(DRAWS, |_| self.run(&slowly_noisier_input(self.recording, rng), None))
    }

    /// The mean over realisations of noise in the initial state.
    fn by_start_noise(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        self.mean(DRAWS, |_| self.run(self.recording.torque(), Some(rng)))
    }

    /// The mean over both ways of omitting every other row of the input: the effect of the unknown input
    /// between the rows; zero for a held input.
    fn by_every_other_row(&self) -> Result<Apart, SimulateError> {
        if self.hold == Hold::Constant {
            return Ok(Apart::default());
        }
        let halved = |phase| every_other(self.recording, self.recording.torque(), phase);
        self.mean(2, |phase| self.run(&halved(phase), None))
    }

    fn mean(
        &self,
        count: usize,
        mut run: impl FnMut(usize) -> Result<Run, SimulateError>,
    ) -> Result<Apart, SimulateError> {
        let mut sum = Apart::default();
        for n in 0..count {
            let one = self.apart(&run(n)?);
            sum.ise = [0, 1].map(|i| sum.ise[i] + one.ise[i]);
            sum.square += one.square;
        }
        let share = 1.0 / count as f64;
        Ok(Apart { ise: sum.ise.map(|v| share * v), square: share * sum.square })
    }

    fn apart(&self, run: &Run) -> Apart {
        let t = self.recording.t();
        let ise = [0, 1].map(|i| {
            let Some((free, plain)) = run.free.as_ref().zip(self.plain.free.as_ref()) else {
                return 0.0;
            };
            let square = |k: usize| spread(&free[k], &plain[k], i);
            trapezoid(t, self.recording.pieces(), square)
        });
        let pairs = run.windows.iter().zip(&self.plain.windows);
        let sum: f64 = pairs.map(|(a, b)| spread(a, b, 0) + spread(a, b, 1)).sum();
        Apart { ise, square: sum / (2.0 * t.len() as f64) }
    }
}

fn length(recording: &Recording, piece: &Range<usize>) -> f64 {
    recording.t()[piece.end - 1] - recording.t()[piece.start]
}

fn spread(a: &State, b: &State, i: usize) -> f64 {
    let d = (a.omega[i] - b.omega[i]).powi(2);
    if d.is_finite() { d } else { 0.0 }
}

/// Initial state of a simulation, with a realisation of the noise of the speeds if `rng` is given.
fn start(local: &LocalMotion, rng: Option<&mut ChaCha8Rng>) -> State {
    let mut first = start_of(local);
    let Some(rng) = rng else { return first };
    let draws = [normal(rng), normal(rng)];
    let single = local.omega[0] == local.omega[1];
    for i in 0..2 {
        // a wheel at rest stays at rest: noise is drawn only for moving wheels
        if first.omega[i] != 0.0 {
            let draw = if single { draws[0] } else { draws[i] };
            first.omega[i] = local.omega[i] + local.omega_variance[i].sqrt() * draw;
        }
    }
    first
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
