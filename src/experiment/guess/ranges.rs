//! Distances: the path of a wheel, or that to an obstacle.

use super::guessed::{Candidate, Guess};
use super::names::{Quantity, Side, is_distance};
use super::relations::is_slope;

/// Share of the range of a path within which it starts at zero.
const START: f64 = 0.01;

/// Removes the quantity of distances that no wheel has covered, and asks where no speed shows it: a path is the
/// integral of the speed of its wheel, and starts at zero or becomes negative; a distance to an obstacle does neither.
pub(super) fn apply(all: &mut [Candidate], guess: &Guess) -> Option<String> {
    let found: Vec<usize> = (0..all.len()).filter(|k| is_one(&all[*k])).collect();
    let time = guess.columns.first().filter(|c| c.key == "t").map(|c| c.name.clone());
    let others: Vec<bool> =
        found.iter().map(|k| !is_path(&all[*k], all, time.as_deref())).collect();
    let forgotten: Vec<usize> =
        found.iter().zip(&others).filter(|(_, other)| **other).map(|(k, _)| *k).collect();
    for k in &forgotten {
        all[*k].named.quantity = None;
        all[*k].named.foreign = true;
    }
    let names: Vec<String> =
        forgotten.iter().map(|k| format!("`{}`", all[*k].column.name)).collect();
    (!names.is_empty() && !all.iter().any(moves)).then(|| {
        format!(
            "are {} the distances that the wheels have covered? Then write them as alpha1 and alpha2, with their unit; \
             distances to obstacles are not used",
            names.join(" and ")
        )
    })
}

fn is_one(c: &Candidate) -> bool {
    c.named.quantity == Some(Quantity::Angle) && is_distance(&c.named.word)
}

fn moves(c: &Candidate) -> bool {
    let side = matches!(c.named.side, Some(Side::Right | Side::Left | Side::Numbered(_)));
    side && (matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed)) || is_bare(c))
}

/// A `v` is a speed or a voltage.
fn is_bare(c: &Candidate) -> bool {
    c.named.word == "v" && c.named.unit.is_none()
}

fn is_path(one: &Candidate, all: &[Candidate], time: Option<&str>) -> bool {
    let values = &one.column.values;
    let columns = || all.iter().map(|c| c.column);
    let time = time.and_then(|name| columns().find(|c| c.name == name));
    let is_speed = |c: &&Candidate| {
        c.named.side == one.named.side
            && c.column.values.len() == values.len()
            && !c.named.wished
            && (c.named.quantity == Some(Quantity::Speed) || is_bare(c))
    };
    let mut speeds = all.iter().filter(is_speed).peekable();
    match time.filter(|t| t.values.len() == values.len() && speeds.peek().is_some()) {
        Some(time) => speeds.any(|c| is_slope(&time.values, values, &c.column.values)),
        None => starts_at_zero(values),
    }
}

fn starts_at_zero(values: &[f64]) -> bool {
    let held = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) =
        held().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    low < 0.0 || held().next().is_some_and(|first| first < START * (high - low))
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    fn column(name: &str, f: impl Fn(f64) -> f64) -> PreviewColumn {
        let values = (0..800).map(|k| f(0.02 * f64::from(k))).collect();
        PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
    }

    fn speed(t: f64) -> f64 {
        8.0 * (1.3 * t).sin()
    }

    fn path(t: f64) -> f64 {
        0.3 * (1.0 - (1.3 * t).cos())
    }

    fn range(t: f64) -> f64 {
        1.5 + 0.4 * (0.7 * t).sin()
    }

    #[test]
    fn distances_to_obstacles_are_no_angles() {
        let log = |speeds: bool, distance: fn(f64) -> f64| {
            let mut all = vec![column("t", |t| t)];
            all.extend(["dist_left", "dist_right"].map(|name| column(name, distance)));
            all.extend(["curr_l", "curr_r"].map(|name| column(name, |t| t.cos())));
            if speeds {
                all.extend(["w_l", "w_r"].map(|name| column(name, speed)));
            }
            guess(&all)
        };
        let has = |g: &super::Guess, key: &str| g.columns.iter().any(|c| c.key == key);
        assert!(has(&log(false, path), "alpha1") && has(&log(true, path), "alpha1"));
        let g = log(true, range);
        assert!(!has(&g, "alpha1") && has(&g, "dalpha1") && !g.asked().contains("dist_"));
        let g = log(false, range);
        assert!(!has(&g, "alpha1") && !has(&g, "dalpha1"), "{:?}", g.columns);
        assert!(g.asked().contains("the distances that the wheels"));
        for name in ["range", "sonar", "ir", "tof_mm", "ultrasonic_cm", "lidar"] {
            let [l, r] = ["left", "right"].map(|side| match name.split_once('_') {
                Some((front, unit)) => format!("{front}_{side}_{unit}"),
                None => format!("{name}_{side}"),
            });
            let g = guess(&[
                column("t", |t| t),
                column(&l, range),
                column(&r, range),
                column("v_l", speed),
                column("v_r", speed),
                column("curr_l", f64::cos),
                column("curr_r", f64::cos),
            ]);
            assert!(!has(&g, "alpha1") && has(&g, "dalpha1"), "{name}: {:?}", g.columns);
            assert!(!g.asked().contains(name.split('_').next().unwrap()), "{}", g.asked());
        }
    }
}
