//! Columns that belong together: the same quantity at the right and at the left wheel.

use super::guessed::{About, Candidate, Guessed, Question};
use super::names::{MEASURED, Quantity, Side};
use super::samples::never_varies;
use super::shafts;
use super::shares;
use super::values::fits;

/// Letters in which two names differ and that are not motors: axes of space and of a motor's field, and the
/// terms of a controller.
const NO_MOTORS: [&str; 7] = ["x", "y", "z", "d", "q", "p", "i"];
/// Words of a name that is that of a wheel.
const WHEELS: [&str; 4] = ["wheel", "wheels", "drive", "traction"];
/// Words for the shaft after a gear, which turns with the wheel.
const SHAFTS: [&str; 5] = ["output", "shaft", "gearbox", "load", "axle"];
/// Words of the motor, used if another current is that of the battery.
const MOTORS: [&str; 5] = ["motor", "wheel", "wheels", "drive", "mot"];

/// What is written where several motors drive a side.
const ADDED: &str = "; of several motors of a side one as name, and the others as plus = [\"…\"], which adds them up";

/// Finds pairs, and collects the questions on those that are not used.
pub(super) struct Pairs<'a, 'b> {
    all: &'a [Candidate<'b>],
    pub(super) questions: Vec<Question>,
    /// Whether there are more wheels or motors than two.
    pub(super) are_several: bool,
}

/// The columns of the right and the left wheel.
type Two<'a, 'b> = (&'a Candidate<'b>, &'a Candidate<'b>);

