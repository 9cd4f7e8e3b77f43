//! Logs of text that are no plain CSV: another encoding, words above the table, columns parted by spaces,
//! a header in a comment or none, the time of a serial monitor before each line, a record of `name=value`, of JSON or
//! of words and numbers in every line, lines of several kinds, messages of YAML.
//!
//! The table is the first run of lines that have the same number of cells, most of them numbers. Its
//! names stand in the line above, if need be behind a line of units or a comment sign (as `savetxt` of
//! numpy writes them); without any they are `column1`, `column2`, ….

mod decode;
mod labelled;
mod record;
mod stamp;
mod yaml;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use self::decode::decoded;
use self::stamp::CLOCK;
use super::IoError;
use super::csv::{ABSENT, is_units, split, value, with_unit};

/// Columns with their names; a cell without a number is NaN.
type Columns = Vec<(String, Vec<f64>)>;

/// The table, with whatever stands above it, begins within this many bytes.
const HEAD: u64 = 1 << 16;
/// Rows of the same number of cells that make a table: a preamble repeats itself less.
const ROWS: usize = 5;
/// Lines above the rows among which the names are looked for.
const ABOVE: usize = 3;
/// What may part columns; those that occur in numbers and words come last.
const SEPARATORS: [char; 5] = [';', '\t', ',', '|', ' '];
/// Those of plain CSV.
const PLAIN: [char; 3] = [';', '\t', ','];

/// Where a table stands among the lines of a text.
#[derive(Debug)]
struct Table {
    separator: char,
    /// Line of the names, unless they are made up.
    header: Option<usize>,
    names: Vec<String>,
    /// Cells before the first that has a name.
    before: usize,
    /// Line of the first row.
    first: usize,
    /// Parts the time before each line from the line, where there is one.
    read: Option<Stamp>,
}

/// Parts a time before a line from the line.
type Stamp = fn(&str) -> Option<(f64, &str)>;

/// The columns of a text that is no plain CSV; `None` for one that is, or in which no table is found: its
/// reader says what is wrong with it.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn read(path: &Path) -> Result<Option<Columns>, IoError> {
    let bytes = |limit: u64| -> Result<Vec<u8>, IoError> {
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
        file.take(limit).read_to_end(&mut bytes).map_err(|e| IoError::system(path, &e))?;
        Ok(bytes)
    };
    let head = bytes(HEAD)?;
    let is_cut = head.len() as u64 == HEAD;
    let (text, is_utf8) = decoded(&head);
    let mut lines: Vec<&str> = text.lines().collect();
    if is_cut {
        lines.pop();
    }
    if yaml::is_one(&lines) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(yaml::columns(text.lines())));
    }
    // before tables: the labels of `l: 134 r: -5` are cells between spaces too
    if record::is_one(&lines) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(record::columns(text.lines())));
    }
    let table = stamped_table(&lines);
    if labelled::is_one(&lines, table.as_ref()) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(labelled::columns(text.lines())));
    }
    let Some(table) = table else { return Ok(None) };
    if is_utf8 && is_plain(&table, &lines) {
        return Ok(None);
    }
    let (text, _) = decoded(&bytes(u64::MAX)?);
    Ok(Some(table.columns(text.lines())))
}

/// The columns of a JSON file that holds columns or records, or one record in every line; `None` for any other,
/// whose reader says what is wrong with it.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn json(path: &Path) -> Result<Option<Columns>, IoError> {
    let bytes = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    if let Ok(value) = serde_json::from_slice(&bytes) {
        return Ok(record::of_json(&value));
    }
    let (text, _) = decoded(&bytes);
    let lines: Vec<&str> = text.lines().collect();
    Ok(record::is_one(&lines).then(|| record::columns(text.lines())))
}

/// The name of a column without one.
fn made_up(k: usize) -> String {
    format!("column{}", k + 1)
}

/// Whether the names of a file are made up, because it has no header.
pub(super) fn has_no_header(names: &[String]) -> bool {
    names.iter().enumerate().all(|(k, name)| *name == made_up(k))
}

