//! A recording from a file of any format that is read.

mod channels;
mod direction;
mod fraction;
mod header;
mod headers;
mod missing;
mod sum;

use std::path::{Path, PathBuf};

use polars::prelude::DataFrame;

use self::channels::{FACTORS, NANOSECONDS};
pub(super) use self::channels::{Place, channels};
use self::direction::SIGNS;
pub(super) use self::direction::read_words;
pub use self::fraction::part_of_second;
use self::header::bare;
pub use self::header::{opening, unknown_unit, without_port};
use self::headers::headers_of;
pub use self::headers::{Headers, headers};
pub(super) use self::headers::{Source, are_same, parted};
use self::missing::missing;
use super::columns::CONTRACT;
use super::csv;
use super::error::shown;
use super::format::Format;
use super::signals::frame;
use super::{ColumnMap, IoError, parquet, sha256, sysid, text_log};
use crate::recording::{Channels, DriveUnit, Factor, Recording};

/// Reads a recording: the columns of the contract under the names and units of `columns`; others
/// are passed over. A time that counts from the start of a calendar is counted from the first row
/// instead. Returns the recording with the SHA-256 of its file.
///
/// # Errors
/// Everything in [`IoError`], with file, row and column.
pub fn read_recording(
    path: &Path,
    columns: &ColumnMap,
    drive_unit: DriveUnit,
) -> Result<(Recording, String), IoError> {
    let raw = read_channels(path, columns)?;
    let sha256 = raw.sha256.clone();
    Ok((raw.recording(drive_unit)?, sha256))
}

/// The columns of a file as they are, in the units of the contract.
#[derive(Clone, Debug)]
pub struct RawChannels {
    /// Name of the recording: that of the file, and of its part where it has several.
    pub name: String,
    /// The columns; a cell without a number is NaN.
    pub channels: Channels,
    /// The columns by which the inputs are multiplied.
    pub factors: [Option<Factor>; 2],
    /// SHA-256 of the file; empty for a table in memory.
    pub sha256: String,
    pub(super) path: PathBuf,
    /// Name of the column of the time, and its unit \[s\].
    pub(super) time: (String, f64),
    pub(super) is_text: bool,
    /// Rows of the file.
    pub(super) rows: usize,
}

impl RawChannels {
    /// The recording of these columns.
    ///
    /// # Errors
    /// What [`Recording::new`] refuses; with the line of its row, unless rows were left out.
    pub fn recording(self, drive_unit: DriveUnit) -> Result<Recording, IoError> {
        let same = self.channels.t.len() == self.rows;
        Recording::new(self.name, self.channels, drive_unit).map_err(|error| {
            let row = error.row().filter(|_| self.is_text && same);
            let error = error.of_time(&self.time.0, self.time.1);
            IoError::Recording { line: row.and_then(|r| csv::line_of(&self.path, r)), error }
        })
    }
}

/// Reads the columns of a recording as [`read_recording`] does, and does not check them.
///
/// # Errors
/// Everything in [`IoError`] but what is wrong with the values.
pub fn read_channels(path: &Path, columns: &ColumnMap) -> Result<RawChannels, IoError> {
    let (path, part) = parted(path);
    let mut headers = headers_of(path, part)?;
    read_words(&mut headers, columns);
    let wanted = wanted(path, &headers, columns)?;
    let names = names_of(path, &headers, &wanted)?;
    let frame = match &headers.source {
        Source::Text(layout) => csv::read(path, layout, &names)?,
        Source::Parquet => parquet::read(path, names)?,
        Source::Signals(signals) => signals.frame(path, &names, |name| is_sensor(name, &wanted))?,
        Source::Columns(columns) => side_by_side(path, columns, &names)?,
    };
    if frame.height() == 0 {
        return Err(IoError::HeaderOnly { file: shown(path) });
    }
    let (channels, factors) = channels(path, columns, &wanted, &frame, &mut Place::default())?;
    let file = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let name = part.map_or(file.clone(), |part| format!("{file}#{part}"));
    let is_text = matches!(headers.source, Source::Text(_));
    let (rows, sha256, path) = (channels.t.len(), sha256(path)?, path.to_path_buf());
    let time = time_of(&wanted, columns);
    Ok(RawChannels { name, channels, factors, sha256, path, time, is_text, rows })
}

