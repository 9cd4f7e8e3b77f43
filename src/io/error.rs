//! Errors of files, with their messages.

mod phrases;

use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use polars::prelude::{PolarsError, PolarsResult};

use self::phrases::{assigned, first_line, for_example, in_file, quoted, ragged};
pub(super) use self::phrases::{shortened, shown};
use crate::recording::RecordingError;

/// An error of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IoError {
    /// An error of the operating system.
    #[error("{file}: {reason}")]
    System {
        /// As the user named it.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// A directory in place of a file.
    #[error("{file} is a directory; expected a recording or an experiment file: name a file in it{}", for_example(example.as_ref()))]
    Directory {
        /// As the user named it.
        file: String,
        /// A file in it.
        example: Option<String>,
    },
    /// A file in place of a folder.
    #[error("{path} is a file; results need a folder, name another with --out")]
    NotAFolder {
        /// As the user named it.
        path: String,
    },
    /// A folder where a result is to be written.
    #[error("{path} is a folder, and a result of that name is to be written; move it away")]
    NotAFile {
        /// As the user named it.
        path: String,
    },
    /// The first line is data.
    #[error(
        "{file}: the first line contains numbers where the names of the columns are expected (a line that starts with # is a comment); write a header, for example t,dalpha1,dalpha2,M1,M2, or name the {count} columns by their place: columns = {{ t = \"column1\", … }}"
    )]
    NoHeader {
        /// As the user named it.
        file: String,
        /// Columns.
        count: usize,
    },
    /// A text of no form that is read.
    #[error(
        "{file}{}: this text was not understood: no column of it contains numbers. Expected a header and rows of numbers between commas, semicolons, tabs or spaces, or lines such as `l: 134 r: -5`, `l=134,r=-5`, `L 44.1rpm | R 43.9rpm`, `STATE:1,2,3` or JSON; leave out other lines or write a table (docs/files.md lists all forms)", first_line(line.as_ref())
    )]
    NotUnderstood {
        /// As the user named it.
        file: String,
        /// Number and words of its first line.
        line: Option<(usize, String)>,
    },
    /// Nothing in it.
    #[error("{file} is empty; expected a header and rows of numbers")]
    Empty {
        /// As the user named it.
        file: String,
    },
    /// A header without rows.
    #[error("{file}: there is a header but no row of data below it")]
    HeaderOnly {
        /// As the user named it.
        file: String,
    },
    /// A column that is needed is not there.
    #[error("{file}: there is no column `{column}`{}; the file has {present}. Name it in the experiment file: columns = {{ {} }}", near.as_ref().map_or(String::new(), |n| format!(" (did you mean `{n}`?)")), assigned(key))]
    MissingColumn {
        /// As the user named it.
        file: String,
        /// Name looked for.
        column: String,
        /// Its key in `columns`.
        key: String,
        /// The closest name.
        near: Option<String>,
        /// All names.
        present: String,
    },
    /// Text where a number is needed.
    #[error(
        "{file}, row {row}{}: {column} is {}; expected a number (rows count from 1 below the header)", in_file(*line), quoted(text)
    )]
    NotANumber {
        /// As the user named it.
        file: String,
        /// Counted from 1, below the header.
        row: usize,
        /// Line of the file, where it has lines.
        line: Option<usize>,
        /// Name in the file.
        column: String,
        /// The text found.
        text: String,
    },
    /// The content does not have the format of the file name.
    #[error("{file} cannot be read as {format}: {reason}")]
    Format {
        /// As the user named it.
        file: String,
        /// Its name.
        format: String,
        /// Message of the reader.
        reason: String,
    },
    /// A unit that is not known for the quantity.
    #[error(
        "columns.{column}: unit `{unit}` is not known for {quantity}; use one of {known}, or the factor to one of them: unit = \"{}\", scale = …", known.split(',').next().unwrap_or_default()
    )]
    Unit {
        /// Contract column.
        column: String,
        /// As written.
        unit: String,
        /// Time, angle, speed or input.
        quantity: String,
        /// All that are.
        known: String,
    },
    /// A unit that cannot be converted without another number.
    #[error("columns.{column}: unit `{unit}` needs {need}")]
    UnitNeeds {
        /// Contract column.
        column: String,
        /// As written.
        unit: String,
        /// The missing value.
        need: String,
    },
    /// A unit in the header that is not known for the quantity.
    #[error(
        "{file}: the header contains `{column}`, but `{unit}` is not a known unit; give a known unit in the experiment file, and the factor to it as scale: columns = {{ {key} = {{ name = \"{column}\", unit = \"{si}\", scale = … }} }}"
    )]
    HeaderUnit {
        /// As the user named it.
        file: String,
        /// Its name in the header.
        column: String,
        /// The text in the brackets.
        unit: String,
        /// Unit of the contract.
        si: &'static str,
        /// Its key in `columns`.
        key: String,
    },
    /// A factor that makes nothing of a column.
    #[error(
        "columns.{column}: a factor of {factor} and an offset of {offset} make no sense; scale, offset, per_turn and torque_constant must be finite, and all but offset not zero"
    )]
    Scale {
        /// Contract column.
        column: String,
        /// Factor to SI.
        factor: f64,
        /// Offset in SI.
        offset: f64,
    },
    /// A sum of quantities that cannot be added.
    #[error("columns.{column}.plus: {reason}")]
    Sum {
        /// Contract column.
        column: String,
        /// The error, and the remedy.
        reason: String,
    },
    /// A direction for a quantity without one, or its values without a column.
    #[error(
        "column {column}: `sign` names the column with the direction of a speed or an input (dalpha1, dalpha2, M1, M2), and `backward` its content for negative values: {{ name = \"pwmL\", sign = \"dirL\", backward = \"0\" }}"
    )]
    Direction {
        /// Contract column.
        column: String,
    },
    /// A direction that is none of the two.
    #[error(
        "{file}, row {row}: {key}.sign takes the direction from column `{column}`, which has no number there; name its content for negative values: backward = \"…\""
    )]
    NoDirection {
        /// As the user named it.
        file: String,
        /// Row of data, from 1.
        row: usize,
        /// Contract column.
        key: String,
        /// Column of the direction.
        column: String,
    },
    /// A period of the rows that is none.
    #[error(
        "columns.{column}: expected the sampling period [s] above 0, as t = {{ period = 0.02 }}, found period = {period}; it is allowed in `t` only, in place of all other keys"
    )]
    Period {
        /// Contract column.
        column: String,
        /// As written.
        period: f64,
    },
    /// A key of `columns` that is no column of the contract.
    #[error(
        "columns.{column} is not a column of a recording{}; they are t, alpha1, alpha2, dalpha1, dalpha2, M1, M2", near.as_ref().map_or(String::new(), |n| format!(" (did you mean `{n}`?)"))
    )]
    UnknownColumn {
        /// As written.
        column: String,
        /// The closest name.
        near: Option<String>,
    },
    /// A name that two columns have.
    #[error("{file}: two columns are called `{column}`; rename one")]
    RepeatedColumn {
        /// As the user named it.
        file: String,
        /// The name.
        column: String,
    },
    /// More cells in a row than names in the header.
    #[error(
        "{file}, row {row} (line {line}) `{text}`: {found} cells, and {}", ragged(*expected, *has_header, *most)
    )]
    Ragged {
        /// As the user named it.
        file: String,
        /// Counted from 1, below the header.
        row: usize,
        /// Counted from 1, the header included.
        line: usize,
        /// Cells found.
        found: usize,
        /// Names in the header.
        expected: usize,
        /// Beginning of the row.
        text: String,
        /// Whether the names of the columns stand in the file.
        has_header: bool,
        /// Whether most rows have another number of cells than the header.
        most: bool,
    },
    /// A binary file that breaks the rules of its format.
    #[error(
        "{file} is damaged or not a {format} file: {place}: expected {expected}, found {found}; copy it again from where it was recorded"
    )]
    Damaged {
        /// As the user named it.
        file: String,
        /// WPILOG, MCAP, MAT or SysId JSON.
        format: &'static str,
        /// Byte, entry or message.
        place: String,
        /// Expected content.
        expected: String,
        /// Content found.
        found: String,
    },
    /// A file of a known format without anything to use.
    #[error("{file}: this {format} file contains no {needed}; it contains: {found}")]
    Nothing {
        /// As the user named it.
        file: String,
        /// WPILOG, MCAP or MAT.
        format: &'static str,
        /// The required content.
        needed: String,
        /// The existing content.
        found: String,
    },
    /// The extension of the name contradicts the content.
    #[error("{file} does not have the format of its name; rename it to end in .{extension}")]
    OtherFormat {
        /// As the user named it.
        file: String,
        /// The one that fits.
        extension: String,
    },
    /// Signals that have no time in common.
    #[error(
        "{file}: `{late}` begins after the last value of `{early}`, so no row contains both; name other columns"
    )]
    Apart {
        /// As the user named it.
        file: String,
        /// The signal that begins last.
        late: String,
        /// The one that gives the rows.
        early: String,
    },
    /// Vectors of different lengths.
    #[error(
        "{file}: `{column}` has {length} values and `{other}` has {others}; name columns of the same length"
    )]
    Unequal {
        /// As the user named it.
        file: String,
        /// Name of the one that differs.
        column: String,
        /// Rows that it has.
        length: usize,
        /// The column that is named first.
        other: String,
        /// Rows that it has.
        others: usize,
    },
    /// The columns do not make a recording.
    #[error("{error}{}", in_file(*line))]
    Recording {
        /// What is wrong with them.
        error: RecordingError,
        /// Line of the file, where a row is named and the file has lines.
        line: Option<usize>,
    },
}

