//! Recordings in CSV and Parquet, by polars.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

use polars::prelude::{
    Column as PolarsColumn, CsvParseOptions, CsvReadOptions, DataFrame, DataType, NamedFrom,
    ParquetReader, ParquetWriter, PolarsError, Schema, SerReader, Series,
};

use super::columns::CONTRACT;
use super::{ColumnMap, IoError, sha256};
use crate::recording::{Channels, DriveUnit, Recording};

/// Columns of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Headers {
    /// Names, in order.
    pub names: Vec<String>,
    separator: u8,
}

/// A column to write.
#[derive(Clone, Debug, PartialEq)]
pub enum TableColumn {
    /// Numbers; NaN for missing.
    Number(String, Vec<f64>),
    /// Text.
    Text(String, Vec<String>),
}

/// The names of the columns of a CSV or Parquet file.
///
/// # Errors
/// A directory, an empty file, or one that cannot be read.
pub fn headers(path: &Path) -> Result<Headers, IoError> {
    if path.is_dir() {
        return Err(IoError::Directory { file: path.display().to_string() });
    }
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    if is_parquet(path) {
        let schema = ParquetReader::new(file).schema().map_err(|e| format(path, "Parquet", &e))?;
        let names = schema.iter_names().map(ToString::to_string).collect();
        return Ok(Headers { names, separator: b',' });
    }
    let mut first = Vec::new();
    for line in BufReader::new(file).split(b'\n').take(1000) {
        let line = line.map_err(|e| IoError::system(path, &e))?;
        if !line.trim_ascii().is_empty() && !line.starts_with(b"#") {
            first = line;
            break;
        }
    }
    if first.is_empty() {
        return Err(IoError::Empty { file: path.display().to_string() });
    }
    let text = String::from_utf8(first).map_err(|_| IoError::Format {
        file: path.display().to_string(),
        format: "CSV".into(),
        reason: "the header is not UTF-8 text".into(),
    })?;
    let text = text.trim_start_matches('\u{feff}').trim();
    let count = |c: char| text.matches(c).count();
    let separator =
        [',', ';', '\t'].into_iter().max_by_key(|c| (count(*c), *c == ',')).unwrap_or(',');
    let names = text.split(separator).map(|n| n.trim().trim_matches('"').to_string()).collect();
    Ok(Headers { names, separator: separator as u8 })
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"))
}

fn format(path: &Path, format: &str, e: &PolarsError) -> IoError {
    let reason = e.to_string();
    let reason = reason.lines().next().unwrap_or_default().to_string();
    IoError::Format { file: path.display().to_string(), format: format.into(), reason }
}

/// Reads a recording: the columns of the contract under the names and units of `columns`; others
/// are passed over. Returns it with the SHA-256 of its file.
///
/// # Errors
/// Everything in [`IoError`], with file, row and column.
pub fn read_recording(
    path: &Path,
    columns: &ColumnMap,
    drive_unit: DriveUnit,
) -> Result<(Recording, String), IoError> {
    let headers = headers(path)?;
    let wanted = wanted(path, &headers, columns)?;
    let mut names: Vec<String> = wanted.iter().map(|(_, name)| name.clone()).collect();
    names.sort();
    names.dedup();
    let frame = if is_parquet(path) {
        let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
        let reader = ParquetReader::new(file).with_columns(Some(names));
        reader.finish().map_err(|e| format(path, "Parquet", &e))?
    } else {
        read_csv(path, &headers, &names)?
    };
    if frame.height() == 0 {
        return Err(IoError::HeaderOnly { file: path.display().to_string() });
    }
    let mut channels = Channels::default();
    let one = |key: &str| -> Result<Option<Vec<f64>>, IoError> {
        let Some((_, name)) = wanted.iter().find(|(k, _)| *k == key) else { return Ok(None) };
        let factor = columns.get(key).factor;
        numbers(path, &frame, name).map(|v| Some(v.into_iter().map(|x| factor * x).collect()))
    };
    let pair = |a: Option<Vec<f64>>, b: Option<Vec<f64>>| {
        a.zip(b).map(|(a, b)| a.into_iter().zip(b).map(|(a, b)| [a, b]).collect::<Vec<_>>())
    };
    channels.t = one("t")?.unwrap_or_default();
    channels.alpha = pair(one("alpha1")?, one("alpha2")?);
    channels.omega = pair(one("dalpha1")?, one("dalpha2")?);
    channels.moment = pair(one("M1")?, one("M2")?).unwrap_or_default();
    let name = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    Ok((Recording::new(name, channels, drive_unit)?, sha256(path)?))
}

