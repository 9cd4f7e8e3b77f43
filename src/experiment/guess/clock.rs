//! The column of the time.

use super::guessed::{Candidate, Guessed};
use super::names::Quantity;
use super::values::{increases, is_constant, largest, whole};
use crate::io::part_of_second;
use crate::math::{mean, median_high};

/// Share of a second that the fractional parts must exceed at least once; they never reach one.
const HALF: f64 = 0.5;
/// Part of the steps of whole seconds at which their fraction falls back: others are gaps in the log.
const FALLS: f64 = 0.9;
/// Larger values are those of a calendar \[s\]: the year 2001.
const CALENDAR: f64 = 1e9;
/// Words that denote a position rather than the time if the name has no others.
const PLACES: [&str; 8] = ["x", "y", "z", "pos", "position", "dist", "distance", "odom"];

/// The time: the best name whose values increase, else two columns that are seconds and a part of a second, else the
/// sum of the steps between the rows, else the column that always increases, with the most even steps, else the counter
/// of a timer. A column that counts the rows is not their time; a name that may be a position is asked about.
pub(super) fn time(all: &[Candidate]) -> Option<Guessed> {
    let parted = seconds_and_part(all);
    let is_part = |one: &Guessed| {
        parted
            .as_ref()
            .is_some_and(|p| p.name == one.name || p.nanoseconds.as_ref() == Some(&one.name))
    };
    named(all)
        .filter(|one| one.nanoseconds.is_some() || !is_part(one))
        .or(parted)
        .or_else(|| steps(all))
        .or_else(|| rising(all))
        .or_else(|| timer(all))
}

fn guessed(c: &Candidate) -> Guessed {
    Guessed {
        key: "t",
        name: c.column.name.clone(),
        unit: c.named.unit.filter(|u| *u != "s").map(Into::into),
        scale: c.named.scale,
        ..Guessed::default()
    }
}

/// The time by its name, that with the fewest other words first. The seconds and nanoseconds of one stamp
/// come before all others, so that the stamp of the message comes before that of its arrival.
fn named(all: &[Candidate]) -> Option<Guessed> {
    let rises = |c: &&Candidate| increases(&c.column.values);
    // a time as text that cannot be read is not used
    let holds = |c: &&Candidate| c.column.values.iter().any(|v| v.is_finite());
    let is_time = |c: &&Candidate| c.named.quantity == Some(Quantity::Time);
    // a logger whose clock stands still
    let changes = |c: &&Candidate| c.column.values.len() < 2 || !is_constant(&c.column.values);
    let mut named: Vec<&Candidate> =
        all.iter().filter(is_time).filter(holds).filter(changes).collect();
    named.sort_by_key(|c| (c.column.name != "t", c.named.rest.len()));
    let of_stamp = |c: &Candidate| {
        let mut parts = all.iter().filter(|n| n.named.quantity == Some(Quantity::Nanoseconds));
        parts.find(|n| stem(&n.column.name) == stem(&c.column.name))
    };
    let stamped = named.iter().find(|c| of_stamp(c).is_some() && whole(&c.column.values));
    let best = stamped
        .copied()
        .or_else(|| named.iter().copied().find(rises))
        .or_else(|| named.first().copied())?;
    let nanoseconds = stamped.and_then(|c| of_stamp(c)).map(|c| c.column.name.clone());
    let out = Guessed { nanoseconds, ..guessed(best) };
    if !falls(&best.column.values) {
        return Some(out);
    }
    // stamps of a calendar never count down
    let is_calendar = best.column.values.iter().any(|v| *v > CALENDAR);
    let newest =
        Guessed { evidence: vec!["it falls: the newest row is first".into()], ..out.clone() };
    Some(if is_calendar { newest } else { counted_down(out) })
}

/// Whether values decrease and never increase.
fn falls(values: &[f64]) -> bool {
    let mut held = values.iter().filter(|v| v.is_finite());
    let (first, last) = (held.next(), held.next_back());
    first > last && values.windows(2).all(|w| !(w[1] > w[0]))
}

/// A remaining time, for example of a match.
fn counted_down(time: Guessed) -> Guessed {
    let why = "it falls: a countdown, turned round";
    Guessed { scale: Some(-1.0), evidence: vec![why.into()], ..time }
}

/// A name without its last word: `header.stamp.` of `header.stamp.nanosec`.
fn stem(name: &str) -> &str {
    &name[..name.rfind(|c: char| !c.is_alphanumeric()).map_or(0, |end| end + 1)]
}

/// Whole numbers below those of a second that fall back exactly where another column of whole numbers
/// increases: the seconds. The unit of the fractional part is given by its name; default: nanoseconds.
fn seconds_and_part(all: &[Candidate]) -> Option<Guessed> {
    let is_part = |c: &&Candidate| {
        let values = &c.column.values;
        let top = largest(values) * part_of_second(&c.column.name);
        whole(values) && (HALF..1.0).contains(&top) && values.iter().all(|v| *v >= 0.0)
    };
    let goes_on = |seconds: &[f64], part: &[f64]| {
        let rows = || seconds.windows(2).zip(part.windows(2));
        let steps = rows().filter(|(s, _)| s[1] > s[0]).count();
        let falls = rows().filter(|(s, p)| s[1] > s[0] && p[1] < p[0]).count();
        falls > 1
            && rows().all(|(s, p)| s[1] >= s[0] && (s[1] > s[0] || p[1] > p[0]))
            && falls as f64 >= FALLS * steps as f64
    };
    all.iter().filter(is_part).find_map(|part| {
        let mut others = all.iter().filter(|c| whole(&c.column.values));
        let seconds = others.find(|c| goes_on(&c.column.values, &part.column.values))?;
        let name = &part.column.name;
        let why =
            format!("it increases by one where `{name}` wraps: seconds and fractions of a second");
        let nanoseconds = Some(name.clone());
        Some(Guessed { nanoseconds, evidence: vec![why], ..guessed(seconds) })
    })
}

