//! Number formats of a text: the decimal sign and the thousands separator.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use super::bare::bare;
use super::{Layout, is_row, split};
use crate::io::IoError;

/// How the numbers of a text are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) enum Style {
    /// Decimal points; a comma is not part of a number.
    Point,
    /// Decimal points or commas; no thousands separators.
    Either,
    /// Decimal commas, and points between thousands: `1.224,9`.
    PointedThousands,
    /// Decimal points, and commas between thousands: `1,224.9`.
    CommaThousands,
}

/// Thousands separators that are not decimal signs: apostrophes and non-breaking spaces.
const PARTED: [char; 4] = ['\'', '\u{2019}', '\u{a0}', '\u{202f}'];

impl Style {
    /// The formats that a column separator allows: with commas between columns, a comma is not a decimal
    /// sign.
    pub(in crate::io) fn of(separator: char) -> Self {
        if separator == ',' { Self::Point } else { Self::Either }
    }

    /// A cell without spaces around it as a number.
    pub(super) fn number(self, cell: &str) -> Option<f64> {
        let bare = match PARTED.into_iter().find(|sign| cell.contains(*sign)) {
            Some(sign) => {
                let is_grouped = [',', '.'].iter().any(|decimal| is_grouped(cell, sign, *decimal));
                &is_grouped.then(|| cell.replace(sign, ""))?
            }
            None => cell,
        };
        match self {
            Self::Point => bare.parse().ok(),
            Self::Either => bare.parse().ok().or_else(|| bare.replacen(',', ".", 1).parse().ok()),
            Self::PointedThousands => {
                let is_right = !bare.contains('.') || is_grouped(bare, '.', ',');
                is_right.then(|| bare.replace('.', "").replacen(',', ".", 1).parse().ok())?
            }
            Self::CommaThousands => {
                let is_right = !bare.contains(',') || is_grouped(bare, ',', '.');
                is_right.then(|| bare.replace(',', "").parse().ok())?
            }
        }
    }
}

/// Whether a number has that sign between thousands: one to three digits, the first no zero, and groups of three.
fn is_grouped(text: &str, sign: char, decimal: char) -> bool {
    let text = text.trim_start_matches(['+', '-']);
    let (whole, part) = text.split_once(decimal).unwrap_or((text, ""));
    let are_digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    let mut groups = whole.split(sign);
    let first = groups.next().unwrap_or_default();
    let mut count = 0;
    let others = groups.all(|group| {
        count += 1;
        group.len() == 3 && are_digits(group)
    });
    let is_first = (1..=3).contains(&first.len()) && are_digits(first) && !first.starts_with('0');
    is_first && others && count > 0 && are_digits(part)
}

/// Number formats observed in a column.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Cells that are grouped, for certain or perhaps: `1.000` may be one.
    grouped: usize,
    /// Whole numbers of up to three digits.
    short: usize,
    /// Number of numbers with more digits than a group and no separator.
    long: usize,
}

/// Evidence for the number format of a text.
#[derive(Clone, Debug, Default)]
pub(in crate::io) struct Evidence {
    /// Cells whose point or comma can only be the decimal sign.
    points: usize,
    commas: usize,
    /// Cells with groups of thousands for certain, by the sign between them: point, comma.
    groups: [usize; 2],
    /// Cells that may have one: `1.000`, `1,000`.
    perhaps: [usize; 2],
    columns: Vec<Seen>,
}

impl Evidence {
    /// Adds the cell of a column; other text is ignored.
    pub(in crate::io) fn see(&mut self, place: usize, cell: &str) {
        let cell = bare(cell);
        let is_part = |b: u8| b.is_ascii_digit() || b"+-.,eE".contains(&b);
        if !cell.bytes().all(is_part) || !cell.bytes().any(|b| b.is_ascii_digit()) {
            return;
        }
        if self.columns.len() <= place {
            self.columns.resize(place + 1, Seen::default());
        }
        let column = &mut self.columns[place];
        let [points, commas] = ['.', ','].map(|sign| cell.matches(sign).count());
        let grouped =
            [('.', ','), (',', '.')].map(|(sign, decimal)| is_grouped(cell, sign, decimal));
        match (grouped, points, commas) {
            ([true, _], 1, 0) => self.perhaps[0] += 1,
            ([true, _], ..) => self.groups[0] += 1,
            ([_, true], 0, 1) => self.perhaps[1] += 1,
            ([_, true], ..) => self.groups[1] += 1,
            (_, 1, 0) => self.points += 1,
            (_, 0, 1) => self.commas += 1,
            _ => {}
        }
        let whole = cell.trim_start_matches(['+', '-']);
        let digits = whole.find(|c: char| !c.is_ascii_digit()).unwrap_or(whole.len());
        column.grouped += usize::from(grouped != [false; 2]);
        column.short += usize::from(digits == whole.len() && digits <= 3);
        column.long += usize::from(digits > 3);
    }

    /// Whether further cells cannot change the result.
    fn is_settled(&self) -> bool {
        self.points > 0 && self.commas > 0
    }

