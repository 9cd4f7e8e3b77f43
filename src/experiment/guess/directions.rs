//! Columns with the direction of a magnitude: `dirL` and `pwmL`.

use super::guessed::{Guess, Guessed};
use super::names::{Side, named};
use super::samples::{all_values, all_words};
use super::values::{is_constant, is_never_negative};
use crate::io::PreviewColumn;
use crate::math::quantile;

/// Words for a direction, and those that state the direction of a 1.
const DIRECTIONS: [&str; 6] = ["dir", "direction", "sign", "sgn", "richtung", "dirn"];
const FORWARDS: [&str; 4] = ["fwd", "forward", "forwards", "vorwaerts"];
const BACKWARDS: [&str; 6] = ["rev", "reverse", "reversed", "back", "backward", "backwards"];
/// Cell contents for forward and for backward, in lower case.
const AHEAD: [&str; 10] =
    ["f", "fwd", "forward", "forwards", "fw", "+", "pos", "v", "vor", "ahead"];
const BACK: [&str; 13] = [
    "r",
    "rev",
    "reverse",
    "b",
    "bwd",
    "back",
    "backward",
    "backwards",
    "-",
    "neg",
    "z",
    "rw",
    "rwd",
];
/// Cell contents of a motor that is driven neither way.
const NEITHER: [&str; 10] =
    ["n", "neutral", "s", "stop", "stopped", "halt", "idle", "brake", "coast", "off"];
/// Share of the work of an input above which it drives its wheel in the stated direction.
const DRIVES: f64 = 0.2;
/// Share of the steps of an angle that are no wraps, and ratio to the largest of them above which a step is a wrap.
const USUAL: f64 = 0.9;
const WRAP: f64 = 3.0;

/// A direction: its column, the wheel, and its values.
struct Direction {
    name: String,
    side: Option<Side>,
    rest: Vec<String>,
    values: Vec<f64>,
    words: Vec<String>,
}

/// The directions of a log, from all its recordings: one of them may drive forward only.
pub(super) struct Directions(Vec<Direction>);

impl Directions {
    /// The columns that are directions by their names and hold two values.
    pub(super) fn of(columns: &[PreviewColumn]) -> Self {
        Self(columns.iter().filter_map(direction).collect())
    }

    /// Whether both columns of a pair have a direction.
    pub(super) fn are_of(&self, pair: &[Guessed; 2]) -> bool {
        pair.iter().all(|one| self.beside(one).is_some())
    }

    /// The direction of a column: the direction of its wheel with the most words in common.
    fn beside(&self, one: &Guessed) -> Option<&Direction> {
        let own = named(&one.name);
        let common = |d: &&Direction| d.rest.iter().filter(|w| own.rest.contains(w)).count();
        // of equal ones that with the fewest other words
        let rank = |d: &&Direction| (common(d), std::cmp::Reverse(d.rest.len()));
        // that of one axis has no side
        let is_of = |d: &&Direction| {
            d.side == own.side && (d.side.is_some() || d.has(&DIRECTIONS) && !own.battery)
        };
        self.0.iter().filter(is_of).max_by_key(rank)
    }

    /// Adds to magnitudes the columns of their directions and the value for backward, or the question for it.
    pub(super) fn give(&self, columns: &[PreviewColumn], guess: &mut Guess) {
        let of = |name: &str| columns.iter().find(|c| c.name == name).map_or(vec![], all_values);
        let is_magnitude = |one: &Guessed| {
            let values = of(&one.name);
            !is_constant(&values) && is_never_negative(&values)
        };
        let speed = |c: &Guessed| match c.key {
            "dalpha1" | "dalpha2" if !is_magnitude(c) => Some((c.key, of(&c.name))),
            "alpha1" | "alpha2" => Some((c.key, steps(&of(&c.name)))),
            _ => None,
        };
        let speeds: Vec<(&str, Vec<f64>)> = guess.columns.iter().filter_map(speed).collect();
        let mut asked = vec![];
        for one in &mut guess.columns {
            let is_signed = one.key.starts_with("dalpha") || one.key.starts_with('M');
            let Some(d) = self.beside(one).filter(|_| is_signed && is_magnitude(one)) else {
                continue;
            };
            let wheel = one.key.trim_start_matches(|c: char| !c.is_ascii_digit());
            let speed = speeds.iter().find(|(key, _)| key.ends_with(wheel)).map(|(_, v)| &v[..]);
            one.sign = Some(d.name.clone());
            match d.backward(&of(&one.name), speed.filter(|_| one.key.starts_with('M'))) {
                Some((word, why)) => {
                    one.backward = word;
                    one.evidence.push(why);
                }
                None => {
                    one.backward_open = true;
                    asked.push(format!("`{}` ({})", d.name, d.shown().join(" or ")));
                }
            }
        }
        asked.dedup();
        if !asked.is_empty() {
            guess.ask(format!(
                "which value of {} is backward? Write it as backward, in quotes",
                asked.join(" and of ")
            ));
        }
    }
}