/// Whether a column is the angle or the speed of a wheel.
fn is_sensor(column: &str, wanted: &[(&'static str, String)]) -> bool {
    let sensors = ["alpha1", "alpha2", "dalpha1", "dalpha2"];
    wanted.iter().any(|(key, name)| name == column && sensors.contains(key))
}

/// Name of the column of the time, and its unit \[s\]; the standard ones without such a column.
pub(super) fn time_of(wanted: &[(&'static str, String)], columns: &ColumnMap) -> (String, f64) {
    let name = wanted.iter().find(|(key, _)| *key == "t").map_or("t", |(_, name)| name);
    let unit = columns.conversion("t", columns.get("t"), self::header::bracketed(name));
    (name.to_owned(), unit.map_or(1.0, |(factor, _)| factor))
}

/// The parts of a file that are recordings of their own, by name: the tests of a SysId file. None of
/// any other.
///
/// # Errors
/// A file that cannot be read.
pub fn parts(path: &Path) -> Result<Vec<String>, IoError> {
    match Format::of(path)? {
        Format::SysId if text_log::json(path)?.is_none() => sysid::tests(path),
        _ => Ok(vec![]),
    }
}

/// The radius of the wheels \[m\] that a file states (SysId: by the way of a turn), with the text of its statement.
#[must_use]
pub fn stated_radius(path: &Path) -> Option<(f64, String)> {
    let (path, _) = parted(path);
    matches!(Format::of(path), Ok(Format::SysId)).then(|| sysid::radius(path))?
}

/// The names in the file, each once.
pub(super) fn names_of(
    path: &Path,
    headers: &Headers,
    wanted: &[(&'static str, String)],
) -> Result<Vec<String>, IoError> {
    let mut names: Vec<String> = wanted.iter().map(|(_, name)| name.clone()).collect();
    names.sort();
    names.dedup();
    let is_repeated = |name: &String| headers.names.iter().filter(|h| *h == name).count() > 1;
    let differ = |name: &&String| is_repeated(name) && !headers.are_copies(path, name);
    if let Some(twice) = names.iter().find(differ) {
        return Err(IoError::RepeatedColumn { file: shown(path), column: twice.clone() });
    }
    Ok(names)
}

/// The columns of those names, which must have the same length.
pub(super) fn side_by_side(
    path: &Path,
    columns: &[(String, Vec<f64>)],
    names: &[String],
) -> Result<DataFrame, IoError> {
    let mut wanted: Vec<_> = columns.iter().filter(|(name, _)| names.contains(name)).collect();
    // copies are one column
    let mut seen = std::collections::BTreeSet::new();
    wanted.retain(|(name, _)| seen.insert(name));
    let unequal = wanted.iter().find(|(_, v)| v.len() != wanted[0].1.len());
    if let Some((column, values)) = unequal {
        return Err(IoError::Unequal {
            file: shown(path),
            column: column.clone(),
            length: values.len(),
            other: wanted[0].0.clone(),
            others: wanted[0].1.len(),
        });
    }
    frame(path, wanted.into_iter().map(|(name, values)| (name.as_str(), values.clone())))
}

/// Contract column and its name in the file, for those that are there; t and the inputs must be,
/// and of angles and speeds at least one pair.
pub(super) fn wanted(
    path: &Path,
    headers: &Headers,
    columns: &ColumnMap,
) -> Result<Vec<(&'static str, String)>, IoError> {
    let mut out = Vec::new();
    for key in CONTRACT {
        let column = columns.get(key);
        if column.period.is_some() {
            continue;
        }
        let exact = headers.names.iter().find(|n| **n == column.name);
        let found = exact.or_else(|| headers.names.iter().find(|n| bare(n) == column.name));
        let needed = column.named || matches!(key, "t" | "M1" | "M2");
        match found {
            Some(name) => out.push((key, name.clone())),
            None if needed => return Err(missing(path, headers, key, &column.name)),
            None => {}
        }
    }
    if let Some(name) = &columns.get("t").nanoseconds {
        if !headers.names.contains(name) {
            return Err(missing(path, headers, "t.nanoseconds", name));
        }
        out.push((NANOSECONDS, name.clone()));
    }
    for (key, input) in FACTORS {
        let Some(name) = &columns.get(input).times else { continue };
        if !headers.names.contains(name) {
            return Err(missing(path, headers, key, name));
        }
        out.push((key, name.clone()));
    }
    out.extend(sum::wanted(path, headers, columns, &out)?);
    for (key, of) in SIGNS {
        let Some(name) = &columns.get(of).sign else { continue };
        if !headers.names.contains(name) {
            return Err(missing(path, headers, key, name));
        }
        out.push((key, name.clone()));
    }
    let has = |key: &str| out.iter().any(|(k, _)| *k == key);
    let angles = has("alpha1") && has("alpha2");
    let speeds = has("dalpha1") && has("dalpha2");
    if !angles && !speeds {
        let key = if has("dalpha1") { "dalpha2" } else { "dalpha1" };
        return Err(missing(path, headers, key, &columns.get(key).name));
    }
    // half a pair is of no use
    out.retain(|(k, _)| !k.starts_with("alpha") || angles);
    out.retain(|(k, _)| !k.starts_with("dalpha") || speeds);
    Ok(out)
}

#[cfg(test)]
mod tests;
