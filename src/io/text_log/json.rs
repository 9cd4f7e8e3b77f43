//! Files of JSON.

use std::path::Path;

use super::decode::decoded;
use super::lines::Columns;
use super::{IoError, keyed, record};
use crate::io::json::parsed;

/// The columns of a JSON file that holds columns or records, or one record in every line; `None` for any other,
/// whose reader says what is wrong with it.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::io) fn json(path: &Path) -> Result<Option<Columns>, IoError> {
    let bytes = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let (text, _) = decoded(&bytes);
    if let Ok(value) = parsed(&text) {
        return Ok(record::of_json(&value));
    }
    let lines: Vec<&str> = text.lines().collect();
    Ok(record::is_one(&lines).then(|| keyed::columns(text.lines())))
}
