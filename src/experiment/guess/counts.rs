//! Counts of encoders.

use super::values::{COUNTED, is_unknown, largest, whole};
use super::{Guess, Guessed};
use crate::io::PreviewColumn;

/// Whether a column holds whole numbers, and many: counts of an encoder.
pub(super) fn are(columns: &[PreviewColumn], one: &Guessed) -> bool {
    let values = columns.iter().find(|c| c.name == one.name).map_or(&[][..], |c| &c.values);
    whole(values) && largest(values) > COUNTED
}

/// Counts per turn where speeds in a known unit say them, else a question. Speeds that are the slope of the
/// counts are in counts as well.
pub(super) fn per_turn(columns: &[PreviewColumn], guess: &mut Guess) {
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
