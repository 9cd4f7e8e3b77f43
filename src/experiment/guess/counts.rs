//! Counts of encoders.

use super::guessed::{Guess, Guessed};
use super::speed_units::is_unknown;
use super::times::{row_step, seconds};
use super::values::{COUNTED, largest, values_of, whole};
use crate::io::PreviewColumn;

/// Whether a column contains many different whole numbers: counts of an encoder.
pub(super) fn are(columns: &[PreviewColumn], one: &Guessed) -> bool {
    let values = values_of(columns, &one.name);
    whole(values) && largest(values) > COUNTED
}

/// Counts per turn, from speeds in a known unit, or from the unit that gives the counts of a usual
/// encoder, else a question. Speeds that are the slope or the steps of the counts are in counts as well.
pub(super) fn per_turn(columns: &[PreviewColumn], guess: &mut Guess) {
    let known: Vec<Guessed> = guess.columns.clone();
    let of = |name: &str| values_of(columns, name);
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
        if let Some((w, ratio)) = ratio {
            let row = time.and_then(|t| Some(row_step(of(&t.name), t.sum)? * seconds(t)));
            let stated = match w.unit {
                Some(_) => stated(w, ratio),
                None if is_unknown(of(&w.name), w) => None,
                None => unstated(ratio),
            };
            if let Some((turns, unit)) = stated.filter(|(turns, _)| COUNTS.contains(turns)) {
                guess.columns[k].per_turn = Some(turns);
                let why = format!("{turns} counts per turn, from the speed column");
                guess.columns[k].evidence.push(why);
                let w = guess.columns.iter_mut().find(|c| c.key == w.key && unit != RADIANS);
                if let Some(w) = w.filter(|w| w.unit.is_none()) {
                    w.unit = Some(unit.into());
                    w.evidence.push(format!("an encoder of {turns} counts makes this {unit}"));
                }
                continue;
            }
            let is_free = w.unit.is_none() && w.scale.is_none();
            let w = guess.columns.iter_mut().find(|c| c.key == w.key && is_free);
            if let Some(w) = w {
                in_counts(w, ratio, row.filter(|_| whole(of(&w.name))));
            }
        }
        if !asked {
            asked = true;
            guess.ask(
                "how many counts has a turn of the wheel (encoder lines x 4 x gear; 360 if they are \
                 degrees)? Write it as per_turn",
            );
        }
    }
}

/// Counts per turn of usual encoders.
const COUNTS: std::ops::Range<f64> = 4.0..1e7;
/// Part by which the slope of a counter and its speed may differ.
const ALIKE: f64 = 0.02;

/// Unit of a speed that states none.
const RADIANS: &str = "rad/s";
/// Units of a speed, and how many of them are one turn per second.
const UNITS: [(&str, f64); 4] =
    [(RADIANS, std::f64::consts::TAU), ("rev/s", 1.0), ("rpm", 60.0), ("deg/s", 360.0)];

/// Counts per turn of the wheel, from a speed whose unit is stated.
fn stated(speed: &Guessed, ratio: f64) -> Option<(f64, &'static str)> {
    let unit = speed.unit.as_deref().filter(|_| !speed.is_electrical());
    let &(unit, by_turn) = UNITS.iter().find(|(name, _)| Some(*name) == unit)?;
    let turns = ratio * by_turn / speed.scale.unwrap_or(1.0);
    Some((encoder(turns).unwrap_or_else(|| turns.round()), unit))
}

/// Usual counts per turn of an encoder, and the unit of the speed for which they result.
fn unstated(ratio: f64) -> Option<(f64, &'static str)> {
    UNITS.iter().find_map(|(unit, by_turn)| Some((encoder(ratio * by_turn)?, *unit)))
}

/// Sets the unit of a speed to counts if it is their slope, or their increment per row of `row` seconds.
fn in_counts(speed: &mut Guessed, ratio: f64, row: Option<f64>) {
    if (ratio - 1.0).abs() < ALIKE {
        speed.unit = Some("ticks/s".into());
        speed.evidence.push("the derivative of the counts: counts per second".into());
    } else if let Some(row) = row.filter(|row| (ratio * row - 1.0).abs() < ALIKE) {
        speed.unit = Some("ticks/s".into());
        speed.scale = Some((1e4 / row).round() / 1e4);
        speed.evidence.push(format!("the increments of the counts, in rows of {row:.4} s"));
    }
}

/// Counts divided by the integral of the speed without conversion, in counts per unit and second.
fn counts_by_speed(t: &[f64], time: &Guessed, counts: &[f64], speed: &[f64]) -> Option<f64> {
    let second = seconds(time);
    let rows = t.len().min(counts.len()).min(speed.len());
    let (mut passed, mut way) = (0.0, 0.0);
    for k in 1..rows {
        let by = 0.5 * (speed[k] + speed[k - 1]) * (t[k] - t[k - 1]) * second;
        if by.is_finite() && counts[k].is_finite() && counts[k - 1].is_finite() {
            passed += (counts[k] - counts[k - 1]) * by.signum();
            way += by.abs();
        }
    }
    // enough counts for a small quantisation error
    (passed.abs() > 100.0 && way > 0.0).then(|| (passed / way).abs())
}

/// The count of a usual encoder within half a percent.
fn encoder(ratio: f64) -> Option<f64> {
    let powers = (3..24).map(|n| f64::from(1 << n));
    let tens = [100.0, 200.0, 360.0, 400.0, 500.0, 1000.0, 1440.0, 2000.0, 4000.0, 5000.0, 10000.0];
    let mut known = powers.chain(tens);
    known.find(|k| (ratio / k - 1.0).abs() < 5e-3)
}
