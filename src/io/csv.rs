//! Tables of text: separators, decimal commas, comments, and where a wrong cell stands.

mod blocks;
mod unfold;

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::sync::Arc;

use polars::prelude::{
    Column as PolarsColumn, CsvParseOptions, CsvReadOptions, DataFrame, DataType, NamedFrom,
    PolarsError, PolarsResult, Schema, SerReader, Series,
};

pub(super) use self::blocks::{Blocks, has_more_lines};
pub(super) use self::unfold::unfold;
use super::IoError;
use super::columns::is_unit;
use super::error::{caught, format_error, shown};

/// What the first lines of a file say about it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Names of the columns, in order.
    pub(super) names: Vec<String>,
    separator: u8,
    decimal_comma: bool,
    /// Lines above the header: blank ones and comments.
    above: usize,
    /// Whether the line below the names holds their units.
    units: bool,
}

/// A header, with whatever stands above it, is looked for in this many bytes.
const HEAD: u64 = 1 << 20;

/// Reads the header: the first line that is neither blank nor a comment.
pub(super) fn layout(path: &Path) -> Result<Layout, IoError> {
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    let (mut lines, mut above) = (Vec::new(), 0);
    for line in BufReader::new(file).take(HEAD).split(b'\n') {
        let line = line.map_err(|e| IoError::system(path, &e))?;
        if is_row(&line) {
            lines.push(line);
        } else if lines.is_empty() {
            above += 1;
        }
        if lines.len() == 3 {
            break;
        }
    }
    let mut lines = lines.into_iter();
    let first = lines.next().ok_or_else(|| IoError::Empty { file: shown(path) })?;
    let text = String::from_utf8(first).map_err(|_| IoError::Format {
        file: shown(path),
        format: "CSV".into(),
        reason: "the header is not UTF-8 text; save it as CSV in UTF-8".into(),
    })?;
    let text = text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
    let count = |c: char| text.matches(c).count();
    let separator =
        [',', ';', '\t'].into_iter().max_by_key(|c| (count(*c), *c == ',')).unwrap_or(',');
    let names = split(text, separator);
    if names.iter().all(|n| number(n, separator != ',').is_some()) {
        return Err(IoError::NoHeader { file: shown(path), count: names.len() });
    }
    let mut row = lines.next().unwrap_or_default();
    let units = units_of(&row, separator).filter(|units| units.len() == names.len());
    if units.is_some() {
        row = lines.next().unwrap_or_default();
    }
    let decimal_comma = separator != ',' && row.contains(&b',') && !row.contains(&b'.');
    let (names, units) = match units {
        Some(units) => (names.iter().zip(&units).map(|(n, u)| with_unit(n, u)).collect(), true),
        None => (names, false),
    };
    Ok(Layout { names, separator: separator as u8, decimal_comma, above, units })
}

/// Whether cells without a number are units, at least half of them; a text among them may be a unit that is
/// not known.
pub(super) fn is_units(cells: &[String]) -> bool {
    2 * cells.iter().filter(|c| is_unit(bare(c))).count() > cells.len()
}

/// A unit without the brackets around it.
fn bare(cell: &str) -> &str {
    cell.trim_matches(['[', ']', '(', ')']).trim()
}

/// The units of a line that holds units and no number: `s,rpm,,mNm`.
fn units_of(line: &[u8], separator: char) -> Option<Vec<String>> {
    let text = str::from_utf8(line).ok()?.trim_end_matches(['\r', '\n']);
    let cells = split(text, separator).into_iter();
    let cells: Vec<String> = cells.map(|cell| bare(&cell).to_string()).collect();
    let data = cells.iter().any(|c| !c.is_empty() && value(c, separator != ',').is_some());
    (!data && is_units(&cells)).then_some(cells)
}