/// The column that increases from row to row; a row counter only if there is no other. It is asked about if its steps are
/// not those of a time.
fn rising(all: &[Candidate]) -> Option<Guessed> {
    // counts of a wheel that turns in one direction increase as well
    let rising =
        |c: &&Candidate| increases(&c.column.values) && !c.named.step && c.named.quantity.is_none();
    let (rows, times): (Vec<&Candidate>, Vec<&Candidate>) =
        all.iter().filter(rising).partition(|c| counts_rows(&c.column.values));
    let of = |c: &Candidate, why: &str| Guessed { evidence: vec![why.into()], ..guessed(c) };
    let placed = |one: &Candidate, why: &str| {
        // a column without a name is the index of a table, and of its own for stamps
        let is_index = one.column.name.trim().is_empty();
        let is_place = !is_index && one.named.rest.iter().all(|w| PLACES.contains(&w.as_str()));
        let unit_open = is_place || !is_steady(&one.column.values);
        Some(Guessed { unit_open, ..of(one, why) })
    };
    match (&times[..], &rows[..]) {
        ([one], _) => placed(one, "the only column that increases from row to row"),
        ([_, _, ..], _) => placed(
            most_even(&times)?,
            "of the columns that increase from row to row the one that always does, in the most even steps",
        ),
        ([], [one, ..]) => {
            let found = of(one, "it increases by 1 from row to row: it counts rows");
            Some(Guessed { scale_open: true, ..found })
        }
        _ => None,
    }
}

/// Part of the steps of a time that are about as long as their median, and by how much of it they may differ: rows that
/// are late or lost are fewer (judgement).
const STEADY: f64 = 0.9;
const ABOUT: f64 = 0.5;

/// Whether values increase in every row, in nearly even steps. The way of a wheel rests or varies with its speed.
fn is_steady(values: &[f64]) -> bool {
    let held: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let steps: Vec<f64> = held.windows(2).map(|w| w[1] - w[0]).collect();
    let usual = median_high(steps.iter().copied());
    let even = steps.iter().filter(|h| (*h / usual - 1.0).abs() <= ABOUT).count();
    steps.iter().all(|h| *h > 0.0) && even as f64 >= STEADY * steps.len() as f64
}

/// Variation of the steps of a timer, as a share of their mean, below which they are even.
const EVEN: f64 = 0.1;

/// Ticks of no wheel that increase in even steps: those of a timer, of unknown length. The counts of a wheel vary with
/// its speed.
fn timer(all: &[Candidate]) -> Option<Guessed> {
    let is_one = |c: &&Candidate| {
        let values = &c.column.values;
        let rows = values.len().max(2) as f64 - 1.0;
        c.named.unit == Some("ticks")
            && c.named.side.is_none()
            && whole(values)
            && variation(values).is_some_and(|square| square < rows * EVEN * EVEN)
    };
    let mut found = all.iter().filter(is_one);
    let one = found.next().filter(|_| found.next().is_none())?;
    let why = "it increases in even steps: the counter of a timer".into();
    Some(Guessed { unit: None, scale_open: true, evidence: vec![why], ..guessed(one) })
}

/// The column that increases in every row, by steps with the smallest deviation relative to their mean: counts of a
/// wheel repeat or vary with its speed.
fn most_even<'a, 'b>(all: &[&'a Candidate<'b>]) -> Option<&'a Candidate<'b>> {
    let strict = all.iter().filter_map(|c| Some((variation(&c.column.values)?, *c)));
    strict.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| c)
}

/// Sum of the squared deviations of the steps from their mean, relative to it; `None` if the values do not always
/// increase.
fn variation(values: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).collect();
    let mean = mean(steps.iter().copied());
    let square = steps.iter().map(|h| (h / mean - 1.0).powi(2)).sum::<f64>();
    steps.iter().all(|h| *h > 0.0).then_some(square)
}

/// Whether a column increases by exactly 1 from row to row.
fn counts_rows(values: &[f64]) -> bool {
    let held: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    whole(&held) && held.len() > 2 && held.windows(2).all(|w| w[1] - w[0] == 1.0)
}

/// The steps between the rows.
fn steps(all: &[Candidate]) -> Option<Guessed> {
    let is_positive = |c: &Candidate| c.column.values.iter().skip(1).all(|v| *v > 0.0);
    let mut found = all.iter().filter(|c| c.named.step && is_positive(c));
    let one = found.next().filter(|_| found.next().is_none())?;
    let why = "the step from row to row: the time is its sum".into();
    Some(Guessed { sum: true, evidence: vec![why], ..guessed(one) })
}
