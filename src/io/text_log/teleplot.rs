//! Lines of Teleplot: `>left_rpm:1718020983000:44.1`, with the time in milliseconds, or without one.
//!
//! Source: Teleplot, README, telemetry format.

use super::lines::Columns;
use super::record::{Pairs, collected, joined};
use crate::io::csv::with_unit;

/// Number of lines from which the format is detected.
const LOOKED_AT: usize = 40;

/// Whether nearly all of the first lines are values of Teleplot.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let held = || lines.iter().filter(|line| !line.trim().is_empty()).take(LOOKED_AT);
    let found = held().filter(|line| pairs(line).is_some()).count();
    found > 1 && 10 * found >= 9 * held().count()
}

/// A column for each name; values of one time stand in one row.
pub(super) fn columns(text: &str) -> Columns {
    collected(joined(text.lines().filter_map(pairs)))
}

/// The time, if given, and the value: `>name:time:value§unit|flags`.
fn pairs(line: &str) -> Option<Pairs> {
    let line = line.trim().strip_prefix('>')?;
    let line = line.split('|').next()?;
    let (line, unit) = line.split_once('§').unwrap_or((line, ""));
    let parts: Vec<&str> = line.split(':').collect();
    let (name, time, value) = match parts[..] {
        [name, value] => (name, None, value),
        [name, time, value] => (name, Some(time.parse().ok()?), value),
        _ => return None,
    };
    let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let value: f64 = value.trim().parse().ok().filter(|_| is_name)?;
    let time = time.map(|time: f64| ("time_ms".to_string(), time));
    Some(time.into_iter().chain([(with_unit(name, unit), value)]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_one_time_stand_in_one_row() {
        let line = |k: u32| format!(">l:17{k:02}:{k}.5§rpm|g\n>r:17{k:02}:-{k}\n");
        let text: String = (0..9).map(line).collect();
        assert!(is_one(&text.lines().collect::<Vec<_>>()) && !is_one(&["> 1 2", "> 3 4"]));
        let found = columns(&text);
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!((names, found[1].1[4]), (vec!["time_ms", "l [rpm]", "r"], 4.5));
    }
}
