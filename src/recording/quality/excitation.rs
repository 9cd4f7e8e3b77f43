//! Checks of the excitation: without turns, reversals or motion some parameters are not identifiable.

use super::super::Recording;
use super::window::Window;
use super::{Finding, Issue, Severity, quantile};

/// Ratio of speed to top speed below which a wheel is at rest \[1\].
const STANDING: f64 = 0.03;
/// Share of the moving windows below which a kind of motion counts as absent.
const ABSENT: f64 = 0.03;
/// Difference (sum) of the wheel speeds relative to the larger one, above which a robot turns (travels).
const TURNING: f64 = 0.15;
/// Share of standstill that gives a note, and share that gives a warning.
const STANDSTILL: (f64, f64) = (0.3, 0.6);

pub(super) fn findings(r: &Recording, windows: &[Window]) -> Vec<Finding> {
    let top = quantile(windows.iter().flat_map(|w| w.speed), 0.99);
    let fastest = |w: &Window| w.speed[0].abs().max(w.speed[1].abs());
    let moving: Vec<&Window> = windows.iter().filter(|w| fastest(w) > STANDING * top).collect();
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
    out.extend((0..2).filter_map(|i| one_way(&moving, i)));
    out
}

fn kinds(r: &Recording, moving: &[&Window]) -> Option<Finding> {
    if r.is_single_axis() {
        return Some(Finding::new(Severity::Note, Issue::OneAxis));
    }
    let share = |part: &dyn Fn(&Window) -> f64| {
        let found = moving
            .iter()
            .filter(|w| part(w).abs() > TURNING * w.speed[0].abs().max(w.speed[1].abs()));
        found.count() as f64 / moving.len() as f64
    };
    if share(&|w| w.speed[0] - w.speed[1]) < ABSENT {
        return Some(Finding::new(Severity::Warning, Issue::StraightOnly));
    }
    if share(&|w| w.speed[0] + w.speed[1]) < ABSENT {
        return Some(Finding::new(Severity::Warning, Issue::SpotOnly));
    }
    None
}

fn one_way(moving: &[&Window], i: usize) -> Option<Finding> {
    let top = quantile(moving.iter().map(|w| w.speed[i]), 0.99);
    let share = |sign: f64| {
        let turning = moving.iter().filter(|w| sign * w.speed[i] > STANDING * top);
        turning.count() as f64 / moving.len() as f64
    };
    let forward = match (share(1.0) < 0.01, share(-1.0) < 0.01) {
        (false, true) => true,
        (true, false) => false,
        _ => return None,
    };
    Some(Finding::new(Severity::Note, Issue::OneWay(i, forward)))
}
