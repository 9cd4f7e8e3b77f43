//! Units in names: in brackets, as suffix, as prefix.

use super::interpreted::Quantity;
use super::words::{LENGTHS, WEAK, is_quantity, take_quantity};
use crate::io::spellings;

/// Removes the unit from the end of the words. A single letter is kept if another word denotes a quantity
/// with other units: `a` of `speed_a` is a motor.
pub(super) fn unit_behind(words: &mut Vec<String>) -> Option<(&'static str, Option<Quantity>)> {
    let before = words.clone();
    // the letter of a motor and of a torque: only behind a length it is a unit
    if words.last().is_some_and(|w| w == "m") && words.iter().any(|w| LENGTHS.contains(&w.as_str()))
    {
        words.pop();
        return Some(("m", Some(Quantity::Angle)));
    }
    let last = take_unit(words).or_else(|| unit_before_side(words));
    if let Some(inner) = unit_before_motor(&before, words) {
        return Some(inner);
    }
    let found = of_its_quantity(last?, words);
    let letter =
        before.last().is_some_and(|last| last.len() == 1) && before.len() == words.len() + 1;
    if letter
        && let Some(of) = found.1
        && let Some((stated, word)) = take_quantity(&mut words.clone())
        && stated != of
        && !WEAK.contains(&word.as_str())
    {
        *words = before;
        return None;
    }
    Some(found)
}

/// A unit of several letters before the side at the end, `wheel_rad_s_left`, if it is not a word for its
/// quantity.
fn unit_before_side(words: &mut Vec<String>) -> Option<(&'static str, Option<Quantity>)> {
    let (last, inner) = words.split_last()?;
    crate::io::side(last)?;
    let mut others = inner.to_vec();
    let found = take_unit(&mut others)?;
    let taken = &inner[others.len()..];
    if taken.concat().len() < 2 || taken.iter().any(|word| is_quantity(word)) {
        return None;
    }
    others.push(last.clone());
    *words = others;
    Some(found)
}

/// The unit before a last letter that is a motor and could be read as a unit: `current_mA.A`, `current_mA.B`.
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

