//! The next recording: the manoeuvre that distinguishes two effects, and the probability of success.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::candidate::Candidate;
use crate::filter::{
    Columns, Instant, Likelihood, PassSettings, Prepared, ProcessNoise, filter_pass,
};
use crate::math::distribution::normal_cdf;
use crate::math::eliminate;
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::kinematics;
use crate::simulate::{Movement, NoiseLevel, Recorder, Segment, record};

/// Limits of a manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Limits {
    /// Largest wheel speed [rad/s].
    pub speed: f64,
    /// Largest torque [N m].
    #[serde(rename = "moment")]
    pub torque: f64,
    /// Side of the square floor \[m\].
    pub floor: f64,
    /// Length \[s\].
    pub duration: f64,
}

/// A proposed manoeuvre and its expected result.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Proposal {
    /// The manoeuvre.
    pub movement: Movement,
    /// Expected probability of naming the correct one of the two after this recording.
    pub probability: f64,
    /// Statistic that the smaller of the two directions would reach (chi-square, one degree).
    pub discrimination: f64,
    /// The same for a random manoeuvre of the same length (median).
    pub random: f64,
}

/// Random manoeuvres that the search starts from.
const RANDOM: usize = 48;
/// Generations of an evolution strategy (3 parents, 12 children).
const GENERATIONS: usize = 10;
const PARENTS: usize = 3;
const CHILDREN: usize = 12;
/// Steps a second of the controller in the search; half the accuracy of a recording is enough.
const CONTROL_RATE: f64 = 200.0;

struct Pair<'a> {
    effects: [&'a Candidate; 2],
}

impl Columns for Pair<'_> {
    fn count(&self) -> usize {
        self.effects.iter().map(|c| c.columns()).sum()
    }
    fn torque(&self, at: &Instant, out: &mut [[f64; 2]]) {
        let first = self.effects[0].columns();
        self.effects[0].torque(0, at, &mut out[..first]);
        self.effects[1].torque(0, at, &mut out[first..]);
    }
}

/// Two effects, each with the coefficients of its columns as far as the data show them.
#[derive(Clone, Copy)]
pub struct Rivals<'a> {
    /// The candidates.
    pub effects: [&'a Candidate; 2],
    /// Their coefficients.
    pub sizes: [&'a [f64]; 2],
}

/// Designs a manoeuvre within `limits` that distinguishes two rivals.
///
/// ```text
/// T_A|B = θ_A' I_A|B θ_A,   I_A|B: information on A when base and B are free
/// maximise min(T_A|B, T_B|A);   P(right) = Φ(½ √T)
/// ```
/// The information is that of a noise-free simulated run under the noise of the recordings; the
/// best of random manoeuvres is improved by an evolution strategy. `None` where no manoeuvre
/// gives any information (the two are the same in the equations).
#[must_use]
pub fn next_run(
    model: &Model,
    p: &[f64],
    noise: &ProcessNoise,
    likelihood: &Likelihood,
    rivals: &Rivals,
    limits: &Limits,
    seed: u64,
) -> Option<Proposal> {
    let like = likelihood.prepared.first()?;
    let search = Search { model, p, noise, like, rivals, limits };
    let mut scored: Vec<(f64, Movement)> = (0..RANDOM as u64)
        .into_par_iter()
        .map(|k| {
            let top = limits.speed;
            let movement =
                Movement::rich(model.robot(), seed.wrapping_add(k), limits.duration, top);
            (search.value(&movement), movement)
        })
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let random = scored[RANDOM / 2].0.max(0.0);
    scored.truncate(PARENTS);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for generation in 0..GENERATIONS {
        let spread = 0.35 * 0.8_f64.powi(generation as i32);
        let children: Vec<Movement> = (0..CHILDREN)
            .map(|k| mutate(&scored[k % PARENTS].1, model, limits, spread, &mut rng))
            .collect();
        let values: Vec<f64> = children.par_iter().map(|m| search.value(m)).collect();
        scored.extend(values.into_iter().zip(children));
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        scored.truncate(PARENTS);
    }
    let (discrimination, movement) = scored.into_iter().next()?;
    (discrimination > 0.0).then(|| Proposal {
        movement,
        probability: normal_cdf(0.5 * discrimination.sqrt()),
        discrimination,
        random,
    })
}

struct Search<'a> {
    model: &'a Model,
    p: &'a [f64],
    noise: &'a ProcessNoise,
    like: &'a Prepared<'a>,
    rivals: &'a Rivals<'a>,
    limits: &'a Limits,
}