impl Table {
    fn columns<'a>(&self, lines: impl Iterator<Item = &'a str>) -> Columns {
        let mut columns: Columns = self.names.iter().map(|n| (n.clone(), vec![])).collect();
        let mut clock = vec![];
        for line in lines.skip(self.first).filter(|line| !is_blank(line) && !is_comment(line)) {
            let stamped = self.read.and_then(|read| read(line));
            clock.push(stamped.map_or(f64::NAN, |(time, _)| time));
            let line = stamped.map_or(line, |(_, rest)| rest);
            let cells = cells(line, self.separator);
            for (k, (_, values)) in columns.iter_mut().enumerate() {
                let cell = cells.get(self.before + k).map_or("", String::as_str);
                values.push(value(cell, self.separator != ',').unwrap_or(f64::NAN));
            }
        }
        if self.read.is_some() {
            columns.insert(0, (CLOCK.into(), clock));
        }
        columns
    }

    /// A line without the time before it.
    fn bare<'a>(&self, line: &'a str) -> &'a str {
        self.read.and_then(|read| read(line)).map_or(line, |(_, rest)| rest)
    }
}

/// Whether the reader of plain CSV finds the same: the names in the first line that is neither blank nor a
/// comment of `#`.
fn is_plain(table: &Table, lines: &[&str]) -> bool {
    let first = lines.iter().position(|line| !is_blank(line) && !line.starts_with('#'));
    PLAIN.contains(&table.separator)
        && table.read.is_none()
        && first.is_some()
        && table.header == first
        && table.before == 0
}

fn is_blank(line: &str) -> bool {
    line.trim().is_empty()
}

/// Lines that loggers and mathematics programs write between rows of data.
fn is_comment(line: &str) -> bool {
    ["#", "%", "//"].iter().any(|sign| line.trim_start().starts_with(sign))
}

/// The cells of a line; several spaces part two columns as one does.
fn cells(line: &str, separator: char) -> Vec<String> {
    if separator == ' ' {
        line.split_whitespace().map(Into::into).collect()
    } else {
        split(line, separator)
    }
}

/// Whether at least half of the cells that hold something hold numbers.
fn is_data(cells: &[String], separator: char) -> bool {
    if cells.len() < 2 {
        return false;
    }
    let held = || cells.iter().filter(|c| !c.trim().is_empty());
    let numbers = held().filter(|c| value(c, separator != ',').is_some()).count();
    numbers > 0 && 2 * numbers >= held().count()
}

/// The table of a text in which a time may stand before each line. An arrow stands in no cell; brackets do, so that a
/// header goes before them.
fn stamped_table(lines: &[&str]) -> Option<Table> {
    let behind = |read: Stamp| {
        let rest: Vec<&str> =
            lines.iter().map(|line| read(line).map_or(*line, |(_, rest)| rest)).collect();
        Some(Table { read: Some(read), ..table(&rest)? })
    };
    if stamp::is_on(lines, stamp::before_arrow) {
        return behind(stamp::before_arrow);
    }
    let plain = table(lines);
    if plain.as_ref().is_none_or(|t| t.header.is_none()) && stamp::is_on(lines, stamp::marked) {
        return behind(stamp::marked);
    }
    plain
}

fn table(lines: &[&str]) -> Option<Table> {
    SEPARATORS.into_iter().find_map(|separator| {
        let first = first_row(lines, separator)?;
        let count = cells(lines[first], separator).len();
        let found = std::iter::once((0, 0))
            .chain(unnamed(lines, first, separator))
            .map(|(before, behind)| {
                (before, names(lines, first, separator, count - before - behind))
            })
            .find(|(_, (header, _))| header.is_some());
        let (before, (header, names)) =
            found.unwrap_or_else(|| (0, (None, (0..count).map(made_up).collect())));
        Some(Table { separator, header, names, before, first, read: None })
    })
}

