//! What is reported of rows with more or fewer cells than the others.

use std::path::Path;

use super::format::Format;
use super::uneven::Cells;
use super::{IoError, csv, text_log};

/// A sentence on the rows of a text file that have more or fewer cells than the others, with the first of them. `None`
/// without such rows, for other formats, and for a file that cannot be read.
#[must_use]
pub fn uneven_rows(path: &Path) -> Option<String> {
    matches!(Format::of(path), Ok(Format::Csv)).then(|| cells_of(path).ok())??.words()
}

fn cells_of(path: &Path) -> Result<Cells, IoError> {
    match text_log::cells_of(path)? {
        Some(cells) => Ok(cells),
        None => csv::cells_of(path, &csv::layout(path)?),
    }
}
