//! Sides in words that are not known, or are sides only beside each other: names of the motion and of the input that
//! differ in the same word.

use super::guessed::Candidate;
use super::names::{MEASURED, Named, Quantity, Side, WISHED, named_with};
use crate::io::words;

/// Words in which names of one wheel differ as well: places, axes, and how a value was treated.
const OTHERS: [&str; 22] = [
    "front", "rear", "back", "mid", "middle", "x", "y", "z", "d", "q", "p", "i", "raw", "filtered",
    "filt", "avg", "mean", "max", "min", "old", "new", "est",
];

/// Right and left in letters and words that have other meanings alone: Polish and Czech (prawy, lewy), French (droite,
/// gauche), Spanish (derecha, izquierda), Portuguese (direita, esquerda), Italian (destra, sinistra), Swedish and
/// Danish (höger, vänster), Finnish (oikea, vasen), Russian, and on board.
const TOGETHER: [(&str, &str); 10] = [
    ("p", "l"),
    ("d", "g"),
    ("d", "i"),
    ("d", "e"),
    ("d", "s"),
    ("h", "v"),
    ("o", "v"),
    ("п", "л"),
    ("stbd", "port"),
    ("starboard", "port"),
];

/// Interprets such words as the sides where names of a motion and of an input differ in them alone, and no motion has a
/// right side.
pub(super) fn by_pairs_of_words(all: &mut [Candidate]) {
    if all.iter().any(|c| c.named.side == Some(Side::Right) && is_of(c, true)) {
        return;
    }
    for (right, left) in TOGETHER {
        let as_sides = |word: String| match word {
            word if word == right => "right".into(),
            word if word == left => "left".into(),
            word => word,
        };
        let names: Vec<Vec<String>> = all.iter().map(|c| words(&c.column.name)).collect();
        let differ = |a: &[String], b: &[String]| {
            let mut differ = a.iter().zip(b).filter(|(a, b)| a != b);
            let one = differ
                .next()
                .is_some_and(|(a, b)| a == right && b == left || a == left && b == right);
            a.len() == b.len() && one && differ.next().is_none()
        };
        let read: Vec<Candidate> = (0..all.len())
            .filter(|k| names.iter().any(|other| differ(&names[*k], other)))
            .map(|k| Candidate {
                column: all[k].column,
                named: named_with(&all[k].column.name, &as_sides),
            })
            .collect();
        let has = |motion: bool| {
            read.iter().any(|c| c.named.side == Some(Side::Right) && is_of(c, motion))
        };
        if has(true) && has(false) {
            for one in read {
                let place = all.iter_mut().find(|c| std::ptr::eq(c.column, one.column));
                place.into_iter().for_each(|c| c.named = one.named.clone());
            }
            return;
        }
    }
}

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

