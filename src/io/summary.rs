//! Grouping rows and writing tables as CSV, by polars behind plain types.

use std::path::Path;

use polars::prelude::{Column, CsvWriter, PolarsError, SerWriter};

use super::table::frame;
use super::{IoError, TableColumn};

fn wrong(e: &PolarsError) -> IoError {
    let reason = e.to_string();
    IoError::Format { file: "summary".into(), format: "table".into(), reason }
}

/// The rows that are equal in all columns, groups in the order of their first row.
///
/// # Errors
/// Columns of different length.
pub fn group_rows(columns: &[TableColumn]) -> Result<Vec<Vec<usize>>, IoError> {
    let frame = frame(columns).map_err(|e| wrong(&e))?;
    if frame.height() == 0 || columns.is_empty() {
        return Ok(vec![]);
    }
    let names: Vec<String> = frame.get_column_names().iter().map(ToString::to_string).collect();
    let grouped = frame.group_by_stable(names).map_err(|e| wrong(&e))?;
    let groups = grouped.get_groups().iter().map(|group| {
        use polars::prelude::GroupsIndicator;
        match group {
            GroupsIndicator::Idx((_, rows)) => rows.iter().map(|r| *r as usize).collect(),
            GroupsIndicator::Slice([first, count]) => {
                (first as usize..(first + count) as usize).collect()
            }
        }
    });
    Ok(groups.collect())
}

/// A table as CSV; numbers that are missing are written `NaN`.
///
/// # Errors
/// Columns of different length.
pub fn write_csv_table(columns: &[TableColumn]) -> Result<Vec<u8>, IoError> {
    let mut bytes = Vec::new();
    let mut frame = frame(columns).map_err(|e| wrong(&e))?;
    CsvWriter::new(&mut bytes).finish(&mut frame).map_err(|e| wrong(&e))?;
    Ok(bytes)
}

/// The columns of a Parquet table, numbers and text.
///
/// # Errors
/// A file that is no Parquet table of numbers and text.
pub fn read_parquet_table(path: &Path) -> Result<Vec<TableColumn>, IoError> {
    use polars::prelude::{DataType, ParquetReader, SerReader};
    let file = std::fs::File::open(path).map_err(|e| IoError::system(path, &e))?;
    let frame = ParquetReader::new(file).finish().map_err(|e| wrong(&e))?;
    let column = |column: &Column| -> Result<TableColumn, PolarsError> {
        let name = column.name().to_string();
        if matches!(column.dtype(), DataType::String) {
            let values = column.str()?.iter().map(|t| t.unwrap_or_default().to_string());
            return Ok(TableColumn::Text(name, values.collect()));
        }
        let numbers = column.cast(&DataType::Float64)?;
        let values = numbers.f64()?.iter().map(|v| v.unwrap_or(f64::NAN)).collect();
        Ok(TableColumn::Number(name, values))
    };
    frame.columns().iter().map(|c| column(c).map_err(|e| wrong(&e))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(name: &str, values: &[&str]) -> TableColumn {
        TableColumn::Text(name.into(), values.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn rows_are_grouped_in_the_order_of_their_first_appearance() {
        let columns = [text("a", &["y", "x", "y", "y"]), text("b", &["1", "1", "2", "1"])];
        assert_eq!(group_rows(&columns).unwrap(), [vec![0, 3], vec![1], vec![2]]);
        assert!(group_rows(&[text("a", &[])]).unwrap().is_empty());
    }

    #[test]
    fn csv_quotes_what_holds_a_comma() {
        let columns = [text("a", &["p, q"]), TableColumn::Number("b".into(), vec![0.5])];
        assert_eq!(write_csv_table(&columns).unwrap(), b"a,b\n\"p, q\",0.5\n");
    }
}
