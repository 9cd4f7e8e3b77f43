//! What the values of columns say: units of time, counts, milliamperes, and what has to be asked.

use super::{Guess, Guessed};
use crate::io::PreviewColumn;
use crate::math::median;
use crate::recording::DriveUnit;

/// Rates that logs of robots have [Hz].
const RATES: (f64, f64) = (2.0, 2e4);
/// Beyond this a stamp is that of a calendar [s]: the year 2001.
const CALENDAR: f64 = 1e9;
/// More than any motor of a small robot draws [A].
const AMPERES: f64 = 200.0;
/// Wheel speed beyond which a number is rather one of rpm [rad/s].
const FAST: f64 = 120.0;

/// What metres need.
pub(super) const RADIUS: &str =
    "what is the radius of the wheels? Angles or speeds are in metres: write r_m under [robot]";

/// Whether a column increases in nearly all rows.
pub(super) fn increases(values: &[f64]) -> bool {
    let up = values.windows(2).filter(|w| w[1] > w[0]).count();
    values.len() > 2 && 20 * up > 19 * (values.len() - 1)
}

/// Whether a unit that a name states is one of this quantity, and not that of the program anyway.
pub(super) fn fits(key: &str, unit: &str) -> bool {
    match key {
        "alpha1" | "alpha2" => matches!(unit, "deg" | "rev" | "ticks" | "m"),
        "dalpha1" | "dalpha2" => {
            matches!(unit, "deg/s" | "rev/s" | "rpm" | "ticks/s" | "m/s")
        }
        "M1" | "M2" => matches!(unit, "mN m" | "N cm" | "mA" | "mV"),
        _ => true,
    }
}

/// Whether an input never changes its sign although the wheels turn both ways.
pub(super) fn is_magnitude(
    columns: &[PreviewColumn],
    input: &[Guessed; 2],
    angles: Option<&[Guessed; 2]>,
    speeds: Option<&[Guessed; 2]>,
) -> bool {
    let of = |name: &str| columns.iter().find(|c| c.name == name).map_or(&[][..], |c| &c.values);
    let extent = |values: &mut dyn Iterator<Item = f64>| {
        let finite = values.filter(|v| v.is_finite());
        finite.fold((0.0, 0.0), |(a, b): (f64, f64), v| (a.min(v), b.max(v)))
    };
    // a twentieth of the way: noise of a sensor at rest is no turn back
    let both_ways = |(low, high): (f64, f64)| low < -0.05 * high && high > -0.05 * low;
    let by_speed = |one: &Guessed| both_ways(extent(&mut of(&one.name).iter().copied()));
    let by_angle = |one: &Guessed| {
        let held: Vec<f64> = of(&one.name).iter().copied().filter(|v| v.is_finite()).collect();
        let mut steps: Vec<f64> = held.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        // without the wraps of a counter
        let at = |share: usize| steps.get(steps.len() * share / 100).copied().unwrap_or_default();
        both_ways((at(2), at(98)))
    };
    let driven = match (speeds, angles) {
        (Some(pair), _) => pair.iter().any(by_speed),
        (None, Some(pair)) => pair.iter().any(by_angle),
        (None, None) => false,
    };
    driven && !input.iter().any(by_speed)
}

/// Share of the rows with wheels that turn against each other beyond which it is asked whether a motor is
/// mounted mirrored: nobody but a test of turning drives so.
const OPPOSED: f64 = 2.0 / 3.0;

/// The question whether one wheel counts the other way, where the wheels turn against each other nearly
/// always.
fn mirrored(columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let of = |key: &str| {
        let one = guess.columns.iter().find(|c| c.key == key)?;
        columns.iter().find(|c| c.name == one.name)
    };
    let (right, left) = of("dalpha1").zip(of("dalpha2"))?;
    let tops = [largest(&right.values), largest(&left.values)];
    let pairs = right.values.iter().zip(&left.values);
    let moving: Vec<f64> = pairs
        .filter(|(a, b)| a.abs() > 0.05 * tops[0] && b.abs() > 0.05 * tops[1])
        .map(|(a, b)| a * b)
        .collect();
    let opposed = moving.iter().filter(|p| **p < 0.0).count();
    (right.name != left.name && opposed as f64 > OPPOSED * moving.len() as f64).then(|| {
        format!(
            "the wheels turn against each other in {:.0} % of the rows: did the robot turn on the spot, or is a \
             motor mounted mirrored? Then write scale = -1 in every column of that wheel",
            100.0 * opposed as f64 / moving.len() as f64
        )
    })
}