impl<'a, 'b> Pairs<'a, 'b> {
    pub(super) fn new(all: &'a [Candidate<'b>]) -> Self {
        Self { all, questions: vec![], are_several: false }
    }

    /// The columns of a quantity at the right and the left wheel: two names that differ in the side only; measured
    /// values before set-points, sides before numbers, wheels before other words, the fewest words first, then those
    /// with a unit, and the slower of two in a constant ratio. With more than two wheels, and with set-points only of
    /// speeds or angles, a question is asked.
    pub(super) fn of(
        &mut self,
        quantity: Quantity,
        keys: [&'static str; 2],
    ) -> Option<[Guessed; 2]> {
        let fits: Vec<&'a Candidate<'b>> =
            self.all.iter().filter(|c| c.named.quantity == Some(quantity)).collect();
        let (pair, others) = best(&fits, keys)?;
        if !others.is_empty() {
            self.are_several = true;
            let text = format!(
                "which of {} are those of the right and of the left wheel ({}, {})? Write them in place of \"?\"{}",
                listed(&[&[pair.0, pair.1], &others[..]].concat()),
                keys[0],
                keys[1],
                if matches!(quantity, Quantity::Torque | Quantity::Current) { ADDED } else { "" }
            );
            self.questions.push(Question { about: About::Which(keys[0]), text });
            return None;
        }
        let is_motion = matches!(quantity, Quantity::Angle | Quantity::Speed);
        if is_motion && pair.0.named.wished && !is_exact(pair.0, keys) {
            let text = format!(
                "{} are set-points by their names: which columns contain the measured values ({}, {})?",
                listed(&[pair.0, pair.1]),
                keys[0],
                keys[1]
            );
            self.questions.push(text.into());
            return None;
        }
        Some(guessed(pair, keys))
    }

    /// Two columns whose names contain the side and nothing else.
    pub(super) fn bare(&self, keys: [&'static str; 2]) -> Option<[Guessed; 2]> {
        let says_no_more =
            |c: &Candidate| c.named.rest.iter().all(|w| MEASURED.contains(&w.as_str()));
        let is_bare = |c: &&Candidate| {
            c.named.quantity.is_none() && !c.named.wished && !c.named.foreign && says_no_more(c)
        };
        let fits: Vec<&Candidate> = self.all.iter().filter(is_bare).collect();
        best(&fits, keys)
            .filter(|(_, others)| others.is_empty())
            .map(|(pair, _)| guessed(pair, keys))
    }
}

fn listed(columns: &[&Candidate]) -> String {
    columns.iter().map(|c| format!("`{}`", c.column.name)).collect::<Vec<_>>().join(", ")
}

fn is_exact(c: &Candidate, keys: [&str; 2]) -> bool {
    keys.contains(&c.column.name.as_str())
}

fn guessed((right, left): Two, keys: [&'static str; 2]) -> [Guessed; 2] {
    let is_known = matches!(right.named.side, Some(Side::Right)) || is_exact(right, keys);
    let one = |c, key| Guessed { side_unsure: !is_known, ..of(c, key) };
    [one(right, keys[0]), one(left, keys[1])]
}

/// The pair that comes first, and the columns that may as well be the wheels.
fn best<'a, 'b>(
    fits: &[&'a Candidate<'b>],
    keys: [&str; 2],
) -> Option<(Two<'a, 'b>, Vec<&'a Candidate<'b>>)> {
    let partner = |a: &&'a Candidate<'b>| {
        let of_other_side = |b: &&&Candidate| {
            let same = a.named.rest == b.named.rest && a.named.wished == b.named.wished;
            let sides = (a.named.side, b.named.side);
            let opposite = matches!(
                sides,
                (Some(Side::Right), Some(Side::Left))
                    | (Some(Side::Numbered(1)), Some(Side::Numbered(2) | Side::Numbered(0)))
            );
            same && opposite
        };
        // of several the one in the same unit and words
        let differs =
            |b: &&'a Candidate<'b>| (b.named.unit != a.named.unit, b.named.word != a.named.word);
        fits.iter().filter(of_other_side).copied().min_by_key(differs)
    };
    let mut pairs: Vec<Two> =
        fits.iter().copied().filter_map(|a| Some((a, partner(&a)?))).collect();
    pairs.sort_by_key(|(a, _)| {
        let n = &a.named;
        let words = (!is_of_wheel(a), n.rest.len());
        // of `left_vel` and `left_rpm` the one that states its unit
        (!is_exact(a, keys), n.wished, is_numbered(a), words, n.unit.is_none())
    });
    // a gear makes a motor slower
    let is_slower = |(a, _): &Two| !is_of_wheel(pairs[0].0) && shafts::is_slower(pairs[0].0, a);
    if let Some(k) = (1..pairs.len()).find(|k| is_slower(&pairs[*k])) {
        pairs.swap(0, k);
    }
    if let Some(k) = (1..pairs.len()).find(|k| shares::is_volts_of(pairs[0].0, pairs[*k].0)) {
        pairs.swap(0, k);
    }
    let Some(&pair) = pairs.first() else { return lettered(fits).map(|pair| (pair, vec![])) };
    let others = if is_exact(pair.0, keys) || !is_numbered(pair.0) {
        vec![]
    } else {
        let mut others = siblings(fits, pair);
        others.extend(rivals(&pairs));
        others
    };
    Some((pair, others))
}

fn is_numbered(c: &Candidate) -> bool {
    matches!(c.named.side, Some(Side::Numbered(_)))
}

/// Whether a name is that of a wheel, or of the shaft after the gear of its motor.
fn is_of_wheel(c: &Candidate) -> bool {
    let moves = matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed));
    has_word(c, &WHEELS) || moves && has_word(c, &SHAFTS)
}

fn has_word(c: &Candidate, words: &[&str]) -> bool {
    c.named.rest.iter().any(|w| words.contains(&w.as_str()))
}

/// The columns with the next numbers after a pair: the other wheels of four.
fn siblings<'a, 'b>(fits: &[&'a Candidate<'b>], pair: Two) -> Vec<&'a Candidate<'b>> {
    let is_number = |word: &String| word.chars().all(|c| c.is_ascii_digit());
    let stem = |c: &Candidate| -> Option<Vec<String>> {
        let numbers = c.named.rest.iter().filter(|w| is_number(w)).count();
        match (c.named.side, numbers) {
            (Some(Side::Numbered(_)), _) => Some(c.named.rest.clone()),
            (None, 1) => Some(c.named.rest.iter().filter(|w| !is_number(w)).cloned().collect()),
            _ => None,
        }
    };
    let own = [pair.0, pair.1].map(|c| &c.column.name);
    let is_one = |c: &&&Candidate| {
        !own.contains(&&c.column.name)
            && !never_varies(c.column)
            && c.named.wished == pair.0.named.wished
            && stem(c).is_some_and(|s| s == pair.0.named.rest)
    };
    fits.iter().filter(is_one).copied().collect()
}

