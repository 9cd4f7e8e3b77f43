//! Tables that are written: recordings as CSV, anything as Parquet.

use std::path::Path;

use polars::prelude::{
    Column as PolarsColumn, DataFrame, NamedFrom, ParquetWriter, PolarsError, Series,
};

use super::IoError;
use super::error::format_error;
use crate::recording::Recording;

/// A column to write.
#[derive(Clone, Debug, PartialEq)]
pub enum TableColumn {
    /// Numbers; NaN for missing.
    Number(String, Vec<f64>),
    /// Words, one per row.
    Text(String, Vec<String>),
}

/// A recording as CSV in the columns of the contract.
#[must_use]
pub fn write_csv(recording: &Recording) -> String {
    use std::fmt::Write as _;
    let mut out = String::from("t,alpha1,alpha2,dalpha1,dalpha2,M1,M2\n");
    for (k, t) in recording.t().iter().enumerate() {
        let (a, w, m) = (recording.alpha()[k], recording.omega()[k], recording.torque()[k]);
        let _ = writeln!(out, "{t},{},{},{},{},{},{}", a[0], a[1], w[0], w[1], m[0], m[1]);
    }
    out
}

/// A table as Parquet.
///
/// # Errors
/// Columns of different length.
pub fn write_parquet_table(path: &Path, columns: &[TableColumn]) -> Result<Vec<u8>, IoError> {
    let mut frame = frame(columns).map_err(|e| format_error(path, "Parquet", &e))?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .finish(&mut frame)
        .map_err(|e| format_error(path, "Parquet", &e))?;
    Ok(bytes)
}

/// A long table as Parquet, from pieces of it that are made one after the other: one row group
/// each.
///
/// # Errors
/// No piece, columns of different length, and pieces of different columns.
pub fn write_parquet_pieces(
    path: &Path,
    pieces: impl Iterator<Item = Vec<TableColumn>>,
) -> Result<Vec<u8>, IoError> {
    let wrong = |e: PolarsError| format_error(path, "Parquet", &e);
    let mut pieces = pieces.map(|columns| frame(&columns).map_err(wrong));
    let no_piece = || wrong(PolarsError::NoData("a table without rows".into()));
    let first = pieces.next().ok_or_else(no_piece)??;
    let mut bytes = Vec::new();
    let mut writer = ParquetWriter::new(&mut bytes).batched(first.schema()).map_err(wrong)?;
    for piece in std::iter::once(Ok(first)).chain(pieces) {
        writer.write_batch(&piece?).map_err(wrong)?;
    }
    writer.finish().map_err(wrong)?;
    drop(writer);
    Ok(bytes)
}

/// Columns as polars takes them.
pub(super) fn frame(columns: &[TableColumn]) -> Result<DataFrame, PolarsError> {
    let series: Vec<PolarsColumn> = columns
        .iter()
        .map(|column| match column {
            TableColumn::Number(name, values) => Series::new(name.as_str().into(), values).into(),
            TableColumn::Text(name, values) => Series::new(name.as_str().into(), values).into(),
        })
        .collect();
    let height = series.first().map_or(0, PolarsColumn::len);
    DataFrame::new(height, series)
}

#[cfg(test)]
mod tests {
    use super::super::read_parquet_table;
    use super::*;

    fn piece(numbers: &[f64], texts: &[&str]) -> Vec<TableColumn> {
        let texts = texts.iter().map(ToString::to_string).collect();
        vec![
            TableColumn::Number("x".into(), numbers.to_vec()),
            TableColumn::Text("t".into(), texts),
        ]
    }

    #[test]
    fn pieces_of_a_table_are_read_as_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let pieces = [piece(&[1.0, 2.0], &["a", ""]), piece(&[f64::INFINITY], &["c"])];
        std::fs::write(&path, write_parquet_pieces(&path, pieces.into_iter()).unwrap()).unwrap();
        let all = piece(&[1.0, 2.0, f64::INFINITY], &["a", "", "c"]);
        assert_eq!(read_parquet_table(&path).unwrap(), all);
    }

    #[test]
    fn pieces_that_do_not_fit_are_an_error() {
        let path = Path::new("t.parquet");
        assert!(write_parquet_pieces(path, std::iter::empty()).is_err());
        assert!(write_parquet_pieces(path, [piece(&[1.0], &["a", "b"])].into_iter()).is_err());
    }
}
