//! The time of arrival that a serial monitor or a logger writes before each line.

use crate::io::csv::{Style, duration, value};

/// Name of its column.
pub(super) const CLOCK: &str = "clock";

/// The time \[s\] before an arrow, as the serial monitors of Arduino and PlatformIO write it, and the rest of
/// the line: `14:30:00.100 -> l: 3`.
pub(super) fn before_arrow(line: &str) -> Option<(f64, &str)> {
    [" -> ", " > "].iter().find_map(|arrow| {
        let (clock, rest) = line.split_once(arrow)?;
        Some((time(clock)?, rest))
    })
}

/// The same in brackets: `[  9.0s] l: 3`, `I (12345) motors: l: 3` of ESP-IDF. Whole numbers in square brackets
/// are indices.
fn in_brackets(line: &str) -> Option<(f64, &str)> {
    let line = line.trim_start();
    let of_level = line.strip_prefix(['I', 'W', 'E', 'D', 'V']).and_then(|l| l.strip_prefix(" ("));
    if let Some((clock, rest)) = of_level.and_then(|l| l.split_once(") ")) {
        return Some((clock.parse().ok()?, rest));
    }
    let (mut clock, mut rest) = line.strip_prefix('[')?.split_once(']')?;
    // the level of a node of ROS: `[INFO] [1718020983.123] [motors]: l: 3`
    if clock.chars().all(|c| c.is_ascii_uppercase()) {
        (clock, rest) = rest.trim_start().strip_prefix('[')?.split_once(']')?;
        rest = rest.strip_prefix(':').unwrap_or(rest);
    }
    let is_time = clock.contains(['.', ':', 's']) && rest.starts_with(char::is_whitespace);
    is_time.then(|| Some((time(clock)?, rest)))?
}

/// A time before a line, and the rest of the line.
pub(super) fn marked(line: &str) -> Option<(f64, &str)> {
    before_arrow(line).or_else(|| in_brackets(line))
}

/// A whole number in square brackets before labels, which is no index there: `[1230] l: 3`.
fn counted(line: &str) -> Option<(f64, &str)> {
    let (clock, rest) = line.trim_start().strip_prefix('[')?.split_once("] ")?;
    let is_whole = !clock.trim().is_empty() && clock.trim().chars().all(|c| c.is_ascii_digit());
    (is_whole && rest.contains([':', '='])).then(|| Some((clock.trim().parse().ok()?, rest)))?
}

/// A time before a line of labels, which needs no mark: a time of day, with a date if need be, as loggers of
/// programs write it.
pub(super) fn parted(line: &str) -> Option<(f64, &str)> {
    marked(line).or_else(|| counted(line)).or_else(|| {
        let line = line.trim_start();
        let (first, behind) = line.split_once(char::is_whitespace)?;
        let dated = || {
            let (second, rest) = behind.split_once(char::is_whitespace)?;
            Some((date_time(&format!("{first} {second}"))?, rest))
        };
        dated().or_else(|| first.contains(':').then(|| Some((time(first)?, behind)))?)
    })
}

/// A date with a time in the second cell of a line, behind the word that names its kind, and the line without it:
/// `IMU;2022:06:01 13:16:42.022;x;0.1`.
pub(super) fn behind_word(line: &str) -> Option<(f64, String)> {
    let (at, separator) = line.char_indices().find(|(_, c)| [';', ',', '\t'].contains(c))?;
    let word = &line[..at];
    let (cell, rest) = line[at + 1..].split_once(separator)?;
    let is_word = word.starts_with(char::is_alphabetic) && !word.contains(char::is_whitespace);
    is_word.then(|| Some((date_time(cell.trim())?, format!("{word}{separator}{rest}"))))?
}

/// A date with a time of day: `2024-05-01 10:00:00.010`, `2022:06:01T13:16:42`.
fn date_time(text: &str) -> Option<f64> {
    let (date, clock) = text.split_once(['T', ' '])?;
    let is_date = ['-', '/', ':'].iter().any(|mark| date.matches(*mark).count() == 2);
    (is_date && clock.contains(':')).then(|| time(text))?
}

/// Whether nearly all lines have a time according to `read`.
pub(super) fn is_on(lines: &[&str], read: fn(&str) -> Option<(f64, &str)>) -> bool {
    let held = || lines.iter().filter(|line| !line.trim().is_empty());
    let stamped = held().filter(|line| read(line).is_some()).count();
    stamped > 1 && 10 * stamped >= 9 * held().count()
}

/// A time of day, a date, a number, a number with a unit of time.
fn time(text: &str) -> Option<f64> {
    let is_number = text.trim_start().starts_with(|c: char| c.is_ascii_digit());
    value(text, Style::Point).or_else(|| duration(text)).filter(|t| is_number && t.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_before_lines_are_parted_from_them() {
        for (line, expected) in [
            ("00:00:02.5 -> TELEM,1", Some((2.5, "TELEM,1"))),
            ("00:00:02.5 > l: 1", Some((2.5, "l: 1"))),
            ("[   9.5s] PID", Some((9.5, " PID"))),
            ("I (12345) motors: l: 1", Some((12345.0, "motors: l: 1"))),
            ("[INFO] [2.5] [motors]: l: 1", Some((2.5, " [motors]: l: 1"))),
            ("[INFO] [2.5]: l: 1", Some((2.5, " l: 1"))),
            ("00:00:02,5 INFO l=1", Some((2.5, "INFO l=1"))),
            ("1970-01-01 00:00:02,5 INFO l=1", Some((2.5, "INFO l=1"))),
            ("1970:01:01 00:00:02.5 l 1", Some((2.5, "l 1"))),
            ("00:00:02.5 l:1 r:2", Some((2.5, "l:1 r:2"))),
            ("[1230] l: 1", Some((1230.0, "l: 1"))),
            ("[3] 1 2", None),
            ("[0.1, 0.2] 1", None),
            ("[0.5],1,2", None),
            ("l: 1 -> r: 2", None),
            ("1: 0 2: 0", None),
        ] {
            assert_eq!(parted(line), expected, "{line}");
        }
    }
}
