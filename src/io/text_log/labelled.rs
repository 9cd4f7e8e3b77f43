//! Lines of words and numbers, as `printf` writes them: `L 44.1rpm u +80 | R 43.9rpm u +79`, `STATE:1,2,3`.

use std::collections::HashMap;

use super::Table;
use super::lines::{Columns, cells, is_blank, is_comment};
use super::record::{self, Pairs, qualified};
use super::stamp;
use crate::io::columns::is_unit;
use crate::io::csv::{Style, quantity, value, with_unit};

/// Number of lines from which the format is detected.
const LOOKED_AT: usize = 64;
/// Lines of one kind that make a recording, and the most kinds of lines.
const ROWS: usize = 5;
const KINDS: usize = 16;

/// Words of sides, in pairs.
const SIDES: [&str; 6] = ["left", "right", "l", "r", "links", "rechts"];

/// Levels of loggers.
const LEVELS: [&str; 7] = ["TRACE", "DEBUG", "INFO", "NOTICE", "WARN", "WARNING", "ERROR"];

/// Content of a line.
#[derive(Debug, PartialEq)]
pub(super) struct Line {
    /// The time before the line.
    before: Option<(String, f64)>,
    /// Words before the first label.
    head: String,
    /// Names and numbers.
    pairs: Pairs,
    /// Whether every number has a label of its own.
    is_labelled: bool,
}

/// A number with the words before it and the unit after it.
struct Item<'a> {
    words: Vec<&'a str>,
    number: f64,
    unit: &'a str,
}

/// A piece of a line between separators.
enum Piece<'a> {
    Sign,
    Word(&'a str),
    /// A number with a word directly before it, and its unit.
    Number(Option<&'a str>, f64, &'a str),
}

impl Line {
    /// The numbers of a line; `None` of one in which a number has no label, or that is none of words and numbers.
    pub(super) fn of(line: &str) -> Option<Self> {
        let dated = stamp::behind_word(line.trim());
        let (before, rest) = match &dated {
            Some((clock, rest)) => (Some((stamp::CLOCK.into(), *clock)), rest.as_str()),
            None => record::before(line.trim()),
        };
        let mut items = items(rest)?;
        if items.first().is_none_or(|item| item.words.is_empty()) {
            return None;
        }
        share_words(&mut items);
        let is_labelled = items.len() > 1 && items.iter().all(|item| !item.words.is_empty());
        let head = head(&mut items);
        Some(Self { before, head, pairs: named(&items), is_labelled })
    }

    /// The names of a line, by which kinds of lines differ.
    fn kind(&self) -> String {
        let names = self.pairs.iter().map(|(name, _)| name.as_str());
        std::iter::once(self.head.as_str()).chain(names).collect::<Vec<_>>().join("\n")
    }

    /// Names and numbers of the line, with the words before the first label where they are to be kept.
    fn record(&self, with_head: bool) -> Pairs {
        let name = |name: &String| {
            if with_head && !self.head.is_empty() {
                format!("{}.{name}", self.head)
            } else {
                name.clone()
            }
        };
        let pairs = self.pairs.iter().map(|(own, x)| (name(own), *x));
        self.before.clone().into_iter().chain(pairs).collect()
    }
}

/// Whether nearly all of the first lines after a preamble are of a few kinds of words and numbers, and are not better
/// read as a table: there is no table, or one without a header that has labels in separate columns or attached to the
/// numbers, or lines of several kinds alternate.
pub(super) fn is_one(lines: &[&str], table: Option<&Table>) -> bool {
    if table.is_some_and(|table| table.header.is_some()) || table.is_none() && is_headed(lines) {
        return false;
    }
    let held: Vec<(&str, Option<Line>)> = lines
        .iter()
        .filter(|line| !is_blank(line) && !is_comment(line))
        .map(|line| (*line, Line::of(line)))
        .skip_while(|(_, found)| found.is_none())
        .take(LOOKED_AT)
        .collect();
    let kinds: Vec<String> =
        held.iter().filter_map(|(_, found)| Some(found.as_ref()?.kind())).collect();
    let mut counts: HashMap<&str, usize> = HashMap::new();
    kinds.iter().for_each(|kind| *counts.entry(kind).or_default() += 1);
    let again: Vec<&str> = kinds.iter().map(String::as_str).filter(|k| counts[k] > 1).collect();
    let several = counts.values().filter(|count| **count > 1).count();
    if again.len() < ROWS || 10 * again.len() < 9 * held.len() || several > KINDS {
        return false;
    }
    let Some(table) = table else { return true };
    let changes = again.windows(2).filter(|w| w[0] != w[1]).count();
    let is_several = several > 1 && 2 * changes + 1 >= again.len();
    let found = || held.iter().filter_map(|(line, found)| Some((*line, found.as_ref()?)));
    let is_glued = |(line, found): (&str, &Line)| {
        let cells = cells(table.bare(line), table.separator);
        let numbers = cells.iter().filter(|c| value(c, Style::of(table.separator)).is_some());
        let count = found.pairs.len() + usize::from(found.before.is_some());
        count > numbers.count() + usize::from(table.read.is_some())
    };
    is_several || found().all(|(_, line)| line.is_labelled) || found().all(is_glued)
}