/// What polars reads; damaged files can make it panic (a CSV that ends in an open quote, a changed bit of
/// Parquet), which is an error like any other.
pub(super) fn caught<T>(read: impl FnOnce() -> PolarsResult<T>) -> PolarsResult<T> {
    let damaged = |_| PolarsError::ComputeError("its data are damaged; write it again".into());
    catch_unwind(AssertUnwindSafe(read)).map_err(damaged)?
}

/// The error message of polars for a file, in one line.
pub(super) fn format_error(path: &Path, format: &str, e: &PolarsError) -> IoError {
    let reason = e.to_string();
    let reason = reason.lines().next().unwrap_or_default().to_string();
    IoError::Format { file: shown(path), format: format.into(), reason }
}

impl IoError {
    pub(super) fn not_a_number(
        path: &Path,
        row: usize,
        line: Option<usize>,
        column: &str,
        text: &str,
    ) -> Self {
        let text = text.chars().take(40).collect();
        Self::NotANumber { file: shown(path), row, line, column: column.into(), text }
    }

    /// The error of a row of which there are many or few.
    pub(super) fn of_most(mut self, is_usual: bool) -> Self {
        if let Self::Ragged { most, .. } = &mut self {
            *most = is_usual;
        }
        self
    }

    /// A file without any of the required content.
    pub(super) fn nothing(path: &Path, format: &'static str, needed: &str, found: &str) -> Self {
        let found = shortened(found);
        Self::Nothing { file: shown(path), format, needed: needed.into(), found }
    }

