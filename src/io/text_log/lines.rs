//! Lines of a text and their cells.

use crate::io::csv::{is_separator, split};

/// Columns with their names; NaN for cells without a number.
pub(in crate::io) type Columns = Vec<(String, Vec<f64>)>;

/// Possible column separators; those that occur in numbers and words come last.
pub(super) const SEPARATORS: [char; 5] = [';', '\t', ',', '|', ' '];

/// The generated name of a column.
pub(super) fn made_up(k: usize) -> String {
    format!("column{}", k + 1)
}

/// Whether a line is empty, a rule, or a separator of columns alone.
pub(super) fn is_blank(line: &str) -> bool {
    let line = line.trim();
    let is_rule = || line.contains("--") && line.chars().all(|c| "-|:+= ".contains(c));
    line.is_empty() || is_separator(line.as_bytes()) || is_rule()
}

/// Lines that loggers and mathematics programs write between rows of data.
pub(super) fn is_comment(line: &str) -> bool {
    ["#", "%", "//"].iter().any(|sign| line.trim_start().starts_with(sign))
}

/// The cells of a line; several spaces count as one separator.
pub(super) fn cells(line: &str, separator: char) -> Vec<String> {
    if separator == ' ' {
        // rows of a matrix of MATLAB end so
        line.trim_end().trim_end_matches(';').split_whitespace().map(Into::into).collect()
    } else if separator == '|' {
        // a table of Markdown has a bar at both ends
        let line = line.trim();
        let inner = line.strip_prefix('|').and_then(|l| l.strip_suffix('|'));
        split(inner.unwrap_or(line), separator)
    } else {
        split(line, separator)
    }
}
