//! Preview of all columns of a file.

use std::path::Path;

use super::error::{format_error, shown};
use super::recording::{Source, are_same, headers};
use super::{IoError, csv, parquet};

/// A column with its values; NaN for cells that are not numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PreviewColumn {
    /// Name in the file.
    pub name: String,
    /// Values in order; a signal with separate time stamps has its own number of values.
    pub values: Vec<f64>,
    /// The words of a column that holds a few and no numbers.
    pub words: Vec<String>,
    /// The first cells of a text column without numbers that contain something; empty ones if no cell does.
    pub texts: Vec<String>,
    /// Whether it holds one value in this recording and another one in a recording beside it.
    pub varies: bool,
    /// Values and words in the other recordings of the experiment, one after the other.
    pub elsewhere: Vec<f64>,
    /// See `elsewhere`.
    pub words_elsewhere: Vec<String>,
}

/// All columns of a file with their values.
///
/// # Errors
/// A file that cannot be read, and a text without any number in its columns.
pub fn preview(path: &Path) -> Result<Vec<PreviewColumn>, IoError> {
    Ok(without_copies(all(path)?))
}

/// Leaves out columns that have the name and the values of an earlier one: the time beside every signal.
fn without_copies(columns: Vec<PreviewColumn>) -> Vec<PreviewColumn> {
    let mut out: Vec<PreviewColumn> = vec![];
    for column in columns {
        let is_copy =
            |c: &PreviewColumn| c.name == column.name && are_same(&c.values, &column.values);
        if !out.iter().any(is_copy) {
            out.push(column);
        }
    }
    out
}

fn all(path: &Path) -> Result<Vec<PreviewColumn>, IoError> {
    let headers = headers(path)?;
    let column = |(name, values): (String, Vec<f64>)| PreviewColumn {
        name,
        values,
        ..PreviewColumn::default()
    };
    let of_text = |c: csv::TextColumn| PreviewColumn {
        name: c.name,
        values: c.values,
        words: c.words,
        texts: c.texts,
        ..PreviewColumn::default()
    };
    Ok(match headers.source {
        Source::Text(layout) => {
            let columns: Vec<_> = csv::all(path, &layout)?.into_iter().map(of_text).collect();
            if columns.iter().all(|c| c.values.is_empty()) {
                return Err(IoError::HeaderOnly { file: shown(path) });
            }
            if columns.iter().flat_map(|c| &c.values).all(|x| x.is_nan()) {
                return Err(csv::not_understood(path));
            }
            columns
        }
        Source::Columns(columns) => columns.into_iter().map(column).collect(),
        Source::Signals(signals) => signals.all().into_iter().map(column).collect(),
        Source::Parquet => {
            // columns of numbers alone: text is no signal
            let read = |name: &String| {
                let frame = parquet::read(path, vec![name.clone()])?;
                let wrong = |e| format_error(path, "table", &e);
                let found = frame.column(name).map_err(wrong)?;
                let cast = found.cast(&polars::prelude::DataType::Float64).map_err(wrong)?;
                let values = cast.f64().map_err(wrong)?.iter().map(|v| v.unwrap_or(f64::NAN));
                Ok(column((name.clone(), values.collect())))
            };
            let read: Vec<Result<_, IoError>> = headers.names.iter().map(read).collect();
            read.into_iter().filter_map(Result::ok).collect()
        }
    })
}
