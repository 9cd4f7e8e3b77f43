//! A recording from a file of any format that is read.

mod direction;
mod fraction;
mod header;
mod missing;
mod sum;

use std::path::{Path, PathBuf};

use polars::prelude::{DataFrame, DataType, PolarsError};

pub(super) use self::direction::read_words;
use self::direction::{SIGNS, give_sign};
use self::fraction::in_seconds;
pub use self::fraction::part_of_second;
pub use self::header::unknown_unit;
use self::header::{bare, conversion};
use self::missing::missing;
use super::columns::CONTRACT;
use super::csv::{self, Layout};
use super::error::{format_error, shown};
use super::format::Format;
use super::signals::{Signals, frame};
use super::whole::Content;
use super::{ColumnMap, IoError, parquet, sha256, sysid, text_log};
use crate::recording::{Channels, DriveUnit, Recording};

/// Columns of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Headers {
    /// Names, in order.
    pub names: Vec<String>,
    pub(super) source: Source,
}

/// Where the values of the columns are.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    /// In the lines of a text.
    Text(Layout),
    Parquet,
    /// Already read, each with its own stamps.
    Signals(Signals),
    /// Already read.
    Columns(Vec<(String, Vec<f64>)>),
}

/// The part of a time that is written as seconds and a part of a second.
const NANOSECONDS: &str = "t.nanoseconds";
/// The columns that multiply the inputs, with their inputs.
const FACTORS: [(&str, &str); 2] = [("M1.times", "M1"), ("M2.times", "M2")];

/// A time beyond this is that of a calendar and not of the recording \[s\].
const CALENDAR: f64 = 1e6;

/// The names of the columns of a file. The ending of its name says the format: `.parquet`,
/// `.wpilog`, `.mcap`, `.mat`, `.json` (SysId), and CSV for any other.
///
/// # Errors
/// A directory, an empty file, one that cannot be read, or one whose content is of another format.
pub fn headers(path: &Path) -> Result<Headers, IoError> {
    let (path, part) = parted(path);
    headers_of(path, part)
}

fn headers_of(path: &Path, part: Option<&str>) -> Result<Headers, IoError> {
    if path.is_dir() {
        return Err(IoError::Directory { file: shown(path) });
    }
    let columns = |columns: Vec<(String, Vec<f64>)>| {
        (columns.iter().map(|(name, _)| name.clone()).collect(), Source::Columns(columns))
    };
    let (names, source) = match Format::of(path)? {
        Format::Csv => match text_log::read(path)? {
            Some(found) => columns(found),
            None => {
                let layout = csv::named_by_cells(path, csv::layout(path)?)?;
                let several = match csv::unfold(path, &layout)? {
                    Some(unfolded) => Some(unfolded),
                    None => csv::lists(path, &layout)?,
                };
                match several {
                    Some(found) => columns(found),
                    None => (layout.names.clone(), Source::Text(layout)),
                }
            }
        },
        Format::Parquet => (parquet::names(path)?, Source::Parquet),
        Format::Whole(format) => match (format.read)(path)? {
            Content::Columns(found) => columns(found),
            Content::Signals(found) => (found.names(), Source::Signals(found)),
        },
        Format::SysId => match text_log::json(path)? {
            Some(found) => columns(found),
            None => columns(sysid::read(path, part)?),
        },
    };
    Ok(Headers { names, source })
}

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
    /// SHA-256 of the file; empty for a table in memory.
    pub sha256: String,
    pub(super) path: PathBuf,
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
        Source::Signals(signals) => signals.frame(path, &names)?,
        Source::Columns(columns) => side_by_side(path, columns, &names)?,
    };
    if frame.height() == 0 {
        return Err(IoError::HeaderOnly { file: shown(path) });
    }
    let channels = channels(path, columns, &wanted, &frame, &mut Place::default())?;
    let file = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let name = part.map_or(file.clone(), |part| format!("{file}#{part}"));
    let is_text = matches!(headers.source, Source::Text(_));
    let (rows, sha256, path) = (channels.t.len(), sha256(path)?, path.to_path_buf());
    Ok(RawChannels { name, channels, sha256, path, is_text, rows })
}

