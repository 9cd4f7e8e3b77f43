//! Units of speeds that can only be asked for.

use std::f64::consts::{PI, TAU};

use super::guessed::{Guess, Guessed};
use super::names::named;
use super::values::{largest, seconds, values_of};
use crate::io::PreviewColumn;

/// Wheel speed beyond which a number is rather one of rpm [rad/s].
const FAST: f64 = 120.0;
/// Words of a speed that do not state its unit; `omega` and the like are angular speeds in SI.
const GENERAL: [&str; 9] =
    ["", "v", "speed", "vel", "velo", "velocity", "velocities", "drehzahl", "geschwindigkeit"];
/// Words of an angle that do not state its unit.
const POSITIONS: [&str; 9] =
    ["", "enc", "encoder", "pos", "position", "positions", "distance", "dist", "travel"];
/// Radius of the wheels with which candidates are compared \[m\].
const RADIUS: f64 = 0.05;
/// Part by which a speed may differ from the slope of its angle.
const ALIKE: f64 = 0.1;

/// Whether a speed is in a unit that nobody stated and that is none of SI.
pub(super) fn is_unknown(values: &[f64], one: &Guessed) -> bool {
    let is_stated = one.unit.is_some() || named(&one.name).unit.is_some();
    !is_stated && largest(values) * one.scale.unwrap_or(1.0).abs() > FAST
}

/// Asks for the unit of speeds that names do not state and angles do not show. Both wheels have one unit.
pub(super) fn open(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |name: &str| values_of(columns, name);
    let is_joint = guess.columns.iter().any(|c| c.key == "M1" && is_effort(&c.name));
    angles(columns, guess, is_joint);
    let is_open = |one: &Guessed| {
        let name = named(&one.name);
        let is_general = one.name != one.key
            && one.unit.is_none()
            && name.unit.is_none()
            && GENERAL.contains(&name.word.as_str())
            && !(is_joint && name.word == "velocity");
        one.key.starts_with("dalpha")
            && (is_unknown(of(&one.name), one) || is_general && !agrees(columns, guess, one))
    };
    let Some(first) = guess.columns.iter().find(|c| is_open(c)) else { return };
    let top = largest(of(&first.name)) * first.scale.unwrap_or(1.0).abs();
    let digits = if top < 10.0 { 3 } else { 0 };
    let ground = |by: f64| format!("{:.2}", RADIUS * by * top);
    guess.questions.push(format!(
        "{} up to {top:.digits$}: in rad/s, rpm, deg/s, rev/s, ticks/s, m/s, cm/s or mm/s? Write it as unit (wheels of {RADIUS} m \
         would go {} m/s as rad/s, {} as rpm, {} as deg/s, {} as rev/s)",
        first.asks_unit(),
        ground(1.0),
        ground(TAU / 60.0),
        ground(PI / 180.0),
        ground(TAU)
    ));
    let speeds = guess.columns.iter_mut().filter(|c| c.key.starts_with("dalpha"));
    speeds.filter(|c| c.unit.is_none()).for_each(|c| c.unit_open = true);
}

/// Asks for the unit of angles under the general names of a sensor or a position, where the speeds beside them do not
/// show it.
fn angles(columns: &[PreviewColumn], guess: &mut Guess, is_joint: bool) {
    let of = |name: &str| values_of(columns, name);
    let speed = |key: &str| guess.columns.iter().find(|c| c.key.strip_prefix('d') == Some(key));
    let is_open = |one: &Guessed| {
        let name = named(&one.name);
        one.key.starts_with("alpha")
            && one.name != one.key
            && one.unit.is_none()
            && one.per_turn.is_none()
            && name.unit.is_none()
            && POSITIONS.contains(&name.word.as_str())
            && !(is_joint && name.word == "position")
            && !speed(one.key).is_some_and(|w| agrees(columns, guess, w))
    };
    let Some(first) = guess.columns.iter().find(|c| is_open(c)) else { return };
    let held = of(&first.name).iter().copied().filter(|v| v.is_finite());
    let (low, high) =
        held.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let question = format!(
        "{} from {low:.2} to {high:.2}: an angle in rad, deg, rev or ticks, or a way in m, cm or mm? Write it as unit; of speeds \
         write dalpha1 and dalpha2 in place of alpha1 and alpha2",
        first.asks_unit()
    );
    guess.questions.push(question);
    let angles = guess.columns.iter_mut().filter(|c| c.key.starts_with("alpha"));
    angles.filter(|c| c.unit.is_none()).for_each(|c| c.unit_open = true);
}

/// Whether the input is the effort of a joint: joint states of ROS are in SI.
fn is_effort(name: &str) -> bool {
    name.to_lowercase().contains("effort")
}

/// Whether a speed in rad/s is the slope of the angle beside it.
fn agrees(columns: &[PreviewColumn], guess: &Guess, speed: &Guessed) -> bool {
    let found = |key: &str| {
        let one = guess.columns.iter().find(|c| c.key == key)?;
        Some((one, &columns.iter().find(|c| c.name == one.name)?.values))
    };
    let (Some((time, t)), Some((angle, a)), Some((_, w))) =
        (found("t"), speed.key.strip_prefix('d').and_then(&found), found(speed.key))
    else {
        return false;
    };
    // signals with stamps of their own are compared where they are read
    if a.len() != w.len() || t.len() != w.len() {
        return true;
    }
    let unit = match (angle.unit.as_deref(), angle.per_turn) {
        (None, _) => 1.0,
        (Some("mrad"), _) => 1e-3,
        (Some("deg"), _) => PI / 180.0,
        (Some("rev"), _) => TAU,
        (Some("ticks"), Some(turn)) => TAU / turn,
        _ => return false,
    };
    let second = seconds(time) * time.scale.unwrap_or(1.0);
    let (mut passed, mut way) = (0.0, 0.0);
    for k in 1..t.len().min(a.len()).min(w.len()) {
        let step = 0.5 * (w[k] + w[k - 1]) * (t[k] - t[k - 1]) * second;
        let turned = unit * (a[k] - a[k - 1]);
        // a wrap is no motion
        if step.is_finite() && turned.is_finite() && turned.abs() < PI {
            passed += turned * step.signum();
            way += step.abs();
        }
    }
    way > 0.0 && (passed / way - 1.0).abs() < ALIKE
}