/// The unit at the end of a name, given its quantity: `ms` of a speed is m/s, not a time.
fn of_its_quantity(
    found: (&'static str, Option<Quantity>),
    words: &[String],
) -> (&'static str, Option<Quantity>) {
    let stated = take_quantity(&mut words.to_vec()).map(|(stated, _)| stated);
    match found.0 {
        "ms" if stated == Some(Quantity::Speed) => ("m/s", stated),
        _ => found,
    }
}

/// A unit at the beginning of a name, of more letters than one, and the rest of the name: `mA_left`, `rad_s_l`. Of
/// several words it is that of a speed; one that is a word of its quantity as well is found as such: `rpm_left`.
pub(super) fn unit_in_front(name: &str) -> (Option<(&'static str, Option<Quantity>)>, &str) {
    let is_edge = |c: char| !c.is_alphanumeric();
    let ends: Vec<usize> =
        name.match_indices(is_edge).map(|(at, _)| at).chain([name.len()]).take(3).collect();
    for (k, &end) in ends.iter().enumerate().rev() {
        let (front, rest) = name.split_at(end);
        let front = front.to_lowercase();
        let words: Vec<&str> = front.split(is_edge).collect();
        let found = unit(&words.join("/")).or_else(|| unit(&words.concat()));
        let is_one = |(_, of): &(&str, Option<Quantity>)| match of {
            Some(Quantity::Speed) => k > 0 || !is_quantity(&front),
            Some(of) => *of != Quantity::Time && k == 0 && !is_quantity(&front),
            None => false,
        };
        // `tick_ms` are no counts
        let is_time =
            || unit(rest.trim_matches(is_edge)).is_some_and(|(_, of)| of == Some(Quantity::Time));
        if let Some(found) = found.filter(is_one)
            && front.len() > 1
            && (k > 0 || !rest.is_empty() && !is_time())
        {
            return (Some(found), rest);
        }
    }
    (None, name)
}

/// The name and the unit in brackets after it; an index is not a unit.
pub(super) fn split_unit(name: &str) -> (&str, Option<&str>) {
    let Some(at) = crate::io::opening(name) else { return (name, None) };
    let inner = name[at + 1..].trim().trim_end_matches([']', ')']);
    // `omega 1 (right)`
    if crate::io::is_side(inner) || !inner.chars().any(char::is_alphabetic) {
        return (name, None);
    }
    (name[..at].trim(), Some(inner.trim()))
}

pub(super) fn unit(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    listed(text).or_else(|| a_second(text))
}

fn listed(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    let found = UNITS.iter().find(|(words, unit, _)| {
        words.contains(&text) || spellings(unit).contains(&text) && !OTHER_WORDS.contains(&text)
    });
    found.map(|(_, unit, of)| (*unit, *of))
}

/// Endings that turn the unit of an angle into that of a speed, the longest first.
const A_SECOND: [&str; 9] =
    ["persecond", "persec", "pers", "/second", "/sec", "/s", "/per/second", "/per/sec", "/per/s"];

/// The unit of an angle per second, for any combination of its words: `turns_per_s`, `rotations/s`.
fn a_second(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    let angles = A_SECOND.iter().filter_map(|end| text.strip_suffix(end)).filter_map(listed);
    let speeds = angles.filter_map(|(unit, _)| match unit {
        "mrad" => Some("mrad/s"),
        "rad" => Some("rad/s"),
        "deg" => Some("deg/s"),
        "rev" => Some("rev/s"),
        "ticks" => Some("ticks/s"),
        "m" => Some("m/s"),
        "cm" => Some("cm/s"),
        "mm" => Some("mm/s"),
        _ => None,
    });
    speeds.map(|unit| (unit, Some(Quantity::Speed))).next()
}

/// A unit in brackets; `min`, `h`, `ft` and `in` are words of other names without them.
pub(super) fn bracketed(text: &str) -> Option<(&'static str, Option<Quantity>)> {
    match text {
        "ft" => Some(("ft", Some(Quantity::Angle))),
        "in" => Some(("in", Some(Quantity::Angle))),
        _ => {
            let time = ["min", "h", "d"].into_iter();
            let time = time.filter(|unit| *unit == text || spellings(unit).contains(&text));
            time.map(|unit| (unit, None)).next().or_else(|| unit(text))
        }
    }
}

/// Takes the unit off the end of the words: the longest ending that is one, of up to three words.
fn take_unit(words: &mut Vec<String>) -> Option<(&'static str, Option<Quantity>)> {
    for count in (1..=4.min(words.len())).rev() {
        let from = words.len() - count;
        let joined = words[from..].concat();
        let slashed = words[from..].join("/");
        // a name that consists of a unit letter only denotes the quantity: `t`, `v`, `a`
        let alone = from == 0 && joined.len() < 2;
        // `m_s` is m/s, and no ms
        if let Some(found) = unit(&slashed).or_else(|| unit(&joined)).filter(|_| !alone) {
            // words such as `rpm`, `volts` and `ticks` also denote the quantity
            words.truncate(from);
            return Some(found);
        }
    }
    None
}

/// Spellings of units that are words of other names: frames and instructions per second, a counter of rows.
const OTHER_WORDS: [&str; 3] = ["fps", "ips", "count"];

/// Endings of a name that are a unit, beside its spellings in the columns of an experiment file
/// ([`crate::io::spellings`]): as written, unit of the program, and the quantity if the unit alone determines it.
const UNITS: [(&[&str], &str, Option<Quantity>); 38] = [
    (&["mm/s", "mmps", "mmpersec", "mmpersecond"], "mm/s", Some(Quantity::Speed)),
    (&["cm/s", "cmps", "cmpersec", "cmpersecond"], "cm/s", Some(Quantity::Speed)),
    (
        &[
            "meterspersecond",
            "meterspersec",
            "metrespersecond",
            "mpersecond",
            "mpersec",
            "mpers",
            "mps",
            "m/s",
        ],
        "m/s",
        Some(Quantity::Speed),
    ),
    (&["ft/s", "ftpers", "ftpersec", "feetpersec", "feetpersecond"], "ft/s", Some(Quantity::Speed)),
    (
        &["in/s", "inpers", "inpersec", "inchespersec", "inchespersecond"],
        "in/s",
        Some(Quantity::Speed),
    ),
    (&["km/h", "kmperh", "kmperhour"], "km/h", Some(Quantity::Speed)),
    (
        &[
            "radianspersecond",
            "radianspersec",
            "radpersec",
            "radpers",
            "radps",
            "rads",
            "radsec",
            "rad/s",
        ],
        "rad/s",
        Some(Quantity::Speed),
    ),
    (
        &["degreespersecond", "degreespersec", "degpersec", "degpers", "degps", "deg/s"],
        "deg/s",
        Some(Quantity::Speed),
    ),
    (
        &[
            "rotationspersecond",
            "rotationspersec",
            "revolutionspersecond",
            "revpersec",
            "revpers",
            "rev/s",
            "turnspersecond",
        ],
        "rev/s",
        Some(Quantity::Speed),
    ),
    (&["rotationsperminute", "rpm"], "rpm", Some(Quantity::Speed)),
    (
        &[
            "ticks/s",
            "tickspersecond",
            "tickspersec",
            "countspersecond",
            "countspersec",
            "tickspers",
            "countspers",
            "cps",
            "qpps",
            "pps",
        ],
        "ticks/s",
        Some(Quantity::Speed),
    ),
    (&["mrad/s", "mrad/sec", "mradps", "mradpers", "mradpersec"], "mrad/s", Some(Quantity::Speed)),
    (&["mrad"], "mrad", Some(Quantity::Angle)),
    (&["radians", "rad"], "rad", Some(Quantity::Angle)),
    (&["deg", "grad"], "deg", Some(Quantity::Angle)),
    (&["rotations", "rotation", "revolutions", "rev"], "rev", Some(Quantity::Angle)),
    (&["ticks", "cnt", "pulses"], "ticks", Some(Quantity::Angle)),
    (&["meters", "metres"], "m", None),
    (&["centimeters", "centimetres", "cm"], "cm", Some(Quantity::Angle)),
    (&["millimeters", "millimetres", "mm"], "mm", Some(Quantity::Angle)),
    (&[], "ft", Some(Quantity::Angle)),
    (&[], "in", Some(Quantity::Angle)),
    (&["milliseconds", "millis", "msec", "ms"], "ms", Some(Quantity::Time)),
    (&["microseconds", "micros", "usec", "us"], "us", Some(Quantity::Time)),
    (&["nanoseconds", "ns"], "ns", Some(Quantity::Time)),
    (&["milliamps", "ma"], "mA", Some(Quantity::Current)),
    (&["a"], "A", Some(Quantity::Current)),
    (&["millivolts", "mv"], "mV", Some(Quantity::Voltage)),
    (&["v"], "V", Some(Quantity::Voltage)),
    (&["mnm"], "mN m", Some(Quantity::Torque)),
    (&["nmm"], "N mm", Some(Quantity::Torque)),
    (&["ncm"], "N cm", Some(Quantity::Torque)),
    (&["kgfcm"], "kgf cm", Some(Quantity::Torque)),
    (&["ozin"], "oz in", Some(Quantity::Torque)),
    (&[], "lb in", Some(Quantity::Torque)),
    (&[], "lb ft", Some(Quantity::Torque)),
    (&["newtonmeters", "newtonmetres", "nm"], "N m", Some(Quantity::Torque)),
    (&["s"], "s", None),
];
