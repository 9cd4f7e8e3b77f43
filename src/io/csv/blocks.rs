//! A table of text block by block, in memory of one block.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use polars::prelude::DataFrame;

use super::plain::front;
use super::uneven::used;
use super::{Layout, Style, is_row, split};
use crate::io::IoError;
use crate::io::error::shown;
use crate::io::signals::frame;
use crate::io::uneven::beginning;

/// Whether a file has more than `limit` lines.
pub(in crate::io) fn has_more_lines(path: &Path, limit: usize) -> Result<bool, IoError> {
    let wrong = |e: std::io::Error| IoError::system(path, &e);
    let mut file = File::open(path).map_err(wrong)?;
    if file.metadata().map_err(wrong)?.len() <= limit as u64 {
        return Ok(false);
    }
    let (mut bytes, mut lines) = (vec![0; 1 << 16], 0);
    loop {
        let count = file.read(&mut bytes).map_err(wrong)?;
        lines += bytes[..count].iter().filter(|b| **b == b'\n').count();
        if count == 0 || lines > limit {
            return Ok(lines > limit);
        }
    }
}

/// Reads the required columns block by block.
pub(in crate::io) struct Blocks<'a> {
    path: &'a Path,
    layout: &'a Layout,
    /// Names and indices of the required columns.
    wanted: Vec<(&'a str, usize)>,
    /// Whether a cell of digits with a point can only be that number.
    is_plain: bool,
    /// The required column in each place of a row.
    columns: Vec<Option<usize>>,
    lines: BufReader<File>,
    text: Vec<u8>,
    /// Number of lines read.
    line: usize,
    /// Number of header lines still to be read: names, and units if they have a line.
    header: usize,
    /// Number of rows read.
    row: usize,
}

impl<'a> Blocks<'a> {
    pub(in crate::io) fn new(
        path: &'a Path,
        layout: &'a Layout,
        names: &'a [String],
    ) -> Result<Self, IoError> {
        let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
        let place = |n: &String| layout.names.iter().position(|h| h == n).unwrap_or_default();
        let wanted: Vec<(&str, usize)> = names.iter().map(|n| (n.as_str(), place(n))).collect();
        let column = |k: usize| wanted.iter().position(|(_, place)| *place == k);
        let columns: Vec<Option<usize>> = (0..layout.names.len()).map(column).collect();
        let lines = BufReader::with_capacity(1 << 16, file);
        let header = 1 + layout.units;
        let is_one_each = columns.iter().flatten().count() == wanted.len();
        let is_plain =
            is_one_each && layout.directions.is_empty() && layout.style != Style::PointedThousands;
        let text = vec![];
        Ok(Self { path, layout, wanted, is_plain, columns, lines, text, line: 0, header, row: 0 })
    }

    /// The next rows, at most `rows`; empty at the end.
    pub(in crate::io) fn next_rows(&mut self, rows: usize) -> Result<DataFrame, IoError> {
        let mut values = vec![Vec::with_capacity(rows); self.wanted.len()];
        while values.first().is_some_and(|v| v.len() < rows) {
            if self.take_plain(&mut values)? {
                continue;
            }
            if !self.next_line()? {
                break;
            }
            self.parse(&mut values)?;
        }
        frame(self.path, self.wanted.iter().map(|(name, _)| *name).zip(values))
    }

    /// Puts the next row of data into `text`.
    fn next_line(&mut self) -> Result<bool, IoError> {
        loop {
            self.text.clear();
            let read = self.lines.read_until(b'\n', &mut self.text);
            if read.map_err(|e| IoError::system(self.path, &e))? == 0 {
                return Ok(false);
            }
            self.line += 1;
            let separator = self.layout.separator;
            let blank = |b: &u8| b.is_ascii_whitespace() || *b == separator;
            if !is_row(&self.text) {
                continue;
            }
            if self.header > 0 {
                self.header -= 1;
            } else if !self.text.iter().all(blank) {
                self.row += 1;
                return Ok(true);
            }
        }
    }

