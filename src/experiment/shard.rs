//! A grid on several machines: each runs a part of the combinations and writes a separate journal.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use crate::io::file_names;

/// Part `number` of `of` parts of a grid: every `of`-th combination.
///
/// ```
/// use amigo_ident::experiment::Shard;
///
/// let shard: Shard = "2/4".parse().unwrap();
/// let cells: Vec<usize> = (0..10).filter(|cell| shard.holds(*cell)).collect();
/// assert_eq!(cells, [1, 5, 9]);
/// assert!("5/4".parse::<Shard>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    of: usize,
    number: usize,
}

/// A text that is not a part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a part of a grid; write I/N with 1 <= I <= N, for example 2/4")]
pub struct ShardError {
    /// The input that could not be parsed.
    pub text: String,
}

impl Shard {
    /// All parts of a grid that is divided into `of`.
    pub(super) fn all(of: usize) -> impl Iterator<Item = Self> {
        (1..=of).map(move |number| Self { of, number })
    }

    /// The number of parts.
    #[must_use]
    pub fn of(self) -> usize {
        self.of
    }

    /// Whether a combination belongs to it.
    #[must_use]
    pub fn holds(self, cell: usize) -> bool {
        cell % self.of == self.number - 1
    }

    /// The file of its journal: `part-2-of-4.jsonl`.
    #[must_use]
    pub fn file(self) -> String {
        format!("part-{}-of-{}.jsonl", self.number, self.of)
    }

    /// The part whose journal has this name.
    #[must_use]
    pub fn from_file(name: &str) -> Option<Self> {
        let (number, of) =
            name.strip_prefix("part-")?.strip_suffix(".jsonl")?.split_once("-of-")?;
        let shard: Self = format!("{number}/{of}").parse().ok()?;
        (shard.file() == name).then_some(shard)
    }

    /// The parts with journals in a folder, sorted.
    pub(super) fn in_folder(folder: &Path) -> Vec<Self> {
        let names = file_names(folder);
        let mut out: Vec<Self> = names.iter().filter_map(|name| Self::from_file(name)).collect();
        out.sort_unstable();
        out
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/');
        let parts = parts.and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { of, number }),
            _ => Err(ShardError { text: text.into() }),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_written_as_a_fraction_and_hold_every_cell_once() {
        for wrong in ["", "1", "0/3", "4/3", "1/0", "a/3", "1/3/3", "-1/3", "1/"] {
            let e = wrong.parse::<Shard>().unwrap_err().to_string();
            assert!(e.contains("for example 2/4"), "{wrong}: {e}");
        }
        for cell in 0..20 {
            assert_eq!(Shard::all(7).filter(|shard| shard.holds(cell)).count(), 1);
        }
    }

    #[test]
    fn the_name_of_a_journal_tells_its_part() {
        let shard: Shard = "2/14".parse().unwrap();
        assert_eq!(shard.file(), "part-2-of-14.jsonl");
        assert_eq!(Shard::from_file(&shard.file()), Some(shard));
        for other in ["part-02-of-14.jsonl", "part-3-of-2.jsonl", "part-1-of-2.json", "x"] {
            assert_eq!(Shard::from_file(other), None, "{other}");
        }
    }
}
