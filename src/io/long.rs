//! Recordings too long to be held, read block by block.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use polars::prelude::DataFrame;

use super::error::shown;
use super::recording::{Headers, Place, Source, channels, headers, names_of, read_words, wanted};
use super::{ColumnMap, IoError, csv, parquet, sha256};
use crate::recording::{
    Channels, DriveUnit, LongRecording, Recording, RecordingError, Rows, RowsError, Survey,
};

/// Rows of a text that are read at a time.
const BLOCK: usize = 1 << 17;
/// Rows of a Parquet file that are read at a time: a group of rows as most programs write it, which is unpacked as a
/// whole.
const GROUP: usize = 1 << 18;

/// A recording of more than `hold_rows` rows: windows of it to hold, a way to read all rows again,
/// and the SHA-256 of the file. `None` if the file has fewer rows, or is of a format that is only
/// read as a whole; CSV and Parquet are read block by block.
///
/// # Errors
/// Everything in [`IoError`], as [`super::read_recording`].
pub fn read_long_recording(
    path: &Path,
    columns: &ColumnMap,
    drive_unit: DriveUnit,
    hold_rows: usize,
) -> Result<Option<(Recording, LongRecording, String)>, IoError> {
    if path.is_dir() || !has_more_rows(path, hold_rows)? {
        return Ok(None);
    }
    let mut headers = headers(path)?;
    read_words(&mut headers, columns);
    // what is read as a whole is held as a whole
    if !matches!(headers.source, Source::Text(_) | Source::Parquet) {
        return Ok(None);
    }
    let wanted = wanted(path, &headers, columns)?;
    let names = names_of(path, &headers, &wanted)?;
    let (path, columns) = (path.to_path_buf(), columns.clone());
    let file = LongFile { path, columns, headers, wanted, names, left_out: Mutex::default() };
    let name = file.path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let mut survey = Survey::new(name, drive_unit);
    let wrong = |error: RecordingError| file.in_recording(error);
    for block in file.read()? {
        survey.add(&block?).map_err(wrong)?;
    }
    let sum = sha256(&file.path)?;
    // windows of rows that were checked: what is wrong now has no line
    let done = survey.finish(Box::new(file));
    let (excerpt, long) = done.map_err(|error| IoError::Recording { error, line: None })?;
    Ok(Some((excerpt, long, sum)))
}

fn has_more_rows(path: &Path, limit: usize) -> Result<bool, IoError> {
    if super::recording::parted(path).1.is_some() {
        return Ok(false);
    }
    match super::format::Format::of(path)? {
        super::format::Format::Csv => csv::has_more_lines(path, limit),
        super::format::Format::Parquet => Ok(parquet::rows(path)? > limit),
        _ => Ok(false),
    }
}

/// A file with the columns to be read.
struct LongFile {
    path: PathBuf,
    columns: ColumnMap,
    headers: Headers,
    wanted: Vec<(&'static str, String)>,
    names: Vec<String>,
    /// Rows whose time does not exceed that before, and the first of them, of the last pass.
    left_out: Mutex<(usize, usize)>,
}

type Block = Result<Channels, IoError>;

impl LongFile {
    fn read(&self) -> Result<Box<dyn Iterator<Item = Block> + '_>, IoError> {
        let mut next: Box<dyn FnMut(usize) -> Result<DataFrame, IoError> + '_> =
            match &self.headers.source {
                Source::Text(layout) => {
                    let mut blocks = csv::Blocks::new(&self.path, layout, &self.names)?;
                    Box::new(move |_| blocks.next_rows(BLOCK))
                }
                _ => {
                    parquet::check(&self.path, &self.names)?;
                    Box::new(|from| parquet::read_rows(&self.path, self.names.clone(), from, GROUP))
                }
            };
        let mut place = Place::default();
        let mut ended = false;
        let mut order = Order { last: f64::NEG_INFINITY, left_out: (0, 0) };
        Ok(Box::new(std::iter::from_fn(move || {
            if ended {
                return None;
            }
            let block = next(place.first).and_then(|frame| {
                if frame.height() == 0 {
                    let empty = place.first == 0;
                    let none = || IoError::HeaderOnly { file: shown(&self.path) };
                    return if empty { Err(none()) } else { Ok(None) };
                }
                let (mut rows, _) =
                    channels(&self.path, &self.columns, &self.wanted, &frame, &mut place)?;
                order.keep(&mut rows, place.first);
                *self.left_out.lock().unwrap_or_else(PoisonError::into_inner) = order.left_out;
                place.first += frame.height();
                Ok(Some(rows))
            });
            ended = !matches!(block, Ok(Some(_)));
            block.transpose()
        })))
    }

    /// The error with the line of its row.
    fn in_recording(&self, error: RecordingError) -> IoError {
        let text = matches!(self.headers.source, Source::Text(_));
        let row = error.row().filter(|_| text);
        IoError::Recording { line: row.and_then(|r| csv::line_of(&self.path, r)), error }
    }
}

/// Leaves out rows whose time does not exceed that before: a few are those of a logger that writes a
/// row twice; with more than one in a hundred the recording is refused with the row, as it stands.
struct Order {
    last: f64,
    left_out: (usize, usize),
}

impl Order {
    fn keep(&mut self, rows: &mut Channels, before: usize) {
        if rows.t.first().is_some_and(|t| *t > self.last) && rows.t.is_sorted_by(|a, b| a < b) {
            self.last = rows.t[rows.t.len() - 1];
            return;
        }
        let mut last = self.last;
        let late: Vec<bool> = rows
            .t
            .iter()
            .map(|t| {
                let late = *t <= last;
                last = last.max(*t);
                late
            })
            .collect();
        self.last = last;
        let count = late.iter().filter(|late| **late).count();
        if count == 0 || 100 * (self.left_out.0 + count) > before + late.len() {
            return;
        }
        if self.left_out.0 == 0 {
            self.left_out.1 = before + late.iter().position(|late| *late).unwrap_or(0) + 1;
        }
        self.left_out.0 += count;
        let pick = |v: &Vec<[f64; 2]>| -> Vec<[f64; 2]> {
            v.iter().zip(&late).filter(|(_, late)| !**late).map(|(v, _)| *v).collect()
        };
        rows.t = rows.t.iter().zip(&late).filter(|(_, late)| !**late).map(|(t, _)| *t).collect();
        rows.torque = pick(&rows.torque);
        rows.alpha = rows.alpha.as_ref().map(pick);
        rows.omega = rows.omega.as_ref().map(pick);
    }
}

impl Rows for LongFile {
    fn left_out(&self) -> (usize, usize) {
        *self.left_out.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn blocks(&self) -> Box<dyn Iterator<Item = Result<Channels, RowsError>> + '_> {
        match self.read() {
            Ok(blocks) => Box::new(blocks.map(|block| block.map_err(RowsError::new))),
            Err(e) => Box::new(std::iter::once(Err(RowsError::new(e)))),
        }
    }
}

#[cfg(test)]
mod tests;
