//! Simulations of a recording with several inputs and initial states, for the noise floor.

use std::ops::Range;

use rand_chacha::ChaCha8Rng;

use super::error::{Acting, windows_of};
use super::input_noise::{noisier_input, normal, slowly_noisier_input};
use crate::math::trapezoid;
use crate::recording::{Recording, Start};
use crate::robot::State;
use crate::simulate::{
    Dynamics, Hold, Realisation, SimulateError, Speeds, WINDOW, speeds_of_realisations,
};

/// Number of noise realisations.
const DRAWS: usize = 8;

/// Which simulations of a recording are computed.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Reach {
    Windows,
    FreeAndWindows,
}

/// Simulations of a recording with an input or an initial state that differ from the recorded ones.
pub(super) struct Runs<'a> {
    dynamics: &'a dyn Dynamics,
    pub(super) recording: &'a Recording,
    hold: Hold,
    reach: Reach,
    /// Rows of the windows of 2 s.
    short: Vec<Range<usize>>,
    /// Starts of the free simulation of each piece, and of the windows.
    recorded: [Vec<Start>; 2],
    /// The simulation with the recorded input and initial state.
    plain: Run,
}

/// Simulated speeds [rad/s] of a free simulation, if there is one, and of windows of 2 s.
#[derive(Default)]
struct Run {
    free: Option<Vec<[f64; 2]>>,
    windows: Vec<[f64; 2]>,
}

/// Initial states of a free simulation and of windows.
struct Starts {
    whole: Vec<State>,
    short: Vec<State>,
}

/// Difference between simulations and the one with recorded input and initial state.
#[derive(Clone, Copy, Default)]
pub(super) struct Apart {
    /// Of the free simulation, per wheel [rad^2/s].
    pub(super) ise: [f64; 2],
    /// Of the windows, mean over rows and wheels [rad^2/s^2].
    pub(super) square: f64,
}

impl<'a> Runs<'a> {
    pub(super) fn new(
        dynamics: &'a dyn Dynamics,
        recording: &'a Recording,
        hold: Hold,
        reach: Reach,
    ) -> Result<Self, SimulateError> {
        Ok(Self::with_inputs(dynamics, recording, hold, reach, &[recording.torque().to_vec()])?.0)
    }

    /// The same, with the mean over both ways of omitting every other row of the input: the effect of the unknown input
    /// between the rows; zero for a held input.
    pub(super) fn with_every_other_row(
        dynamics: &'a dyn Dynamics,
        recording: &'a Recording,
        hold: Hold,
        reach: Reach,
    ) -> Result<(Self, Apart), SimulateError> {
        let recorded = recording.torque();
        if hold == Hold::Constant {
            return Ok((Self::new(dynamics, recording, hold, reach)?, Apart::default()));
        }
        let [even, odd] = [0, 1].map(|phase| recording.half_rate_input(phase).into_owned());
        let inputs = [recorded.to_vec(), even, odd];
        let (runs, halves) = Self::with_inputs(dynamics, recording, hold, reach, &inputs)?;
        let apart = runs.mean(&halves);
        Ok((runs, apart))
    }

    /// Runs with the first of several inputs, which is the recorded one, and those with the others.
    fn with_inputs(
        dynamics: &'a dyn Dynamics,
        recording: &'a Recording,
        hold: Hold,
        reach: Reach,
        inputs: &[Vec<[f64; 2]>],
    ) -> Result<(Self, Vec<Run>), SimulateError> {
        let whole = recording.pieces();
        let short: Vec<Range<usize>> =
            whole.iter().flat_map(|p| windows_of(recording, p, WINDOW)).collect();
        let at = |ranges: &[Range<usize>]| -> Vec<Start> {
            ranges.iter().map(|range| recording.start_at(range.start)).collect()
        };
        let recorded = [at(whole), at(&short)];
        let plain = Run::default();
        let mut runs = Self { dynamics, recording, hold, reach, short, recorded, plain };
        let mut all = runs.all(inputs, vec![runs.starts(None)])?;
        runs.plain = all.remove(0);
        Ok((runs, all))
    }

    /// Initial states, with a realisation of the noise of the speeds if `rng` is given; those of the windows are the
    /// same draws with a free simulation and without.
    fn starts(&self, mut rng: Option<&mut ChaCha8Rng>) -> Starts {
        let [whole, short] = self
            .recorded
            .each_ref()
            .map(|starts| starts.iter().map(|first| start(first, rng.as_deref_mut())).collect());
        Starts { whole, short }
    }

    /// One run for every input, or for every choice of initial states; of the other there is one.
    fn all(
        &self,
        torques: &[Vec<[f64; 2]>],
        starts: Vec<Starts>,
    ) -> Result<Vec<Run>, SimulateError> {
        let (whole, short): (Vec<_>, Vec<_>) =
            starts.into_iter().map(|starts| (starts.whole, starts.short)).unzip();
        let windows = self.speeds(torques, &self.short, &short)?;
        let free = match self.reach {
            Reach::Windows => windows.iter().map(|_| None).collect::<Vec<_>>(),
            Reach::FreeAndWindows => {
                let pieces = self.recording.pieces();
                self.speeds(torques, pieces, &whole)?.into_iter().map(Some).collect()
            }
        };
        let runs = free.into_iter().zip(windows);
        Ok(runs.map(|(free, windows)| Run { free, windows }).collect())
    }