/// Contract column and its name in the file, for those that are there; t and the drives must be,
/// and of angles and speeds at least one pair.
fn wanted(
    path: &Path,
    headers: &Headers,
    columns: &ColumnMap,
) -> Result<Vec<(&'static str, String)>, IoError> {
    let mut out = Vec::new();
    for key in CONTRACT {
        let column = columns.get(key);
        // "M1 [N m]" is M1 with its unit written behind
        let bare = |n: &str| n.split(['[', '(']).next().unwrap_or(n).trim().to_string();
        let exact = headers.names.iter().find(|n| **n == column.name);
        let found = exact.or_else(|| headers.names.iter().find(|n| bare(n) == column.name));
        let needed = column.named || matches!(key, "t" | "M1" | "M2");
        match found {
            Some(name) => out.push((key, name.clone())),
            None if needed => return Err(missing(path, headers, key, &column.name)),
            None => {}
        }
    }
    let has = |key: &str| out.iter().any(|(k, _)| *k == key);
    let angles = has("alpha1") && has("alpha2");
    let both_speeds = has("dalpha1") && has("dalpha2");
    if !angles && !both_speeds {
        let key = if has("dalpha1") { "dalpha2" } else { "dalpha1" };
        return Err(missing(path, headers, key, &columns.get(key).name));
    }
    // half a pair is of no use
    out.retain(|(k, _)| !k.starts_with("alpha") || angles);
    let speeds = out.iter().filter(|(k, _)| k.starts_with("dalpha")).count() == 2;
    out.retain(|(k, _)| !k.starts_with("dalpha") || speeds);
    Ok(out)
}

fn missing(path: &Path, headers: &Headers, key: &str, name: &str) -> IoError {
    // without signs between: they outweigh the rest of names as short as M_2
    let bare = |n: &str| n.to_lowercase().replace(|c: char| !c.is_alphanumeric(), "");
    let near = headers
        .names
        .iter()
        .filter(|n| !CONTRACT.contains(&n.as_str()))
        .map(|n| (strsim::jaro_winkler(&bare(n), &bare(name)), n))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(score, _)| *score > 0.8)
        .map(|(_, n)| n.clone());
    IoError::MissingColumn {
        file: path.display().to_string(),
        column: name.into(),
        key: key.into(),
        near,
        present: headers.names.join(", "),
    }
}

fn read_csv(path: &Path, headers: &Headers, names: &[String]) -> Result<DataFrame, IoError> {
    let parse = CsvParseOptions::default()
        .with_separator(headers.separator)
        .with_comment_prefix(Some("#"))
        .with_truncate_ragged_lines(true);
    let options = CsvReadOptions::default()
        .with_has_header(true)
        .with_infer_schema_length(Some(0))
        .with_chunk_size(NonZeroUsize::MIN.get().max(1 << 16))
        .with_parse_options(parse);
    let read = |options: CsvReadOptions| {
        options.try_into_reader_with_file_path(Some(path.to_path_buf()))?.finish()
    };
    let schema: Schema = names.iter().map(|n| (n.as_str().into(), DataType::Float64)).collect();
    let fast = options
        .clone()
        .with_columns(Some(names.iter().map(|n| n.as_str().into()).collect()))
        .with_schema_overwrite(Some(Arc::new(schema)));
    if let Ok(frame) = read(fast)
        && frame.columns().iter().all(|c| c.null_count() == 0)
    {
        return Ok(frame);
    }
    // slow but exact: decimal commas, spaces, blank lines, which row holds text that is no number
    match read(options) {
        Ok(frame) => by_cell(path, headers, &frame, names),
        Err(e) => Err(format(path, "CSV", &e)),
    }
}