/// Other numbered pairs of the same kind that are not variants of the first: of two arms and two wheels, the log does
/// not state which are the wheels.
fn rivals<'a, 'b>(pairs: &[Two<'a, 'b>]) -> Vec<&'a Candidate<'b>> {
    let first = pairs[0].0;
    let alike = |c: &Candidate| {
        (c.named.wished, is_numbered(c), is_of_wheel(c))
            == (first.named.wished, true, is_of_wheel(first))
    };
    let is_variant = |c: &Candidate| first.named.rest.iter().all(|w| c.named.rest.contains(w));
    let rivals = pairs[1..].iter().filter(|(a, _)| alike(a) && !is_variant(a));
    rivals.flat_map(|(a, b)| [*a, *b]).collect()
}

/// Two columns whose names differ in one letter or number alone, as those of motors B and C, or of 0x141 and 0x142.
fn lettered<'a, 'b>(fits: &[&'a Candidate<'b>]) -> Option<Two<'a, 'b>> {
    let is_id = |word: &String| word.chars().all(|c| c.is_ascii_digit());
    let short =
        |word: &String| is_id(word) || word.len() == 1 && !NO_MOTORS.contains(&word.as_str());
    let differs = |a: &Candidate, b: &Candidate| {
        let (a, b) = (&a.named.rest, &b.named.rest);
        let mut others = a.iter().zip(b).filter(|(a, b)| a != b);
        let one = others.next().is_some_and(|(a, b)| short(a) && short(b) && a < b);
        a.len() == b.len() && one && others.next().is_none()
    };
    let pairs = || fits.iter().flat_map(|a| fits.iter().map(move |b| (*a, *b)));
    let mut found = pairs().filter(|(a, b)| differs(a, b));
    // with three motors either may be it
    found.next().filter(|_| found.next().is_none())
}

/// The one column of a quantity, for both wheels: that of a wheel, else of a motor, with the fewest other words.
/// Set-points come last, and are never used as the motion, nor is a column of one value: a counter of a logger that is
/// not connected. Of a voltage and its share of the battery voltage the voltage is used.
pub(super) fn one(
    all: &[Candidate],
    quantity: Quantity,
    keys: [&'static str; 2],
) -> Option<[Guessed; 2]> {
    let moves = matches!(quantity, Quantity::Angle | Quantity::Speed);
    let fits = |c: &&Candidate| {
        let is_motion = || !c.named.wished && !never_varies(c.column);
        c.named.quantity == Some(quantity) && c.named.side.is_none() && (!moves || is_motion())
    };
    let rank = |c: &Candidate| {
        let n = &c.named;
        (n.wished, moves && !is_of_wheel(c), !has_word(c, &MOTORS), n.rest.len())
    };
    // that of one side stands beside the other
    let is_sided = |c: &Candidate| {
        c.named.quantity == Some(quantity) && c.named.side.is_some() && !c.named.wished
    };
    if all.iter().any(is_sided) {
        return None;
    }
    let fitting: Vec<&Candidate> = all.iter().filter(fits).collect();
    // the share of a voltage is left to the voltage
    let is_share = |c: &&Candidate| fitting.iter().any(|other| shares::is_volts_of(c, other));
    let mut found: Vec<&Candidate> = fitting.iter().copied().filter(|c| !is_share(c)).collect();
    found.sort_by_key(|c| rank(c));
    // of two in one unit either may be that of a wheel, whatever other words they have
    let kind =
        |c: &Candidate| (rank(c).0, rank(c).1, rank(c).2, c.named.unit, c.named.word.clone());
    let are_two = |a: &Candidate, b: &Candidate| {
        rank(a) == rank(b) || a.named.unit.is_some() && kind(a) == kind(b)
    };
    match found[..] {
        [] => None,
        [first, ref others @ ..] if others.iter().any(|other| are_two(first, other)) => None,
        [first, ..] => Some(keys.map(|key| of(first, key))),
    }
}

/// A column as this quantity of the program, with the unit and the factor of its name.
fn of(c: &Candidate, key: &'static str) -> Guessed {
    // a factor is read with its unit, also with that of the program
    let is_scaled = c.named.scale.is_some();
    let unit = c.named.unit.filter(|u| fits(key, u) || is_scaled).map(Into::into);
    let (scale, per_row) = (c.named.scale, c.named.per_row);
    Guessed { key, name: c.column.name.clone(), unit, scale, per_row, ..Guessed::default() }
}
