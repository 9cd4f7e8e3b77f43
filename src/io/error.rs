//! What is wrong with a file, in words.

use crate::recording::RecordingError;

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IoError {
    /// The system says no.
    #[error("{file}: {reason}")]
    System {
        /// File.
        file: String,
        /// The system's words.
        reason: String,
    },
    /// A directory in place of a file.
    #[error("{file} is a directory; name a file in it")]
    Directory {
        /// Path.
        file: String,
    },
    /// A file in place of a folder.
    #[error("{path} is a file; results need a folder, name another with --out")]
    NotAFolder {
        /// Path.
        path: String,
    },
    /// Nothing in it.
    #[error("{file} is empty; expected a header and rows of numbers")]
    Empty {
        /// File.
        file: String,
    },
    /// A header and nothing below.
    #[error("{file}: there is a header but no row of data below it")]
    HeaderOnly {
        /// File.
        file: String,
    },
    /// A column that is needed is not there.
    #[error("{file}: there is no column `{column}`{}; the file has {present}. Say which it is in the experiment file: columns = {{ {key} = \"…\" }}", near.as_ref().map_or(String::new(), |n| format!(" (did you mean `{n}`?)")))]
    MissingColumn {
        /// File.
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
        "{file}, row {row}: {column} is `{text}`; expected a number (rows count from 1 below the header)"
    )]
    NotANumber {
        /// File.
        file: String,
        /// Row from 1.
        row: usize,
        /// Column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// Not the format that its name says.
    #[error("{file} cannot be read as {format}: {reason}")]
    Format {
        /// File.
        file: String,
        /// CSV or Parquet.
        format: String,
        /// What the reader says.
        reason: String,
    },
    /// A unit that is not known for the quantity.
    #[error("columns.{column}: unit `{unit}` is not known for {quantity}; use one of {known}")]
    Unit {
        /// Contract column.
        column: String,
        /// As written.
        unit: String,
        /// Time, angle, speed or drive.
        quantity: String,
        /// All that are.
        known: String,
    },
    /// A key of `columns` that is no column of the contract.
    #[error(
        "columns.{column} is no column of a recording; they are t, alpha1, alpha2, dalpha1, dalpha2, M1, M2"
    )]
    UnknownColumn {
        /// As written.
        column: String,
    },
    /// The columns do not make a recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

impl IoError {
    pub(super) fn system(file: &std::path::Path, e: &std::io::Error) -> Self {
        Self::System { file: file.display().to_string(), reason: e.to_string() }
    }
}