/// Whether the first line is a header of plain CSV: words alone, as many as the next line has cells.
fn is_headed(lines: &[&str]) -> bool {
    let mut held = lines.iter().filter(|line| !is_blank(line) && !line.starts_with('#'));
    let (Some(first), Some(second)) = (held.next(), held.next()) else { return false };
    super::PLAIN.iter().any(|separator| {
        let (names, row) = (cells(first, *separator), cells(second, *separator));
        let is_name = |c: &String| !c.is_empty() && value(c, Style::of(*separator)).is_none();
        names.len() > 1
            && names.len() == row.len()
            && names.iter().all(|c| is_name(c) && !c.contains(':'))
            && names.iter().all(|c| c.split_whitespace().all(|word| quantity(word).is_none()))
    })
}

/// The columns of such lines; a line whose kind does not come again is one of a console.
pub(super) fn columns<'a>(lines: impl Iterator<Item = &'a str>) -> Columns {
    let mut found: Vec<(String, Line)> =
        lines.filter_map(Line::of).map(|line| (line.kind(), line)).collect();
    timed(&mut found);
    let mut counts: HashMap<&str, usize> = HashMap::new();
    found.iter().for_each(|(kind, _)| *counts.entry(kind).or_default() += 1);
    let again = || found.iter().filter(|(kind, _)| counts[kind.as_str()] > 1).map(|(_, line)| line);
    // a tag in capitals before every line (`INFO`, `PID`) and the name of a logger after a level carry no information;
    // other words may be the quantity
    let first = again().next().map_or("", |line| &line.head);
    let is_level = first.split_whitespace().next().is_some_and(|word| LEVELS.contains(&word));
    let is_tag =
        (is_level || !first.contains(char::is_lowercase)) && again().all(|line| line.head == first);
    record::collected(record::joined(again().map(|line| line.record(!is_tag))))
}

/// Takes the first number of lines of several kinds for their time, where each kind has a word of its own before it,
/// and it never falls from line to line: `ENC 0.1 L 3 R 4`, `CUR 0.1 L 1 R 2`.
fn timed(lines: &mut [(String, Line)]) {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    lines.iter().for_each(|(kind, _)| *counts.entry(kind).or_default() += 1);
    let again: Vec<bool> = lines.iter().map(|(kind, _)| counts[kind.as_str()] > 1).collect();
    let kinds = counts.values().filter(|count| **count > 1).count();
    let tag = |line: &Line| -> Option<(String, f64)> {
        let (name, x) = line.pairs.first()?;
        let name = name.strip_suffix(".1").unwrap_or(name);
        let is_tag = line.head.is_empty() && line.before.is_none() && line.pairs.len() > 1;
        (is_tag && name.chars().all(char::is_alphanumeric)).then(|| (name.to_string(), *x))
    };
    let found: Option<Vec<(String, f64)>> = lines
        .iter()
        .zip(&again)
        .filter(|(_, again)| **again)
        .map(|((_, line), _)| tag(line))
        .collect();
    let Some(found) = found.filter(|_| kinds > 1) else { return };
    let tags: std::collections::HashSet<&str> = found.iter().map(|(tag, _)| tag.as_str()).collect();
    let rises = found.windows(2).all(|w| w[1].1 >= w[0].1)
        && found.first().map(|f| f.1) < found.last().map(|f| f.1);
    if tags.len() != kinds || !rises {
        return;
    }
    for (kind, line) in lines.iter_mut() {
        let Some((tag, time)) = tag(line) else { continue };
        line.pairs.remove(0);
        line.before = Some(("time".into(), time));
        // numbers in a row are counted from the one behind the time
        let counted = |(name, x): (String, f64)| {
            let number =
                name.strip_prefix(&format!("{tag}.")).and_then(|n| n.parse::<usize>().ok());
            (number.map_or(name, |n| (n - 1).to_string()), x)
        };
        line.pairs = std::mem::take(&mut line.pairs).into_iter().map(counted).collect();
        line.head.clone_from(&tag);
        *kind = line.kind();
    }
}