    /// Takes the next row, if it has one plain number in each of the required columns and ends within the buffer:
    /// parsed where it was read, as almost all rows are. `false` for any other row, which is left.
    fn take_plain(&mut self, values: &mut [Vec<f64>]) -> Result<bool, IoError> {
        if !self.is_plain || self.header > 0 {
            return Ok(false);
        }
        let buffer = self.lines.fill_buf().map_err(|e| IoError::system(self.path, &e))?;
        let row = values.first().map_or(0, Vec::len);
        let Some(rest) = plain_row(buffer, self.layout.separator, &self.columns, values) else {
            values.iter_mut().for_each(|column| column.truncate(row));
            return Ok(false);
        };
        let length = buffer.len() - rest.len();
        self.lines.consume(length);
        self.line += 1;
        self.row += 1;
        Ok(true)
    }

    fn parse(&self, values: &mut [Vec<f64>]) -> Result<(), IoError> {
        let separator = self.layout.separator;
        let text = String::from_utf8_lossy(&self.text);
        let quoted = text.contains('"');
        let cells: Vec<String> =
            if quoted { split(&text, char::from(separator)) } else { Vec::new() };
        let plain: Vec<&str> = if quoted {
            cells.iter().map(String::as_str).collect()
        } else {
            text.split(char::from(separator)).collect()
        };
        let (row, line) = (self.row, self.line);
        let used = used(plain.iter().copied());
        let expected = self.layout.names.len();
        if used > expected {
            return Err(IoError::Ragged {
                file: shown(self.path),
                row,
                line,
                found: used,
                expected,
                text: beginning(&text),
                has_header: true,
                most: true,
            });
        }
        for ((name, place), column) in self.wanted.iter().zip(values) {
            let cell = plain.get(*place).copied().unwrap_or_default();
            let value = self.layout.value(*place, cell);
            let wrong = || IoError::not_a_number(self.path, row, Some(line), name, cell.trim());
            column.push(value.ok_or_else(wrong)?);
        }
        Ok(())
    }
}

/// Adds the plain numbers of the required `columns` of the row at the front of `text` to their `values`, and returns
/// what follows the row. `None` for a row of another kind, a comment among them, and for one without its end.
#[inline]
fn plain_row<'t>(
    text: &'t [u8],
    separator: u8,
    columns: &[Option<usize>],
    values: &mut [Vec<f64>],
) -> Option<&'t [u8]> {
    let mut text = without_blanks(text, separator);
    let last = columns.len().checked_sub(1).filter(|_| text.first() != Some(&b'#'))?;
    for (place, column) in columns.iter().enumerate() {
        let rest = match column {
            Some(column) => {
                let (value, rest) = front(without_blanks(text, separator))?;
                values[*column].push(value);
                without_blanks(rest, separator)
            }
            // a quoted cell may contain separators
            None => {
                &text[text.iter().position(|b| matches!(b, b'\n' | b'"') || *b == separator)?..]
            }
        };
        match rest {
            [b'\n', rest @ ..] if place == last => return Some(rest),
            [byte, rest @ ..] if *byte == separator && place < last => text = rest,
            _ => return None,
        }
    }
    None
}

/// `text` without the blanks at its front that separate neither cells nor rows.
#[inline]
fn without_blanks(mut text: &[u8], separator: u8) -> &[u8] {
    while let [byte, rest @ ..] = text
        && byte.is_ascii_whitespace()
        && *byte != separator
        && *byte != b'\n'
    {
        text = rest;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::plain_row;

    #[test]
    fn a_plain_row_is_taken_up_to_its_end_and_any_other_is_left() {
        let columns = [Some(1), None, Some(0)];
        let taken = |text: &str| {
            let mut values = vec![vec![], vec![]];
            let rest = plain_row(text.as_bytes(), b',', &columns, &mut values)?;
            Some((values[0][0], values[1][0], rest.len()))
        };
        assert_eq!(taken("1.5,words,-2\n3,4,5\n"), Some((-2.0, 1.5, 6)));
        assert_eq!(taken(" 1.5 ,, 2 \r\n"), Some((2.0, 1.5, 0)));
        let others = [
            "1,2,3",
            "1,2\n3,4,5\n",
            "1,2,3,4\n",
            "1,\"2,3\",4\n",
            "# 1,2,3\n",
            "1,2,\n",
            "\n1,2,3\n",
            "1,2,3e5\n",
            ",,\n",
        ];
        for text in others {
            assert_eq!(taken(text), None, "{text}");
        }
        // a comment whose first column is not required
        let mut values = vec![vec![]];
        assert_eq!(plain_row(b"# 1,2\n", b',', &[None, Some(0)], &mut values), None);
    }
}
