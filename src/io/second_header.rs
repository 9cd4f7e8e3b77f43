//! A second header within a table whose columns are in another order: below it stand other quantities in the columns of
//! the first. Two logs were written into one file.

use std::path::Path;

use super::IoError;
use super::error::shown;
use super::uneven::{Row, beginning};

/// Number of columns that exchange their places at the least.
const EXCHANGED: usize = 2;

/// Checks that a row is no header with the columns `names` in another order; one in the same order is a row without
/// values. `cells` are those of the row.
///
/// # Errors
/// A header with another order, with its row and line.
pub(super) fn check(
    path: &Path,
    names: &[String],
    row: &Row,
    cells: impl FnOnce() -> Vec<String>,
) -> Result<(), IoError> {
    // almost all rows begin with a number, and need not be parted
    let begins = row.text.trim_start().chars().next();
    if begins.is_none_or(|c| c.is_ascii_digit() || matches!(c, '-' | '+' | '.')) {
        return Ok(());
    }
    if !is_reordered(names, &cells()) {
        return Ok(());
    }
    let reason = format!(
        "row {} (line {}) is a second header, `{}`, with the columns of the first, `{}`, in another order. These are two \
         logs in one file: write the rows from there on to a file of their own, and give both as recordings",
        row.number,
        row.line,
        beginning(row.text),
        beginning(&names.join(","))
    );
    Err(IoError::Format { file: shown(path), format: "one table".into(), reason })
}

/// Whether cells name columns in places other than those of the header.
fn is_reordered(names: &[String], cells: &[String]) -> bool {
    let is_elsewhere = |(place, cell): (usize, &String)| {
        let is_here = names.get(place).is_some_and(|name| is_name(name, cell));
        !is_here && names.iter().any(|name| is_name(name, cell))
    };
    let is_number = |cell: &String| cell.parse::<f64>().is_ok();
    let exchanged = cells.iter().enumerate().filter(|cell| is_elsewhere(*cell)).count();
    exchanged >= EXCHANGED && !cells.iter().any(is_number)
}

/// Whether a cell is the name of a column, behind which its unit may stand from a line of units.
fn is_name(name: &str, cell: &str) -> bool {
    let unit = name.strip_prefix(cell).filter(|_| !cell.is_empty());
    unit.is_some_and(|unit| unit.is_empty() || unit.starts_with(" ["))
}

#[cfg(test)]
mod tests {
    use super::is_reordered;

    fn list(line: &str) -> Vec<String> {
        line.split(',').map(Into::into).collect()
    }

    #[test]
    fn a_header_in_another_order_exchanges_columns() {
        let names = list("t [s],w_l [rad/s],w_r [rad/s]");
        let is_one = |line: &str| is_reordered(&names, &list(line));
        assert!(is_one("t [s],w_r [rad/s],w_l [rad/s]") && is_one("t,w_r,w_l"));
        assert!(is_one("w_l,t,w_r,extra"));
        // the same header, words of a column, a damaged row
        for line in ["t,w_l,w_r", "t [s],w_l [rad/s],w_r [rad/s]", "w_l,1,2", "0.1,w_r,w_l", ",,"] {
            assert!(!is_one(line), "{line}");
        }
    }
}