/// The numbers of a line with their words; `None` where something is neither word nor number.
fn items(text: &str) -> Option<Vec<Item<'_>>> {
    let separators = |c: char| c.is_whitespace() || ",;|:=()[]{}<>\"'".contains(c);
    let (mut items, mut words, mut minus): (Vec<Item>, Vec<&str>, bool) = (vec![], vec![], false);
    for chunk in text.split(separators).filter(|chunk| !chunk.is_empty()) {
        match piece(chunk)? {
            Piece::Sign => {}
            Piece::Word(word) => words.push(word),
            // a minus that stands apart may belong to the number
            Piece::Number(None, ..) if minus => return None,
            Piece::Number(word, number, unit) => {
                words.extend(word);
                items.push(Item { words: std::mem::take(&mut words), number, unit });
            }
        }
        minus = chunk == "-";
    }
    // a unit that stands apart: before the next label, or at the end
    for k in 1..items.len() {
        if let [unit, _, ..] = items[k].words[..]
            && items[k - 1].unit.is_empty()
            && is_unit(unit)
        {
            items[k - 1].unit = unit;
            items[k].words.remove(0);
        }
    }
    if let (Some(last), Some(unit)) = (items.last_mut(), words.first())
        && last.unit.is_empty()
        && is_unit(unit)
    {
        last.unit = unit;
    }
    Some(items)
}

/// Applies the words before the first side to the second one, and the unit after the second side to the first: `wheel
/// vel L: 3 R: 4 rad/s`.
fn share_words<'a>(items: &mut [Item<'a>]) {
    let side = |word: &str| SIDES.iter().position(|side| word.eq_ignore_ascii_case(side));
    for k in 1..items.len() {
        let (before, own) = (&items[k - 1], &items[k]);
        let ([shared @ .., first], [second]) = (&before.words[..], &own.words[..]) else {
            continue;
        };
        let (Some(a), Some(b)) = (side(first), side(second)) else { continue };
        let shared = behind_level(shared);
        // a tag in capitals before the line is none of its names
        let says = shared.last().is_some_and(|word| word.contains(char::is_lowercase));
        if !says || a == b || a / 2 != b / 2 {
            continue;
        }
        let words: Vec<&'a str> = shared.iter().copied().chain([*second]).collect();
        let unit = own.unit;
        items[k].words = words;
        if items[k - 1].unit.is_empty() {
            items[k - 1].unit = unit;
        }
    }
}

/// Words without a logger's level and name before them.
fn behind_level<'a, 'b>(words: &'b [&'a str]) -> &'b [&'a str] {
    let has_level = words.first().is_some_and(|word| LEVELS.contains(word));
    if has_level { words.get(2..).unwrap_or_default() } else { words }
}

fn piece(chunk: &str) -> Option<Piece<'_>> {
    let edge = |c: char| !c.is_alphanumeric() && !"+-._%°".contains(c);
    let chunk = chunk.trim_matches(edge);
    if !chunk.contains(char::is_alphanumeric) {
        return Some(Piece::Sign);
    }
    if let Some((number, unit)) = quantity(chunk) {
        return Some(Piece::Number(None, number, unit));
    }
    if !chunk.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    // `T+45.0`
    let is_sign = |(at, c): &(usize, char)| {
        matches!(c, '+' | '-')
            && chunk[at + 1..].starts_with(|c: char| c.is_ascii_digit() || c == '.')
    };
    match chunk.char_indices().find(is_sign) {
        Some((at, _)) => {
            quantity(&chunk[at..]).map(|(x, unit)| Piece::Number(Some(&chunk[..at]), x, unit))
        }
        None => Some(Piece::Word(chunk)),
    }
}

/// Takes the words before the first label off it: those beyond the words that other labels have.
fn head(items: &mut [Item]) -> String {
    let Some((first, others)) = items.split_first_mut() else { return String::new() };
    let most = others.iter().map(|item| item.words.len()).max().unwrap_or(0);
    if most == 0 || first.words.len() <= most {
        return String::new();
    }
    let label = first.words.split_off(first.words.len() - most);
    std::mem::replace(&mut first.words, label).join(" ")
}

