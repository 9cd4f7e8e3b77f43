//! Text logs that are not plain CSV: other encodings, text above the table, columns separated by spaces,
//! a header in a comment or none, the time of a serial monitor before each line, a record of `name=value`, of JSON or
//! of words and numbers in every line, lines of several kinds, messages of YAML.
//!
//! The table is the first run of lines that have the same number of cells, most of them numbers. Its
//! names are in the line above, possibly followed by a line of units or preceded by a comment sign (as `savetxt` of
//! numpy writes them); without names they are `column1`, `column2`, ….

mod attributes;
mod blocks;
mod can;
mod dataflash;
mod decode;
mod described;
mod header;
mod influx;
mod json;
mod keyed;
mod labelled;
mod lines;
mod octave;
mod quoted;
mod record;
mod stamp;
mod tag;
mod teleplot;
mod yaml;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use self::decode::decoded;
use self::header::{has_bare_subscripts, names};
pub(super) use self::json::json;
use self::lines::{Columns, SEPARATORS, cells, is_blank, is_comment, made_up};
use self::stamp::CLOCK;
use super::IoError;
use super::csv::{Evidence, Style, may_be_keyed, quantity, unfolded, value};
use super::error::shown;
use super::format::Format;
use super::second_header;
use super::uneven::{Cells, Row};

/// Number of bytes within which the table, with everything above it, must begin.
const HEAD: u64 = 1 << 16;
/// Number of consecutive rows with equally many cells that make a table; a preamble is less regular.
const ROWS: usize = 5;
/// Number of rows from which it is determined whether a table has a row for each motor.
const LOOKED_AT: usize = 64;
/// Those of plain CSV.
const PLAIN: [char; 3] = [';', '\t', ','];

/// Whether the first lines have a form, and the columns of a text that has it.
type Form = (fn(&[&str]) -> bool, fn(&str) -> Columns);

/// Forms of text that are known by their lines, before any other.
const FORMS: [Form; 7] = [
    (yaml::is_one, yaml::columns),
    (blocks::is_one, blocks::columns),
    (octave::is_one, octave::columns),
    (dataflash::is_one, dataflash::columns),
    (influx::is_one, influx::columns),
    (can::is_one, can::columns),
    (teleplot::is_one, teleplot::columns),
];

/// Error message for raw CAN frames.
const FRAMES: &str = "its lines are raw frames of a CAN bus: decode them with the database of the \
                      motor controllers (cantools decode robot.dbc < candump.log), or log the decoded values";

/// Position of a table among the lines of a text.
#[derive(Debug)]
struct Table {
    separator: char,
    /// Line of the names; `None` if the names are generated.
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
    Ok(found(path)?.map(|found| found.columns))
}

/// The columns of a text, and the cells of the rows of a table.
struct Found {
    columns: Columns,
    cells: Cells,
}

impl From<Columns> for Found {
    fn from(columns: Columns) -> Self {
        Self { columns, cells: Cells::default() }
    }
}

/// The number of cells of the rows of a text that is no plain CSV; none of a form without a table.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn cells_of(path: &Path) -> Result<Option<Cells>, IoError> {
    Ok(found(path)?.map(|found| found.cells))
}

fn found(path: &Path) -> Result<Option<Found>, IoError> {
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
    if can::is_raw(&lines) {
        let (file, format, reason) = (shown(path), "recording".into(), FRAMES.into());
        return Err(IoError::Format { file, format, reason });
    }
    if let Some((_, columns)) = FORMS.iter().find(|(is_one, _)| is_one(&lines)) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(columns(&text).into()));
    }
    // before tables: the labels of `l: 134 r: -5` are cells between spaces too
    if record::is_one(&lines) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(keyed::columns(text.lines()).into()));
    }
    if let Some(tag) = tag::of(&lines) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        let text = tag::without(&text, &tag);
        let table = table(&text.lines().collect::<Vec<_>>());
        return Ok(table.map(|table| table.columns(&text, &Cells::default()).into()));
    }
    if quoted::is_one(&lines) {
        let text = quoted::without(&decoded(&bytes(u64::MAX)?).0);
        let table = stamped_table(&text.lines().collect::<Vec<_>>());
        return table.map(|table| table.found(path, &text)).transpose();
    }
    let table = stamped_table(&lines);
    if labelled::is_one(&lines, table.as_ref()) {
        let (text, _) = decoded(&bytes(u64::MAX)?);
        return Ok(Some(labelled::columns(text.lines()).into()));
    }
    let Some(table) = table else { return Ok(None) };
    if is_utf8 && is_plain(&table, &lines) {
        return Ok(None);
    }
    let (text, _) = decoded(&bytes(u64::MAX)?);
    table.found(path, &text).map(Some)
}

/// The encoding of a text that is not UTF-8, by the beginning of the file. `None` for UTF-8, and for a file that cannot
/// be read or is no text.
#[must_use]
pub fn foreign_encoding(path: &Path) -> Option<&'static str> {
    if !matches!(Format::of(path), Ok(Format::Csv)) {
        return None;
    }
    let mut head = Vec::new();
    File::open(path).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
    decode::foreign(&head)
}

/// Whether the names of a file are generated, because it has no header.
pub(super) fn has_no_header(names: &[String]) -> bool {
    names.iter().enumerate().all(|(k, name)| *name == made_up(k))
}

