//! Units in names: in brackets, behind, in front.

use super::said::Quantity;
use super::words::{LENGTHS, QUANTITIES, UNITS, WEAK, take_quantity};

/// Takes the unit off the end of the words. A single letter stays where another word says a quantity of which it is
/// no unit: `a` of `speed_a` is a motor.
pub(super) fn unit_behind(words: &mut Vec<String>) -> Option<(&'static str, Option<Quantity>)> {
    let before = words.clone();
    // the letter of a motor and of a torque: only behind a length it is a unit
    if words.last().is_some_and(|w| w == "m") && words.iter().any(|w| LENGTHS.contains(&w.as_str()))
    {
        words.pop();
        return Some(("m", Some(Quantity::Angle)));
    }
    let last = take_unit(words);
    if let Some(inner) = unit_before_motor(&before, words) {
        return Some(inner);
    }
    let found = of_its_quantity(last?, words);
    let letter =
        before.last().is_some_and(|last| last.len() == 1) && before.len() == words.len() + 1;
    if letter
        && let Some(of) = found.1
        && let Some((said, word)) = take_quantity(&mut words.clone())
        && said != of
        && !WEAK.contains(&word.as_str())
    {
        *words = before;
        return None;
    }
    Some(found)
}

/// The unit before a last letter that is a motor, and may have been taken for a unit: `current_mA.A`, `current_mA.B`.
fn unit_before_motor(
    before: &[String],
    words: &mut Vec<String>,
) -> Option<(&'static str, Option<Quantity>)> {
    let (letter, inner) = before.split_last()?;
    let is_free = before.len() <= words.len() + 1;
    if letter.len() != 1 || !is_free || !letter.starts_with(char::is_alphabetic) {
        return None;
    }
    let mut others = inner.to_vec();
    let found = take_unit(&mut others)?;
    // a side is found as such, and one letter is none of these units
    if matches!(letter.as_str(), "l" | "r") || inner[others.len()..].concat().len() < 2 {
        return None;
    }
    others.push(letter.clone());
    *words = others;
    Some(found)
}

/// A unit behind the words of a name: `ms` of a speed is m/s, no time.
fn of_its_quantity(
    found: (&'static str, Option<Quantity>),
    words: &[String],
) -> (&'static str, Option<Quantity>) {
    let said = take_quantity(&mut words.to_vec()).map(|(said, _)| said);
    match found.0 {
        "ms" if said == Some(Quantity::Speed) => ("m/s", said),
        _ => found,
    }
}

/// A unit before the first sign that is no letter, of more letters than one: `mA_left`, and the rest of the name.
pub(super) fn unit_in_front(name: &str) -> (Option<(&'static str, Option<Quantity>)>, &str) {
    let end = name.find(|c: char| !c.is_alphanumeric()).unwrap_or(name.len());
    let (front, rest) = name.split_at(end);
    let says = |(_, of): &(&str, Option<Quantity>)| of.is_some_and(|q| q != Quantity::Time);
    let is_word = |word: &str| QUANTITIES.iter().any(|(_, words)| words.contains(&word));
    let front = front.to_lowercase();
    match unit(&front).filter(says) {
        // what is a word of its quantity as well is found as such: `rpm_left`, `ticks_left`
        Some(found) if front.len() > 1 && !rest.is_empty() && !is_word(&front) => {
            (Some(found), rest)
        }
        _ => (None, name),
    }
}

/// The name and the unit in brackets behind it; an index is no unit.
pub(super) fn split_unit(name: &str) -> (&str, Option<&str>) {
    let trimmed = name.trim().trim_end_matches([']', ')']);
    match trimmed.split_once(['[', '(']) {
        Some((bare, inner)) if inner.chars().any(char::is_alphabetic) => {
            (bare.trim(), Some(inner.trim()))
        }
        _ => (name, None),
    }
}

pub(super) fn unit(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    let found = UNITS.iter().find(|(words, ..)| words.contains(&text));
    found.map(|(_, unit, of)| (*unit, *of))
}

/// A unit in brackets; `min` and `h` are words of other names without them.
pub(super) fn bracketed(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    match text {
        "min" | "minute" | "minutes" => Some(("min", None)),
        "h" | "hr" | "hrs" | "hour" | "hours" => Some(("h", None)),
        "d" | "day" | "days" => Some(("d", None)),
        _ => unit(text),
    }
}

/// Takes the unit off the end of the words: the longest ending that is one, of up to three words.
fn take_unit(words: &mut Vec<String>) -> Option<(&'static str, Option<Quantity>)> {
    for count in (1..=4.min(words.len())).rev() {
        let from = words.len() - count;
        let joined = words[from..].concat();
        let slashed = words[from..].join("/");
        // a name that is a unit and nothing else says it as its quantity: `t`, `v`, `a`
        let alone = from == 0 && joined.len() < 2;
        // `m_s` is m/s, and no ms
        if let Some(found) = unit(&slashed).or_else(|| unit(&joined)).filter(|_| !alone) {
            // words such as `rpm` and `volts` say the quantity too, `ticks` of an encoder as well
            words.truncate(from);
            return Some(found);
        }
    }
    None
}
