//! Key columns of long-form tables: joint, motor or signal of each row.

use super::{Style, value};
use crate::io::words::{have_both_sides, side, words};

/// Largest number of joints in a log.
const JOINTS: usize = 16;
/// Largest number of motors that are counted by a column of numbers without a characteristic name.
const COUNTED: usize = 4;
/// Largest number of rows per change of a second label; the state of a robot changes less often.
const STAYS: usize = 8;
/// Names of a column with the number of a motor.
const OWNERS: [&str; 19] = [
    "id",
    "motor",
    "motorid",
    "motornr",
    "motornumber",
    "motoridx",
    "joint",
    "jointid",
    "wheel",
    "wheelid",
    "axis",
    "node",
    "nodeid",
    "channel",
    "ch",
    "servo",
    "servoid",
    "canid",
    "side",
];
/// Names of columns with the part of an experiment, which never identify a wheel.
const PARTS: [&str; 16] = [
    "run",
    "test",
    "trial",
    "phase",
    "mode",
    "step",
    "rep",
    "repetition",
    "state",
    "status",
    "session",
    "segment",
    "experiment",
    "maneuver",
    "manoeuvre",
    "cycle",
];
/// Names of columns whose quantity is given by the key of the row.
const VALUES: [&str; 4] = ["value", "_value", "val", "data"];

/// Whether a column with that name has the quantity that the key of the row gives.
pub(super) fn is_value(name: &str) -> bool {
    VALUES.contains(&name.to_lowercase().as_str())
}

/// Whether a name is that of a column with the number of a motor.
#[must_use]
pub fn is_owner(name: &str) -> bool {
    let bare: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    OWNERS.contains(&bare.as_str())
}

/// Whether a name is that of a part of an experiment: `run`, `test_id`, `robot_mode`.
pub(in crate::io) fn is_part(name: &str) -> bool {
    words(name).iter().any(|word| PARTS.contains(&word.as_str()))
}

/// The time: the first column that changes and never decreases.
pub(super) fn time(head: &[Vec<String>], style: Style) -> Option<usize> {
    let rises = |cells: &Vec<String>| {
        let values: Option<Vec<f64>> = cells.iter().map(|c| value(c, style)).collect();
        values.is_some_and(|v| {
            v.windows(2).all(|w| w[1] >= w[0])
                && v.first().zip(v.last()).is_some_and(|(a, b)| a < b)
        })
    };
    head.iter().position(rises)
}

/// Whether a column may identify the motor of a row: words, numbers under the name of a motor, or a few whole
/// numbers in turn in rows of the same time.
pub(super) fn is_label(name: &str, cells: &[String], times: &[String], style: Style) -> bool {
    let number = |cell: &String| value(cell, style);
    // the direction of one wheel (`dirL`) is in words as well
    if is_part(name) || words(name).iter().any(|word| side(word).is_some()) {
        return false;
    }
    if cells.iter().all(|c| !c.is_empty() && number(c).is_none()) {
        return true;
    }
    let whole = |c: &String| c.parse::<i64>().is_ok();
    if cells.is_empty() || !cells.iter().all(whole) {
        return false;
    }
    if is_owner(name) {
        return true;
    }
    let ids = distinct(cells.iter().map(String::as_str));
    let count = ids.len();
    let in_turn = (0..cells.len()).all(|k| cells[k] == ids[k % count]);
    (2..=COUNTED).contains(&count)
        && in_turn
        && times.chunks(count).all(|cycle| cycle.iter().all(|t| *t == cycle[0]))
}

/// The columns that identify the motor of a row: those of alternating rows, else those of consecutive tables.
pub(super) fn labels(
    names: &[String],
    texts: &[Vec<String>],
    head: &[Vec<String>],
    (time, times): (usize, &[f64]),
    style: Style,
) -> Vec<usize> {
    let found: Vec<usize> = (0..names.len())
        .filter(|k| *k != time && is_label(&names[*k], &head[*k], &head[time], style))
        .filter(|k| (2..=JOINTS).contains(&distinct(texts[*k].iter().map(String::as_str)).len()))
        .collect();
    let in_turn = alternating(head, &found);
    if !in_turn.is_empty() {
        return in_turn;
    }
    // what stands beside both wheels is no wheel
    let others = (0..names.len()).filter(|k| *k != time && !found.contains(k));
    if have_both_sides(&others.map(|k| names[k].as_str()).collect::<Vec<_>>()) {
        return vec![];
    }
    let is_long = names.iter().any(|name| is_value(name));
    one_below_the_other(texts, times, &found, is_long)
}

/// The labels of alternating rows: one that differs from the previous row in at least half of the rows, and
/// those that change occasionally as well.
fn alternating(head: &[Vec<String>], labels: &[usize]) -> Vec<usize> {
    let changes = |k: &usize| head[*k].windows(2).filter(|w| w[0] != w[1]).count();
    let steps = |k: &usize| head[*k].len().saturating_sub(1);
    if !labels.iter().any(|k| 2 * changes(k) >= steps(k)) {
        return vec![];
    }
    labels.iter().copied().filter(|k| STAYS * changes(k) >= steps(k)).collect()
}

/// The labels of consecutive tables: each change of a label begins at an earlier time. Where a clock restarts
/// with a table, the tables were recorded one after the other, unless the label names a quantity.
fn one_below_the_other(
    texts: &[Vec<String>],
    times: &[f64],
    labels: &[usize],
    is_long: bool,
) -> Vec<usize> {
    let begins = |k: &usize| {
        let changes = |row: &usize| texts[*k][*row] != texts[*k][*row - 1];
        let rows: Vec<usize> = (1..times.len()).filter(changes).collect();
        let starts = std::iter::once(0).chain(rows.iter().copied());
        let ends = rows.iter().copied().chain([times.len()]);
        let starts_anew = starts.zip(ends).skip(1).any(|(from, to)| is_near_zero(&times[from..to]));
        !rows.is_empty()
            && rows.iter().all(|row| times[*row] < times[row - 1])
            && (is_long || !starts_anew)
    };
    labels.iter().copied().filter(begins).collect()
}

/// Whether the first time is nearer to zero than the duration, as with a clock that was started for this
/// table.
fn is_near_zero(times: &[f64]) -> bool {
    times.first().zip(times.last()).is_some_and(|(first, last)| *first <= last - first)
}

fn distinct<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut out: Vec<String> = vec![];
    for text in texts {
        if out.len() <= JOINTS && !out.iter().any(|o| o == text) {
            out.push(text.into());
        }
    }
    out
}
