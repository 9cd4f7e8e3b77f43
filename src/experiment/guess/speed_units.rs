//! Units of speeds that must be asked for.

use std::f64::consts::{PI, TAU};

use super::guessed::{Guess, Guessed};
use super::names::{Quantity, is_place, leaves_angle_open, leaves_speed_open, named};
use super::times::seconds;
use super::values::{short, top_of, values_of};
use crate::io::PreviewColumn;

/// Wheel speed above which a number is more likely in rpm [rad/s].
const FAST: f64 = 120.0;
/// Radius of the wheels with which candidates are compared \[m\].
const RADIUS: f64 = 0.05;
/// Part by which a speed may differ from the slope of its angle.
const ALIKE: f64 = 0.1;
/// Factor within which a speed follows its set-point.
const SIMILAR: f64 = 2.0;

/// Whether a speed is in a unit that is not stated and is not an SI unit.
pub(super) fn is_unknown(values: &[f64], one: &Guessed) -> bool {
    let is_stated = one.unit.is_some() || named(&one.name).unit.is_some();
    !is_stated && top_of(values) * one.scale.unwrap_or(1.0).abs() > FAST
}

/// Asks for the unit of speeds that names do not state and angles do not show. Both wheels have one unit.
pub(super) fn open(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |name: &str| values_of(columns, name);
    let is_joint = guess.columns.iter().any(|c| {
        c.key == "M1" && is_effort(&c.name) || named(&c.name).rest.iter().any(|w| w == "joint")
    });
    angles(columns, guess, is_joint);
    let is_open = |one: &Guessed| {
        let name = named(&one.name);
        let is_general = one.name != one.key
            && one.unit.is_none()
            && name.unit.is_none()
            && leaves_speed_open(&name.word)
            && !(is_joint && name.word == "velocity");
        one.key.starts_with("dalpha")
            && (is_unknown(of(&one.name), one) || is_general && !agrees(columns, guess, one))
    };
    let Some(first) = guess.columns.iter().find(|c| is_open(c)) else { return };
    let top = top_of(of(&first.name)) * first.scale.unwrap_or(1.0).abs();
    if let Some((name, unit)) = of_set_point(columns, top) {
        let speeds = guess.columns.iter_mut().filter(|c| c.key.starts_with("dalpha"));
        for one in speeds.filter(|c| c.unit.is_none()) {
            one.unit = (unit != "rad/s").then(|| unit.into());
            one.evidence.push(format!("in {unit} as its set-point `{name}`"));
        }
        return;
    }
    let digits = if top < 10.0 { 3 } else { 0 };
    let ground = |by: f64| short(RADIUS * by * top, 2);
    let question = first.unit_question(&format!(
        "up to {}: in rad/s, rpm, deg/s, rev/s, ticks/s, m/s, cm/s or mm/s? Write it as unit (wheels of {RADIUS} m \
         would go {} m/s as rad/s, {} as rpm, {} as deg/s, {} as rev/s, {} as m/s)",
        short(top, digits),
        ground(1.0),
        ground(TAU / 60.0),
        ground(PI / 180.0),
        ground(TAU),
        short(top, 2)
    ));
    guess.ask(question);
    let speeds = guess.columns.iter_mut().filter(|c| c.key.starts_with("dalpha"));
    speeds.filter(|c| c.unit.is_none()).for_each(|c| c.unit_open = true);
}

/// The set-point with a known unit and about the same maximum as a speed, and its unit.
fn of_set_point(columns: &[PreviewColumn], top: f64) -> Option<(&str, &'static str)> {
    columns.iter().find_map(|column| {
        let name = named(&column.name);
        let unit = name.unit.filter(|_| name.wished && name.quantity == Some(Quantity::Speed))?;
        let set = top_of(&column.values);
        (set < SIMILAR * top && top < SIMILAR * set).then_some((column.name.as_str(), unit))
    })
}