    pub(super) fn system(file: &Path, e: &std::io::Error) -> Self {
        let remedy = match e.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
                "; make room, or name a folder on another disk with --out"
            }
            ErrorKind::ReadOnlyFilesystem => "; name a folder that can be written with --out",
            ErrorKind::PermissionDenied => {
                "; expected a file that can be read: change its permissions (chmod u+r), or copy it to a folder of your own"
            }
            ErrorKind::NotFound => "; expected a file: check the name and the folder",
            _ => "",
        };
        Self::System { file: file.display().to_string(), reason: format!("{e}{remedy}") }
    }

    /// The error of a file or folder that is to be written.
    pub(super) fn unwritable(file: &Path, e: &std::io::Error) -> Self {
        if e.kind() != ErrorKind::PermissionDenied {
            return Self::system(file, e);
        }
        // `.` says little
        let place = std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf());
        let place = place.components().as_path().display().to_string();
        let reason = format!(
            "{e}; expected a place that can be written: name another with -o (a file) or --out (a folder), or change the \
             permissions of the folder (chmod u+w)"
        );
        Self::System { file: place, reason }
    }

    /// The error of a directory in place of a file, with the first file in it by name.
    pub(super) fn directory(path: &Path) -> Self {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        let files = entries.map(|entry| entry.path()).filter(|entry| entry.is_file());
        Self::Directory { file: shown(path), example: files.min().map(|file| shown(&file)) }
    }
}
