//! Message for a missing column.

use std::path::Path;

use super::super::columns::CONTRACT;
use super::super::error::{shortened, shown};
use super::super::{IoError, csv, text_log};
use super::headers::{Headers, Source};

/// The column of that name is not there: with the closest name, and those that there are.
pub(super) fn missing(path: &Path, headers: &Headers, key: &str, name: &str) -> IoError {
    if text_log::has_no_header(&headers.names) {
        return IoError::NoHeader { file: shown(path), count: headers.names.len() };
    }
    if let (Source::Text(_), [_]) = (&headers.source, &headers.names[..]) {
        return csv::not_understood(path);
    }
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
        file: shown(path),
        column: name.into(),
        key: key.into(),
        near,
        present: shortened(&of_interest(&headers.names)),
    }
}

/// Names that are listed as they are.
const LISTED: usize = 24;
/// Words of the names of wheels' angles, speeds and inputs.
const WORDS: [&str; 15] = [
    "pos", "angle", "enc", "vel", "speed", "rpm", "volt", "current", "amp", "torque", "effort",
    "left", "right", "wheel", "drive",
];

/// The names of columns; of many those that may be meant first, by the number of words that say so.
fn of_interest(names: &[String]) -> String {
    if names.len() <= LISTED {
        return names.join(", ");
    }
    let words = |name: &String| {
        let lower = name.to_lowercase();
        WORDS.iter().filter(|word| lower.contains(**word)).count()
    };
    let mut sorted: Vec<&String> = names.iter().collect();
    // stable: among equals in the order of the file
    sorted.sort_by_key(|name| std::cmp::Reverse(words(name)));
    let first: Vec<&str> = sorted.iter().take(LISTED).map(|n| n.as_str()).collect();
    format!("{}, and {} others", first.join(", "), names.len() - LISTED)
}
