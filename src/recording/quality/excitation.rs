//! Checks of the excitation: without turns, reversals or motion some parameters are not identifiable.

use super::super::Recording;
use super::window::{Window, windows};
use super::{Finding, Issue, Severity, quantile};

/// Ratio of speed to top speed below which a wheel is at rest \[1\].
const STANDING: f64 = 0.03;
/// Ratio of the RMS difference (sum) of the wheel speeds to that of their sum (difference) below which turns (travel)
/// are absent: small differences between the wheels amount to a few percent (judgement).
const ABSENT: f64 = 0.1;
/// Number of successive rows with which a wheel turns, if all of them exceed the noise of the sensor: a reversal between
/// slow rows is shorter than a window.
const TURNING: usize = 3;
/// Standard deviations of its noise that such a speed exceeds: by chance three in a row in one of 10⁸.
const ABOVE_NOISE: f64 = 3.0;
/// Share of standstill that gives a note, and share that gives a warning.
const STANDSTILL: (f64, f64) = (0.3, 0.6);

/// A kind of movement that recordings lack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lacking {
    /// Turns: the robot drives straight only.
    Turns,
    /// Travel: the robot turns on the spot only.
    Travel,
}

/// The kind of movement that recordings of two wheels lack together, if one: each of those with any motion lacks it.
/// The turns of one recording are enough, however fast and long the others drive straight.
pub(crate) fn lacking(recordings: &[Recording]) -> Option<Lacking> {
    if recordings.iter().all(Recording::is_single_axis) {
        return None;
    }
    let each: Vec<Vec<Window>> = recordings.iter().map(windows).collect();
    let moving = each.iter().map(|windows| moving(windows)).filter(|windows| !windows.is_empty());
    let mut kinds = moving.map(|windows| lacking_in(&windows));
    let first = kinds.next().flatten()?;
    kinds.all(|kind| kind == Some(first)).then_some(first)
}

/// The windows in which a wheel moves.
fn moving(windows: &[Window]) -> Vec<&Window> {
    let top = quantile(windows.iter().flat_map(|w| w.size), 0.99);
    windows.iter().filter(|w| w.size[0].max(w.size[1]) > STANDING * top).collect()
}

/// What is absent: less than a hundredth of the squares of the other kind.
///
/// ```text
/// turns:  Σ (ω1 - ω2)² < ABSENT² Σ (ω1 + ω2)²      travel:  Σ (ω1 + ω2)² < ABSENT² Σ (ω1 - ω2)²
/// ```
fn lacking_in(moving: &[&Window]) -> Option<Lacking> {
    let square = |sign: f64| -> f64 {
        moving.iter().map(|w| (w.speed[0] + sign * w.speed[1]).powi(2)).sum()
    };
    let (travel, turns) = (square(1.0), square(-1.0));
    if turns < ABSENT * ABSENT * travel {
        return Some(Lacking::Turns);
    }
    (travel < ABSENT * ABSENT * turns).then_some(Lacking::Travel)
}

pub(super) fn findings(r: &Recording, windows: &[Window]) -> Vec<Finding> {
    let moving = moving(windows);
    if moving.is_empty() {
        return vec![]; // both wheels are reported as never moving
    }
    let mut out = Vec::new();
    let still = 1.0 - moving.len() as f64 / windows.len() as f64;
    if still > STANDSTILL.0 {
        let severity = if still > STANDSTILL.1 { Severity::Warning } else { Severity::Note };
        out.push(Finding::new(severity, Issue::Standstill(still)));
    }
    out.extend(kinds(r, &moving));
    out.extend((0..2).filter_map(|i| one_way(r, &moving, i)));
    out
}

fn kinds(r: &Recording, moving: &[&Window]) -> Option<Finding> {
    if r.is_single_axis() {
        return Some(Finding::new(Severity::Note, Issue::OneAxis));
    }
    let issue = match lacking_in(moving)? {
        Lacking::Turns => Issue::StraightOnly,
        Lacking::Travel => Issue::SpotOnly,
    };
    Some(Finding::new(Severity::Warning, issue))
}

fn one_way(r: &Recording, moving: &[&Window], i: usize) -> Option<Finding> {
    let top = quantile(moving.iter().map(|w| w.speed[i]), 0.99);
    let share = |sign: f64| {
        let turning = moving.iter().filter(|w| sign * w.speed[i] > STANDING * top);
        turning.count() as f64 / moving.len() as f64
    };
    let least = (STANDING * top).max(ABOVE_NOISE * r.noise().omega[i]);
    let lacks = |sign: f64| {
        let turns = |rows: &[[f64; 2]]| rows.iter().all(|w| sign * w[i] > least);
        share(sign) < 0.01 && !r.omega().windows(TURNING).any(turns)
    };
    let forward = match (lacks(1.0), lacks(-1.0)) {
        (false, true) => true,
        (true, false) => false,
        _ => return None,
    };
    Some(Finding::new(Severity::Note, Issue::OneWay(i, forward)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wheel_that_oscillates_moves() {
        let window = |speed: f64, size: f64| Window {
            speed: [speed; 2],
            size: [size; 2],
            acceleration: [0.0; 2],
            angle_rate: [speed; 2],
            torque: [0.0; 2],
        };
        // steady at 10 rad/s, about zero mean with 1 rad/s, and at rest
        let all = [window(10.0, 10.0), window(0.01, 1.0), window(0.0, 0.01)];
        assert_eq!(moving(&all), [&all[0], &all[1]]);
    }
}
