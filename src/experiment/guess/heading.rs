//! The heading of the robot as logged beside its wheels.

use std::f64::consts::{PI, TAU};

use super::guessed::{Guess, Guessed};
use super::names::{WISHED, named};
use super::times::{row_step, seconds};
use super::values::values_of;
use crate::io::{PreviewColumn, words};

/// Words of a heading, and those of its rate and of one that was not measured.
const HEADINGS: [&str; 2] = ["heading", "yaw"];
const RATES: [&str; 6] = ["rate", "vel", "velocity", "speed", "gyro", "error"];
/// Time over which angles are compared \[s\]: steps of an encoder and momentary slip are small against its motion.
const PASSED: f64 = 0.25;

/// Changes of the heading and of the wheels over the same intervals.
pub(super) struct Turned {
    /// Name of the column of the heading.
    pub(super) name: String,
    /// Changes of the heading \[rad\].
    pub(super) heading: Vec<f64>,
    /// Changes of the right and of the left wheel, \[rad\] or \[m\].
    pub(super) wheels: [Vec<f64>; 2],
    /// Whether those of the wheels are in metres.
    pub(super) in_metres: bool,
}

/// The changes over a quarter of a second, one after the other or (`sliding`) from every row. `None` without a heading
/// of known unit, a time and angles of both wheels.
pub(super) fn turned(columns: &[PreviewColumn], guess: &Guess, sliding: bool) -> Option<Turned> {
    let of = |key: &str| guess.columns.iter().find(|c| c.key == key);
    let (t, right, left) = (of("t")?, of("alpha1")?, of("alpha2")?);
    let (column, factor) = columns.iter().find_map(|c| Some((c, unit_of_heading(&c.name)?)))?;
    let [by_right, by_left] = [factor_of(right)?, factor_of(left)?];
    let angles = [&right.name, &left.name].map(|name| values_of(columns, name));
    let step = row_step(values_of(columns, &t.name), t.sum)? * seconds(t) * t.scale.unwrap_or(1.0);
    let rows = ((PASSED / step).round() as usize).max(1);
    let count = column.values.len();
    if right.name == left.name || angles.iter().any(|a| a.len() != count) || count <= rows {
        return None;
    }
    let heading = unwrapped(&column.values, factor);
    let starts = (0..count - rows).step_by(if sliding { 1 } else { rows });
    let changes = |values: &[f64], by: f64| -> Vec<f64> {
        starts.clone().map(|k| by * (values[k + rows] - values[k])).collect()
    };
    Some(Turned {
        name: column.name.clone(),
        heading: changes(&heading, 1.0),
        wheels: [changes(angles[0], by_right), changes(angles[1], by_left)],
        in_metres: right.is_in_metres(),
    })
}

/// Radians per unit of a measured heading, if the name is that of one and states its unit.
fn unit_of_heading(name: &str) -> Option<f64> {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|w| list.contains(&w.as_str()));
    let per_unit = match named(name).unit? {
        "rad" => 1.0,
        "deg" => PI / 180.0,
        _ => return None,
    };
    (has(&HEADINGS) && !has(&RATES) && !has(&WISHED)).then_some(per_unit)
}

/// Factor to radians or metres of an angle with its sign; `None` where its unit is not known.
fn factor_of(angle: &Guessed) -> Option<f64> {
    let unit = match (angle.unit.as_deref(), angle.per_turn) {
        (None, None) if !angle.unit_open => 1.0,
        (Some("rev"), _) => TAU,
        (Some("deg"), _) => PI / 180.0,
        (Some("mrad" | "mm"), _) => 1e-3,
        (Some("cm"), _) => 1e-2,
        (Some("ft"), _) => 0.3048,
        (Some("in"), _) => 0.0254,
        (Some("m"), _) => 1.0,
        (Some("ticks"), Some(turn)) => TAU / turn,
        _ => return None,
    };
    Some(unit * angle.scale.unwrap_or(1.0))
}

/// A heading \[rad\] without its jumps of a turn.
fn unwrapped(values: &[f64], factor: f64) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = f64::NAN;
    let one = |value: &f64| {
        let now = factor * value;
        if (now - last).abs() > PI {
            turns += TAU * (last - now).signum();
        }
        if now.is_finite() {
            last = now;
        }
        now + turns
    };
    values.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_headings_of_known_unit_are_taken() {
        for (name, expected) in [
            ("heading [rad]", Some(1.0)),
            ("yaw_deg", Some(PI / 180.0)),
            ("heading", None),
            ("heading_rate [rad/s]", None),
            ("yaw target [deg]", None),
        ] {
            assert_eq!(unit_of_heading(name), expected, "{name}");
        }
        let turning: Vec<f64> = (0..40).map(|k| (15 * k) as f64 % 360.0).collect();
        let passed = unwrapped(&turning, PI / 180.0);
        assert!((passed[39] - passed[0] - 39.0 * PI / 12.0).abs() < 1e-12);
    }
}