/// Uses two motions in one unit and two inputs in one unit as those of the wheels, in their order, where no name has a
/// known side and no other is of either: names in a language that is not known. Which is the right one is asked.
pub(super) fn by_units(all: &mut [Candidate]) {
    let places = |motion: bool| -> Vec<usize> {
        (0..all.len()).filter(|k| is_of(&all[*k], motion) && !all[*k].named.foreign).collect()
    };
    let (motions, inputs) = (places(true), places(false));
    let is_unknown = |word: &String| {
        let word = word.as_str();
        !OTHERS.contains(&word) && !WISHED.contains(&word) && !MEASURED.contains(&word)
    };
    let are_two = |places: &[usize]| match places {
        [a, b] => {
            let (a, b) = (&all[*a].named, &all[*b].named);
            let is_free =
                |n: &Named| n.side.is_none() && !n.wished && n.rest.iter().all(is_unknown);
            a.unit.is_some()
                && (a.unit, a.quantity, a.scale) == (b.unit, b.quantity, b.scale)
                && is_free(a)
                && is_free(b)
        }
        _ => false,
    };
    if !are_two(&motions) || !are_two(&inputs) {
        return;
    }
    for pair in [motions, inputs] {
        for (number, k) in pair.into_iter().enumerate() {
            all[k].named.side = Some(Side::Numbered(number + 1));
            all[k].named.rest.clear();
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
    use crate::experiment::guess::Guess;
    use crate::io::PreviewColumn;

    /// The guess from columns of these names, whose values are the same wave.
    fn of(names: &[&str]) -> Guess {
        let column = |name: &&str| PreviewColumn {
            name: (*name).into(),
            values: (0..200).map(|k| 50.0 * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        guess(&names.iter().map(column).collect::<Vec<_>>())
    }

    #[test]
    fn letters_of_a_language_are_sides_beside_each_other() {
        for names in [
            ["prędkość L [obr/min]", "prędkość P [obr/min]", "prąd L", "prąd P"],
            ["w_L [rad/s]", "w_P [rad/s]", "i_L", "i_P"],
            ["vitesse G (tr/min)", "vitesse D (tr/min)", "courant G (A)", "courant D (A)"],
            ["vel_i [rpm]", "vel_d [rpm]", "corriente_i", "corriente_d"],
            ["varvtal V [rpm]", "varvtal H [rpm]", "ström V", "ström H"],
            ["port_rpm", "stbd_rpm", "port_torque_Nm", "stbd_torque_Nm"],
        ] {
            let g = of(&names);
            let name = |key: &str| g.columns.iter().find(|c| c.key == key).map(|c| &*c.name);
            let found = [name("dalpha1"), name("dalpha2"), name("M1"), name("M2")];
            assert_eq!(found, [names[1], names[0], names[3], names[2]].map(Some), "{}", g.asked());
            assert!(!g.one_axis && !g.asked().contains("is the right wheel"));
        }
        // the terms of a controller are no sides
        let g = of(&["rpm", "amps", "pid_p", "pid_i", "pid_d"]);
        assert!(g.columns.iter().all(|c| !c.name.starts_with("pid")), "{:?}", g.columns);
    }

    #[test]
    fn two_columns_of_one_unit_are_never_one_axis() {
        // no side is known: in their order, with the question
        for names in [
            ["Xa(rpm)", "Ya(rpm)", "Xb(mA)", "Yb(mA)"],
            ["ВуТЦ(rpm)", "УТВЦЧ(rpm)", "ЄЛЩ(mA)", "ЛВЩЦ(mA)"],
        ] {
            let g = of(&names);
            let name = |key: &str| g.columns.iter().find(|c| c.key == key).map(|c| &*c.name);
            let found = [name("dalpha1"), name("dalpha2"), name("M1"), name("M2")];
            assert_eq!(found, names.map(Some), "{}", g.asked());
            assert!(
                !g.one_axis && g.asked().contains("is the right wheel that of"),
                "{}",
                g.asked()
            );
        }
        // more than two: which are the wheels is asked
        let g = of(&["Xa(rpm)", "Yab(rpm)", "Zabc zz(rpm)", "Xb(mA)", "Yb zz(mA)"]);
        assert!(!g.one_axis && !g.columns.iter().any(|c| c.key != "t"), "{:?}", g.columns);
        // one of each is one axis
        assert!(of(&["Xa(rpm)", "Xb(mA)"]).one_axis);
    }

    #[test]
    fn a_word_in_which_speeds_and_inputs_differ_is_that_of_the_side() {
        let g = of(&["rpm_vasak", "rpm_parem", "amps_vasak", "amps_parem"]);
        assert_eq!(g.columns[0].name, "rpm_parem");
        assert!(g.asked().contains("is the right wheel that of `rpm_parem`"));
        assert!(!g.one_axis);
        let g = of(&["rpm_raw", "rpm_filt", "amps_raw", "amps_filt"]);
        assert!(!g.columns.iter().any(|c| c.key == "dalpha1"), "{:?}", g.columns);
    }
}
