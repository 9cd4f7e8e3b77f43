//! A tag at the start of the lines of a table that distinguishes them from other console lines: `@D COLS
//! t,enc`, `@D 0,12`.

use super::{PLAIN, ROWS, is_blank, table};
use crate::io::csv::{Style, value};

/// Share of the lines that must begin with the word.
const MOST: f64 = 0.9;
/// Words before the names that mark a header.
const HEADERS: [&str; 7] = ["cols", "columns", "fields", "header", "names", "csv", "data"];

/// The word, with its space, with which the lines of a table and its header begin.
pub(super) fn of(lines: &[&str]) -> Option<String> {
    let held: Vec<&&str> = lines.iter().filter(|line| !is_blank(line)).collect();
    let last = held.last()?;
    let (word, _) = last.split_once(' ')?;
    let is_word = !word.is_empty()
        && !word.contains(PLAIN)
        && !word.starts_with(['#', '%', '/'])
        && !word.ends_with([':', '=', '>'])
        && value(word, Style::Either).is_none();
    let tag = format!("{word} ");
    let count = held.iter().filter(|line| line.starts_with(&tag)).count();
    if !is_word || held.len() < ROWS || (count as f64) < MOST * held.len() as f64 {
        return None;
    }
    let text = without(&lines.join("\n"), &tag);
    let found = table(&text.lines().collect::<Vec<_>>())?;
    (found.header.is_some() && PLAIN.contains(&found.separator)).then_some(tag)
}

/// The lines that begin with a tag, without it, and the header without its marking word.
pub(super) fn without(text: &str, tag: &str) -> String {
    let bare = |line: &str| -> Option<String> {
        let rest = line.strip_prefix(tag)?.trim_start();
        let is_header = |word: &str| HEADERS.contains(&word.to_lowercase().as_str());
        let named = rest.split_once(' ').filter(|(word, _)| is_header(word)).map(|(_, rest)| rest);
        Some(named.unwrap_or(rest).trim_start().to_string())
    };
    text.lines().filter_map(bare).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_before_header_and_rows_is_left_out() {
        let rows: Vec<String> = (0..20).map(|k| format!("@D {k},{},3", 2 * k)).collect();
        let mut lines = vec!["@D INFO fw=1.4", "@D COLS t_ms,enc_l,enc_r"];
        lines.extend(rows.iter().map(String::as_str));
        assert_eq!(of(&lines).as_deref(), Some("@D "));
        let text = without(&lines.join("\n"), "@D ");
        assert_eq!(text.lines().nth(1), Some("t_ms,enc_l,enc_r"));
        assert_eq!(text.lines().nth(2), Some("0,0,3"));
        // rows without a header, and a table of spaces
        assert_eq!(of(&lines[2..]), None);
        let spaced: Vec<String> = (0..20).map(|k| format!("D {k} 2 3")).collect();
        assert_eq!(of(&spaced.iter().map(String::as_str).collect::<Vec<_>>()), None);
    }
}
