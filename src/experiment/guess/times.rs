//! The time of a log: its unit by the rate, its step, and the questions on it.

use super::guessed::{About, Guess, Guessed, Question};
use super::names::named;
use super::samples::{increases, largest, values_of, whole};
use crate::conditioning::IMPORT;
use crate::io::PreviewColumn;
use crate::math::median_high;

/// Rates that logs of robots have \[Hz\].
const RATES: (f64, f64) = (2.0, IMPORT.fastest_hz);
/// Slower logs of steps of an input \[Hz\], and the slowest where a name states seconds.
const SLOWEST: f64 = 0.5;
const STATED: f64 = 0.1;
/// Shortest duration of a log \[s\].
const SHORTEST: f64 = 4.0;
/// Beyond this a stamp is that of a calendar \[s\]: the year 2001.
const CALENDAR: f64 = 1e9;
/// Values of a counter of 32 bits.
const COUNTER: f64 = 4_294_967_296.0;

impl Guess {
    /// Uses the period of the rows that the file states if no column is the time, or if one counts the rows; returns
    /// whether it was needed.
    pub(in crate::experiment) fn take_period(
        &mut self,
        columns: &[PreviewColumn],
        period: f64,
    ) -> bool {
        match self.columns.iter_mut().find(|c| c.key == "t") {
            Some(t) if t.scale_open => {
                let counts = row_step(values_of(columns, &t.name), false).unwrap_or(1.0);
                (t.scale, t.scale_open) = (Some(period / counts), false);
            }
            Some(_) => return false,
            None => {
                (self.period, self.period_open) = (Some(period), false);
            }
        }
        self.answer(&About::Period);
        true
    }
}

/// The question on a column that was used as the time and may be another quantity.
pub(super) fn time_question(columns: &[PreviewColumn], guess: &Guess) -> Option<Question> {
    let time = guess.columns.iter().find(|c| c.key == "t")?;
    if time.scale_open {
        let counts = row_step(values_of(columns, &time.name), false).unwrap_or(1.0);
        Some(no_step(&time.name, counts))
    } else if time.unit_open {
        Some(Question::from(format!(
            "no name states the time, and `{}` increases from row to row: is it the time? If so, write its unit; if it is a position, write the time column as name, or t = {{ period = 0.02 }} for a constant sampling period",
            time.name
        )))
    } else {
        None
    }
}

/// The question for the step of a column that counts rows, or for that of a timer with these `counts` per row.
fn no_step(name: &str, counts: f64) -> Question {
    let text = if counts == 1.0 {
        format!("`{name}` counts rows: what is the sampling period [s]? Write it as scale of t")
    } else {
        format!(
            "`{name}` counts the ticks of a timer, {counts} from row to row: how many seconds is one? Write this as scale of t \
             ({:.4e} if there are 100 rows per second)",
            0.01 / counts
        )
    };
    Question { about: About::Period, text }
}

/// The question if no time column was found.
pub(super) fn no_time(period_open: bool) -> Question {
    let text = if period_open {
        "what is the sampling period [s]? No column increases steadily: if the period is constant, write t = { period = 0.02 }; otherwise the name of the time column (t)"
    } else {
        "which column contains the time (t)? If none does and rows come at a fixed period, write t = { period = 0.02 }"
    };
    Question { about: About::Period, text: text.into() }
}

/// The unit of a time that its name does not state, from its rate.
pub(super) fn time(values: &[f64], one: &mut Guessed) {
    let Some(step) = row_step(values, one.sum) else { return };
    let is_impossible = is_too_fast(step, one);
    let is_known = one.unit.is_some() && !is_impossible
        || one.unit_open
        || one.nanoseconds.is_some()
        || one.scale_open;
    if is_known {
        return;
    }
    if is_impossible {
        in_slower_unit(step, one);
        return;
    }
    let Some((first, passed)) = first_and_passed(values, one) else { return };
    // counters of 32 bits are beyond the seconds of a calendar, which advance more slowly
    let is_counter = whole(values) && largest(values) < COUNTER && step * STATED > 1.0;
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let rate = |factor: f64| 1.0 / (step * factor);
    let sound = |factor: f64| {
        let calendar = first * factor > 0.3 * CALENDAR && first * factor < 4.0 * CALENDAR;
        rate(factor) >= RATES.0
            && rate(factor) <= RATES.1
            && (first < CALENDAR || calendar || is_counter)
    };
    if are_days(first) && !sound(1.0) && (RATES.0..RATES.1).contains(&rate(DAY)) {
        in_days(step, (first, passed), one);
        return;
    }
    // fractions at a slow rate are not milliseconds if those would give an implausible log
    let is_slow = !whole(values)
        && (SLOWEST..RATES.0).contains(&rate(1.0))
        && passed * 1e-3 < SHORTEST
        && first < CALENDAR;
    let is_stated = named(&one.name).unit == Some("s") && (STATED..RATES.1).contains(&rate(1.0));
    if is_slow || is_stated {
        return;
    }
    let Some((unit, factor)) = units.into_iter().find(|(_, f)| sound(*f)) else { return };
    if unit != "s" {
        one.unit = Some(unit.into());
        one.evidence.push(format!(
            "{:.0} s at {:.3} Hz would be no log: this is {unit} ({:.1} s at {:.0} Hz)",
            passed,
            1.0 / step,
            passed * factor,
            rate(factor)
        ));
    }
}

