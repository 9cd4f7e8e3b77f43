//! The columns of a file, and where their values are.

use std::path::Path;

use super::super::csv::{self, Layout};
use super::super::format::Format;
use super::super::signals::Signals;
use super::super::whole::Content;
use super::super::{IoError, parquet, sysid, text_log};

/// Columns of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Headers {
    /// Names, in order.
    pub names: Vec<String>,
    pub(in crate::io) source: Source,
}

impl Headers {
    /// Whether all columns of that name have the same values, as the time beside every signal in files of Simulink.
    pub(in crate::io) fn are_copies(&self, path: &Path, name: &str) -> bool {
        let values: Vec<Vec<f64>> = match &self.source {
            Source::Text(layout) => {
                let all = csv::all(path, layout).unwrap_or_default().into_iter();
                all.filter(|c| c.name == name).map(|c| c.values).collect()
            }
            Source::Columns(all) => {
                all.iter().filter(|(n, _)| n == name).map(|(_, values)| values.clone()).collect()
            }
            Source::Parquet | Source::Signals(_) => vec![],
        };
        values.windows(2).all(|pair| are_same(&pair[0], &pair[1])) && values.len() > 1
    }
}

/// Whether values are the same, of which NaN is one.
pub(in crate::io) fn are_same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Where the values of the columns are.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::io) enum Source {
    /// In the lines of a text.
    Text(Layout),
    Parquet,
    /// Already read, each with its own stamps.
    Signals(Signals),
    /// Already read.
    Columns(Vec<(String, Vec<f64>)>),
}

/// The names of the columns of a file. The ending of its name says the format: `.parquet`,
/// `.wpilog`, `.mcap`, `.mat`, `.json` (SysId), and CSV for any other.
///
/// # Errors
/// A directory, an empty file, one that cannot be read, or one whose content is of another format.
pub fn headers(path: &Path) -> Result<Headers, IoError> {
    let (path, part) = parted(path);
    headers_of(path, part)
}

pub(super) fn headers_of(path: &Path, part: Option<&str>) -> Result<Headers, IoError> {
    if path.is_dir() {
        return Err(IoError::directory(path));
    }
    let columns = |columns: Vec<(String, Vec<f64>)>| {
        (columns.iter().map(|(name, _)| name.clone()).collect(), Source::Columns(columns))
    };
    let (names, source) = match Format::of(path)? {
        Format::Csv => match text_log::read(path)? {
            Some(found) => columns(found),
            None => {
                let layout = csv::layout(path)?;
                csv::cells_of(path, &layout)?.check(path)?;
                let layout = csv::named_by_cells(path, layout)?;
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

/// A path and the part of the file that stands behind a `#`: `run.json#slow-forward`.
pub(in crate::io) fn parted(path: &Path) -> (&Path, Option<&str>) {
    let split = path.to_str().and_then(|text| text.rsplit_once('#'));
    match split {
        Some((file, part)) if !path.exists() && !part.contains(['/', '\\']) => {
            (Path::new(file), Some(part))
        }
        _ => (path, None),
    }
}
