//! The table of all cells, as `estimates.parquet`.
//!
//! One row per cell, method and parameter, sorted by cell, then in the order of methods and
//! parameters. Columns, in this order:
//!
//! | column | type | meaning |
//! |---|---|---|
//! | `cell` | number | number of the combination from 0, the last key varying fastest |
//! | one per key of `[grid]`, by its name there | number or text | the combination |
//! | `method`, `parameter`, `unit` | text | `parameter` is empty for methods without parameters and for failures |
//! | `value`, `std_error`, `ci95_low`, `ci95_high` | number | estimate; NaN where there is none |
//! | `truth` | number | true value of synthetic data, else NaN |
//! | `ise_train` | number | quality index summed over the training recordings [rad^2/s] |
//! | `ise_validation` | number | the same on the validation recordings, if there are any [rad^2/s] |
//! | `window_rms_validation` | number | 2 s simulation error on the same recordings [rad/s] |
//! | `floor` | number | 2 s simulation error of the noise alone on the same recordings [rad/s] |
//! | `status` | text | `converged`, `iteration_limit`, `stalled` or `failed` |
//! | `reason` | text | why it failed |
//! | `verdict`, `found` | text | of the diagnosis, where one is asked for |
//! | `seconds` | number | wall time of the method \[s\]; the only column that differs between two runs of the same file |

use std::path::Path;

use super::cell::{Cell, Row};
use crate::experiment::combinations::GridPlan;
use crate::experiment::file::GridAxis;
use crate::io::{IoError, TableColumn, write_parquet_pieces};

/// Names that are not available for the column of a grid key.
const TAKEN: [&str; 1] = ["truth"];

/// The column name of an axis.
pub(super) fn column_name(axis: &GridAxis) -> String {
    if TAKEN.contains(&axis.name.as_str()) { axis.key.clone() } else { axis.name.clone() }
}

/// Number of cells converted to columns at a time: all at once would double the memory of a large grid.
const PIECE: usize = 10_000;

/// The table of cells, which are sorted, as Parquet.
///
/// # Errors
/// If the table cannot be made.
pub(super) fn parquet(grid: &GridPlan, cells: &[Cell]) -> Result<Vec<u8>, IoError> {
    let diagnosed = cells.iter().any(|cell| cell.verdict.is_some());
    let pieces = cells.chunks(PIECE).map(|piece| columns(grid, piece, diagnosed));
    write_parquet_pieces(Path::new("estimates.parquet"), pieces)
}

/// A group of cells as columns.
fn columns(grid: &GridPlan, cells: &[Cell], diagnosed: bool) -> Vec<TableColumn> {
    let rows: Vec<(&Cell, &Row)> =
        cells.iter().flat_map(|cell| cell.rows.iter().map(move |row| (cell, row))).collect();
    // one NaN for all: NaN from arithmetic has a sign that a journal does not keep
    let plain = |x: f64| if x.is_nan() { f64::NAN } else { x };
    let number = |name: &str, value: &dyn Fn(&Row) -> f64| {
        TableColumn::Number(name.into(), rows.iter().map(|(_, row)| plain(value(row))).collect())
    };
    let text = |name: &str, value: &dyn for<'a> Fn(&'a Cell, &'a Row) -> &'a str| {
        let texts = rows.iter().map(|(cell, row)| value(cell, row).to_string());
        TableColumn::Text(name.into(), texts.collect())
    };
    let count = rows.iter().map(|(cell, _)| cell.cell as f64).collect();
    let mut out = vec![TableColumn::Number("cell".into(), count)];
    for (k, axis) in grid.axes.iter().enumerate() {
        let places = rows.iter().map(|(cell, _)| grid.places(cell.cell)[k]);
        out.push(match axis.numbers() {
            Some(values) => {
                TableColumn::Number(column_name(axis), places.map(|p| values[p]).collect())
            }
            None => TableColumn::Text(column_name(axis), places.map(|p| axis.text(p)).collect()),
        });
    }
    out.extend([
        text("method", &|_, row| &row.method),
        text("parameter", &|_, row| &row.parameter),
        text("unit", &|_, row| &row.unit),
        number("value", &|row| row.value.0),
        number("std_error", &|row| row.std_error.0),
        number("ci95_low", &|row| row.low.0),
        number("ci95_high", &|row| row.high.0),
        number("truth", &|row| row.truth.0),
        number("ise_train", &|row| row.ise_train.0),
        number("ise_validation", &|row| row.ise_validation.0),
        number("window_rms_validation", &|row| row.window_rms.0),
        number("floor", &|row| row.floor.0),
        text("status", &|_, row| row.status.name()),
        text("reason", &|_, row| &row.reason),
    ]);
    if diagnosed {
        let stated =
            |cell: &Cell| cell.verdict.as_ref().map_or_else(String::new, |v| v.text().into());
        let texts = rows.iter().map(|(cell, _)| stated(cell));
        out.push(TableColumn::Text("verdict".into(), texts.collect()));
        out.push(text("found", &|cell, _| &cell.found));
    }
    out.push(number("seconds", &|row| row.seconds.0));
    out
}