/// First value and the time that passes, in the unit of the column; `None` for rows in disorder, which have no rate.
fn first_and_passed(values: &[f64], one: &Guessed) -> Option<(f64, f64)> {
    let held = || values.iter().copied().filter(|v| v.is_finite());
    let (first, last) = if one.sum {
        (0.0, held().sum())
    } else {
        (held().next().unwrap_or_default(), held().next_back().unwrap_or_default())
    };
    // a counter may wrap
    let is_back = one.scale.is_some_and(|scale| scale < 0.0);
    if last <= first && !is_back && !increases(values) {
        return None;
    }
    let passed = match values.windows(2).any(|w| w[1] < w[0]) && !one.sum && !is_back {
        true => values.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0).sum(),
        false => last - first,
    };
    Some((first, passed))
}

/// Records that the time is in days of a calendar.
fn in_days(step: f64, (first, passed): (f64, f64), one: &mut Guessed) {
    let (steps, seconds, rate) = (DAY * step, passed * DAY, 1.0 / (step * DAY));
    one.unit = Some("d".into());
    one.evidence.push(format!(
        "from {first:.4}, in steps of {steps:.4} s as days: days of a calendar ({seconds:.1} s at {rate:.0} Hz)"
    ));
}

/// Whether the rows would come faster than any logger writes them in the unit that the name of the time states.
fn is_too_fast(step: f64, one: &Guessed) -> bool {
    one.unit.is_some()
        && one.scale.is_none()
        && 1.0 / (step * seconds(one)) > IMPORT.impossible * RATES.1
}

/// Replaces the unit of a name by the longest one that gives the rate of a log: `time_us` in whole seconds.
fn in_slower_unit(step: f64, one: &mut Guessed) {
    let stated = one.unit.clone().unwrap_or_default();
    let units = [("us", 1e-6), ("ms", 1e-3), ("s", 1.0)];
    let sound = |factor: f64| (RATES.0..RATES.1).contains(&(1.0 / (step * factor)));
    let Some((unit, factor)) = units.into_iter().rev().find(|(_, factor)| sound(*factor)) else {
        return;
    };
    one.evidence.push(format!(
        "its name states {stated}, which would be {:.0e} Hz: this is {unit} ({:.0} Hz)",
        1.0 / (step * seconds(one)),
        1.0 / (step * factor)
    ));
    one.unit = Some(unit.into());
}

/// Seconds of a day.
const DAY: f64 = 86_400.0;

/// Whether a number may be that of a day of 1990 to 2090: since 1900 (spreadsheets), 1970 or the year 0 (MATLAB).
fn are_days(first: f64) -> bool {
    [0.0, 25_569.0, -693_960.0].iter().any(|epoch| (32_874.0..69_400.0).contains(&(first + epoch)))
}

/// Repeated stamps for each that differs beyond which a clock is coarser than the rows.
const COARSE: f64 = 0.5;

/// Time between two rows, in the unit of the column, which holds times or steps.
pub(super) fn row_step(values: &[f64], are_steps: bool) -> Option<f64> {
    let steps: Vec<f64> =
        if are_steps { values.to_vec() } else { values.windows(2).map(|w| w[1] - w[0]).collect() };
    let forward = || steps.iter().copied().filter(|h| *h > 0.0);
    let (count, repeated) =
        (forward().count() as f64, steps.iter().filter(|h| **h == 0.0).count() as f64);
    let step = (count > 0.0).then(|| median_high(forward()))?;
    Some(if repeated > COARSE * count { step * count / (count + repeated) } else { step })
}

/// Rate of the rows of a time \[Hz\].
pub(super) fn rate(values: &[f64], one: &Guessed) -> Option<f64> {
    let step = row_step(values, one.sum)? * seconds(one) * one.scale.unwrap_or(1.0).abs();
    (step > 0.0).then(|| 1.0 / step)
}

/// Seconds of a unit of time.
pub(super) fn seconds(time: &Guessed) -> f64 {
    match time.unit.as_deref() {
        Some("ms") => 1e-3,
        Some("us") => 1e-6,
        Some("ns") => 1e-9,
        Some("min") => 60.0,
        Some("h") => 3600.0,
        Some("d") => DAY,
        _ => 1.0,
    }
}