impl Direction {
    /// Whether its name contains one of the words.
    fn has(&self, list: &[&str]) -> bool {
        self.rest.iter().any(|w| list.contains(&w.as_str()))
    }

    /// The different values of the column.
    fn shown(&self) -> Vec<String> {
        if self.words.is_empty() {
            distinct(&self.values).iter().map(f64::to_string).collect()
        } else {
            self.words.clone()
        }
    }

    /// The value for backward, if it is not a negative number, and the evidence: its words, its name, or the sign of
    /// the work of the input.
    fn backward(&self, input: &[f64], speed: Option<&[f64]>) -> Option<(Option<String>, String)> {
        if !self.words.is_empty() {
            let is = |list: &[&str], word: &String| list.contains(&word.to_lowercase().as_str());
            // `R` may be right, unless the other word is forward
            let back = self.words.iter().find(|w| is(&BACK, w) && !is(&AHEAD, w))?;
            let other = self.words.iter().find(|w| *w != back)?;
            let why = format!("direction from `{}`: `{back}` is backward", self.name);
            return is(&AHEAD, other).then(|| (Some(back.clone()), why));
        }
        let values = distinct(&self.values);
        let (low, high) = (values.first()?, values.last()?);
        if *low < 0.0 && *high > 0.0 {
            return Some((None, format!("`{}` contains its sign", self.name)));
        }
        let by = |back: &f64, why: &str| {
            Some((
                Some(format!("{back}")),
                format!("direction from `{}`: {back} is backward{why}", self.name),
            ))
        };
        if let Some(speed) = speed {
            let sign = |k: usize| if self.values[k] == *low { -1.0 } else { 1.0 };
            let rows = 0..input.len().min(speed.len()).min(self.values.len());
            let work = |k: usize| Some(input[k] * speed[k]).filter(|x| x.is_finite());
            let (mut signed, mut size) = (0.0, 0.0);
            rows.filter_map(|k| Some((k, work(k)?))).for_each(|(k, x)| {
                signed += sign(k) * x;
                size += x.abs();
            });
            if signed.abs() > DRIVES * size {
                return by(if signed > 0.0 { low } else { high }, ", as the wheel turns");
            }
        }
        match (self.has(&FORWARDS), self.has(&BACKWARDS)) {
            (true, false) => by(low, " by its name"),
            (false, true) => by(high, " by its name"),
            _ => None,
        }
    }
}

/// The steps of an angle over two rows, without wraps of its counter.
fn steps(angle: &[f64]) -> Vec<f64> {
    let step = |k: usize| angle[(k + 1).min(angle.len() - 1)] - angle[k.saturating_sub(1)];
    let all: Vec<f64> = (0..angle.len()).map(step).collect();
    let finite = all.iter().copied().filter(|x| x.is_finite()).map(f64::abs);
    let usual = quantile(finite, USUAL);
    all.into_iter().map(|x| if x.abs() > WRAP * usual { 0.0 } else { x }).collect()
}

/// Whether a column is a direction by its name.
pub(in crate::experiment) fn is_direction(column: &PreviewColumn) -> bool {
    let says = |w: &String| [&DIRECTIONS[..], &FORWARDS, &BACKWARDS].concat().contains(&w.as_str());
    named(&column.name).rest.iter().any(says)
}

fn direction(column: &PreviewColumn) -> Option<Direction> {
    if !is_direction(column) {
        return None;
    }
    let values = all_values(column);
    let mut words = all_words(column);
    words.retain(|w| !NEITHER.contains(&w.to_lowercase().as_str()));
    if values.iter().any(|v| v.is_finite()) {
        words.clear();
    }
    let name = named(&column.name);
    (words.len() == 2 || distinct(&values).len() == 2).then(|| Direction {
        name: column.name.clone(),
        side: name.side,
        rest: name.rest,
        values,
        words,
    })
}

