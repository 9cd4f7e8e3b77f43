//! The wheel that a name states.

use super::interpreted::Side;
use super::words::{is_of_wheel, is_quantity};
use crate::io::{WheelSide, side};

/// Takes the letters of a side off one of the words, if they contain them.
type Rule = fn(&mut [String]) -> Option<WheelSide>;

/// In order: a corner by itself precedes letters that are glued to others.
const LETTERS: [Rule; 4] =
    [take_corner, take_before_quantity, take_behind_quantity, take_behind_letter];

/// Takes the wheel off the words of a name.
pub(super) fn take_side(words: &mut Vec<String>) -> Option<Side> {
    // `speed_right_left(:,1)` is of either wheel
    if ["right", "left"].iter().all(|side| words.iter().any(|word| word == side)) {
        return take_number(words);
    }
    let letters = |words: &mut [String]| LETTERS.iter().find_map(|rule| rule(words));
    match take_word(words).or_else(|| letters(words)) {
        Some(WheelSide::Right) => Some(Side::Right),
        Some(WheelSide::Left) => Some(Side::Left),
        None => take_number(words),
    }
}

/// A word of its own; short ones may be words of another language.
fn take_word(words: &mut Vec<String>) -> Option<WheelSide> {
    let is_clear = |w: &String| w.len() > 2 && w != "der";
    let clear = words.iter().position(|w| side(w).is_some() && is_clear(w));
    let found = clear.or_else(|| words.iter().position(|w| side(w).is_some()))?;
    side(&words.remove(found))
}

/// A corner of a car: `RL`, `FR`; with the side first: `LF`, `RB`. Beside a word for the quantity `ML` is the wheel in the
/// middle of three on the left; alone, `m` is a torque.
fn take_corner(words: &mut [String]) -> Option<WheelSide> {
    let has_quantity = words.iter().any(|word| is_quantity(word));
    let corner = |w: &String| match w.as_str() {
        "ml" | "mr" if has_quantity => Some(("mid", w[1..].to_owned())),
        "fl" | "fr" => Some(("front", w[1..].to_owned())),
        "rl" | "rr" => Some(("rear", w[1..].to_owned())),
        "lf" | "rf" => Some(("front", w[..1].to_owned())),
        "lb" | "rb" => Some(("back", w[..1].to_owned())),
        _ => None,
    };
    let (word, (place, of)) = words.iter_mut().find_map(|word| {
        let found = corner(word)?;
        Some((word, found))
    })?;
    *word = place.into();
    side(&of)
}

/// Before a quantity: `rspeed`, `leftvel`.
fn take_before_quantity(words: &mut [String]) -> Option<WheelSide> {
    let before = |w: &&mut String| {
        let bare = |sides: &[&str], least: usize| {
            let bare = sides.iter().find_map(|side| w.strip_prefix(side));
            bare.is_some_and(|bare| bare.len() >= least && is_of_wheel(bare))
        };
        !is_quantity(w) && (bare(&["right", "left"], 1) || bare(&["r", "l"], 3))
    };
    let word = words.iter_mut().find(before)?;
    let long = ["right", "left"].iter().find(|side| word.starts_with(**side));
    let rest = word.split_off(long.map_or(1, |side| side.len()));
    side(&std::mem::replace(word, rest))
}

/// Behind a quantity: `taur`, `encl`.
fn take_behind_quantity(words: &mut [String]) -> Option<WheelSide> {
    let behind = |w: &&mut String| {
        let bare = w.strip_suffix(['r', 'l']).filter(|_| w.len() > 3);
        !is_quantity(w) && bare.is_some_and(is_quantity)
    };
    let word = words.iter_mut().find(behind)?;
    side(&word.split_off(word.len() - 1))
}

/// Behind a letter: `wr`, `vl`, `il`.
fn take_behind_letter(words: &mut [String]) -> Option<WheelSide> {
    let behind = |w: &&mut String| w.len() == 2 && w.ends_with(['r', 'l']) && is_short(&w[..1]);
    let word = words.iter_mut().find(behind)?;
    side(&word.split_off(1))
}

/// A letter that denotes a quantity of a wheel.
fn is_short(letter: &str) -> bool {
    matches!(letter, "w" | "v" | "i" | "u" | "m" | "q")
}

/// Takes the last number of a wheel off the words.
fn take_number(words: &mut Vec<String>) -> Option<Side> {
    let number = words.iter().rposition(|w| matches!(w.as_str(), "0" | "1" | "2"))?;
    words.remove(number).parse().ok().map(Side::Numbered)
}
