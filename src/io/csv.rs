//! Text tables: separators, decimal commas, comments, and the place of an invalid cell.

mod bare;
mod blocks;
mod by_cell;
mod keys;
mod lists;
mod named_cells;
mod number;
mod plain;
mod style;
mod uneven;
mod unfold;

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;

use polars::prelude::{
    Column as PolarsColumn, CsvParseOptions, CsvReadOptions, DataFrame, DataType, PolarsError,
    PolarsResult, Schema, SerReader,
};

pub(super) use self::blocks::{Blocks, has_more_lines};
pub use self::keys::is_owner;
pub(super) use self::keys::is_part;
pub(super) use self::lists::lists;
pub(super) use self::named_cells::named_by_cells;
pub(super) use self::number::{ABSENT, duration, number, quantity, value};
pub(super) use self::style::{Evidence, Style};
pub(super) use self::uneven::cells_of;
pub(super) use self::unfold::{may_be_keyed, unfold, unfolded};
use super::IoError;
use super::columns::is_unit;
use super::error::{caught, format_error, shown};

/// Layout of a file according to its first lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Names of the columns, in order.
    pub(super) names: Vec<String>,
    separator: u8,
    decimal_comma: bool,
    /// Number of lines above the header: blank lines and comments.
    above: usize,
    /// Number of lines between the names and the end of the line of units; 0 without units.
    units: usize,
    /// How numbers are written.
    style: Style,
    /// Units in the cells of columns, as written by MATLAB (`0.01 sec`); empty for bare numbers.
    in_cells: Vec<String>,
    /// Indices of the columns whose words are directions, and the word for backward.
    pub(super) directions: Vec<(usize, String)>,
}

impl Layout {
    /// A cell of a column as a number, in the unit of the cells of this column.
    fn value(&self, place: usize, cell: &str) -> Option<f64> {
        if let Some((_, back)) = self.directions.iter().find(|(at, _)| *at == place) {
            let cell = cell.trim().trim_matches('"').trim();
            return Some(if cell.is_empty() {
                f64::NAN
            } else if cell == back {
                -1.0
            } else {
                1.0
            });
        }
        value(cell, self.style).or_else(|| {
            let unit = self.in_cells.get(place).filter(|unit| !unit.is_empty())?;
            number(cell.trim().trim_matches('"').trim().strip_suffix(unit.as_str())?, self.style)
        })
    }
}

/// Number of bytes within which the header must be.
const HEAD: u64 = 1 << 20;

/// Reads the header, and how numbers are written in the rows below it.
pub(super) fn layout(path: &Path) -> Result<Layout, IoError> {
    let layout = head(path)?;
    Ok(Layout { style: style::of_file(path, &layout)?, ..layout })
}

/// Number of lines below the names in which units are searched; types and the like may come first.
const BELOW: usize = 6;

/// Reads the header: the first line that is neither blank nor a comment.
fn head(path: &Path) -> Result<Layout, IoError> {
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    let (mut lines, mut above) = (Vec::new(), 0);
    for line in BufReader::new(file).take(HEAD).split(b'\n') {
        let line = line.map_err(|e| IoError::system(path, &e))?;
        if is_row(&line) {
            lines.push(line);
        } else if lines.is_empty() {
            above += 1;
        }
        if lines.len() == 2 + BELOW {
            break;
        }
    }
    let mut lines = lines.into_iter();
    let first = lines.next().ok_or_else(|| IoError::Empty { file: shown(path) })?;
    let text = String::from_utf8(first).map_err(|_| IoError::Format {
        file: shown(path),
        format: "CSV".into(),
        reason: "its first line is no text; if it is a binary log, export it as CSV with the program that wrote it".into(),
    })?;
    let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
    let count = |c: char| text.matches(c).count();
    let separator =
        [',', ';', '\t'].into_iter().max_by_key(|c| (count(*c), *c == ',')).unwrap_or(',');
    let names = split(text, separator);
    if names.iter().all(|n| number(n, Style::of(separator)).is_some()) {
        return Err(IoError::NoHeader { file: shown(path), count: names.len() });
    }
    let below: Vec<Vec<u8>> = lines.collect();
    let (units, names) = match units_below(&below, separator, names.len()) {
        Some((lines, units)) => {
            (lines, names.iter().zip(&units).map(|(n, u)| with_unit(n, u)).collect())
        }
        None => (0, names),
    };
    let row = below.get(units).cloned().unwrap_or_default();
    let decimal_comma = separator != ',' && row.contains(&b',') && !row.contains(&b'.');
    let in_cells = units_in_cells(&row, separator);
    let unit = |k: usize| in_cells.get(k).map_or("", String::as_str);
    let names = names.iter().enumerate().map(|(k, name)| with_unit(name, unit(k))).collect();
    Ok(Layout {
        names,
        separator: separator as u8,
        decimal_comma,
        above,
        units,
        style: Style::of(separator),
        in_cells,
        directions: vec![],
    })
}

