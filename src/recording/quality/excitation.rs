//! What the driving excites: without turns, reversals or motion some parameters stay unknown.

use super::super::Recording;
use super::window::Window;
use super::{Finding, Severity, WHEELS, quantile};

/// Speed below which a wheel counts as standing, over the top speed [1].
const STANDING: f64 = 0.03;
/// Share of the moving windows below which a kind of motion counts as absent.
const ABSENT: f64 = 0.03;
/// Difference (sum) of the wheel speeds over the larger one, above which a robot turns (travels).
const TURNING: f64 = 0.15;
/// Share of standstill that is worth a word, and one that is a waste.
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
        out.push(Finding::new(
            severity,
            format!("the robot stands still for {:.0} % of the time", 100.0 * still),
            "standing shows neither inertia nor friction in motion; drive more",
        ));
    }
    out.extend(kinds(r, &moving));
    out.extend((0..2).filter_map(|i| one_way(&moving, i)));
    out
}

fn kinds(r: &Recording, moving: &[&Window]) -> Option<Finding> {
    if r.is_single_axis() {
        let what = "both wheels carry the same numbers";
        let remedy = "one axis written down twice: only a1 + a2 and one friction can be found";
        return Some(Finding::new(Severity::Note, what, remedy));
    }
    let share = |part: &dyn Fn(&Window) -> f64| {
        let found = moving
            .iter()
            .filter(|w| part(w).abs() > TURNING * w.speed[0].abs().max(w.speed[1].abs()));
        found.count() as f64 / moving.len() as f64
    };
    if share(&|w| w.speed[0] - w.speed[1]) < ABSENT {
        let remedy = "only the sum a1 + a2 can be found, and a3 not at all; record curves and turns \
                      as well";
        return Some(Finding::new(Severity::Warning, "the robot drives straight only", remedy));
    }
    if share(&|w| w.speed[0] + w.speed[1]) < ABSENT {
        let remedy =
            "only the difference a1 - a2 can be found; record straights and curves as well";
        return Some(Finding::new(Severity::Warning, "the robot turns on the spot only", remedy));
    }
    None
}

fn one_way(moving: &[&Window], i: usize) -> Option<Finding> {
    let top = quantile(moving.iter().map(|w| w.speed[i]), 0.99);
    let share = |sign: f64| {
        let turning = moving.iter().filter(|w| sign * w.speed[i] > STANDING * top);
        turning.count() as f64 / moving.len() as f64
    };
    let way = match (share(1.0) < 0.01, share(-1.0) < 0.01) {
        (false, true) => "forward",
        (true, false) => "backward",
        _ => return None,
    };
    Some(Finding::new(
        Severity::Note,
        format!("{} turns {way} only", WHEELS[i]),
        "a constant offset of its drive cannot be told from Coulomb friction; record reversals",
    ))
}
