//! Tables each of whose rows is one cell in quotes, as a spreadsheet writes a text that it did not part into columns:
//! `"15, 0.0054, 0, 1520"`; or stands in brackets, as Python prints a tuple or a list: `(15, 0.0054, 0, 1520)`.

use super::lines::{is_blank, is_comment};
use super::{PLAIN, ROWS};

/// Share of the lines that are such rows: lines of the console are between them.
const MOST: f64 = 0.9;

/// Whether the lines are such rows; the names above them may have no quotes.
pub(super) fn is_one(lines: &[&str]) -> bool {
    let held = || lines.iter().filter(|line| !is_blank(line) && !is_comment(line)).skip(1);
    let count = held().filter(|line| bare(line).is_some_and(|row| row.contains(PLAIN))).count();
    count >= ROWS && count as f64 >= MOST * held().count() as f64
}

/// The text without the quotes or brackets around rows. Lines keep their places.
pub(super) fn without(text: &str) -> String {
    let bare = |line: &str| bare(line).unwrap_or_else(|| line.to_string());
    text.lines().map(bare).collect::<Vec<_>>().join("\n")
}

/// The row in a line that is one cell in quotes, in which two quotes are one, or stands in brackets. Separators behind
/// it are those of empty cells.
fn bare(line: &str) -> Option<String> {
    let line = line.trim().trim_end_matches(PLAIN).trim_end();
    for (open, close) in [('(', ')'), ('[', ']')] {
        if let Some(row) = line.strip_prefix(open).and_then(|row| row.strip_suffix(close)) {
            return (!row.contains([open, close])).then(|| row.to_string());
        }
    }
    let row = line.strip_prefix('"')?.strip_suffix('"')?;
    let parts: Vec<&str> = row.split("\"\"").collect();
    let is_one = parts.iter().all(|part| !part.contains('"'));
    is_one.then(|| parts.join("\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_in_quotes_is_parted_and_cells_in_quotes_are_not() {
        assert_eq!(bare("\"15, 5.4e-05, 0\"").as_deref(), Some("15, 5.4e-05, 0"));
        assert_eq!(bare(" \"1;0,5;2\";;\r").as_deref(), Some("1;0,5;2"));
        assert_eq!(bare("\"1,\"\"0,5\"\",2\"").as_deref(), Some("1,\"0,5\",2"));
        assert_eq!(bare("(1.5, -2, 3)").as_deref(), Some("1.5, -2, 3"));
        assert_eq!(bare("[1.5, -2],").as_deref(), Some("1.5, -2"));
        for line in [
            "(1, 2), (3, 4)",
            "[1, [2, 3]]",
            "1,2,3",
            "\"1\",\"2\"",
            "\"1,5\";\"2,5\"",
            "\"1,5\",2",
            "\"",
        ] {
            assert_eq!(bare(line), None, "{line}");
        }
        let rows = ["t,w", "\"0,1\"", "\"1,2\"", "\"2,3\"", "\"3,4\"", "\"4,5\""];
        assert!(is_one(&rows) && !is_one(&rows[..5]));
        assert_eq!(without("t,w\n\"0,1\"\n"), "t,w\n0,1");
    }
}
