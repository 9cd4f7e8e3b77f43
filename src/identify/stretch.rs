//! A stretch of rows without a gap: which of them are used, and the filtered columns of the torque
//! balance over it. Recordings in memory are cut into stretches at their gaps; those that are read
//! block by block at the blocks too.

use std::ops::Range;

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use wide::f64x2;

use super::combined::{TOGETHER, quantities};
use super::regressor::{Balance, Regressor};
use crate::effects::Motion;
use crate::math::filter::{Extension, Section, butterworth, filter_both_ways};
use crate::math::{FILLED, filter_columns};
use crate::model::Model;
use crate::recording::{Noise, Recording, differentiate};

/// Near rest: below this share of the top speed, or three standard deviations of the filtered
/// speed's noise.
const REST: f64 = 0.002;
/// Order of the filter.
const ORDER: usize = 4;
/// Rows at the ends of a movement that are not used [s Hz]: seconds times cut-off. There the noise of
/// a single row, about which the signal is extended, weighs most.
const REACH: f64 = 0.35;
/// Extension of a movement beyond its ends [s Hz]: the filter's slowest pole, exp(-2.4 fc t), has
/// fallen to 1e-3.
const EXTENSION: f64 = 3.0;
/// Cut-off of the speeds that distinguish rest from movement, over that of the columns: high enough
/// to locate a reversal.
const SHARPER: f64 = 4.0;

/// Parameters of the treatment of rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Treatment {
    /// Median step in time \[s\].
    pub(super) step: f64,
    /// Cut-off of the filter \[Hz\].
    pub(super) cutoff: f64,
    /// Speed below which a wheel counts as near rest [rad/s].
    slow: f64,
    /// Every how many rows one is kept.
    pub(super) every: usize,
}

impl Treatment {
    /// Cut-off and speed near rest as given, or from noise and motion of the recording.
    pub(super) fn new(
        recording: &Recording,
        cutoff_hz: Option<f64>,
        rest: Option<f64>,
        noise_share: f64,
    ) -> Self {
        let step = recording.step();
        let cutoff = cutoff(recording, cutoff_hz, noise_share);
        let ordinary = || {
            let sigma = recording.motion_noise().omega;
            let left = (2.0 * sharper(cutoff, step) * step).sqrt();
            (REST * recording.top_speed()).max(3.0 * left * sigma[0].max(sigma[1]))
        };
        let every = ((1.0 / (4.0 * cutoff * step)) as usize).max(1);
        Self { step, cutoff, slow: rest.unwrap_or_else(ordinary), every }
    }

    /// Whether a piece of that many rows is shorter than the response of the filter, so that all of
    /// its rows are affected by the ends.
    pub(super) fn is_too_short(&self, rows: usize) -> bool {
        (rows as f64) * self.step <= 4.0 * REACH / self.cutoff
    }

    /// Rows around a disturbance that are affected by it through the filter.
    pub(super) fn reach(&self) -> usize {
        ((REACH / self.cutoff / self.step).ceil() as usize).max(1)
    }

    /// Stretches of rows in which both wheels move without a reversal.
    pub(super) fn movements(&self, omega: &[[f64; 2]]) -> Vec<Range<usize>> {
        if self.slow <= 0.0 {
            return std::iter::once(0..omega.len()).collect();
        }
        let sections = self.sections(sharper(self.cutoff, self.step));
        let speeds = lanes(omega);
        let speeds = filter_both_ways(&sections, &speeds, self.edge(), Extension::Odd);
        let direction = |k: usize| -> Option<[bool; 2]> {
            let w = speeds[k].as_array();
            let moving = w[0].abs() >= self.slow && w[1].abs() >= self.slow;
            moving.then(|| [w[0] > 0.0, w[1] > 0.0])
        };
        let mut out: Vec<Range<usize>> = vec![];
        let mut before = None;
        for k in 0..omega.len() {
            let now = direction(k);
            match out.last_mut() {
                Some(last) if now.is_some() && now == before => last.end = k + 1,
                _ if now.is_some() => out.push(k..k + 1),
                _ => {}
            }
            before = now;
        }
        out
    }

