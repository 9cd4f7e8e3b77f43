//! Logs of ArduPilot as text: `FMT` lines name the columns of each kind of line, and lines of several kinds follow.
//!
//! Source: ArduPilot documentation, onboard message log.

use std::collections::HashMap;

use super::lines::Columns;
use super::record::{Pairs, collected, joined};

/// The kind of the lines that describe others, and the place of the first name in them.
const FORMAT: &str = "FMT";
const NAMES: usize = 5;

fn cells(line: &str) -> impl Iterator<Item = &str> {
    line.split(',').map(str::trim)
}

/// Whether the first line describes a kind of lines.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let first = lines.iter().find(|line| !line.trim().is_empty());
    first.is_some_and(|line| {
        let mut cells = cells(line);
        cells.next() == Some(FORMAT) && cells.count() >= NAMES
    })
}

/// A column for each name of each kind, `MOT.Volt`, and the common time in microseconds.
pub(super) fn columns(text: &str) -> Columns {
    let mut kinds: HashMap<&str, Vec<&str>> = HashMap::new();
    let mut rows: Vec<Pairs> = vec![];
    for line in text.lines() {
        let found: Vec<&str> = cells(line).collect();
        if found[0] == FORMAT {
            if let [_, _, _, kind, _, names @ ..] = &found[..] {
                kinds.insert(kind, names.to_vec());
            }
        } else if let Some(names) = kinds.get(found[0]) {
            rows.extend(row(found[0], names, &found[1..]));
        }
    }
    collected(joined(rows.into_iter()))
}

/// The numbers of a line that begins with its time; empty for a line without a time.
fn row(kind: &str, names: &[&str], cells: &[&str]) -> Option<Pairs> {
    let (time, scale) = match *names.first()? {
        "TimeUS" => (cells.first()?.parse::<f64>().ok()?, 1.0),
        "TimeMS" => (cells.first()?.parse::<f64>().ok()?, 1e3),
        _ => return None,
    };
    let numbers = names.iter().zip(cells).skip(1);
    let numbers =
        numbers.filter_map(|(name, cell)| Some((format!("{kind}.{name}"), cell.parse().ok()?)));
    Some(std::iter::once(("TimeUS".to_string(), scale * time)).chain(numbers).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_by_the_names_that_their_kind_has() {
        let head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
                    FMT, 200, 31, ENC, Qff, TimeUS,RPMr,RPMl\nFMT, 201, 31, MOT, Qf, TimeUS,Volt\nPARM, 1, A, 2\n";
        let rows: String =
            (0..4).map(|k| format!("ENC, {k}00, {k}, -{k}\nMOT, {k}05, 7.5\n")).collect();
        let text = format!("{head}{rows}");
        assert!(is_one(&text.lines().collect::<Vec<_>>()) && !is_one(&["t,a", "1,2"]));
        let found = columns(&text);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["TimeUS", "ENC.RPMr", "ENC.RPMl", "MOT.Volt"]);
        assert_eq!((found[0].1[1], found[3].1[1]), (5.0, 7.5));
    }
}
