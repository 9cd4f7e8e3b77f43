//! Candidates: effects that may be missing, each with the torque columns that show it.

use std::sync::Arc;

use crate::effects::{DIRECTIONS, Effect, Motion, ParameterKind, along};
use crate::identify::kalman::{Instant, unclear};
use crate::math::{Real, sgn};
use crate::model::Model;
use crate::recording::{LocalMotion, Recording};

/// Speeds below this share of the top speed are smoothed over where an effect brings a friction
/// direction of its own (the model has no filter variance for it).
const REST: f64 = 0.004;
/// Top speed of the AmigoBot, to which the grid of Stribeck speeds belongs [rad/s].
const AMIGOBOT_SPEED: f64 = 12.0;

/// An effect at one value of its shape, ready to ride along in a filter pass.
#[derive(Clone)]
pub struct Candidate {
    /// Id of the effect.
    pub id: String,
    /// The effect.
    pub effect: Arc<dyn Effect>,
    /// Its parameters: shapes at their grid value, linear ones at zero.
    pub p: Vec<f64>,
    /// Places of the linear parameters in `p`, one column each. A drive effect has one column.
    pub linear: Vec<usize>,
    /// Number of grid values of this effect: the price of choosing the best.
    pub grid: usize,
    /// How a column is computed.
    pub form: Form,
    /// Speed below which a friction direction of its own is smoothed [rad/s].
    rest: f64,
}

/// How the column of a candidate is computed.
#[derive(Clone)]
pub enum Form {
    /// From the instant: what the effect adds to the moment balance.
    Instant,
    /// A change of the recorded drive, one signal a recording, per unit of the drive parameter.
    Signal(Arc<Vec<Vec<[f64; 2]>>>),
}

/// All candidates of a model: registered effects and the user's `own` that it lacks (or those named),
/// at every value of their shape grid. Effects that are the same for any wheel recording appear once;
/// those that put a body behind the wheels, and formulas without a linear parameter, are left out.
#[must_use]
pub fn candidates(
    model: &Model,
    named: &[String],
    own: &[Arc<dyn Effect>],
    recordings: &[&Recording],
) -> Vec<Candidate> {
    let present = model.effect_ids();
    let held = (0..3).any(|j| model.parameters()[j].fixed.is_some());
    let mut out: Vec<Candidate> = Vec::new();
    let scale = Scale::of(recordings);
    let registered = crate::effects::all().into_iter().map(Arc::from);
    for effect in registered.chain(own.iter().cloned()) {
        let description = effect.description();
        let id = description.id.clone();
        let asked = named.is_empty() || named.contains(&id);
        let twin = description
            .equivalent
            .iter()
            .any(|e| present.contains(e) || out.iter().any(|c| c.id == *e));
        // payload is another a1, a2 unless those are held at the construction data
        if !asked || present.contains(&id) || twin || (id == "payload" && !held) {
            continue;
        }
        // the filter carries no body behind the wheels
        if model.add_effect(effect.clone()).is_ok_and(|with| with.is_coupled()) {
            continue;
        }
        out.extend(grid(&id, &effect, &scale, recordings).into_iter().filter(|c| c.columns() > 0));
    }
    if recordings.iter().all(|r| r.is_single_axis()) {
        let motions: Vec<_> = recordings.iter().map(|r| r.local_motion()).collect();
        out.retain(|candidate| candidate.treats_wheels_alike(model, recordings[0], &motions[0]));
        // turning effects do nothing here, and a slope of one heading is an offset
        out.retain(|candidate| {
            let sizes = common_size(candidate, model, recordings[0], &motions[0]);
            let largest = sizes.iter().fold(0.0_f64, |a, b| a.max(*b));
            sizes.iter().all(|size| *size > 1e-9 * largest)
        });
    }
    out
}

/// Size of the signals, which sets the grids of shape parameters.
struct Scale {
    moment: f64,
    step: f64,
    duration: f64,
    speed: f64,
    /// Largest angle that a wheel goes through [rad].
    angle: f64,
}

impl Scale {
    fn of(recordings: &[&Recording]) -> Self {
        let largest = recordings
            .iter()
            .flat_map(|r| r.moment().iter().flatten())
            .fold(0.0_f64, |a, m| a.max(m.abs()));
        let step = recordings.iter().map(|r| r.step()).fold(0.0, f64::max);
        let duration = recordings.iter().map(|r| r.duration()).fold(0.0, f64::max);
        let speed = recordings.iter().map(|r| r.top_speed()).fold(0.0, f64::max);
        let span = |r: &Recording, i: usize| {
            let angles = || r.alpha().iter().map(|a| a[i]);
            angles().fold(f64::MIN, f64::max) - angles().fold(f64::MAX, f64::min)
        };
        let spans = recordings.iter().flat_map(|r| [span(r, 0), span(r, 1)]);
        let angle = spans.fold(0.0, f64::max);
        Self { moment: largest, step, duration, speed, angle }
    }
}

