//! Words that are put together, and words that another one gives its meaning.

use super::words::is_quantity;

/// Endings of words that are put together.
const COMPOUNDS: [&str; 13] = [
    "drehzahl",
    "winkelgeschwindigkeit",
    "geschwindigkeit",
    "drehmoment",
    "strom",
    "spannung",
    "moment",
    "stroom",
    "snelheid",
    "toerental",
    "spanning",
    "hastighet",
    "varvtal",
];

/// Parts the words of languages that put them together: `motorstrom` has motor and strom. The `rad` of `raddrehzahl` is
/// a wheel.
pub(super) fn part(words: &mut Vec<String>) {
    let ending = |word: &String| {
        let is_whole = is_quantity(word);
        COMPOUNDS
            .iter()
            .find(|end| !is_whole && word.len() > end.len() + 1 && word.ends_with(**end))
    };
    while let Some((k, end)) = (0..words.len()).find_map(|k| Some((k, ending(&words[k])?))) {
        let whole = std::mem::replace(&mut words[k], (*end).to_owned());
        let front = &whole[..whole.len() - end.len()];
        words.insert(k, if front == "rad" { "wheel".into() } else { front.to_owned() });
    }
}

/// Quantities of Vietnamese, which are written in two words: speed, voltage, current, time, angle, torque.
const PHRASES: [([&str; 2], &str); 7] = [
    (["toc", "do"], "speed"),
    (["van", "toc"], "speed"),
    (["dien", "ap"], "voltage"),
    (["dong", "dien"], "current"),
    (["thoi", "gian"], "time"),
    (["goc", "quay"], "angle"),
    (["mo", "men"], "torque"),
];

/// Joins the words of a phrase to the one word that it means.
pub(super) fn join(words: &mut Vec<String>) {
    let at = |words: &[String]| {
        let phrase = |pair: &[String]| {
            PHRASES.iter().find(|(two, _)| pair[0] == two[0] && pair[1] == two[1])
        };
        words.windows(2).enumerate().find_map(|(k, pair)| Some((k, phrase(pair)?.1)))
    };
    while let Some((k, meaning)) = at(words) {
        words.splice(k..k + 2, [meaning.to_owned()]);
    }
}

/// Gives words their meaning beside others: the force of a joint or hinge that turns is its torque (Gazebo), and a wheel
/// sensor measures its angle (Webots).
pub(super) fn in_context(words: &mut [String]) {
    let has = |word: &str| words.iter().any(|w| w == word);
    let change = |words: &mut [String], from: &str, to: &str| {
        words.iter_mut().filter(|w| *w == from).for_each(|w| *w = to.into());
    };
    if (has("joint") || has("hinge")) && has("force") {
        change(words, "force", "effort");
    } else if has("wheel") && has("sensor") && !words.iter().any(|w| is_quantity(w)) {
        change(words, "sensor", "encoder");
    }
}