/// Looks at the values of the guessed columns, and adds units, evidence and questions.
pub(super) fn look(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |name: &str| columns.iter().find(|c| c.name == name).map_or(&[][..], |c| &c.values);
    for one in &mut guess.columns {
        let values = of(&one.name);
        if one.unit.is_none() {
            of_controller(values, one);
        }
        match one.key {
            "t" => time(values, one),
            "alpha1" | "alpha2" => angle(values, one),
            "dalpha1" | "dalpha2" => speed(values, one, &mut guess.questions),
            _ if guess.drive_unit == DriveUnit::Ampere => current(values, one),
            _ => {}
        }
    }
    counts(columns, guess);
    let asked = mirrored(columns, guess);
    guess.questions.extend(asked);
    if guess.columns.iter().any(|c| c.name.to_lowercase().contains("erpm")) {
        guess.questions.push(
            "erpm counts electrical turns: divide by the pole pairs of the motor and the gear, \
             scale = 0.14 for 7 pole pairs without gear"
                .into(),
        );
    }
    if guess.columns.iter().any(Guessed::is_in_metres) {
        guess.questions.push(RADIUS.into());
    }
    let [angles, speeds] = ["alpha", "dalpha"].map(|of| {
        guess.columns.iter().any(|c| c.key.strip_prefix(of).is_some_and(|s| s.len() == 1))
    });
    if !angles && !speeds {
        guess.questions.push("which columns hold the angles (alpha1, alpha2) or speeds (dalpha1, dalpha2) of the wheels?".into());
    }
    if !guess.columns.iter().any(|c| c.key == "M1") {
        guess.questions.push(
            "which columns hold the torques, currents or voltages of the motors (M1, M2)?".into(),
        );
    }
    if !guess.columns.iter().any(|c| c.key == "t") {
        guess.questions.push("which column holds the time (t)?".into());
    }
}

/// The unit of a controller whose names are known and say none.
fn of_controller(values: &[f64], one: &mut Guessed) {
    let (angle, speed) = (one.key.starts_with("alpha"), one.key.starts_with("dalpha"));
    let name = one.name.to_lowercase();
    let (unit, scale, per_turn, why) = if angle && name.ends_with("pos_estimate") {
        ("rev", None, None, "ODrive counts in turns")
    } else if speed && name.ends_with("vel_estimate") {
        ("rev/s", None, None, "ODrive counts in turns")
    } else if !name.contains("present_") || !whole(values) {
        return;
    } else if angle {
        ("ticks", None, Some(4096.0), "a Dynamixel of series X has 4096 counts a turn")
    } else if speed {
        ("rpm", Some(0.229), None, "a Dynamixel of series X counts speed in 0.229 rpm")
    } else if name.contains("current") {
        ("mA", Some(2.69), None, "a Dynamixel of series X counts current in 2.69 mA")
    } else {
        return;
    };
    (one.unit, one.scale, one.per_turn) = (Some(unit.into()), scale, per_turn);
    one.evidence.push(why.into());
}

/// The unit of a time that its name does not state, from its rate.
fn time(values: &[f64], one: &mut Guessed) {
    let steps = || values.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0);
    if steps().next().is_none() || one.unit.is_some() || one.nanoseconds.is_some() {
        return;
    }
    let step = median(steps());
    let (first, last) = (values[0], values[values.len() - 1]);
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let rate = |factor: f64| 1.0 / (step * factor);
    let sound = |factor: f64| {
        let calendar = first * factor > 0.3 * CALENDAR && first * factor < 4.0 * CALENDAR;
        rate(factor) >= RATES.0 && rate(factor) <= RATES.1 && (first < CALENDAR || calendar)
    };
    let Some((unit, factor)) = units.into_iter().find(|(_, f)| sound(*f)) else { return };
    if unit != "s" {
        one.unit = Some(unit.into());
        one.evidence.push(format!(
            "{:.0} s at {:.3} Hz would be no log: this is {unit} ({:.1} s at {:.0} Hz)",
            last - first,
            1.0 / step,
            (last - first) * factor,
            rate(factor)
        ));
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().filter(|v| v.is_finite()).fold(0.0, |a: f64, v| a.max(v.abs()))
}

pub(super) fn whole(values: &[f64]) -> bool {
    values.iter().all(|v| !v.is_finite() || v.fract() == 0.0)
}

/// Whether a column holds whole numbers, and many: counts of an encoder.
pub(super) fn are_counts(columns: &[PreviewColumn], one: &Guessed) -> bool {
    let values = columns.iter().find(|c| c.name == one.name).map_or(&[][..], |c| &c.values);
    whole(values) && largest(values) > COUNTED
}

/// Whole angles beyond this are no radians.
const COUNTED: f64 = 50.0;

fn angle(values: &[f64], one: &mut Guessed) {
    if one.unit.is_none() && whole(values) && largest(values) > COUNTED {
        one.unit = Some("ticks".into());
        one.evidence.push("whole numbers: counts of an encoder".into());
    }
}