fn grid(
    id: &str,
    effect: &Arc<dyn Effect>,
    scale: &Scale,
    recordings: &[&Recording],
) -> Vec<Candidate> {
    let specs = effect.parameters();
    let shape = specs.iter().position(|s| s.kind == ParameterKind::Shape);
    let values: Vec<f64> = match shape {
        None => vec![f64::NAN],
        Some(j) => shape_values(id, specs[j].typical, scale)
            .into_iter()
            .filter(|v| *v >= specs[j].range.0 && *v <= specs[j].range.1)
            .collect(),
    };
    // a wave of which less than a period was driven is an offset in disguise
    let goes_round = |value: f64| match id {
        "torque_ripple" => value * scale.angle >= std::f64::consts::TAU,
        "wheel_eccentricity" => scale.angle >= std::f64::consts::TAU,
        _ => true,
    };
    let values: Vec<f64> = values.into_iter().filter(|v| goes_round(*v)).collect();
    let count = values.len();
    values
        .into_iter()
        .map(|value| {
            let mut p: Vec<f64> = specs
                .iter()
                .map(|s| if s.kind == ParameterKind::Shape { s.typical } else { 0.0 })
                .collect();
            if let Some(j) = shape {
                p[j] = value;
            }
            let linear: Vec<usize> =
                (0..specs.len()).filter(|&j| specs[j].kind == ParameterKind::Linear).collect();
            let form = if effect.acts_on_drive() {
                Form::Signal(Arc::new(signals(effect, &p, &linear, recordings)))
            } else {
                Form::Instant
            };
            Candidate {
                id: id.into(),
                effect: effect.clone(),
                p,
                linear,
                grid: count,
                form,
                rest: REST * scale.speed,
            }
        })
        .collect()
}

/// Grid of the shape parameter of an effect.
fn shape_values(id: &str, typical: f64, scale: &Scale) -> Vec<f64> {
    match id {
        "stribeck" => [0.15, 0.3, 0.6, 1.2, 2.4].map(|w| w * scale.speed / AMIGOBOT_SPEED).to_vec(),
        "friction_warmup" => {
            [2.0, 5.0, 10.0, 20.0, 40.0].into_iter().filter(|t| *t < 2.0 * scale.duration).collect()
        }
        "torque_saturation" => [0.5, 0.65, 0.8, 0.9].map(|s| s * scale.moment).to_vec(),
        "backlash_deadzone" => [0.02, 0.05, 0.1].map(|s| s * scale.moment).to_vec(),
        "actuator_lag" | "actuator_delay" => vec![scale.step],
        "torque_ripple" => (2..=16).map(f64::from).collect(),
        _ if crate::effects::find(id).is_some() => vec![typical],
        // of a formula nothing is known but where the user looks for its shape
        _ => [0.25, 0.5, 1.0, 2.0, 4.0].map(|s| s * typical).to_vec(),
    }
}

/// The change of the drive that a drive effect makes, per unit of its parameter where that is
/// small and smooth (lag, delay, gain), for the whole change otherwise.
fn signals(
    effect: &Arc<dyn Effect>,
    p: &[f64],
    linear: &[usize],
    recordings: &[&Recording],
) -> Vec<Vec<[f64; 2]>> {
    recordings
        .iter()
        .map(|recording| {
            let smooth = smoothed_drive(recording);
            let (mut q, size) = (p.to_vec(), 1e-3);
            let unit = match linear.first() {
                Some(&j) => {
                    q[j] = size;
                    size
                }
                None if is_time(effect) => p[0],
                None => 1.0,
            };
            let changed = effect.drive(recording.t(), &smooth, &q).unwrap_or(smooth.clone());
            changed
                .iter()
                .zip(&smooth)
                .map(|(c, s)| [(c[0] - s[0]) / unit, (c[1] - s[1]) / unit])
                .collect()
        })
        .collect()
}

/// Whether the effect shifts the drive in time, so that its column is a derivative.
fn is_time(effect: &Arc<dyn Effect>) -> bool {
    effect.parameters().first().is_some_and(|s| s.unit == "s")
}

/// The recorded drive without its noise: the mean over five samples (two to either side).
#[must_use]
pub(super) fn smoothed_drive(recording: &Recording) -> Vec<[f64; 2]> {
    let m = recording.moment();
    let mut out = m.to_vec();
    for piece in recording.pieces() {
        for k in piece.clone() {
            let half = 2.min(k - piece.start).min(piece.end - 1 - k);
            let count = (2 * half + 1) as f64;
            out[k] =
                [0, 1].map(|i| m[k - half..=k + half].iter().map(|v| v[i]).sum::<f64>() / count);
        }
    }
    out
}

impl Candidate {
    /// The same candidate with its signals made for other recordings.
    #[must_use]
    pub fn for_recordings(&self, recordings: &[&Recording]) -> Self {
        let form = match self.form {
            Form::Instant => Form::Instant,
            Form::Signal(_) => {
                Form::Signal(Arc::new(signals(&self.effect, &self.p, &self.linear, recordings)))
            }
        };
        Self { form, ..self.clone() }
    }