/// Cells at the beginning and at the end of the rows that may have no name: one with the same word in every row, by
/// which a console tells lines apart, and an empty one behind a separator at the end.
fn unnamed(lines: &[&str], first: usize, separator: char) -> Vec<(usize, usize)> {
    let rows: Vec<Vec<String>> = lines[first..]
        .iter()
        .filter(|line| !is_blank(line) && !is_comment(line))
        .map(|line| cells(line, separator))
        .collect();
    let rows: Vec<&Vec<String>> = rows.iter().filter(|row| row.len() == rows[0].len()).collect();
    let head = rows[0].first().filter(|cell| value(cell, separator != ',').is_none_or(f64::is_nan));
    let before = usize::from(head.is_some() && rows.iter().all(|row| row.first() == head));
    let is_empty = |row: &&Vec<String>| row.len() > 2 && row.last().is_some_and(String::is_empty);
    let behind = usize::from(rows.iter().all(is_empty));
    let ways = [(0, behind), (before, 0), (before, behind)];
    ways.into_iter().filter(|way| *way != (0, 0)).collect()
}

/// The first of several rows of data with the same number of cells.
fn first_row(lines: &[&str], separator: char) -> Option<usize> {
    let rows: Vec<(usize, Option<usize>)> = lines
        .iter()
        .enumerate()
        .filter(|(_, line)| !is_blank(line) && !is_comment(line))
        .map(|(k, line)| {
            let cells = cells(line, separator);
            (k, is_data(&cells, separator).then_some(cells.len()))
        })
        .collect();
    let run = rows.windows(ROWS).find(|w| w.iter().all(|r| r.1.is_some() && r.1 == w[0].1))?;
    Some(run[0].0)
}

/// The names of so many columns above the first row, and the line that they stand in; made-up ones without any.
/// Separators at the end of that line name nothing.
fn names(
    lines: &[&str],
    first: usize,
    separator: char,
    count: usize,
) -> (Option<usize>, Vec<String>) {
    let no_number = |cells: &[String]| {
        let named =
            |c: &String| ABSENT.contains(&c.as_str()) || value(c, separator != ',').is_none();
        cells.len() == count && cells.iter().all(named) && cells.iter().any(|c| !c.is_empty())
    };
    let named_cells = |line: &str, separator: char| {
        let mut cells = cells(line, separator);
        while cells.len() > count && cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        cells
    };
    // the first line of all, whatever stands between: rows may be broken
    let top = (0..first).find(|k| !is_blank(lines[*k]) && !lines[*k].starts_with('#'));
    if let Some(k) = top {
        let cells = named_cells(lines[k], separator);
        if no_number(&cells) && cells.iter().all(|c| !c.is_empty()) {
            return (Some(k), cells);
        }
    }
    let mut units: Option<Vec<String>> = None;
    let above = (0..first).rev().filter(|k| !is_blank(lines[*k])).take(ABOVE);
    for k in above {
        let line = lines[k].trim_start_matches(['#', '%', '/', ' ']);
        let ways: &[char] = if is_comment(lines[k]) { &SEPARATORS } else { &[separator] };
        let Some(cells) = ways.iter().map(|s| named_cells(line, *s)).find(|c| no_number(c)) else {
            continue;
        };
        if units.is_none() && is_units(&cells) {
            units = Some(cells);
            continue;
        }
        // or somewhere in the preamble, behind a word that says so
        let of_line = |line: &&str| Some(self::cells(line, separator)).filter(|c| c.len() == count);
        let preamble = || lines[..k].iter().rev().filter_map(of_line).find(|c| is_units(c));
        let units = units.clone().or_else(preamble).unwrap_or_default();
        let is_one = |cell: &&String| is_units(std::slice::from_ref(*cell));
        let unit = |k: usize| units.get(k).filter(is_one).map_or("", String::as_str);
        let name = |(k, cell): (usize, &String)| {
            if cell.is_empty() { made_up(k) } else { with_unit(cell, unit(k)) }
        };
        return (Some(k), cells.iter().enumerate().map(name).collect());
    }
    (None, (0..count).map(made_up).collect())
}

#[cfg(test)]
mod tests;