impl Table {
    /// The columns of a text with this table, without the rows that are damaged.
    ///
    /// # Errors
    /// Too many rows with more cells than the others, and a second header with another order of the columns.
    fn found(&self, path: &Path, text: &str) -> Result<Found, IoError> {
        for row in self.rows(text) {
            let row = Row { text: self.bare(row.text), ..row };
            let cells = || cells(row.text, self.separator).into_iter().skip(self.before).collect();
            second_header::check(path, &self.names, &row, cells)?;
        }
        let cells = self.counted(text);
        cells.check(path)?;
        Ok(Found { columns: self.columns(text, &cells), cells })
    }

    fn columns(&self, text: &str, cells: &Cells) -> Columns {
        let style = self.style(text);
        let keyed = self.keyed(text, style);
        header::completed(keyed.unwrap_or_else(|| self.numbers(text, style, cells)), text)
    }

    /// The rows of the table: number and line of each from 1, and its text.
    fn rows<'a>(&self, text: &'a str) -> impl Iterator<Item = Row<'a>> {
        let lines = text.lines().enumerate().skip(self.first);
        let held = lines.filter(|(_, line)| !is_blank(line) && !is_comment(line)).enumerate();
        held.map(|(row, (line, text))| Row { number: row + 1, line: line + 1, text })
    }

    /// The number of cells of the rows; lines of words are none. What stands behind the last column is a cell of a
    /// damaged row if it is a number, else a comment.
    fn counted(&self, text: &str) -> Cells {
        let mut out = Cells::new(self.names.len(), self.header.is_some());
        for row in self.rows(text) {
            let cells = cells(self.bare(row.text), self.separator);
            let is_number =
                |cell: &String| value(cell, Style::of(self.separator)).is_some_and(f64::is_finite);
            if is_data(&cells, self.separator) {
                let is_held = |cell: &String| is_number(cell) || self.parted(cell) > 0;
                let inner: usize = cells.iter().map(|cell| self.parted(cell)).sum();
                let used = cells.iter().rposition(is_held).map_or(0, |k| k + 1) + inner;
                let own = |count: usize| count.saturating_sub(self.before);
                out.see(&row, own(cells.len() + inner), own(used));
            }
        }
        out
    }

    /// How the numbers of all rows are written.
    fn style(&self, text: &str) -> Style {
        let mut evidence = Evidence::default();
        for line in text.lines().skip(self.first).filter(|line| !is_comment(line)) {
            let cells = cells(self.bare(line), self.separator);
            cells.iter().enumerate().for_each(|(k, cell)| evidence.see(k, cell));
        }
        evidence.style(self.separator)
    }

    /// Number of other separators between numbers in a cell: `5\t-0.06` in a table of commas is two cells.
    fn parted(&self, cell: &str) -> usize {
        let is_number = |part: &str| value(part, Style::Either).is_some_and(f64::is_finite);
        let parts = || cell.split(['\t', ';', '|']);
        if parts().all(is_number) { parts().count() - 1 } else { 0 }
    }

    /// The columns of rows of several motors in turn.
    fn keyed(&self, text: &str, style: Style) -> Option<Columns> {
        let rows = || {
            let held =
                text.lines().skip(self.first).filter(|line| !is_blank(line) && !is_comment(line));
            held.filter(|_| self.read.is_none()).map(|line| cells(line, self.separator))
        };
        let cell =
            |row: &Vec<String>, k: usize| row.get(self.before + k).cloned().unwrap_or_default();
        let places = 0..self.names.len();
        let head: Vec<Vec<String>> = rows()
            .take(LOOKED_AT)
            .map(|row| places.clone().map(|k| cell(&row, k)).collect())
            .collect();
        if head.is_empty() || !may_be_keyed(&self.names, &head, style) {
            return None;
        }
        let mut texts: Vec<Vec<String>> = vec![vec![]; self.names.len()];
        for row in rows() {
            texts.iter_mut().enumerate().for_each(|(k, column)| column.push(cell(&row, k)));
        }
        unfolded(&self.names, &texts, style)
    }

    fn numbers(&self, text: &str, style: Style, counted: &Cells) -> Columns {
        let mut columns: Columns = self.names.iter().map(|n| (n.clone(), vec![])).collect();
        let mut clock = vec![];
        let left_out = counted.left_out();
        for row in self.rows(text) {
            let stamped = self.read.and_then(|read| read(row.text));
            clock.push(stamped.map_or(f64::NAN, |(time, _)| time));
            let line = stamped.map_or(row.text, |(_, rest)| rest);
            let is_left_out = left_out.contains(&row.number);
            let cells = if is_left_out { vec![] } else { cells(line, self.separator) };
            for (k, (_, values)) in columns.iter_mut().enumerate() {
                let cell = cells.get(self.before + k).map_or("", String::as_str);
                values.push(value(cell, style).unwrap_or(f64::NAN));
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
/// comment of `#`, and no separator in them.
fn is_plain(table: &Table, lines: &[&str]) -> bool {
    let first = lines.iter().position(|line| !is_blank(line) && !line.starts_with('#'));
    PLAIN.contains(&table.separator)
        && table.read.is_none()
        && first.is_some_and(|k| !has_bare_subscripts(lines[k], table.separator))
        && table.header == first
        && table.before == 0
}

/// Whether at least half of the cells that hold something hold numbers.
fn is_data(cells: &[String], separator: char) -> bool {
    if cells.len() < 2 {
        return false;
    }
    let held = || cells.iter().filter(|c| !c.trim().is_empty());
    let numbers = held().filter(|c| value(c, Style::of(separator)).is_some()).count();
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
    let head =
        rows[0].first().filter(|cell| value(cell, Style::of(separator)).is_none_or(f64::is_nan));
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

#[cfg(test)]
mod tests;