/// A name with its unit behind it, where there is one and the name has none yet.
pub(super) fn with_unit(name: &str, unit: &str) -> String {
    let unit = bare(unit);
    if unit.is_empty() || name.ends_with([']', ')']) {
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
    !line.trim_ascii().is_empty() && !line.starts_with(b"#")
}

/// The wanted columns as numbers.
pub(super) fn read(path: &Path, layout: &Layout, names: &[String]) -> Result<DataFrame, IoError> {
    let schema: Schema = names.iter().map(|n| (n.as_str().into(), DataType::Float64)).collect();
    let fast = options(layout, false)
        .with_columns(Some(names.iter().map(|n| n.as_str().into()).collect()))
        .with_schema_overwrite(Some(Arc::new(schema)));
    if !layout.units
        && let Ok(frame) = finish(path, fast)
        && frame.columns().iter().all(|c| c.null_count() == 0)
    {
        return Ok(frame);
    }
    // slow but exact: spaces, blank lines, which row holds text that is no number
    if let Some(ragged) = ragged(path, layout)? {
        return Err(ragged);
    }
    let frame = finish(path, options(layout, true)).map_err(|e| format_error(path, "CSV", &e))?;
    by_cell(path, layout, &frame, names)
}

/// Every column, cells that are no numbers as NaN.
pub(super) fn all(path: &Path, layout: &Layout) -> Result<Vec<(String, Vec<f64>)>, IoError> {
    let comma = layout.separator != b',';
    let number = |cell: String| value(&cell, comma).unwrap_or(f64::NAN);
    let columns = layout.names.iter().zip(by_place(path, layout)?);
    Ok(columns.map(|(name, c)| (name.clone(), c.into_iter().map(number).collect())).collect())
}

/// The cells of every column as they stand, spaces around them left out.
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
        .with_skip_rows_after_header(usize::from(layout.units))
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
    let header = 1 + usize::from(layout(path)?.units);
    let rows = lines.filter(|(_, line)| is_row(line)).skip(header).enumerate();
    Ok(rows.map(|(row, (line, text))| (row + 1, line + 1, text)))
}

/// The line of a row of data.
pub(super) fn line_of(path: &Path, row: usize) -> Option<usize> {
    rows(path).ok()?.find(|(k, ..)| *k == row).map(|(_, line, _)| line)
}

/// The first row with more cells than the header has names; empty ones at the end do not count.
fn ragged(path: &Path, layout: &Layout) -> Result<Option<IoError>, IoError> {
    let expected = layout.names.len();
    for (row, line, text) in rows(path)? {
        if text.contains(&b'"') {
            continue; // a separator may stand inside quotes
        }
        let cells = text.split(|b| *b == layout.separator);
        let used = cells.enumerate().filter(|(_, cell)| !cell.trim_ascii().is_empty());
        let found = used.last().map_or(0, |(k, _)| k + 1);
        if found > expected {
            let file = shown(path);
            return Ok(Some(IoError::Ragged { file, row, line, found, expected }));
        }
    }
    Ok(None)
}

/// The wanted columns of a frame of text, cell by cell.
fn by_cell(
    path: &Path,
    layout: &Layout,
    frame: &DataFrame,
    names: &[String],
) -> Result<DataFrame, IoError> {
    let wrong = |e: PolarsError| format_error(path, "CSV", &e);
    // by place: the header may hold spaces around the names
    let place = |name: &String| layout.names.iter().position(|n| n == name).unwrap_or_default();
    let columns: Vec<&PolarsColumn> =
        names.iter().filter_map(|n| frame.select_at_idx(place(n))).collect();
    let texts = columns.iter().map(|c| c.str()).collect::<Result<Vec<_>, _>>().map_err(wrong)?;
    let all = frame.columns().iter().map(|c| c.str()).collect::<Result<Vec<_>, _>>();
    let all = all.map_err(wrong)?;
    let mut values = vec![Vec::with_capacity(frame.height()); texts.len()];
    let mut row = 0;
    for k in 0..frame.height() {
        if all.iter().all(|t| t.get(k).unwrap_or_default().trim().is_empty()) {
            continue; // a blank line
        }
        row += 1;
        for (j, text) in texts.iter().enumerate() {
            let cell = text.get(k).unwrap_or_default();
            let value = value(cell, layout.separator != b',');
            values[j].push(value.ok_or_else(|| {
                let line = line_of(path, row);
                IoError::not_a_number(path, row, line, &names[j], cell)
            })?);
        }
    }
    let height = values.first().map_or(0, Vec::len);
    let columns = names.iter().zip(values);
    let columns = columns.map(|(n, v)| Series::new(n.as_str().into(), v).into()).collect();
    DataFrame::new(height, columns).map_err(wrong)
}

