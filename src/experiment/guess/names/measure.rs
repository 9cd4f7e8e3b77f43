//! The unit of a name, and the factor in front of it.

use super::factor::{many, multiplied, take_multiple, take_power_of_ten};
use super::interpreted::Quantity;
use super::unit::{bracketed, unit, unit_behind};

/// Unit and factor that a name states.
pub(super) struct Measure {
    /// The unit, with the quantity that it belongs to if there is one only.
    pub(super) unit: Option<(&'static str, Option<Quantity>)>,
    /// The factor.
    pub(super) scale: Option<f64>,
    /// The text in brackets in lower case, without spaces, points and signs.
    pub(super) plain: Option<String>,
    /// Whether a unit is in brackets.
    pub(super) in_brackets: bool,
}

impl Measure {
    /// Takes unit and factor off the words of a name with the factor `times`, a text in brackets, and a unit in front
    /// of it.
    pub(super) fn taken(
        words: &mut Vec<String>,
        times: Option<f64>,
        bracket: Option<&str>,
        front: Option<(&'static str, Option<Quantity>)>,
    ) -> Self {
        let (mut scale, bracket) = bracket.map_or((None, None), |b| {
            let (times, unit) = multiplied(b);
            let (scale, unit) = many(unit);
            (times.or(scale), Some(unit))
        });
        scale = times.or(scale).or_else(|| take_multiple(words));
        part_halves(words);
        let plain = bracket.map(|u| u.to_lowercase().replace([' ', '·', '*', '.', '-'], ""));
        let is_half = plain.as_deref().is_some_and(|u| u.starts_with(HALF));
        let mut ending =
            plain.as_deref().and_then(|u| bracketed(u.strip_prefix(HALF).unwrap_or(u)));
        ending = ending.or(front);
        if ending.is_none() {
            ending = unit_behind(words);
            scale = scale.or_else(|| ending.and_then(|_| take_power_of_ten(words)));
        }
        if is_half || take_half(words, ending.map(|(unit, _)| unit)) {
            scale = Some(0.5 * scale.unwrap_or(1.0));
        }
        if ending.is_none() && words.iter().any(|w| w == "rpm" || w == "erpm") {
            ending = unit("rpm");
        }
        let in_brackets = bracket.is_some_and(|b| !b.is_empty());
        Self { unit: ending, scale, plain, in_brackets }
    }
}

/// What stands before turns of which two are one.
const HALF: &str = "half";

/// Makes two words of `halfturns`.
fn part_halves(words: &mut Vec<String>) {
    let glued = |w: &String| {
        let of = w.strip_prefix(HALF).and_then(unit);
        of.is_some_and(|(unit, _)| unit.starts_with("rev"))
    };
    if let Some(k) = words.iter().position(glued) {
        let turns = words[k].split_off(HALF.len());
        words.insert(k + 1, turns);
    }
}

/// Takes the word of half turns off the end, where their unit stood behind it.
fn take_half(words: &mut Vec<String>, unit: Option<&str>) -> bool {
    let is_half =
        unit.is_some_and(|u| u.starts_with("rev")) && words.last().is_some_and(|w| w == HALF);
    if is_half {
        words.pop();
    }
    is_half
}
