//! Checks of every channel separately: constant values, limits, spikes, jumps, coarse steps.

use super::super::never_moves;
use super::super::noise::quantum;
use super::super::{DriveUnit, Recording};
use super::{Finding, Issue, Quantity, Severity, quantile};
use crate::math::median_high;

/// A spike deviates from both neighbours by this many times the ordinary deviation.
const SPIKE: f64 = 8.0;
/// Share of the largest values excluded when the ordinary deviation is estimated.
const RARE: f64 = 0.02;
/// Smallest step of an input, as a share of its range.
const STEP: f64 = 0.25;
/// Smallest jump of an angle \[rad\].
const JUMP: f64 = 0.3;
/// A limit is reached in at least this many samples and this share of them.
const AT_LIMIT: (usize, f64) = (20, 0.005);
/// Share of samples at the extreme above which the input is a command of constant magnitude.
const CONSTANT_COMMAND: f64 = 0.4;

/// Largest current \[A\], voltage \[V\] and torque \[N m\] of the motor of a wheel (taste: those of heavy vehicles are below).
const MOST: (f64, f64, f64) = (500.0, 1000.0, 1e4);

pub(super) fn findings(r: &Recording) -> Vec<Finding> {
    let mut out = Vec::new();
    for i in 0..2 {
        out.extend(still(r, i));
        out.extend(constant_input(r, i));
        out.extend(limit(r, i));
        out.extend(too_large(r, i));
        if r.measured().alpha {
            out.extend(jumps(r, i));
            out.extend(spikes(r, Quantity::Angle, i, r.alpha()));
        }
        if r.measured().omega {
            out.extend(coarse_speed(r, i));
            out.extend(spikes(r, Quantity::Speed, i, r.omega()));
        }
        out.extend(spikes(r, Quantity::Input, i, r.torque()));
    }
    out
}

fn extremes(values: &[[f64; 2]], i: usize) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v[i]), high.max(v[i])))
}

fn still(r: &Recording, i: usize) -> Option<Finding> {
    let (low, high) = extremes(r.omega(), i);
    let top = quantile(r.omega().iter().flatten().copied(), 0.99);
    // an encoder at rest may alternate between two counts
    let is_still = high.max(-low) <= 1e-3 * top || (low, high) == (0.0, 0.0);
    (is_still || shows_no_motion(r, i)).then(|| Finding::new(Severity::Warning, Issue::Still(i)))
}

/// Whether all sensors of wheel `i` show noise alone, or nothing.
pub(crate) fn shows_no_motion(r: &Recording, i: usize) -> bool {
    let of = |values: &[[f64; 2]]| values.iter().map(|v| v[i]).collect::<Vec<f64>>();
    let (input, measured) = (of(r.torque()), r.measured());
    let is_still = |values: &[[f64; 2]]| never_moves(&of(values), &input);
    (!measured.alpha || is_still(r.alpha())) && (!measured.omega || is_still(r.omega()))
}

fn constant_input(r: &Recording, i: usize) -> Option<Finding> {
    let (low, high) = extremes(r.torque(), i);
    let issue = Issue::ConstantInput { wheel: i, value: low, unit: r.drive_unit() };
    (low >= high).then(|| Finding::new(Severity::Warning, issue))
}

/// Inputs that no motor of a wheel has, as values in thousandths of their unit are.
fn too_large(r: &Recording, i: usize) -> Option<Finding> {
    let (unit, top) = (r.drive_unit(), quantile(r.torque().iter().map(|m| m[i]), 0.95));
    let most = match unit {
        DriveUnit::Ampere => MOST.0,
        DriveUnit::Volt => MOST.1,
        DriveUnit::NewtonMetre => MOST.2,
    };
    let issue = Issue::TooLarge { wheel: i, top, unit };
    (top > most).then(|| Finding::new(Severity::Warning, issue))
}

/// Many samples exactly at the largest or smallest input.
fn limit(r: &Recording, i: usize) -> Option<Finding> {
    let (low, high) = extremes(r.torque(), i);
    if low == high {
        return None;
    }
    let count = |x: f64| if x == 0.0 { 0 } else { r.torque().iter().filter(|m| m[i] == x).count() };
    let (extreme, samples) = [low, high].map(|x| (x, count(x))).into_iter().max_by_key(|c| c.1)?;
    let both = count(low) + count(high);
    let share = both as f64 / r.len() as f64;
    if samples < AT_LIMIT.0 || share < AT_LIMIT.1 || on_few_levels(r, i) || rests(r, i, extreme) {
        return None;
    }
    let (unit, is_command) = (r.drive_unit(), share > CONSTANT_COMMAND);
    let severity = if is_command { Severity::Note } else { Severity::Warning };
    let issue = Issue::AtLimit { wheel: i, value: extreme, unit, share, is_command };
    Some(Finding::new(severity, issue))
}

/// Smallest number of levels other than its extremes at which a command rests as long as at them (judgement).
const LEVELS: usize = 3;

/// Whether an input rests at other values than its extreme ones and zero as long as at an `extreme` one: a stick that is
/// held, not a limit.
fn rests(r: &Recording, i: usize, extreme: f64) -> bool {
    let (low, high) = extremes(r.torque(), i);
    let stays: Vec<(f64, usize)> = r
        .torque()
        .chunk_by(|a, b| a[i] == b[i])
        .map(|rows| (rows[0][i], rows.len()))
        .filter(|(_, rows)| *rows > 1)
        .collect();
    let at_it = stays.iter().filter(|(value, _)| *value == extreme);
    let usual = median_high(at_it.map(|(_, rows)| *rows as f64));
    let others = stays.iter().filter(|(value, _)| *value != low && *value != high && *value != 0.0);
    others.filter(|(_, rows)| *rows as f64 >= usual).count() >= LEVELS
}

