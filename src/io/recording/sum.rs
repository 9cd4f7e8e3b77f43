//! Inputs that are the sum of columns: the torques or currents of several motors of a side.

use std::path::Path;

use super::super::{ColumnMap, IoError};
use super::header::bracketed;
use super::headers::Headers;
use super::missing::missing;

/// A column with what it stands for.
type Wanted = (&'static str, String);

/// The columns that are added to the inputs, with their inputs.
const SUMS: [(&str, &str); 2] = [("M1.plus", "M1"), ("M2.plus", "M2")];

/// The names of the columns that are added to the values of a quantity.
pub(super) fn columns_of<'a>(key: &str, wanted: &'a [Wanted]) -> impl Iterator<Item = &'a str> {
    let sum = SUMS.iter().find(|(_, input)| *input == key).map(|(sum, _)| *sum);
    wanted.iter().filter(move |(k, _)| Some(*k) == sum).map(|(_, name)| name.as_str())
}

/// The columns that are added, which must be there and in the unit of those to which they are.
///
/// # Errors
/// A column that is not there, and one whose header states another unit where the experiment file states none.
pub(super) fn wanted(
    path: &Path,
    headers: &Headers,
    columns: &ColumnMap,
    found: &[Wanted],
) -> Result<Vec<Wanted>, IoError> {
    let mut out = vec![];
    for (key, input) in SUMS {
        let column = columns.get(input);
        let first = found.iter().find(|(k, _)| *k == input).map_or("", |(_, name)| name.as_str());
        for other in &column.plus {
            if !headers.names.contains(other) {
                return Err(missing(path, headers, key, other));
            }
            let units = [bracketed(first), bracketed(other)];
            if column.unit.is_none() && units[0] != units[1] {
                let [a, b] = units.map(|u| u.map_or("no unit".into(), |u| format!("`{u}`")));
                let reason = format!(
                    "the header states {a} for `{first}` and {b} for `{other}`; add columns of one unit, and write it as \
                     unit"
                );
                return Err(IoError::Sum { column: input.into(), reason });
            }
            out.push((key, other.clone()));
        }
    }
    Ok(out)
}