/// A path and the part of the file that stands behind a `#`: `run.json#slow-forward`.
pub(super) fn parted(path: &Path) -> (&Path, Option<&str>) {
    let split = path.to_str().and_then(|text| text.rsplit_once('#'));
    match split {
        Some((file, part)) if !path.exists() && !part.contains(['/', '\\']) => {
            (Path::new(file), Some(part))
        }
        _ => (path, None),
    }
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

/// The names in the file, each once.
pub(super) fn names_of(
    path: &Path,
    headers: &Headers,
    wanted: &[(&'static str, String)],
) -> Result<Vec<String>, IoError> {
    let mut names: Vec<String> = wanted.iter().map(|(_, name)| name.clone()).collect();
    names.sort();
    names.dedup();
    if let Some(twice) = names.iter().find(|n| headers.names.iter().filter(|h| h == n).count() > 1)
    {
        return Err(IoError::RepeatedColumn { file: shown(path), column: twice.clone() });
    }
    Ok(names)
}

/// Where a block of rows stands in its file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Rows before it.
    pub(super) first: usize,
    /// Time of the first row of all, where that is the start of a calendar.
    start: f64,
    /// Time of the last row before it, where the file has steps in place of times.
    passed: f64,
}

/// The columns of those names, which must have the same length.
pub(super) fn side_by_side(
    path: &Path,
    columns: &[(String, Vec<f64>)],
    names: &[String],
) -> Result<DataFrame, IoError> {
    let wanted: Vec<_> = columns.iter().filter(|(name, _)| names.contains(name)).collect();
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

/// The columns of a block of rows, in the units of the contract.
pub(super) fn channels(
    path: &Path,
    columns: &ColumnMap,
    wanted: &[(&'static str, String)],
    frame: &DataFrame,
    place: &mut Place,
) -> Result<Channels, IoError> {
    let rows = place.first..place.first + frame.height();
    let part = wanted.iter().find(|(k, _)| *k == NANOSECONDS);
    let part = part
        .map(|(_, name)| Ok(in_seconds(name, numbers(path, frame, name, place.first)?)))
        .transpose()?;
    let mut one = |key: &str| -> Result<Option<Vec<f64>>, IoError> {
        let Some((_, name)) = wanted.iter().find(|(k, _)| *k == key) else { return Ok(None) };
        let (factor, offset) = conversion(path, columns, key, name)?;
        let mut values = numbers(path, frame, name, place.first)?;
        for other in sum::columns_of(key, wanted) {
            // another controller may write in rows of its own
            let others = held(numbers(path, frame, other, place.first)?);
            values.iter_mut().zip(others).for_each(|(x, other)| *x += other);
        }
        // a row without a time may come first
        let start = values.iter().copied().find(|t| t.is_finite()).unwrap_or_default();
        if key == "t"
            && place.first == 0
            && !columns.get("t").sum
            && (factor * start).abs() > CALENDAR
        {
            place.start = start;
        }
        if key == "t" && place.start != 0.0 {
            values.iter_mut().for_each(|t| *t -= place.start);
        }
        if (factor, offset) != (1.0, 0.0) {
            values.iter_mut().for_each(|x| *x = factor * *x + offset);
        }
        if key == "t" && columns.get("t").sum {
            for t in &mut values {
                // a row without a step is one without a time
                place.passed += if t.is_finite() { *t } else { 0.0 };
                *t = if t.is_finite() { place.passed } else { f64::NAN };
            }
        }
        if let (Some(part), "t") = (&part, key) {
            values.iter_mut().zip(part).for_each(|(t, part)| *t += part);
        }
        let factor = FACTORS.iter().find(|(_, input)| *input == key).map(|(factor, _)| factor);
        if let Some((_, name)) = wanted.iter().find(|(k, _)| Some(k) == factor) {
            let by = held(numbers(path, frame, name, place.first)?);
            values.iter_mut().zip(by).for_each(|(x, by)| *x *= by);
        }
        let sign = SIGNS.iter().find(|(_, of)| *of == key).map(|(sign, _)| sign);
        if let Some((_, name)) = wanted.iter().find(|(k, _)| Some(k) == sign) {
            let directions = numbers(path, frame, name, place.first)?;
            give_sign(path, (key, columns.get(key)), &mut values, &directions, place.first)?;
        }
        Ok(Some(values))
    };
    let pair = |a: Option<Vec<f64>>, b: Option<Vec<f64>>| {
        a.zip(b).map(|(a, b)| a.into_iter().zip(b).map(|(a, b)| [a, b]).collect::<Vec<_>>())
    };
    Ok(Channels {
        t: match columns.get("t").period {
            Some(period) => rows.map(|row| period * row as f64).collect(),
            None => one("t")?.unwrap_or_default(),
        },
        alpha: pair(one("alpha1")?, one("alpha2")?),
        omega: pair(one("dalpha1")?, one("dalpha2")?),
        torque: pair(one("M1")?, one("M2")?).unwrap_or_default(),
    })
}

/// The values with the last one in place of those that are missing: the battery is measured more slowly than
/// the wheels. Before the first there is the first.
fn held(mut values: Vec<f64>) -> Vec<f64> {
    let mut last = values.iter().copied().find(|x| x.is_finite()).unwrap_or(f64::NAN);
    for x in &mut values {
        last = if x.is_finite() { *x } else { last };
        *x = last;
    }
    values
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

/// A column of a frame, after so many rows, as numbers; a file of Parquet may hold whole numbers or text.
fn numbers(path: &Path, frame: &DataFrame, name: &str, before: usize) -> Result<Vec<f64>, IoError> {
    let wrong = |e: PolarsError| format_error(path, "table", &e);
    let broken =
        |k: usize, text: &str| IoError::not_a_number(path, before + k + 1, None, name, text);
    let column = frame.column(name).map_err(wrong)?;
    if matches!(column.dtype(), DataType::String) {
        let cells = column.str().map_err(wrong)?.iter().map(Option::unwrap_or_default);
        let cells = cells.enumerate();
        return cells
            .map(|(k, c)| csv::value(c, csv::Style::Either).ok_or_else(|| broken(k, c)))
            .collect();
    }
    let column = column.cast(&DataType::Float64).map_err(wrong)?;
    let values = column.f64().map_err(wrong)?.iter();
    Ok(values.map(|v| v.unwrap_or(f64::NAN)).collect())
}

#[cfg(test)]
mod tests;
