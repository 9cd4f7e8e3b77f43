//! Recordings from tables in memory.

use std::path::Path;

use super::error::shown;
use super::recording::{
    Headers, Place, RawChannels, Source, channels, names_of, side_by_side, time_of, wanted,
};
use super::{ColumnMap, IoError};

/// Which columns of a table in memory with these `names` are read.
///
/// # Errors
/// A missing or repeated column.
pub fn needed_columns(
    table: &str,
    names: &[String],
    columns: &ColumnMap,
) -> Result<Vec<String>, IoError> {
    let headers = Headers { names: names.to_vec(), source: Source::Columns(vec![]) };
    let path = Path::new(table);
    names_of(path, &headers, &wanted(path, &headers, columns)?)
}

/// The channels of a table in memory, in the units of the contract.
///
/// # Errors
/// Missing columns, columns of different length, a table without rows.
pub fn table_channels(
    table: &str,
    values: &[(String, Vec<f64>)],
    columns: &ColumnMap,
) -> Result<RawChannels, IoError> {
    let names: Vec<String> = values.iter().map(|(name, _)| name.clone()).collect();
    let path = Path::new(table);
    let headers = Headers { names, source: Source::Columns(vec![]) };
    let wanted = wanted(path, &headers, columns)?;
    let names = names_of(path, &headers, &wanted)?;
    let frame = side_by_side(path, values, &names)?;
    if frame.height() == 0 {
        return Err(IoError::HeaderOnly { file: shown(path) });
    }
    let (channels, factors) = channels(path, columns, &wanted, &frame, &mut Place::default())?;
    let (rows, name, path) = (channels.t.len(), table.to_owned(), path.to_path_buf());
    let (time, sha256) = (time_of(&wanted, columns), String::new());
    Ok(RawChannels { name, channels, factors, sha256, path, time, is_text: false, rows })
}