    /// Whether each of so many samples is used: inside a movement, away from its ends.
    pub(super) fn usable(&self, movements: &[Range<usize>], samples: usize) -> Vec<bool> {
        let mut good = vec![false; samples];
        for rows in movements.iter().filter(|rows| self.holds_rows(rows)) {
            good[rows.start + self.reach()..rows.end - self.reach()].fill(true);
        }
        good
    }

    fn holds_rows(&self, movement: &Range<usize>) -> bool {
        movement.len() > 2 * self.reach()
    }

    fn edge(&self) -> usize {
        (EXTENSION / self.cutoff / self.step).ceil() as usize
    }

    fn sections(&self, cutoff: f64) -> Vec<Section> {
        butterworth(ORDER, cutoff, 1.0 / self.step).expect("the cut-off is below half the rate")
    }
}

fn sharper(cutoff: f64, step: f64) -> f64 {
    (SHARPER * cutoff).min(0.25 / step)
}

/// Both wheels side by side.
fn lanes(rows: &[[f64; 2]]) -> Vec<f64x2> {
    rows.iter().map(|row| f64x2::new(*row)).collect()
}

/// The given cut-off, or the one with little noise in the acceleration \[Hz\]:
///
/// ```text
/// var(noise of dw after the filter) = (2π)² σ² 2 fc³ / (3 rate) = (noise_share rms dw)²
/// ```
fn cutoff(recording: &Recording, given: Option<f64>, noise_share: f64) -> f64 {
    let rate = 1.0 / recording.step();
    let automatic = || {
        let motion = recording.local_motion();
        let square: f64 =
            motion.iter().map(|m| m.acceleration[0].powi(2) + m.acceleration[1].powi(2)).sum();
        let rms = (square / (2.0 * motion.len() as f64)).sqrt();
        let noise = recording.motion_noise();
        let sigma = noise.omega[0].max(noise.omega[1]).max(1e-12);
        let turn = std::f64::consts::TAU;
        let allowed = (noise_share * rms).powi(2);
        (3.0 * rate * allowed / (2.0 * turn * turn * sigma * sigma)).cbrt()
    };
    given.unwrap_or_else(automatic).clamp(0.5_f64.min(0.1 * rate), 0.1 * rate)
}

/// The motion and the input torque from which columns are computed.
#[derive(Clone)]
pub(super) struct Source {
    pub(super) alpha: Vec<[f64; 2]>,
    pub(super) omega: Vec<[f64; 2]>,
    pub(super) input: Vec<[f64; 2]>,
}

impl Source {
    pub(super) fn measured(recording: &Recording) -> Self {
        Self {
            alpha: recording.on_lines(recording.alpha()).into_owned(),
            omega: recording.on_lines(recording.omega()).into_owned(),
            input: recording.torque().to_vec(),
        }
    }

    /// The same with noise added; one draw for both wheels if they have the `same` data.
    pub(super) fn with_noise(mut self, noise: &Noise, same: bool, rng: &mut ChaCha8Rng) -> Self {
        let mut normal = || -> f64 { StandardNormal.sample(&mut *rng) };
        for (rows, sigma) in [
            (&mut self.alpha, noise.alpha),
            (&mut self.omega, noise.omega),
            (&mut self.input, noise.torque),
        ] {
            for row in rows.iter_mut() {
                let first = normal();
                let second = if same { first } else { normal() };
                row[0] += sigma[0] * first;
                row[1] += sigma[1] * second;
            }
        }
        self
    }
}

/// Rows without a gap between them.
pub(super) struct Stretch<'a> {
    /// Time \[s\].
    pub(super) t: &'a [f64],
    /// Time of the first row of the recording \[s\].
    pub(super) start: f64,
    /// Angles \[rad\].
    pub(super) alpha: &'a [[f64; 2]],
    /// Speeds [rad/s].
    pub(super) omega: &'a [[f64; 2]],
    /// The acting input around each row.
    pub(super) input: &'a [[f64; 2]],
}

/// Filtered columns and right-hand side of both wheels in the movements of a stretch.
pub(super) struct Signals {
    width: usize,
    /// In the order of their rows.
    movements: Vec<Movement>,
}

