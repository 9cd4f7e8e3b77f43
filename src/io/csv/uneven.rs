//! The number of cells in the rows of a plain table.

use std::path::Path;

use super::{Layout, rows, split};
use crate::io::IoError;
use crate::io::second_header;
use crate::io::uneven::{Cells, Row};

/// Number of rows that are compared: of longer files, which are read block by block, the first ones.
const MOST_ROWS: usize = 1_000_000;

/// The cells of every row. Rows whose lines are parted by a line break in quotes are not compared.
///
/// # Errors
/// A file that cannot be read, and a second header with another order of the columns.
pub(in crate::io) fn cells_of(path: &Path, layout: &Layout) -> Result<Cells, IoError> {
    let separator = char::from(layout.separator);
    let none = || Cells::new(layout.names.len(), true);
    // a separator at the end of the header names nothing, and rows may lack it
    let named = layout.names.iter().rposition(|name| !name.is_empty()).map_or(0, |k| k + 1);
    let mut out = none();
    for (number, line, bytes) in rows(path)?.take(MOST_ROWS) {
        let text = String::from_utf8_lossy(&bytes);
        let row = Row { number, line, text: &text };
        second_header::check(path, &layout.names, &row, || split(&text, separator))?;
        if text.matches('"').count() % 2 == 1 {
            return Ok(none());
        }
        let (cells, used) = if text.contains('"') {
            let cells = split(&text, separator);
            (cells.len(), used(cells.iter().map(String::as_str)))
        } else {
            (text.split(separator).count(), used(text.split(separator)))
        };
        // a blank line
        if used > 0 || text.contains('"') {
            let cells = if cells >= named { layout.names.len() } else { cells };
            out.see(&row, cells, used);
        }
    }
    Ok(out)
}

/// Number of cells up to the last one that contains something.
pub(super) fn used<'a>(cells: impl Iterator<Item = &'a str>) -> usize {
    let held = cells.enumerate().filter(|(_, cell)| !cell.trim().is_empty());
    held.last().map_or(0, |(k, _)| k + 1)
}
