//! Sides in words that are not known: names of the motion and of the input that differ in the same word.

use super::guessed::Candidate;
use super::names::{MEASURED, Quantity, Side, WISHED};

/// Words in which names of one wheel differ as well: places, axes, and how a value was treated.
const OTHERS: [&str; 22] = [
    "front", "rear", "back", "mid", "middle", "x", "y", "z", "d", "q", "p", "i", "raw", "filtered",
    "filt", "avg", "mean", "max", "min", "old", "new", "est",
];

/// Uses two words as those of the sides where names of a motion and of an input differ in them alone, and no
/// name has a known side. Which word is the right side is asked, as for motors A and B.
pub(super) fn apply(all: &mut [Candidate]) {
    if all.iter().any(|c| c.named.side.is_some() && is_of(c, true)) {
        return;
    }
    let inputs = pairs(all, false);
    let mut found: Vec<[String; 2]> =
        pairs(all, true).into_iter().filter(|pair| inputs.contains(pair)).collect();
    found.sort();
    found.dedup();
    let [[first, second]] = &found[..] else { return };
    for c in all.iter_mut().filter(|c| c.named.side.is_none()) {
        for (number, word) in [first, second].into_iter().enumerate() {
            if let Some(k) = c.named.rest.iter().position(|w| w == word) {
                c.named.rest.remove(k);
                c.named.side = Some(Side::Numbered(number + 1));
            }
        }
    }
}

/// Whether a column is one of a motion, or one of an input.
fn is_of(c: &Candidate, motion: bool) -> bool {
    match c.named.quantity {
        Some(Quantity::Angle | Quantity::Speed) => motion,
        Some(Quantity::Torque | Quantity::Current | Quantity::Voltage) => !motion,
        _ => false,
    }
}

/// The words in which two names of one quantity differ, in order.
fn pairs(all: &[Candidate], motion: bool) -> Vec<[String; 2]> {
    let of: Vec<&Candidate> = all.iter().filter(|c| is_of(c, motion)).collect();
    let both = of.iter().flat_map(|a| of.iter().map(move |b| (*a, *b)));
    both.filter_map(|(a, b)| differing(a, b)).collect()
}

/// The one word in which two names differ that may be that of a side.
fn differing(a: &Candidate, b: &Candidate) -> Option<[String; 2]> {
    let (x, y) = (&a.named, &b.named);
    let same = (x.quantity, x.unit, x.wished, x.rest.len())
        == (y.quantity, y.unit, y.wished, y.rest.len());
    let mut differ = x.rest.iter().zip(&y.rest).filter(|(a, b)| a != b);
    let (first, second) = differ.next().filter(|(a, b)| same && a < b)?;
    let may_be = |word: &String| {
        let word = word.as_str();
        word.chars().all(char::is_alphabetic)
            && !OTHERS.contains(&word)
            && !WISHED.contains(&word)
            && !MEASURED.contains(&word)
    };
    (differ.next().is_none() && may_be(first) && may_be(second))
        .then(|| [first.clone(), second.clone()])
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn a_word_in_which_speeds_and_inputs_differ_is_that_of_the_side() {
        let of = |names: &[&str]| {
            let column = |name: &&str| PreviewColumn {
                name: (*name).into(),
                values: (0..200).map(|k| 50.0 * (0.05 * f64::from(k)).sin()).collect(),
                ..PreviewColumn::default()
            };
            guess(&names.iter().map(column).collect::<Vec<_>>())
        };
        let g = of(&["rpm_vasen", "rpm_oikea", "amps_vasen", "amps_oikea"]);
        assert_eq!(g.columns[0].name, "rpm_oikea");
        assert!(g.asked().contains("is the right wheel that of `rpm_oikea`"));
        assert!(!g.one_axis);
        let g = of(&["rpm_raw", "rpm_filt", "amps_raw", "amps_filt"]);
        assert!(!g.columns.iter().any(|c| c.key == "dalpha1"), "{:?}", g.columns);
    }
}