/// Filtered columns and right-hand side of both wheels in one movement.
struct Movement {
    rows: Range<usize>,
    /// Samples before the first row, and after the last one, that the filter needs.
    edge: usize,
    /// All signals of a sample, filled up to `width` numbers.
    signals: Vec<f64>,
    width: usize,
}

impl Signals {
    /// Column `c` of wheel `wheel` at sample `k`, zero outside all movements; column `width` is the right-hand side.
    pub(super) fn at(&self, wheel: usize, c: usize, k: usize) -> f64 {
        let number = self.movements.partition_point(|movement| movement.rows.end <= k);
        match self.movements.get(number).filter(|movement| movement.rows.start <= k) {
            Some(movement) => movement.at(wheel * (self.width + 1) + c, k),
            None => 0.0,
        }
    }
}

impl Movement {
    /// The signal at this place among all of both wheels, at sample `k` of the stretch.
    fn at(&self, place: usize, k: usize) -> f64 {
        self.signals[(self.edge + k - self.rows.start) * self.width + place]
    }
}

impl Stretch<'_> {
    /// Filtered columns and right-hand side within each movement.
    ///
    /// ```text
    /// F(M) = Σ_c θ_c F(column_c),   F(dw) = F(F'(w)) differenced,  M and dw passing F as often
    /// ```
    /// Every movement is filtered separately, with an odd extension of the speeds and an even extension
    /// of all torques: the balance is then valid up to the ends, and friction at rest, which is not a
    /// column times a parameter, does not enter.
    pub(super) fn signals(
        &self,
        regressor: &Regressor,
        model: &Model,
        treatment: &Treatment,
        movements: &[Range<usize>],
    ) -> Signals {
        let usable = movements.iter().filter(|rows| treatment.holds_rows(rows));
        let movement = |rows| self.movement(regressor, model, treatment, rows);
        Signals { width: regressor.width(), movements: usable.map(movement).collect() }
    }

    fn movement(
        &self,
        regressor: &Regressor,
        model: &Model,
        treatment: &Treatment,
        rows: &Range<usize>,
    ) -> Movement {
        let sections = treatment.sections(treatment.cutoff);
        let edge = treatment.edge().min(rows.len() - 1);
        let even = |s: &[f64x2]| filter_both_ways(&sections, s, edge, Extension::Even);
        let t = &self.t[rows.clone()];
        // the torques are filtered as often as the accelerations
        let input = even(&lanes(&self.input[rows.clone()]));
        let speeds = lanes(&self.omega[rows.clone()]);
        let omega: Vec<[f64; 2]> = filter_both_ways(&sections, &speeds, edge, Extension::Odd)
            .iter()
            .map(|w| w.to_array())
            .collect();
        let acceleration = differentiate(t, &omega, std::slice::from_ref(&(0..t.len())), 1);
        let columns = regressor.width();
        let width = (2 * (columns + 1)).next_multiple_of(FILLED);
        // with room for what the filter adds before and after
        let mut signals = vec![0.0; (t.len() + 2 * edge) * width];
        let mut balance = Balance::default();
        let own = signals[edge * width..].chunks_exact_mut(width).take(t.len());
        for (k, signals) in own.enumerate() {
            let (w, a) = (omega[k], acceleration[k]);
            if let Some(combined) = regressor.combined() {
                let torques = combined.at(quantities(w, a));
                let some = signals.chunks_exact_mut(TOGETHER).zip(torques);
                some.for_each(|(some, torques)| some.copy_from_slice(torques.as_array()));
            } else {
                let (time, alpha) = (t[k] - self.start, self.alpha[rows.start + k]);
                regressor.write(&Motion::at(time, alpha, w, model.robot()), &mut balance);
                for c in 0..=columns {
                    let side = if c < columns { 1.0 } else { -1.0 };
                    for (wheel, torque) in balance.total_torque(c, &a).into_iter().enumerate() {
                        signals[wheel * (columns + 1) + c] = side * torque;
                    }
                }
            }
            for (wheel, input) in input[k].as_array().iter().enumerate() {
                signals[wheel * (columns + 1) + columns] += input;
            }
        }
        filter_columns(&sections, (&mut signals, width), edge, Extension::Even);
        Movement { rows: rows.clone(), edge, signals, width }
    }
}