/// The numbers under their words. Words that come again have the last one before that does not: `u` of
/// `L 3 u 1 R 4 u 2` is `L.u` and `R.u`; numbers in a row are counted, `STATE.1`, `STATE.2`.
fn named(items: &[Item]) -> Vec<(String, f64)> {
    let lengths: Vec<usize> = (0..items.len())
        .map(|k| 1 + items[k + 1..].iter().take_while(|item| item.words.is_empty()).count())
        .collect();
    let labels: Vec<(Vec<&str>, usize)> = items
        .iter()
        .zip(&lengths)
        .filter(|(i, _)| !i.words.is_empty())
        .map(|(i, n)| (i.words.clone(), *n))
        .collect();
    let words: Vec<&[&str]> = labels.iter().map(|(words, _)| &words[..]).collect();
    let places = labels.iter().zip(qualified(&words)).flat_map(|((_, n), name)| {
        (1..=*n).map(move |k| if *n == 1 { name.clone() } else { format!("{name}.{k}") })
    });
    places.zip(items).map(|(name, item)| (with_unit(&name, item.unit), item.number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Option<Pairs> {
        Line::of(line).map(|line| line.record(true))
    }

    fn names(line: &str) -> Vec<String> {
        read(line).unwrap().into_iter().map(|(name, _)| name).collect()
    }

    #[test]
    fn numbers_have_the_names_and_units_of_the_words_around_them() {
        let line = "[   9.5s] PID T+45.0 | L  44.1rpm u +80  R -43.9rpm u-79 | bat 8.10V";
        let pairs = [
            ("clock", 9.5),
            ("PID.T", 45.0),
            ("PID.L [rpm]", 44.1),
            ("PID.L.u", 80.0),
            ("PID.R [rpm]", -43.9),
            ("PID.R.u", -79.0),
            ("PID.bat [V]", 8.1),
        ];
        let expected: Vec<(String, f64)> = pairs.iter().map(|(n, x)| ((*n).into(), *x)).collect();
        assert_eq!(read(line), Some(expected));
        assert_eq!(names("L: rpm=3 pwm=4 | R: rpm=5 pwm=6"), ["L rpm", "L.pwm", "R rpm", "R.pwm"]);
        assert_eq!(names("wheel speed left 3, right 4"), ["wheel speed left", "wheel speed right"]);
        assert_eq!(names("left motor speed 3 right motor speed 4")[1], "right motor speed");
        assert_eq!(names("L 3.5 rpm R 4.5 rpm"), ["L [rpm]", "R [rpm]"]);
        assert_eq!(names("V 3 A 4"), ["V", "A"]);
        assert_eq!(names("a 3 a 4"), ["a", "a.2"]);
        assert_eq!(names("STATE:-1,2,3"), ["STATE.1", "STATE.2", "STATE.3"]);
        assert_eq!(names("1234 l 3 r nan"), ["column1", "l", "r"]);
        let dated = "IMU;1970:01:01 00:00:02.5;Rate;3;4;Tilt;5";
        assert_eq!(read(dated).unwrap()[0], ("clock".into(), 2.5));
        assert_eq!(names(dated), ["clock", "IMU.Rate.1", "IMU.Rate.2", "IMU.Tilt"]);
    }

    #[test]
    fn a_tag_before_all_lines_is_left_out_and_distinguishes_kinds_of_lines() {
        let of = |lines: &[&str]| -> Vec<String> {
            columns(lines.repeat(2).into_iter()).into_iter().map(|(name, _)| name).collect()
        };
        assert_eq!(of(&["INFO: l 1 r 2"]), ["l", "r"]);
        assert_eq!(of(&["INFO - robot.drive - l=1 r=2"]), ["l", "r"]);
        assert_eq!(of(&["GYRO x 1 y 2", "ACC x 3 y 4"]), ["GYRO.x", "GYRO.y", "ACC.x", "ACC.y"]);
        let lines = ["ENC 1 L 2 R 3", "CUR 1 L 4 R 5", "ENC 2 L 2 R 3", "CUR 2 L 4 R 5"];
        let found = columns(lines.into_iter());
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["time", "ENC.L", "ENC.R", "CUR.L", "CUR.R"]);
        assert_eq!((found[0].1.len(), found[3].1[1]), (2, 4.0));
        // a line of the console in between is none of them
        assert_eq!(of(&["l 1 r 2", "l 3 r 4"]), ["l", "r"]);
        let stray = ["l 1 r 2", "Error: Core 0 panic", "l 3 r 4"];
        let found = columns(stray.into_iter());
        assert_eq!((found.len(), found[0].1.len()), (2, 2));
    }

    #[test]
    fn lines_of_anything_else_are_none() {
        for line in ["", "words alone", "1,2,3", "0x40 a 3", "l 3 - 5", "a 1-2", "12:x 3"] {
            assert_eq!(read(line), None, "{line}");
        }
    }
}