/// The values of a column in order, without a zero between the two signs; at most the first three.
fn distinct(values: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> = vec![];
    for v in values.iter().filter(|v| v.is_finite()) {
        if out.len() < 4 && !out.contains(v) {
            out.push(*v);
        }
    }
    out.sort_by(f64::total_cmp);
    if let [low, 0.0, high] = out[..]
        && low < 0.0
        && high > 0.0
    {
        return vec![low, high];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    fn column(name: &str, of: impl Fn(f64) -> f64) -> PreviewColumn {
        let values = (0..400).map(|k| of(0.05 * f64::from(k))).collect();
        PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
    }

    fn log(dir: impl Fn(f64) -> f64 + Copy, words: &[&str]) -> Guess {
        let one = |name: &str| PreviewColumn {
            words: words.iter().map(ToString::to_string).collect(),
            ..column(name, if words.is_empty() { |t: f64| t } else { |_| f64::NAN })
        };
        let dirs = ["dirL", "dirR"]
            .map(|name| if words.is_empty() { column(name, dir) } else { one(name) });
        let mut log = vec![column("t", |t| t)];
        log.extend(["rpmL", "rpmR"].map(|name| column(name, |t| 90.0 * (t - 0.2).sin())));
        log.extend(["pwmL", "pwmR"].map(|name| column(name, |t| (200.0 * t.sin()).abs().round())));
        log.extend(dirs);
        guess(&log)
    }

    #[test]
    fn counts_of_an_encoder_show_the_direction_too() {
        let turned =
            |t: f64| (9000.0 + 2000.0 * (1.0 - (t - 0.2).cos())).rem_euclid(10_000.0).floor();
        let mut log = vec![column("t", |t| t)];
        log.extend(["encA", "encB"].map(|name| column(name, turned)));
        log.extend(["pwmA", "pwmB"].map(|name| column(name, |t| (200.0 * t.sin()).abs().round())));
        log.extend(["dirA", "dirB"].map(|name| column(name, |t| f64::from(t.sin() < 0.0))));
        let g = guess(&log);
        assert_eq!(
            (input(&g).sign.as_deref(), input(&g).backward.as_deref()),
            (Some("dirA"), Some("1"))
        );
        assert!(!g.asked().contains("backward"), "{}", g.asked());
    }

    #[test]
    fn the_recordings_of_an_experiment_show_the_direction_together() {
        use super::super::add_recording;
        let way = |forward: bool, word: &str| {
            let sign = if forward { 1.0 } else { -1.0 };
            let dir = PreviewColumn { words: vec![word.into()], ..column("dir", |_| f64::NAN) };
            vec![
                column("t", |t| t),
                column("rpm", |t| sign * 90.0 * (0.3 * t).sin().abs()),
                column("pwm", |t| 200.0 * (0.3 * t).sin().abs()),
                if word.is_empty() { column("dir", |_| f64::from(u8::from(forward))) } else { dir },
            ]
        };
        let found = |all: &[Vec<PreviewColumn>]| {
            let mut columns = all[0].clone();
            all[1..].iter().for_each(|other| add_recording(&mut columns, other));
            let g = guess(&columns);
            assert!(!g.asked().contains("backward"), "{}", g.asked());
            (input(&g).sign.clone(), input(&g).backward.clone())
        };
        let (dir, back) = (Some("dir".to_string()), Some("R".to_string()));
        let [ahead, reverse, rest] = [way(true, "F"), way(false, "R"), way(true, "N")];
        for all in [
            [ahead.clone(), reverse.clone(), rest.clone()],
            [rest.clone(), reverse.clone(), ahead.clone()],
            [reverse, rest.clone(), ahead.clone()],
        ] {
            assert_eq!(found(&all), (dir.clone(), back.clone()));
        }
        // no recording drives backward
        assert_eq!(found(&[rest, ahead]), (None, None));
        let numbers = [way(true, ""), way(false, "")];
        assert_eq!(found(&numbers), (dir, Some("0".to_string())));
    }

    fn input(g: &Guess) -> &Guessed {
        g.columns.iter().find(|c| c.key == "M1").unwrap()
    }

    #[test]
    fn magnitudes_take_the_sign_of_their_directions() {
        for (dir, back) in [(1.0, "0"), (-1.0, "1")] {
            let g = log(|t: f64| f64::from(u8::from(dir * t.sin() >= 0.0)), &[]);
            let one = input(&g);
            assert_eq!((one.sign.as_deref(), one.backward.as_deref()), (Some("dirR"), Some(back)));
        }
        let g = log(|t: f64| t.sin().signum(), &[]);
        assert_eq!(
            (input(&g).sign.as_deref(), input(&g).backward.as_deref()),
            (Some("dirR"), None)
        );
        let g = log(|t| t, &["F", "R"]);
        assert_eq!(
            (input(&g).sign.as_deref(), input(&g).backward.as_deref()),
            (Some("dirR"), Some("R"))
        );
        let g = log(|t| t, &["X", "Y"]);
        assert!(
            input(&g).backward_open && g.asked().contains("`dirR` (X or Y)"),
            "{:?}",
            g.questions
        );
    }
}
