//! Logs of a CAN bus: frames as `candump` prints them, and frames with their signals as `cantools decode` does.

use super::lines::Columns;
use super::record::{Pairs, collected, joined};
use crate::io::csv::{quantity, with_unit};

/// Number of lines from which the format is detected.
const LOOKED_AT: usize = 40;

fn held<'a>(lines: &[&'a str]) -> Vec<&'a str> {
    lines.iter().filter(|line| !line.trim().is_empty()).take(LOOKED_AT).copied().collect()
}

/// Whether the lines are raw, undecoded frames: `(1718.25) can0 141#9C1F…`, `can0 141 [8] 9C 1F …`.
pub(super) fn is_raw(lines: &[&str]) -> bool {
    let held = held(lines);
    held.len() > 1 && held.iter().all(|line| is_frame(line) && !line.contains("::"))
}

/// Whether the frames have their signals after `::`.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let held = held(lines);
    held.len() > 1
        && held.iter().all(|line| is_frame(line))
        && held.iter().any(|line| signals(line).is_some())
}

/// A time in parentheses if need be, the name of a bus, an identifier, and bytes.
fn is_frame(line: &str) -> bool {
    let rest = behind_time(line).1;
    let mut words = rest.split_whitespace();
    let is_bus = |word: &str| word.contains("can") && word.ends_with(|c: char| c.is_ascii_digit());
    let is_hex = |word: &str| !word.is_empty() && word.bytes().all(|b| b.is_ascii_hexdigit());
    let (Some(bus), Some(id)) = (words.next(), words.next()) else { return false };
    let has_bytes = match id.split_once('#') {
        Some((id, _)) => is_hex(id),
        None => is_hex(id) && words.next().is_some_and(|w| w.starts_with('[') && w.ends_with(']')),
    };
    is_bus(bus) && has_bytes
}

fn behind_time(line: &str) -> (Option<f64>, &str) {
    let parted = line.trim_start().strip_prefix('(').and_then(|line| line.split_once(')'));
    match parted.and_then(|(time, rest)| Some((time.trim().parse().ok()?, rest))) {
        Some((time, rest)) => (Some(time), rest),
        None => (None, line),
    }
}

/// The time and the signals of a frame: `(0.01) can0 141 [8] … :: MotorRight(Speed: 44.1 rpm, Current: 0.5 A)`.
fn signals(line: &str) -> Option<Pairs> {
    let (head, decoded) = line.split_once("::")?;
    let (message, inner) = decoded.trim().split_once('(')?;
    let time = behind_time(head).0.map(|time| ("time".to_string(), time));
    let mut pairs: Pairs = time.into_iter().collect();
    for signal in inner.trim_end().trim_end_matches(')').split(',') {
        let Some((name, text)) = signal.split_once(':') else { continue };
        let number = quantity(text.trim());
        pairs.extend(
            number.map(|(x, unit)| {
                (with_unit(&format!("{}.{}", message.trim(), name.trim()), unit), x)
            }),
        );
    }
    Some(pairs)
}

/// A column for each signal of each message.
pub(super) fn columns(text: &str) -> Columns {
    collected(joined(text.lines().filter_map(signals)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_distinguished_from_their_signals() {
        for raw in
            ["(1718.25) can0 141#9C1F00", "  can0  141   [3]  9C 1F 00", " (0.1) vcan1 141 [1] 00"]
        {
            assert!(is_raw(&[raw, raw]) && !is_one(&[raw, raw]), "{raw}");
        }
        let line = |k: u32, side: &str| {
            format!(
                "(0.{k})  can0  141   [1]  00 :: Motor{side}(Speed: {k}.5 rpm, Mode: 'on', Temp: 31 degC)"
            )
        };
        let text: Vec<String> = (0..9).flat_map(|k| [line(k, "Right"), line(k, "Left")]).collect();
        let lines: Vec<&str> = text.iter().map(String::as_str).collect();
        assert!(is_one(&lines) && !is_raw(&lines));
        let found = columns(&text.join("\n"));
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names[..2], ["time", "MotorRight.Speed [rpm]"]);
        assert_eq!((found[0].1.len(), found[1].1[4]), (9, 4.5));
        assert!(!is_raw(&["t can", "1 2"]));
    }
}
