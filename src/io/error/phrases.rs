//! Parts of messages.

use std::path::Path;

/// A key with what it is given; a list where it takes one.
pub(super) fn assigned(key: &str) -> String {
    if key.ends_with(".plus") { format!("{key} = [\"…\"]") } else { format!("{key} = \"…\"") }
}

/// The line of a file in brackets.
pub(super) fn in_file(line: Option<usize>) -> String {
    line.map_or(String::new(), |line| format!(" (line {line} of the file)"))
}

/// A file as the end of a sentence.
pub(super) fn for_example(file: Option<&String>) -> String {
    file.map_or(String::new(), |file| format!(", for example {file}"))
}

/// Number and text of a line behind the name of its file.
pub(super) fn first_line(line: Option<&(usize, String)>) -> String {
    line.map_or(String::new(), |(number, text)| format!(", line {number} `{text}`"))
}

/// A cell in quotes.
pub(super) fn quoted(text: &str) -> String {
    if text.is_empty() { "missing".into() } else { format!("`{text}`") }
}

/// The number of cells that a row should have, and what is to be done about rows with more.
pub(super) fn ragged(expected: usize, has_header: bool, most: bool) -> String {
    let whose = if has_header { "the header has" } else { "the other rows have" };
    let remedy = if most {
        "a decimal comma needs another separator, for example `;`"
    } else {
        "more than 1 % of the rows have too many: correct these lines or leave them out"
    };
    format!("{whose} {expected}; {remedy}")
}

/// A list as messages show it: logs of robots hold hundreds of names.
pub(in crate::io) fn shortened(list: &str) -> String {
    const MOST: usize = 2000;
    match list.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &list[..end]),
        None => list.into(),
    }
}

/// A path as messages show it.
pub(in crate::io) fn shown(path: &Path) -> String {
    path.display().to_string()
}