    /// Whether the effect can act the same on both wheels of a single axis: one column that does,
    /// or a column a wheel.
    fn treats_wheels_alike(
        &self,
        model: &Model,
        recording: &Recording,
        motion: &[LocalMotion],
    ) -> bool {
        if self.columns() != 1 {
            return true;
        }
        let mut row = [[0.0; 2]];
        motion.iter().enumerate().step_by(11).all(|(k, m)| {
            self.torque(0, &instant(model, recording, k, m), &mut row);
            (row[0][0] - row[0][1]).abs() <= 1e-9 * row[0][0].abs()
        })
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        match self.form {
            Form::Instant => self.linear.len(),
            Form::Signal(_) => 1,
        }
    }

    /// Whether the estimate of column `c` may not be negative.
    #[must_use]
    pub fn not_negative(&self, c: usize) -> bool {
        match self.form {
            Form::Instant => self.effect.parameters()[self.linear[c]].range.0 >= 0.0,
            Form::Signal(_) => {
                self.linear.is_empty() || self.effect.parameters()[self.linear[c]].range.0 >= 0.0
            }
        }
    }

    /// Writes the torque of each column on the drive side [N m].
    pub fn torque(&self, recording: usize, at: &Instant, out: &mut [[f64; 2]]) {
        self.torque_with(recording, at, &signs(at, self.rest), out);
    }

    /// The friction signs at an instant, the same for all candidates of one list.
    pub(super) fn signs(&self, at: &Instant) -> [f64; 4] {
        signs(at, self.rest)
    }

    /// [`Candidate::torque`] with friction signs that are known.
    pub(super) fn torque_with(
        &self,
        recording: usize,
        at: &Instant,
        sign: &[f64; 4],
        out: &mut [[f64; 2]],
    ) {
        match &self.form {
            Form::Signal(signals) => {
                let signal = &signals[recording];
                let (a, b) = (signal[at.sample], signal[(at.sample + 1).min(signal.len() - 1)]);
                out[0] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
            }
            Form::Instant => {
                let mut p = [0.0; 8];
                p[..self.p.len()].copy_from_slice(&self.p);
                for (column, &j) in out.iter_mut().zip(&self.linear) {
                    p[j] = 1.0;
                    let terms = self.effect.terms(&at.motion, &p[..self.p.len()]);
                    *column = terms.moment(&at.acceleration, sign).map(|v| -v);
                    p[j] = 0.0;
                }
            }
        }
    }
}

/// Friction signs in all directions; those that the model has none of are smoothed by the spread
/// of the filter's speeds.
fn signs(at: &Instant, rest: f64) -> [f64; 4] {
    let spread = [at.motion.variance[2], at.motion.variance[3], at.spread[0], at.spread[1]];
    let mut sign = at.sign;
    for j in 0..DIRECTIONS.len() {
        let v = along(j, &at.motion.omega);
        if sign[j] == 0.0 && !unclear(j, v, spread[j]) {
            let width = (2.0 * spread[j].max(0.0) + rest * rest).sqrt();
            sign[j] = if width > 0.0 { Real::erf(v / width) } else { sgn(v) };
        }
    }
    sign
}

/// An instant of the smooth motion, where no filter has run.
fn instant<'a>(model: &'a Model, recording: &Recording, k: usize, m: &LocalMotion) -> Instant<'a> {
    Instant {
        sample: k,
        motion: Motion {
            t: recording.t()[k] - recording.t()[0],
            alpha: m.alpha,
            omega: m.omega,
            variance: [0.0; 4],
            robot: model.robot(),
        },
        acceleration: m.acceleration,
        sign: [0.0; 4],
        spread: [0.0; 2],
        drive: recording.moment()[k],
    }
}

/// What the two wheels have in common of each column of a candidate: largest value [N m per unit].
fn common_size(
    candidate: &Candidate,
    model: &Model,
    recording: &Recording,
    motion: &[LocalMotion],
) -> Vec<f64> {
    let mut largest = vec![0.0_f64; candidate.columns()];
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (k, m) in motion.iter().enumerate().step_by(7) {
        candidate.torque(0, &instant(model, recording, k, m), &mut row);
        for (size, torque) in largest.iter_mut().zip(&row) {
            *size = size.max((torque[0] + torque[1]).abs());
        }
    }
    largest
}

/// The effect of a candidate seen on the smooth `motions` of the recordings, to know its size: root
/// mean square of each column over them [N m per unit].
#[must_use]
pub(super) fn column_size(
    candidate: &Candidate,
    model: &Model,
    recordings: &[&Recording],
    motions: &[Vec<LocalMotion>],
) -> Vec<f64> {
    let mut sums = vec![0.0; candidate.columns()];
    let mut count = 0.0;
    let mut row = vec![[0.0; 2]; candidate.columns()];
    for (r, (recording, motion)) in recordings.iter().zip(motions).enumerate() {
        for (k, m) in motion.iter().enumerate().step_by(7) {
            let at = instant(model, recording, k, m);
            candidate.torque(r, &at, &mut row);
            for (sum, torque) in sums.iter_mut().zip(&row) {
                *sum += torque[0] * torque[0] + torque[1] * torque[1];
            }
            count += 2.0;
        }
    }
    sums.iter().map(|s| (s / f64::max(count, 1.0)).sqrt().max(1e-12)).collect()
}