impl Search<'_> {
    /// Discrimination, reduced if the manoeuvre exceeds the limits; zero if it cannot be simulated.
    fn value(&self, movement: &Movement) -> f64 {
        let rate = (1.0 / self.like.recording.step()).min(CONTROL_RATE);
        let recorder = Recorder {
            rate,
            control_rate: CONTROL_RATE.max(rate),
            noise: NoiseLevel::default(),
            ticks: None,
            seed: 0,
        };
        let Ok(run) = record("design", self.model, self.p, movement, &recorder) else { return 0.0 };
        let penalty = self.penalty(&run);
        self.discrimination(&run).map_or(0.0, |t| t * penalty)
    }

    fn discrimination(&self, run: &Recording) -> Option<f64> {
        let mut prepared = crate::filter::prepare(run);
        prepared.variance = self.like.variance;
        prepared.used = self.like.used;
        prepared.speed_variance = self.like.speed_variance;
        let settings = PassSettings {
            noise: *self.noise,
            derivatives: true,
            keep_innovations: false,
            input_noise: false,
            step_scatter: 1.0,
        };
        // columns that are signals belong to the recordings they were made for
        let columns = self.rivals.effects.map(|c| c.for_recordings(&[run]));
        let pair = Pair { effects: [&columns[0], &columns[1]] };
        let pass = filter_pass(self.model, self.p, &prepared, &settings, &pair).ok()?;
        let first = self.p.len();
        let widths = [columns[0].columns(), columns[1].columns()];
        let own = [
            (first..first + widths[0]).collect::<Vec<_>>(),
            (first + widths[0]..first + widths[0] + widths[1]).collect::<Vec<_>>(),
        ];
        let part = |i: usize| {
            let mut base = self.model.free();
            base.extend(&own[1 - i]);
            let (information, _) = eliminate(&pass.information, &pass.score, &base, &own[i]);
            let theta = nalgebra::DVector::from_row_slice(self.rivals.sizes[i]);
            theta.dot(&(information * &theta)).max(0.0)
        };
        Some(part(0).min(part(1))).filter(|t| t.is_finite())
    }

    /// One within the limits, falling fast outside.
    fn penalty(&self, run: &Recording) -> f64 {
        let path = kinematics::path(self.model.robot(), run.alpha());
        let extent = |i: usize| {
            let values = path.iter().map(|p| p[i]);
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            high - low
        };
        let room = extent(0).max(extent(1)) / self.limits.floor;
        let largest = run.torque().iter().flatten().fold(0.0_f64, |a, m| a.max(m.abs()));
        let fastest = run.omega().iter().flatten().fold(0.0_f64, |a, w| a.max(w.abs()));
        let over = |ratio: f64| (1.0_f64 / ratio.max(1.0)).powi(8);
        over(room) * over(largest / self.limits.torque) * over(fastest / (1.1 * self.limits.speed))
    }
}

fn mutate(
    parent: &Movement,
    model: &Model,
    limits: &Limits,
    spread: f64,
    rng: &mut ChaCha8Rng,
) -> Movement {
    let robot = model.robot();
    let mut normal = || -> f64 { StandardNormal.sample(rng) };
    let mut segments: Vec<Segment> = Vec::with_capacity(parent.segments.len());
    let last = parent.segments.len() - 1;
    for (k, segment) in parent.segments.iter().enumerate() {
        let mut s = *segment;
        if k > 0 && k < last {
            let (r, l1) = (robot.r(), robot.l1());
            let (mean, half) = (s.speed_m_s / r, s.turn_rad_s * l1 / r);
            let wheels = [mean + half, mean - half]
                .map(|w| (w + spread * limits.speed * normal()).clamp(-limits.speed, limits.speed));
            s.speed_m_s = 0.5 * r * (wheels[0] + wheels[1]);
            s.turn_rad_s = 0.5 * r / l1 * (wheels[0] - wheels[1]);
            s.blend_s = (s.blend_s * (spread * normal()).exp()).clamp(0.1, 3.0);
            s.hold_s = (s.hold_s * (spread * normal()).exp()).clamp(0.05, 3.0);
        }
        segments.push(s);
    }
    // the duration is unchanged
    let movement = Movement { segments };
    let factor = limits.duration / movement.duration();
    let stretch =
        |s: &Segment| Segment { hold_s: s.hold_s * factor, blend_s: s.blend_s * factor, ..*s };
    let out = Movement { segments: movement.segments.iter().map(stretch).collect() };
    if rng.random::<f64>() < 0.1 { shuffled(out, rng) } else { out }
}

/// Exchanges two inner segments.
fn shuffled(mut movement: Movement, rng: &mut ChaCha8Rng) -> Movement {
    let count = movement.segments.len();
    if count > 4 {
        let (a, b) = (rng.random_range(1..count - 1), rng.random_range(1..count - 1));
        movement.segments.swap(a, b);
    }
    movement
}