/// The wanted columns of a frame of text, cell by cell.
fn by_cell(
    path: &Path,
    headers: &Headers,
    frame: &DataFrame,
    names: &[String],
) -> Result<DataFrame, IoError> {
    let wrong = |e: PolarsError| format(path, "CSV", &e);
    // by place: the header may hold spaces around the names
    let place = |name: &String| headers.names.iter().position(|n| n == name).unwrap_or_default();
    let columns: Vec<&PolarsColumn> =
        names.iter().filter_map(|n| frame.select_at_idx(place(n))).collect();
    let texts = columns.iter().map(|c| c.str()).collect::<Result<Vec<_>, _>>().map_err(wrong)?;
    let all = frame.columns().iter().map(|c| c.str()).collect::<Result<Vec<_>, _>>();
    let all = all.map_err(wrong)?;
    let mut values = vec![Vec::with_capacity(frame.height()); texts.len()];
    for row in 0..frame.height() {
        if all.iter().all(|t| t.get(row).unwrap_or_default().trim().is_empty()) {
            continue; // a blank line
        }
        for (j, text) in texts.iter().enumerate() {
            let cell = text.get(row).unwrap_or_default();
            let value = number(cell, headers.separator != b',');
            values[j].push(value.ok_or_else(|| not_a_number(path, row, &names[j], cell))?);
        }
    }
    let height = values.first().map_or(0, Vec::len);
    let columns = names.iter().zip(values);
    let columns = columns.map(|(n, v)| Series::new(n.as_str().into(), v).into()).collect();
    DataFrame::new(height, columns).map_err(wrong)
}

/// A cell as a number; a comma may be the decimal sign where it does not separate columns.
fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim().trim_matches('"').trim();
    let parsed = cell.parse().ok();
    if parsed.is_none() && decimal_comma { cell.replacen(',', ".", 1).parse().ok() } else { parsed }
}

fn not_a_number(path: &Path, row: usize, column: &str, text: &str) -> IoError {
    IoError::NotANumber {
        file: path.display().to_string(),
        row: row + 1,
        column: column.into(),
        text: text.chars().take(40).collect(),
    }
}

fn numbers(path: &Path, frame: &DataFrame, name: &str) -> Result<Vec<f64>, IoError> {
    let wrong = |e: PolarsError| format(path, "table", &e);
    let column = frame.column(name).map_err(wrong)?;
    if matches!(column.dtype(), DataType::String) {
        let texts = column.str().map_err(wrong)?;
        let cells = texts.iter().map(Option::unwrap_or_default).enumerate();
        return cells
            .map(|(k, c)| number(c, true).ok_or_else(|| not_a_number(path, k, name, c)))
            .collect();
    }
    let column = column.cast(&DataType::Float64).map_err(wrong)?;
    let values = column.f64().map_err(wrong)?.iter().enumerate();
    values.map(|(k, v)| v.ok_or_else(|| not_a_number(path, k, name, ""))).collect()
}

/// A recording as CSV in the columns of the contract.
#[must_use]
pub fn write_csv(recording: &Recording) -> String {
    use std::fmt::Write as _;
    let mut out = String::from("t,alpha1,alpha2,dalpha1,dalpha2,M1,M2\n");
    for (k, t) in recording.t().iter().enumerate() {
        let (a, w, m) = (recording.alpha()[k], recording.omega()[k], recording.moment()[k]);
        let _ = writeln!(out, "{t},{},{},{},{},{},{}", a[0], a[1], w[0], w[1], m[0], m[1]);
    }
    out
}

/// A table as Parquet.
///
/// # Errors
/// Columns of different length.
pub fn write_parquet_table(path: &Path, columns: &[TableColumn]) -> Result<Vec<u8>, IoError> {
    let series: Vec<PolarsColumn> = columns
        .iter()
        .map(|column| match column {
            TableColumn::Number(name, values) => Series::new(name.as_str().into(), values).into(),
            TableColumn::Text(name, values) => Series::new(name.as_str().into(), values).into(),
        })
        .collect();
    let height = columns.first().map_or(0, |c| match c {
        TableColumn::Number(_, v) => v.len(),
        TableColumn::Text(_, v) => v.len(),
    });
    let mut frame = DataFrame::new(height, series).map_err(|e| format(path, "Parquet", &e))?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).map_err(|e| format(path, "Parquet", &e))?;
    Ok(bytes)
}