/// Asks for the unit of angles whose names do not state it: of those under the general names of a sensor or a
/// position, where the speeds beside them do not show it, and of those that would turn faster than wheels do and are
/// no joints. A speed without unit that is the slope of a position has the same unit per second, which the data do
/// not show.
fn angles(columns: &[PreviewColumn], guess: &mut Guess, is_joint: bool) {
    let of = |name: &str| values_of(columns, name);
    let speed = |key: &str| guess.columns.iter().find(|c| c.key.strip_prefix('d') == Some(key));
    let is_stated = |w: &Guessed| w.unit.is_some() || named(&w.name).unit.is_some();
    let is_slope = |one: &Guessed| speed(one.key).is_some_and(|w| agrees(columns, guess, w));
    let is_shown = |one: &Guessed| {
        let is_way = is_place(&named(&one.name).word);
        is_slope(one) && (!is_way || speed(one.key).is_some_and(is_stated))
    };
    let is_open = |one: &Guessed| {
        let name = named(&one.name);
        let is_general = leaves_angle_open(&name.word)
            && !(is_joint && name.word == "position")
            && !is_shown(one);
        one.key.starts_with("alpha")
            && one.name != one.key
            && one.unit.is_none()
            && one.per_turn.is_none()
            && name.unit.is_none()
            && (is_general || !is_joint && slope(columns, guess, one).is_some_and(|w| w > FAST))
    };
    let Some(first) = guess.columns.iter().find(|c| is_open(c)) else { return };
    let held = of(&first.name).iter().copied().filter(|v| v.is_finite());
    let (low, high) =
        held.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let range = format!("from {low:.2} to {high:.2}");
    let both = speed(first.key).filter(|w| is_slope(first) && !is_stated(w) && w.name != w.key);
    let question = match both {
        Some(w) => format!(
            "{range}, and `{}` is its derivative: in rad and rad/s, rev and rev/s, deg and deg/s, or m and m/s? Write both as unit",
            w.name
        ),
        None => format!(
            "{range}: an angle in rad, deg, rev or ticks, or a distance in m, cm or mm? Write it as unit; for speeds \
             write dalpha1 and dalpha2 in place of alpha1 and alpha2"
        ),
    };
    let keys: &[&str] = if both.is_some() { &["alpha", "dalpha"] } else { &["alpha"] };
    let question = first.unit_question(&question);
    guess.ask(question);
    let is_one = |c: &&mut Guessed| {
        keys.iter().any(|key| c.key.strip_prefix(key).is_some_and(|wheel| wheel.len() == 1))
    };
    let angles = guess.columns.iter_mut().filter(is_one);
    angles.filter(|c| c.unit.is_none()).for_each(|c| c.unit_open = true);
}

/// The speed, in the unit of the angle per second, that nearly all rows stay below.
fn slope(columns: &[PreviewColumn], guess: &Guess, angle: &Guessed) -> Option<f64> {
    let time = guess.columns.iter().find(|c| c.key == "t")?;
    let (t, a) = (values_of(columns, &time.name), values_of(columns, &angle.name));
    if t.len() != a.len() || time.sum || time.nanoseconds.is_some() {
        return None;
    }
    let second = seconds(time) * time.scale.unwrap_or(1.0);
    let rows = t.windows(2).zip(a.windows(2));
    let by_row = rows.map(|(t, a)| ((a[1] - a[0]) / ((t[1] - t[0]) * second)).abs());
    Some(top_of(&by_row.collect::<Vec<f64>>()))
}

/// Whether the input is the effort of a joint: joint states of ROS are in SI.
fn is_effort(name: &str) -> bool {
    name.to_lowercase().contains("effort")
}

/// Whether a speed in rad/s is the slope of the angle of the same wheel.
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
        // a wrap is not motion
        if step.is_finite() && turned.is_finite() && turned.abs() < PI {
            passed += turned * step.signum();
            way += step.abs();
        }
    }
    way > 0.0 && (passed / way - 1.0).abs() < ALIKE
}