/// Whether a channel is so coarse that every level occurs often, including the extreme ones.
fn on_few_levels(r: &Recording, i: usize) -> bool {
    let step = quantum(r.torque(), i);
    let (low, high) = extremes(r.torque(), i);
    step > 0.0 && high - low < 40.0 * step
}

/// Deviation of a sample from both its neighbours, if in the same direction; otherwise zero.
fn zigzag(w: &[[f64; 2]], i: usize) -> f64 {
    let (before, after) = (w[1][i] - w[0][i], w[1][i] - w[2][i]);
    if before * after > 0.0 { before.abs().min(after.abs()) } else { 0.0 }
}

/// Whether the input of a wheel steps in row `k` or in one of the two before it, by more than a quarter of its range
/// (judgement): a robot that is fast against the rows may then deviate from its neighbours for a single row.
pub(crate) fn steps_before(torque: &[[f64; 2]]) -> impl Fn(usize) -> bool {
    let range = [0, 1].map(|i| {
        let at = |share| quantile(torque.iter().map(|m| m[i]), share);
        at(0.99) - at(0.01)
    });
    move |k| {
        let steps = |j: usize| {
            let change = |i: usize| (torque[j][i] - torque[j - 1][i]).abs();
            (0..2).any(|i| change(i) > STEP * range[i])
        };
        (k.saturating_sub(2).max(1)..=k).any(steps)
    }
}

fn spikes(r: &Recording, channel: Quantity, i: usize, values: &[[f64; 2]]) -> Option<Finding> {
    let sizes = || values.windows(3).map(|w| zigzag(w, i));
    let positive = || sizes().filter(|z| *z > 0.0);
    let range = quantile(values.iter().map(|v| v[i]), 0.99);
    let ordinary = quantile(positive(), 1.0 - RARE).max(quantum(values, i));
    let limit = (SPIKE * quantile(positive(), 0.5))
        .max(2.0 * ordinary)
        .max(if channel == Quantity::Input { 0.15 } else { 0.05 } * range);
    let mut found: Vec<usize> =
        sizes().enumerate().filter(|(_, z)| *z > limit).map(|(k, _)| k + 1).collect();
    if channel == Quantity::Input {
        let answers = answers(r, i);
        found.retain(|k| !answers(*k));
    } else if !found.is_empty() {
        let steps = steps_before(r.torque());
        found.retain(|k| !steps(*k) && !turns(values, i, *k));
    }
    let first = *found.first()?;
    let around = [first - 1, first, first + 1].map(|k| values[k][i]);
    let severity = if channel == Quantity::Input { Severity::Note } else { Severity::Warning };
    let (count, t) = (found.len(), r.t()[first]);
    Some(Finding::new(severity, Issue::Spikes { channel, wheel: i, count, t, around }))
}

/// Whether the motion turns at sample `k`: the line through the two samples on one side of it reaches more than half of the way
/// to it, so that it is nearer to that line than to its neighbours.
fn turns(values: &[[f64; 2]], i: usize, k: usize) -> bool {
    let reaches = |near: usize, far: usize| {
        let at = |j: usize| values.get(j).map_or(f64::NAN, |v| v[i]);
        let (step, way) = (at(near) - at(far), at(k) - at(near));
        step * way > 0.0 && step.abs() > 0.5 * way.abs()
    };
    k >= 2 && reaches(k - 1, k - 2) || reaches(k + 1, k + 2)
}

/// Whether the speed of wheel `i` changes at row `k`, or from it to the next, as it does in one of fifty rows (judgement): a
/// wheel that starts or reverses in a single row answers to an input that lasts as long.
fn answers(r: &Recording, i: usize) -> impl Fn(usize) -> bool {
    let change = move |k: usize| (r.omega()[k][i] - r.omega()[k - 1][i]).abs();
    let usual = quantile((1..r.len()).map(change), 1.0 - RARE);
    move |k| (k..(k + 2).min(r.len())).any(|k| change(k) > usual)
}

/// Steps of an angle that the speed cannot explain.
fn jumps(r: &Recording, i: usize) -> Option<Finding> {
    let (t, alpha, omega) = (r.t(), r.alpha(), r.omega());
    let pairs = || r.pieces().iter().flat_map(|p| p.start + 1..p.end);
    let step = |k: usize| alpha[k][i] - alpha[k - 1][i];
    let unexplained = |k: usize| {
        if r.measured().omega {
            step(k) - 0.5 * (t[k] - t[k - 1]) * (omega[k][i] + omega[k - 1][i])
        } else {
            step(k)
        }
    };
    let limit = (6.0 * quantile(pairs().map(unexplained), 0.98)).max(JUMP);
    let found: Vec<usize> = pairs().filter(|&k| unexplained(k).abs() > limit).collect();
    let first = *found.first()?;
    let (count, t, size) = (found.len(), t[first], step(first));
    Some(Finding::new(Severity::Problem, Issue::Jumps { wheel: i, count, t, size }))
}

/// Speeds with a quantisation step that is a considerable part of the speed.
fn coarse_speed(r: &Recording, i: usize) -> Option<Finding> {
    let step = quantum(r.omega(), i);
    let top = quantile(r.omega().iter().map(|w| w[i]), 0.95);
    let is_coarse = r.measured().alpha && step > 0.05 * top && top > 0.0;
    is_coarse.then(|| Finding::new(Severity::Note, Issue::CoarseSpeed(i, step)))
}
