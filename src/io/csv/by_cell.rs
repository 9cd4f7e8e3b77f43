//! Plain CSV read cell by cell: tolerates spaces, blank lines, and lines that are not rows.

use std::path::Path;

use polars::prelude::DataFrame;

use super::{Layout, rows, split};
use crate::io::IoError;
use crate::io::error::shown;
use crate::io::signals::frame;
use crate::io::uneven::{Cells, STRAY, beginning};

/// The required columns as numbers. A row with more cells than names, or with text in place of a number, is a
/// row without values, up to the share [`STRAY`]; so are few rows with fewer cells than the others, by the `counted` cells
/// of all rows.
pub(super) fn read(
    path: &Path,
    layout: &Layout,
    names: &[String],
    counted: &Cells,
) -> Result<DataFrame, IoError> {
    // by place: the header may hold spaces around the names
    let place = |name: &String| layout.names.iter().position(|n| n == name).unwrap_or_default();
    let places: Vec<usize> = names.iter().map(place).collect();
    let mut values: Vec<Vec<f64>> = vec![vec![]; names.len()];
    let (mut count, mut stray, mut first) = (0_u32, 0_u32, None);
    let left_out = counted.left_out();
    for (row, line, text) in rows(path)? {
        let cells = split(&String::from_utf8_lossy(&text), char::from(layout.separator));
        if cells.iter().all(String::is_empty) && !text.contains(&b'"') {
            continue; // a blank line
        }
        count += 1;
        if left_out.contains(&row) && cells.len() < layout.names.len() {
            values.iter_mut().for_each(|column| column.push(f64::NAN));
            continue;
        }
        let parsed = parsed(path, layout, names, &places, &cells, (row, line));
        let numbers = parsed.unwrap_or_else(|error| {
            stray += 1;
            first.get_or_insert(error);
            vec![f64::NAN; names.len()]
        });
        values.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
    }
    match first {
        Some(error) if f64::from(stray) > STRAY * f64::from(count) => {
            Err(error.of_most(2 * stray > count))
        }
        _ => frame(path, names.iter().map(String::as_str).zip(values)),
    }
}

/// The required cells of a row; row and line numbers are for error messages.
fn parsed(
    path: &Path,
    layout: &Layout,
    names: &[String],
    places: &[usize],
    cells: &[String],
    (row, line): (usize, usize),
) -> Result<Vec<f64>, IoError> {
    let expected = layout.names.len();
    // empty cells at the end do not count
    let found = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |k| k + 1);
    if found > expected {
        let (file, text) = (shown(path), beginning(&cells.join(&separator(layout))));
        let (has_header, most) = (true, false);
        return Err(IoError::Ragged { file, row, line, found, expected, text, has_header, most });
    }
    let number = |(place, name): (&usize, &String)| {
        let cell = cells.get(*place).map_or("", String::as_str);
        let wrong = || IoError::not_a_number(path, row, Some(line), name, cell);
        layout.value(*place, cell).ok_or_else(wrong)
    };
    places.iter().zip(names).map(number).collect()
}

fn separator(layout: &Layout) -> String {
    char::from(layout.separator).to_string()
}