/// The units after the numbers of a row; empty where there are none.
fn units_in_cells(row: &[u8], separator: char) -> Vec<String> {
    let text = String::from_utf8_lossy(row);
    let unit = |cell: &String| {
        let unit = quantity(cell).map_or("", |(_, unit)| unit);
        if unit == "%" || is_unit(unit) { unit.to_string() } else { String::new() }
    };
    split(text.trim_end_matches(['\r', '\n']), separator).iter().map(unit).collect()
}

/// The error for a text without numbers, with its first line that is neither blank nor a comment.
pub(super) fn not_understood(path: &Path) -> IoError {
    let lines = File::open(path).map(|file| BufReader::new(file.take(HEAD)).split(b'\n'));
    let mut lines = lines.into_iter().flatten().map_while(Result::ok).enumerate();
    let first = lines.find(|(_, line)| is_row(line));
    let shortened = |line: &[u8]| String::from_utf8_lossy(line).trim().chars().take(120).collect();
    let line = first.map(|(k, line)| (k + 1, shortened(&line)));
    IoError::NotUnderstood { file: shown(path), line }
}

/// What stands in a line of units for a column without one; a format of time is none of its numbers.
const NO_UNIT: [&str; 14] =
    ["", "-", "--", "–", "—", "1", "na", "n/a", "n.a.", "none", "null", "nan", "bool", "enum"];
/// Units of quantities that a recording does not need.
const OTHER_UNITS: [&str; 12] =
    ["%", "°c", "degc", "k", "hz", "w", "j", "g", "m/s2", "m/s^2", "m/s²", "bar"];

/// Whether a cell in a line of units is that of a column without one.
fn is_no_unit(cell: &str) -> bool {
    let cell = bare(cell).to_lowercase();
    NO_UNIT.contains(&cell.as_str()) || cell.contains("hh:mm") || cell.contains("mm:ss")
}

/// Whether cells are a line of units: each is a unit or says that there is none, and more than one in two of those that
/// hold a number, as `1` may, is a unit; or, without numbers, more than half are units, and others may be unknown ones.
pub(super) fn is_units(cells: &[String]) -> bool {
    let units = cells.iter().filter(|c| is_unit(bare(c))).count();
    let is_known = |c: &String| {
        is_unit(bare(c)) || is_no_unit(c) || OTHER_UNITS.contains(&bare(c).to_lowercase().as_str())
    };
    let numbers = cells.iter().filter(|c| is_finite(bare(c))).count();
    let are_known = cells.iter().all(is_known) && units > numbers;
    are_known || numbers == 0 && 2 * units > cells.len()
}

/// Whether a cell holds a number.
fn is_finite(cell: &str) -> bool {
    value(cell, Style::Either).is_some_and(f64::is_finite)
}

/// A unit without brackets and without a word before it, as in `Units: deg/s`.
fn bare(cell: &str) -> &str {
    let cell = cell.trim_matches(['[', ']', '(', ')']).trim();
    match cell.split_once(':') {
        Some(("Units" | "Unit" | "units" | "unit", unit)) => unit.trim(),
        _ => cell,
    }
}

/// The units of `columns` columns below a header, and the number of lines without numbers above the first
/// row.
fn units_below(below: &[Vec<u8>], separator: char, columns: usize) -> Option<(usize, Vec<String>)> {
    let cells = |line: &Vec<u8>| {
        let text = String::from_utf8_lossy(line);
        split(text.trim_end_matches(['\r', '\n']), separator)
    };
    let holds_number = |line: &Vec<u8>| {
        let cells = cells(line);
        !is_units(&cells) && cells.iter().any(|c| is_finite(c))
    };
    let lines = below.iter().take_while(|line| !holds_number(line)).count().min(BELOW);
    let mut rows = below[..lines].iter().map(cells);
    Some((lines, rows.find(|cells| cells.len() == columns && is_units(cells))?))
}

/// A name with its unit appended, if there is a unit and the name has none.
pub(super) fn with_unit(name: &str, unit: &str) -> String {
    let unit = bare(unit);
    if is_no_unit(unit) || name.ends_with([']', ')']) {
        name.into()
    } else {
        format!("{name} [{unit}]")
    }
}

/// The names of a header; within quotes a separator is a part of the name, and `""` a quote.
pub(super) fn split(header: &str, separator: char) -> Vec<String> {
    let (mut names, mut quoted) = (vec![String::new()], false);
    let mut letters = header.chars().peekable();
    while let Some(c) = letters.next() {
        let Some(name) = names.last_mut() else { break };
        match c {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                name.push('"');
            }
            '"' if quoted || name.trim().is_empty() => quoted = !quoted,
            c if c == separator && !quoted => names.push(String::new()),
            c => name.push(c),
        }
    }
    names.iter().map(|name| name.trim().to_string()).collect()
}

/// Whether a line is header or data.
fn is_row(line: &[u8]) -> bool {
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let line = line.trim_ascii();
    !line.is_empty() && !line.starts_with(b"#") && !is_separator(line)
}

/// Whether a line declares the separator for Excel: `sep=;`.
pub(super) fn is_separator(line: &[u8]) -> bool {
    matches!(line.strip_prefix(b"sep="), Some([_]))
}