/// Words for a value that is not there.
pub(super) const ABSENT: [&str; 6] = ["", "na", "n/a", "null", "none", "-"];

/// A cell of data as a number; NaN where it says that there is none.
pub(super) fn value(cell: &str, decimal_comma: bool) -> Option<f64> {
    let bare = cell.trim().trim_matches('"').trim().to_lowercase();
    if ABSENT.contains(&bare.as_str()) {
        return Some(f64::NAN);
    }
    number(cell, decimal_comma).or_else(|| date_time(&bare))
}

/// A date with time, or a time of day, in seconds: `2026-03-03T12:00:00.250Z`, `12:00:00.25`. Time zones
/// shift all rows alike and do not matter.
fn date_time(text: &str) -> Option<f64> {
    let (date, time) = match text.split_once(['t', ' ']) {
        Some((date, time)) => (Some(date), time),
        None => (None, text),
    };
    let clock = time.trim_end_matches('z').split(['+']).next().unwrap_or_default();
    let clock = if clock.matches('-').count() == 1 { clock.split('-').next()? } else { clock };
    let mut parts = clock.split(':');
    let mut part = || parts.next()?.replacen(',', ".", 1).parse::<f64>().ok();
    let (hours, minutes, seconds) = (part()?, part()?, part().unwrap_or(0.0));
    let days = match date {
        None => 0.0,
        Some(date) => {
            let mut parts = date.split(['-', '/', '.']).map(|p| p.parse::<i64>().ok());
            let (a, b, c) = (parts.next()??, parts.next()??, parts.next()??);
            // the year first, as ISO 8601 has it, or last
            let (year, month, day) = if a > 31 { (a, b, c) } else { (c, b, a) };
            days_since_1970(year, month, day)? as f64
        }
    };
    Some(86400.0 * days + 3600.0 * hours + 60.0 * minutes + seconds)
}

/// Days of the Gregorian calendar. Source: H. Hinnant, chrono-compatible low-level date algorithms.
fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1900..3000).contains(&year) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let (era, month) = (year.div_euclid(400), (month + 9) % 12);
    let in_era = year - 400 * era;
    let in_year = (153 * month + 2) / 5 + day - 1;
    Some(146_097 * era + 365 * in_era + in_era / 4 - in_era / 100 + in_year - 719_468)
}

/// A cell as a number; a comma may be the decimal sign where it does not separate columns.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim().trim_matches('"').trim();
    let parsed = cell.parse().ok();
    if parsed.is_none() && decimal_comma { cell.replacen(',', ".", 1).parse().ok() } else { parsed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_times_of_day_are_seconds() {
        // python: datetime(2026, 3, 3, 12, 0, 0, 250000, timezone.utc).timestamp()
        let expected = 1_772_539_200.25;
        for text in [
            "2026-03-03T12:00:00.250Z",
            "2026-03-03 12:00:00.25",
            "03.03.2026 12:00:00,250",
            "2026-03-03T12:00:00.25+01:00",
        ] {
            assert_eq!(value(text, true), Some(expected), "{text}");
        }
        assert_eq!(value("12:00:01.5", false), Some(43201.5));
        assert!(value("", false).unwrap().is_nan() && value("null", false).unwrap().is_nan());
        assert_eq!(
            [value("broken", true), value("2026-13-03 00:00", true), value("1:x", true)],
            [None; 3]
        );
    }
}