    /// How the numbers are written, of a text with that separator of columns.
    pub(in crate::io) fn style(&self, separator: char) -> Style {
        // a column that groups its thousands groups all of them
        let is_refuted = self.columns.iter().any(|c| c.grouped > 0 && c.long > 0);
        let is_mixed = self.columns.iter().any(|c| c.grouped > 0 && c.short > 0);
        let of = |sign: usize| self.groups[sign] + self.perhaps[sign] > 0;
        if self.commas > 0 || self.groups[0] > 0 {
            let is_pointed = self.points == 0 && self.groups[1] == 0 && of(0) && !is_refuted;
            return if is_pointed { Style::PointedThousands } else { Style::Either };
        }
        let is_comma = self.groups[1] > 0 || of(1) && (self.points > 0 || is_mixed);
        if is_comma && !is_refuted {
            Style::CommaThousands
        } else if of(0) && !of(1) && self.points == 0 && is_mixed && !is_refuted && separator == ';'
        {
            Style::PointedThousands
        } else if of(1) {
            Style::Either
        } else {
            Style::of(separator)
        }
    }
}

/// How the numbers of a plain table are written, once for the whole file: `1.000` is a thousand where other cells have
/// decimal commas. Commas in a table that is parted by commas stand in quotes.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn of_file(path: &Path, layout: &Layout) -> Result<Style, IoError> {
    let separator = char::from(layout.separator);
    let file = File::open(path).map_err(|e| IoError::system(path, &e))?;
    let mut lines = BufReader::with_capacity(1 << 16, file);
    let (mut evidence, mut has_quotes) = (Evidence::default(), false);
    let (mut line, mut header) = (vec![], 1 + layout.units);
    loop {
        line.clear();
        if !lines.read_until(b'\n', &mut line).is_ok_and(|count| count > 0) {
            break;
        }
        if !is_row(&line) {
            continue;
        }
        if header > 0 {
            header -= 1;
            continue;
        }
        has_quotes |= line.contains(&b'"');
        // without a quoted cell only numbers without commas were seen
        if separator == ',' && !has_quotes && evidence.points > 0 {
            continue;
        }
        let text = String::from_utf8_lossy(line.strip_suffix(b"\n").unwrap_or(&line));
        if text.contains('"') {
            split(&text, separator).iter().enumerate().for_each(|(k, c)| evidence.see(k, c));
        } else {
            text.split(separator).enumerate().for_each(|(k, c)| evidence.see(k, c));
        }
        if evidence.is_settled() {
            break;
        }
    }
    Ok(evidence.style(separator))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The style of a table of rows of cells.
    fn style(separator: char, rows: &[&[&str]]) -> Style {
        let mut evidence = Evidence::default();
        for row in rows {
            row.iter().enumerate().for_each(|(k, cell)| evidence.see(k, cell));
        }
        evidence.style(separator)
    }

    #[test]
    fn a_point_parts_thousands_beside_decimal_commas() {
        let rows: [&[&str]; 3] = [&["0", "0,632"], &["990", "-12,5"], &["1.000", "-0,003"]];
        assert_eq!(style(';', &rows), Style::PointedThousands);
        assert_eq!(style(';', &[&["1.224,9"], &["0,5"]]), Style::PointedThousands);
        // 0.010 is no thousand
        assert_eq!(style(';', &[&["0.010", "0,632"], &["1.000", "0,5"]]), Style::Either);
        assert_eq!(style(';', &[&["0,010"], &["1000,5"]]), Style::Either);
        // whole numbers alone: those below a thousand have no point
        assert_eq!(style(';', &[&["990"], &["1.000"]]), Style::PointedThousands);
        assert_eq!(style(';', &[&["990"], &["1000"], &["1.001"]]), Style::Either);
        assert_eq!(style(';', &[&["1.125"], &["1.250"]]), Style::Either);
    }

    #[test]
    fn a_comma_parts_thousands_beside_decimal_points() {
        let rows: [&[&str]; 2] = [&["990", "0.63"], &["1,000", "-1,224.9"]];
        assert_eq!(style(',', &rows), Style::CommaThousands);
        assert_eq!(style('\t', &rows), Style::CommaThousands);
        assert_eq!(style(',', &[&["0,01", "1,2"], &["1,000", "3"]]), Style::Either);
        assert_eq!(style(',', &[&["990"], &["1,000"]]), Style::CommaThousands);
        assert_eq!(style(',', &[&["0.01", "1"]]), Style::Point);
    }

    #[test]
    fn numbers_are_read_in_their_style() {
        for (style, text, expected) in [
            (Style::PointedThousands, "1.224,9", Some(1224.9)),
            (Style::PointedThousands, "-12.000", Some(-12_000.0)),
            (Style::PointedThousands, "0,5", Some(0.5)),
            (Style::PointedThousands, "1.5", None),
            (Style::CommaThousands, "-1,224.9", Some(-1224.9)),
            (Style::CommaThousands, "1,000,000", Some(1e6)),
            (Style::CommaThousands, "1,5", None),
            (Style::Either, "1'224.9", Some(1224.9)),
            (Style::Either, "1\u{202f}224,9", Some(1224.9)),
            (Style::Point, "1,5", None),
        ] {
            assert_eq!(style.number(text), expected, "{text}");
        }
    }
}