/// The required columns as numbers.
pub(super) fn read(path: &Path, layout: &Layout, names: &[String]) -> Result<DataFrame, IoError> {
    let schema: Schema = names.iter().map(|n| (n.as_str().into(), DataType::Float64)).collect();
    let fast = options(layout, false)
        .with_columns(Some(names.iter().map(|n| n.as_str().into()).collect()))
        .with_schema_overwrite(Some(Arc::new(schema)));
    let cells = cells_of(path, layout)?;
    if layout.units == 0
        && layout.style == Style::of(char::from(layout.separator))
        && cells.are_even()
        && let Ok(frame) = finish(path, fast)
        && frame.columns().iter().all(|c| c.null_count() == 0)
    {
        return Ok(frame);
    }
    // slow but exact: spaces, blank lines, rows that are none
    by_cell::read(path, layout, names, &cells)
}

/// A column of a text file without conversion.
pub(super) struct TextColumn {
    pub(super) name: String,
    /// Values; NaN for cells that are not numbers.
    pub(super) values: Vec<f64>,
    /// The different words of the column; empty if there are many.
    pub(super) words: Vec<String>,
    /// The first cells of a column without numbers that contain something; empty ones if no cell does.
    pub(super) texts: Vec<String>,
}

/// Number of cells of a column without numbers that are shown.
const SHOWN: usize = 3;

/// Largest number of different words in a column of words: states, directions, names of motors.
const WORDS: usize = 16;

/// All columns.
pub(super) fn all(path: &Path, layout: &Layout) -> Result<Vec<TextColumn>, IoError> {
    let columns = layout.names.iter().zip(by_place(path, layout)?);
    // a separator at the end of the header names nothing
    let is_column = |(name, cells): &(&String, Vec<String>)| {
        !name.is_empty() || cells.iter().any(|cell| !cell.is_empty())
    };
    let column = |(k, (name, cells)): (usize, (&String, Vec<String>))| {
        let number = |cell: &String| layout.value(k, cell);
        let words = words(&cells, number);
        let values: Vec<f64> = cells.iter().map(|cell| number(cell).unwrap_or(f64::NAN)).collect();
        let is_text = values.iter().all(|x| x.is_nan());
        let texts = if is_text { shown_cells(cells) } else { vec![] };
        TextColumn { name: name.clone(), values, words, texts }
    };
    Ok(columns.enumerate().filter(|(_, column)| is_column(column)).map(column).collect())
}

/// The first cells that contain something, or the first ones if all are empty.
fn shown_cells(cells: Vec<String>) -> Vec<String> {
    let held: Vec<String> = cells.iter().filter(|c| !c.is_empty()).take(SHOWN).cloned().collect();
    if held.is_empty() { cells.into_iter().take(SHOWN).collect() } else { held }
}

/// The different words of the cells, if all cells are words and few are different.
fn words(cells: &[String], number: impl Fn(&String) -> Option<f64>) -> Vec<String> {
    let mut words: Vec<String> = vec![];
    for cell in cells {
        if number(cell).is_some() || words.len() > WORDS {
            return vec![];
        }
        if !words.contains(cell) {
            words.push(cell.clone());
        }
    }
    if words.len() > WORDS { vec![] } else { words }
}

/// The cells of every column, without spaces around them.
fn by_place(path: &Path, layout: &Layout) -> Result<Vec<Vec<String>>, IoError> {
    let wrong = |e: PolarsError| format_error(path, "CSV", &e);
    let frame = finish(path, options(layout, true)).map_err(wrong)?;
    let cells = |column: &PolarsColumn| -> Result<Vec<String>, IoError> {
        let texts = column.str().map_err(wrong)?.iter();
        Ok(texts.map(|c| c.unwrap_or_default().trim().to_string()).collect())
    };
    frame.columns().iter().map(cells).collect()
}

fn options(layout: &Layout, truncate: bool) -> CsvReadOptions {
    let parse = CsvParseOptions::default()
        .with_separator(layout.separator)
        .with_decimal_comma(layout.decimal_comma)
        .with_comment_prefix(Some("#"))
        .with_truncate_ragged_lines(truncate);
    CsvReadOptions::default()
        .with_has_header(true)
        .with_skip_lines(layout.above)
        .with_skip_rows_after_header(layout.units)
        .with_infer_schema_length(Some(0))
        .with_parse_options(parse)
}

fn finish(path: &Path, options: CsvReadOptions) -> PolarsResult<DataFrame> {
    caught(|| options.try_into_reader_with_file_path(Some(path.to_path_buf()))?.finish())
}

/// The rows of data with their line, both from 1.
fn rows(path: &Path) -> Result<impl Iterator<Item = (usize, usize, Vec<u8>)>, IoError> {
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    let lines = BufReader::new(file).split(b'\n').map_while(Result::ok).enumerate();
    let header = 1 + head(path)?.units;
    let rows = lines.filter(|(_, line)| is_row(line)).skip(header).enumerate();
    Ok(rows.map(|(row, (line, text))| (row + 1, line + 1, text)))
}

/// The line of a row of data.
pub(super) fn line_of(path: &Path, row: usize) -> Option<usize> {
    rows(path).ok()?.find(|(k, ..)| *k == row).map(|(_, line, _)| line)
}