    /// Simulated speeds [rad/s] in the rows of `ranges`, as the recording defines them, for every input and every
    /// choice of initial states.
    fn speeds(
        &self,
        torques: &[Vec<[f64; 2]>],
        ranges: &[Range<usize>],
        starts: &[Vec<State>],
    ) -> Result<Speeds, SimulateError> {
        let count = torques.len().max(starts.len());
        let (torque, starts) = (
            |n: usize| &torques[n.min(torques.len() - 1)][..],
            |n: usize| &starts[n.min(starts.len() - 1)],
        );
        if let Some(found) = self.side_by_side(ranges, (0..count).map(|n| (torque(n), starts(n)))) {
            return found;
        }
        let one = |n: usize| {
            let windows: Vec<_> = ranges.iter().cloned().zip(starts(n).iter().copied()).collect();
            let acting = Acting::new(self.dynamics, self.recording, torque(n));
            let states = acting.simulate(&windows, self.hold)?;
            Ok(states.iter().map(|state| state.omega).collect())
        };
        (0..count).map(one).collect()
    }

    /// The same in the lanes of the processor, if the model has them and every row has a new reading of the speeds.
    fn side_by_side<'b>(
        &self,
        ranges: &[Range<usize>],
        runs: impl Iterator<Item = (&'b [[f64; 2]], &'b Vec<State>)>,
    ) -> Option<Result<Speeds, SimulateError>> {
        let (model, p) = self.dynamics.physical()?;
        let r = self.recording;
        if !r.measured().omega || r.repeats_readings() {
            return None;
        }
        let inputs: Vec<(Vec<[f64; 2]>, &Vec<State>)> =
            runs.map(|(torque, starts)| (model.input_of(r, torque, p), starts)).collect();
        let realisations: Vec<Realisation> =
            inputs.iter().map(|(torque, starts)| Realisation { torque, starts }).collect();
        speeds_of_realisations(model, p, (r.t(), self.hold), ranges, &realisations)
    }

    /// The mean over realisations of input noise with the variance of the input's differences.
    pub(super) fn by_input_jumps(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        let sigma = self.recording.input_jumps();
        self.by_inputs((0..DRAWS).map(|_| noisier_input(self.recording, sigma, rng)))
    }

    /// The mean over realisations of slow (autocorrelated) input noise.
    pub(super) fn by_slow_input_noise(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        if self.recording.slow_input_noise().iter().all(|n| n.sigma == 0.0) {
            return Ok(Apart::default());
        }
        self.by_inputs((0..DRAWS).map(|_| slowly_noisier_input(self.recording, rng)))
    }

    /// The mean over realisations of noise in the initial state.
    pub(super) fn by_start_noise(&self, rng: &mut ChaCha8Rng) -> Result<Apart, SimulateError> {
        let starts = (0..DRAWS).map(|_| self.starts(Some(&mut *rng))).collect();
        Ok(self.mean(&self.all(&[self.recording.torque().to_vec()], starts)?))
    }

    /// The mean over several inputs.
    fn by_inputs(
        &self,
        inputs: impl Iterator<Item = Vec<[f64; 2]>>,
    ) -> Result<Apart, SimulateError> {
        let torques: Vec<_> = inputs.collect();
        Ok(self.mean(&self.all(&torques, vec![self.starts(None)])?))
    }

    fn mean(&self, runs: &[Run]) -> Apart {
        let mut sum = Apart::default();
        for one in runs.iter().map(|run| self.apart(run)) {
            sum.ise = [0, 1].map(|i| sum.ise[i] + one.ise[i]);
            sum.square += one.square;
        }
        let share = 1.0 / runs.len() as f64;
        Apart { ise: sum.ise.map(|v| share * v), square: share * sum.square }
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

fn spread(a: &[f64; 2], b: &[f64; 2], i: usize) -> f64 {
    let d = (a[i] - b[i]).powi(2);
    if d.is_finite() { d } else { 0.0 }
}

/// Initial state of a simulation, with a realisation of the error of the speeds if `rng` is given.
fn start(recorded: &Start, rng: Option<&mut ChaCha8Rng>) -> State {
    let Start { state: mut first, omega_square_error } = *recorded;
    let Some(rng) = rng else { return first };
    let draws = [normal(rng), normal(rng)];
    let single = first.omega[0] == first.omega[1];
    for i in 0..2 {
        // a wheel at rest stays at rest: noise is drawn only for moving wheels
        if first.omega[i] != 0.0 {
            let draw = if single { draws[0] } else { draws[i] };
            first.omega[i] += omega_square_error[i].sqrt() * draw;
        }
    }
    first
}