fn speed(values: &[f64], one: &mut Guessed, questions: &mut Vec<String>) {
    let top = largest(values);
    if is_unknown(values, one) && one.key == "dalpha1" {
        questions.push(format!(
            "{} up to {top:.0}: rad/s, or unit = \"rpm\", \"deg/s\", \"ticks/s\"?",
            one.asks_unit()
        ));
    }
}

/// Whether a speed is in a unit that nobody stated and that is none of SI.
fn is_unknown(values: &[f64], one: &Guessed) -> bool {
    one.unit.is_none() && largest(values) > FAST
}

fn current(values: &[f64], one: &mut Guessed) {
    let top = largest(values);
    if one.unit.is_none() && top > AMPERES {
        one.unit = Some("mA".into());
        one.evidence.push(format!("up to {top:.0}: milliamperes"));
    }
}

/// Counts per turn where speeds in a known unit say them, else a question. Speeds that are the slope of the
/// counts are in counts as well.
fn counts(columns: &[PreviewColumn], guess: &mut Guess) {
    let known: Vec<Guessed> = guess.columns.clone();
    let of = |name: &str| columns.iter().find(|c| c.name == name).map_or(&[][..], |c| &c.values);
    let time = known.iter().find(|c| c.key == "t");
    let mut asked = false;
    for k in 0..guess.columns.len() {
        let one = &guess.columns[k];
        if one.per_turn.is_some() || !one.unit.as_deref().is_some_and(|u| u.starts_with("ticks")) {
            continue;
        }
        let speed = known.iter().find(|c| c.key.strip_prefix('d') == Some(one.key));
        let values = of(&one.name);
        let ratio = time
            .zip(speed)
            .and_then(|(t, w)| Some((w, counts_by_speed(of(&t.name), t, values, of(&w.name))?)));
        let turns = ratio.and_then(|(w, ratio)| Some(nice(ratio * unit_by_turn(of(&w.name), w)?)));
        if let Some(turns) = turns.filter(|n| COUNTS.contains(n)) {
            guess.columns[k].per_turn = Some(turns);
            let why = format!("{turns} counts a turn, from the speed beside it");
            guess.columns[k].evidence.push(why);
            continue;
        }
        if let Some((w, _)) = ratio.filter(|(w, r)| w.unit.is_none() && (r - 1.0).abs() < ALIKE)
            && let Some(w) = guess.columns.iter_mut().find(|c| c.key == w.key)
        {
            w.unit = Some("ticks/s".into());
            w.evidence.push("the slope of the counts beside it: counts a second".into());
        }
        if !asked {
            asked = true;
            guess.questions.push(
                "how many counts has a turn of the wheel (encoder lines x 4 x gear)? Write it as \
                 per_turn"
                    .into(),
            );
        }
    }
}

/// Counts a turn that encoders have.
const COUNTS: std::ops::Range<f64> = 4.0..1e7;
/// Part by which the slope of a counter and its speed may differ.
const ALIKE: f64 = 0.02;

/// Units of a speed that are a turn a second, where its unit is known.
fn unit_by_turn(values: &[f64], speed: &Guessed) -> Option<f64> {
    let scale = speed.scale.unwrap_or(1.0);
    let unit = match speed.unit.as_deref() {
        None if is_unknown(values, speed) => return None,
        None => std::f64::consts::TAU,
        Some("rpm") => 60.0,
        Some("deg/s") => 360.0,
        Some("rev/s") => 1.0,
        Some(_) => return None,
    };
    Some(unit / scale)
}

/// Counts passed over the integral of the speed as it stands, in counts per unit and second.
fn counts_by_speed(t: &[f64], time: &Guessed, counts: &[f64], speed: &[f64]) -> Option<f64> {
    let second = match time.unit.as_deref() {
        Some("ms") => 1e-3,
        Some("us") => 1e-6,
        Some("ns") => 1e-9,
        _ => 1.0,
    };
    let rows = t.len().min(counts.len()).min(speed.len());
    let (mut passed, mut way) = (0.0, 0.0);
    for k in 1..rows {
        let by = 0.5 * (speed[k] + speed[k - 1]) * (t[k] - t[k - 1]) * second;
        if by.is_finite() && counts[k].is_finite() && counts[k - 1].is_finite() {
            passed += (counts[k] - counts[k - 1]) * by.signum();
            way += by.abs();
        }
    }
    // counts enough for their steps to be small
    (passed.abs() > 100.0 && way > 0.0).then(|| (passed / way).abs())
}

/// A number of counts within half a percent that encoders have, else the number itself.
fn nice(ratio: f64) -> f64 {
    let powers = (3..24).map(|n| f64::from(1 << n));
    let tens = [100.0, 200.0, 360.0, 400.0, 500.0, 1000.0, 1440.0, 2000.0, 4000.0, 5000.0, 10000.0];
    let mut known = powers.chain(tens);
    known.find(|k| (ratio / k - 1.0).abs() < 5e-3).unwrap_or_else(|| ratio.round())
}
