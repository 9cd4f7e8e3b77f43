//! Units with a prefix of the SI that no list contains, and units per millisecond: `torque_uNm`, `i_left_dA`,
//! `torque_milli_Nm`, `omega_rad_per_ms`. The words are those of the unit without the prefix, with a factor.

use super::interpreted::Quantity;
use super::unit::unit;
use super::words::take_quantity;

/// Letters in front of a unit and their factors; units with `m` are in the list of units.
const LETTERS: [(&str, f64); 7] =
    [("u", 1e-6), ("µ", 1e-6), ("μ", 1e-6), ("c", 1e-2), ("d", 1e-1), ("da", 10.0), ("k", 1e3)];

/// Words in front of a unit and their factors.
const WORDS: [(&str, f64); 8] = [
    ("nano", 1e-9),
    ("micro", 1e-6),
    ("milli", 1e-3),
    ("centi", 1e-2),
    ("deci", 1e-1),
    ("deca", 10.0),
    ("kilo", 1e3),
    ("mega", 1e6),
];

/// Units of a time in which an angle passes, and how many of it are a second.
const TIMES: [(&str, f64); 3] = [("ms", 1e3), ("us", 1e6), ("min", 1.0 / 60.0)];

/// Takes the prefix of a unit off the words of `name`, and puts the unit at their end; returns the factor.
pub(super) fn take_prefix(name: &str, words: &mut Vec<String>) -> Option<f64> {
    take_letter(name, words).or_else(|| take_word(words)).or_else(|| take_time(words))
}

/// A letter glued to a unit. `dA`, `uV` may also be a quantity of motor A, or a voltage: they are a unit only behind a
/// word for a current or a voltage.
fn take_letter(name: &str, words: &mut Vec<String>) -> Option<f64> {
    let mut tokens = name.split(|c: char| !c.is_alphanumeric()).skip(1);
    let (token, (unit, of), factor) = tokens.find_map(|token| {
        let (rest, factor) = LETTERS.iter().find_map(|(letter, factor)| {
            Some((token.strip_prefix(letter)?, *factor)).filter(|(rest, _)| base(rest).is_some())
        })?;
        Some((token, base(rest)?, factor))
    })?;
    let parts = crate::io::words(token);
    let k = words.windows(parts.len()).rposition(|w| w == parts)?;
    let mut others = words.clone();
    others.drain(k..k + parts.len());
    // `i_right` is a current as `i` is
    let without_side = others.iter().filter(|w| crate::io::side(w).is_none());
    let mut without_side: Vec<String> = without_side.cloned().collect();
    let stated = take_quantity(&mut without_side).map(|(stated, _)| stated);
    (of == Quantity::Torque || stated == Some(of)).then(|| {
        others.push(unit.into());
        *words = others;
        factor
    })
}

/// The word of a unit behind a letter, and its quantity.
fn base(text: &str) -> Option<(&'static str, Quantity)> {
    match text {
        "A" => Some(("amps", Quantity::Current)),
        "V" => Some(("volts", Quantity::Voltage)),
        _ => text.eq_ignore_ascii_case("nm").then_some(("nm", Quantity::Torque)),
    }
}

/// A word in front of a unit, or glued to it.
fn take_word(words: &mut Vec<String>) -> Option<f64> {
    let is_one = |text: &str| {
        let of = unit(text).and_then(|(_, of)| of);
        matches!(of, Some(Quantity::Torque | Quantity::Current | Quantity::Voltage))
    };
    (0..words.len()).find_map(|k| {
        let (prefix, factor) = WORDS.iter().find(|(prefix, _)| words[k].starts_with(prefix))?;
        let glued = words[k][prefix.len()..].to_owned();
        let (count, found) = match words.get(k + 1) {
            Some(next) if glued.is_empty() && is_one(next) => (2, next.clone()),
            _ if is_one(&glued) && unit(&words[k]).is_none() => (1, glued),
            _ => return None,
        };
        words.drain(k..k + count);
        words.push(found);
        Some(*factor)
    })
}

/// A time that is no second behind an angle; `rev_min` is in the list of units.
fn take_time(words: &mut [String]) -> Option<f64> {
    let (k, factor) = (1..words.len()).find_map(|k| {
        let (_, factor) = TIMES.iter().find(|(time, _)| words[k] == *time)?;
        Some((k, *factor))
    })?;
    // without `per`, `min` is a smallest value
    let angle = match words[k - 1].as_str() {
        "per" => k.checked_sub(2)?,
        _ if words[k] == "min" => return None,
        _ => k - 1,
    };
    let is_listed =
        || unit(&words[angle..=k].join("/")).or_else(|| unit(&words[angle..=k].concat()));
    // counts in a time have words of their own, and `tick_ms` is a clock
    let is_angle = matches!(unit(&words[angle]), Some(("rad" | "deg" | "rev" | "mrad", _)));
    if !is_angle || is_listed().is_some() {
        return None;
    }
    words[k] = "s".into();
    Some(factor)
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, named};

    #[test]
    fn units_with_a_prefix_are_multiples_of_the_unit() {
        for (name, quantity, unit, scale) in [
            ("torque_right_Nmm", Quantity::Torque, "N mm", None),
            ("torque_right_uNm", Quantity::Torque, "N m", Some(1e-6)),
            ("torque_unm_right", Quantity::Torque, "N m", Some(1e-6)),
            ("torque_right_cNm", Quantity::Torque, "N m", Some(1e-2)),
            ("torque_right_milliNm", Quantity::Torque, "N m", Some(1e-3)),
            ("torqueRightMicroNm", Quantity::Torque, "N m", Some(1e-6)),
            ("torque_right_mNm", Quantity::Torque, "mN m", None),
            ("i_right_dA", Quantity::Current, "A", Some(1e-1)),
            ("current_cA_right", Quantity::Current, "A", Some(1e-2)),
            ("current_right_centiamps", Quantity::Current, "A", Some(1e-2)),
            ("current_right_milliamps", Quantity::Current, "mA", None),
            ("voltage_right_cV", Quantity::Voltage, "V", Some(1e-2)),
            ("omega_right_rad_per_ms", Quantity::Speed, "rad/s", Some(1e3)),
            ("omega_right_deg_per_min", Quantity::Speed, "deg/s", Some(1.0 / 60.0)),
            ("speed_right_rev_min", Quantity::Speed, "rpm", None),
        ] {
            let found = named(name);
            assert_eq!(
                (found.quantity, found.unit, found.scale),
                (Some(quantity), Some(unit), scale),
                "{name}"
            );
        }
    }

    #[test]
    fn letters_of_motors_and_quantities_are_no_prefix() {
        for name in ["motor_uA", "motor_uB", "speed_dA", "pos_cA", "left_speed_ms", "tick_ms"] {
            assert_eq!(named(name).scale, None, "{name}");
        }
    }
}
