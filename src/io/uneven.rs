//! Rows with more or fewer cells than the others: damaged lines of a serial link, two lines in one, a cut last line.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::IoError;
use super::error::shown;

/// Largest share of rows that are not rows of the table: occasional console output, or two lines in one.
/// Above it the file does not match its header.
pub(super) const STRAY: f64 = 0.01;
/// Characters of a row that a message shows.
const SHOWN: usize = 80;

/// A row of a text: its number below the header and its line, both from 1, and its text.
pub(super) struct Row<'a> {
    pub(super) number: usize,
    pub(super) line: usize,
    pub(super) text: &'a str,
}

/// Place and text of the first row with a number of cells.
#[derive(Clone, Debug)]
struct First {
    row: usize,
    line: usize,
    text: String,
}

/// The number of cells of each row.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Columns of the table.
    expected: usize,
    has_header: bool,
    /// Number of rows.
    count: usize,
    /// Number and cells of each row whose cells are not those of the columns.
    others: Vec<(usize, usize)>,
    firsts: BTreeMap<usize, First>,
}

impl Cells {
    pub(super) fn new(expected: usize, has_header: bool) -> Self {
        Self { expected, has_header, ..Self::default() }
    }

    /// Adds a row with so many cells, of which the last that contains something is `used` from 1.
    pub(super) fn see(&mut self, row: &Row, cells: usize, used: usize) {
        let count = if used > self.expected { used } else { cells.min(self.expected) };
        self.count += 1;
        if count == self.expected {
            return;
        }
        self.others.push((row.number, count));
        self.firsts.entry(count).or_insert_with(|| First {
            row: row.number,
            line: row.line,
            text: beginning(row.text),
        });
    }

    /// Rows with more cells than columns.
    fn more(&self) -> impl Iterator<Item = &(usize, usize)> {
        self.others.iter().filter(|(_, count)| *count > self.expected)
    }

    /// The number of cells of most rows, of those that have no more than there are columns.
    fn usual(&self) -> usize {
        let mut times = BTreeMap::from([(self.expected, self.count - self.others.len())]);
        for (_, count) in self.others.iter().filter(|(_, count)| *count < self.expected) {
            *times.entry(*count).or_default() += 1;
        }
        times.into_iter().max_by_key(|(_, times)| *times).map_or(0, |(count, _)| count)
    }

    /// Rows with fewer cells than most.
    fn fewer(&self) -> impl Iterator<Item = &(usize, usize)> {
        let usual = self.usual();
        self.others.iter().filter(move |(_, count)| *count < usual)
    }

    /// Whether so few rows are damaged; more of them are those of a logger that leaves out empty cells at the end.
    fn is_few(&self, count: usize) -> bool {
        count as f64 <= (STRAY * self.count as f64).max(1.0)
    }

    /// Whether no row has more or fewer cells than the others.
    pub(super) fn are_even(&self) -> bool {
        self.more().next().is_none() && self.fewer().next().is_none()
    }

    /// The numbers of the rows whose cells are not used: which of them are missing is not known, and the last one may
    /// be cut.
    pub(super) fn left_out(&self) -> BTreeSet<usize> {
        let numbers = |rows: &mut dyn Iterator<Item = &(usize, usize)>| -> Vec<usize> {
            rows.map(|(number, _)| *number).collect()
        };
        let few = Some(numbers(&mut self.fewer())).filter(|rows| self.is_few(rows.len()));
        numbers(&mut self.more()).into_iter().chain(few.into_iter().flatten()).collect()
    }

    /// Checks that at most 1 % of the rows have more cells than there are columns.
    ///
    /// # Errors
    /// The first of them.
    pub(super) fn check(&self, path: &Path) -> Result<(), IoError> {
        let count = self.more().count();
        if count as f64 <= STRAY * self.count as f64 {
            return Ok(());
        }
        let Some((_, found)) = self.more().next() else { return Ok(()) };
        let Some(First { row, line, text }) = self.firsts.get(found).cloned() else {
            return Ok(());
        };
        let (file, found, expected) = (shown(path), *found, self.expected);
        let (has_header, most) = (self.has_header, 2 * count > self.count);
        Err(IoError::Ragged { file, row, line, found, expected, text, has_header, most })
    }

    /// A sentence on the rows that have more or fewer cells than the others.
    pub(super) fn words(&self) -> Option<String> {
        let (more, fewer) = (self.more().count(), self.fewer().count());
        let usual = self.usual();
        let first = |is: &dyn Fn(usize) -> bool| {
            let of = self.firsts.iter().filter(|(count, _)| is(**count)).map(|(_, first)| first);
            let first = of.min_by_key(|first| first.row)?;
            Some(format!("first: row {} (line {}) `{}`", first.row, first.line, first.text))
        };
        let is_damaged = more > 0 || fewer > 0 && self.is_few(fewer);
        if is_damaged {
            let few = if self.is_few(fewer) { fewer } else { 0 };
            let is = |count: usize| count > self.expected || few > 0 && count < usual;
            return Some(format!(
                "{} of {} rows have more or fewer cells than the others and are left out ({})",
                more + few,
                self.count,
                first(&is)?
            ));
        }
        (fewer > 0).then(|| {
            Some(format!(
                "{fewer} of {} rows have fewer cells than the others; their last columns have no values ({})",
                self.count,
                first(&|count| count < usual)?
            ))
        })?
    }
}

/// The beginning of a row.
pub(super) fn beginning(text: &str) -> String {
    let text = text.trim();
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of three columns with rows of so many cells.
    fn table(counts: &[usize]) -> Cells {
        let mut out = Cells::new(3, true);
        for (k, count) in counts.iter().enumerate() {
            let text = vec!["1"; *count].join(",");
            out.see(&Row { number: k + 1, line: k + 2, text: &text }, *count, *count);
        }
        out
    }

    #[test]
    fn rows_with_another_number_of_cells_are_left_out_or_refused() {
        let even = table(&[3; 300]);
        assert!(even.are_even() && even.words().is_none() && even.left_out().is_empty());
        let mut counts = [3; 300];
        (counts[10], counts[20]) = (4, 2);
        let few = table(&counts);
        assert_eq!(few.left_out().into_iter().collect::<Vec<_>>(), [11, 21]);
        assert!(few.check(Path::new("a.csv")).is_ok());
        assert_eq!(
            few.words().unwrap(),
            "2 of 300 rows have more or fewer cells than the others and are left out (first: row 11 (line 12) `1,1,1,1`)"
        );
        (10..20).for_each(|k| counts[k] = 4);
        let error = table(&counts).check(Path::new("a.csv")).unwrap_err().to_string();
        assert!(error.starts_with("a.csv, row 11 (line 12) `1,1,1,1`: 4 cells"), "{error}");
        // a logger that leaves out empty cells at the end
        let sparse: Vec<usize> = (0..300).map(|k| if k % 4 == 0 { 2 } else { 3 }).collect();
        let sparse = table(&sparse);
        assert!(sparse.left_out().is_empty() && sparse.check(Path::new("a.csv")).is_ok());
        assert!(sparse.words().unwrap().contains("75 of 300 rows have fewer cells"));
        // more names than cells
        assert!(table(&[2; 300]).are_even());
    }
}
