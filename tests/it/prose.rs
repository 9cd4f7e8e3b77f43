//! The prose of a file: what a reader takes as text, without code.

use std::path::Path;

/// The lines of a file that are prose, with their numbers: all of Markdown but code, the comments of TOML, comments
/// and texts of Rust and Python, texts of JSON.
pub(crate) fn prose(path: &Path, text: &str) -> Vec<(usize, String)> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("md") => of_markdown(path, text),
        Some("rs") => of_rust(text),
        Some("py" | "pyi" | "json") => of_python(text),
        // code and data of which every word is read
        Some("c" | "m" | "mo" | "js" | "java" | "cff") => {
            (1..).zip(text.lines().map(str::to_owned)).collect()
        }
        _ => (1..)
            .zip(text.lines())
            .filter_map(|(n, l)| Some((n, l.split_once('#')?.1.into())))
            .collect(),
    }
}

/// What is not between backticks: every second part.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<_>>().join(" ")
}

fn of_markdown(path: &Path, text: &str) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    let mut skipped = false;
    for (number, line) in (1..).zip(text.lines()) {
        if line.trim_start().starts_with("```") {
            skipped = !skipped;
        } else if line.starts_with("## ") && path.ends_with("CONTRIBUTING.md") {
            // the table of the words themselves
            skipped = line == "## Language";
        } else if !skipped {
            out.push((number, without_code(line)));
        }
    }
    out
}

/// Comments outside fenced code, and texts with a space in them: those without are keys.
fn of_rust(source: &str) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    let mut fenced = false;
    for (number, piece) in pieces(source) {
        let Piece::Comment(text) = &piece else {
            let Piece::Text(text) = piece else { continue };
            let lines = (number..).zip(text.split('\n'));
            out.extend(lines.filter(|(_, l)| l.contains(' ')).map(|(n, l)| (n, without_code(l))));
            continue;
        };
        let text = text.trim_start_matches(['/', '!']);
        if text.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            out.push((number, without_code(text)));
        }
    }
    out
}

/// Docstrings, comments, and texts with a space in them; JSON has texts alone.
fn of_python(source: &str) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    let mut number = 1;
    for (place, part) in source.split("\"\"\"").enumerate() {
        for (n, line) in (number..).zip(part.split('\n')) {
            if place % 2 == 1 {
                out.push((n, without_code(line)));
                continue;
            }
            let (code, comment) = line.split_once('#').unwrap_or((line, ""));
            let texts = code.split('"').skip(1).step_by(2).filter(|text| text.contains(' '));
            out.extend(texts.chain([comment]).map(|text| (n, without_code(text))));
        }
        number += part.matches('\n').count();
    }
    out.retain(|(_, text)| !text.is_empty());
    out
}

enum Piece {
    Comment(String),
    Text(String),
}

/// The string literals of a Rust source, as they are written.
pub(crate) fn literals(source: &str) -> Vec<String> {
    let texts = pieces(source).into_iter().filter_map(|(_, piece)| match piece {
        Piece::Text(text) => Some(text),
        Piece::Comment(_) => None,
    });
    texts.collect()
}

/// The comments and string literals of a Rust source, with the lines on which they begin.
fn pieces(source: &str) -> Vec<(usize, Piece)> {
    let mut out = Vec::new();
    let (mut rest, mut line) = (source, 1);
    while let Some(first) = rest.chars().next() {
        let (length, piece) = if rest.starts_with("//") {
            let end = rest.find('\n').unwrap_or(rest.len());
            (end, Some(Piece::Comment(rest[..end].into())))
        } else if let Some((start, close)) = raw_text(rest) {
            let end = start + rest[start..].find(&close).expect("a raw text ends");
            (end + close.len(), Some(Piece::Text(rest[start..end].into())))
        } else if first == '"' {
            let end = 1 + end_of_text(&rest[1..]);
            (end + 1, Some(Piece::Text(rest[1..end].into())))
        } else {
            (character(rest).unwrap_or(first.len_utf8()), None)
        };
        out.extend(piece.map(|piece| (line, piece)));
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    out
}

/// Where the contents of a raw text at the start begin, and what closes them.
fn raw_text(rest: &str) -> Option<(usize, String)> {
    let hashes = rest.strip_prefix('r')?.chars().take_while(|c| *c == '#').count();
    rest[1 + hashes..].starts_with('"').then(|| (hashes + 2, format!("\"{}", "#".repeat(hashes))))
}

/// The place of the quotation mark that ends a text.
fn end_of_text(text: &str) -> usize {
    let mut escaped = false;
    let ends = |(_, c): &(usize, char)| {
        let end = *c == '"' && !escaped;
        escaped = *c == '\\' && !escaped;
        end
    };
    text.char_indices().find(ends).expect("a text ends").0
}

/// The length of a character literal at the start; a lifetime is none.
fn character(rest: &str) -> Option<usize> {
    let inner = rest.strip_prefix('\'')?;
    if inner.starts_with('\\') {
        return Some(3 + inner[2..].find('\'')?);
    }
    let first = inner.chars().next()?.len_utf8();
    inner[first..].starts_with('\'').then_some(first + 2)
}

#[test]
fn docstrings_comments_and_texts_of_python_are_prose() {
    let source = "\"\"\"One `two`\nthree.\"\"\"\nx = f(\"key\", \"a text\")  # why\n";
    let found = of_python(source);
    let found: Vec<(usize, &str)> = found.iter().map(|(n, l)| (*n, l.trim())).collect();
    assert_eq!(found, [(1, "One"), (2, "three."), (3, "a text"), (3, "why")]);
}

#[test]
fn comments_and_texts_are_prose_and_keys_and_code_are_not() {
    let source = "let a = 'b'; let q = '\"'; // one `two` three\n/// ```\n/// let hidden = 1;\n/// ```\nf(\"key\", r#\"a \"raw\" text\"#,\n \"of two\n lines\");";
    let expected = [(1, " one   three"), (5, "a \"raw\" text"), (6, "of two"), (7, " lines")];
    let found = of_rust(source);
    let found: Vec<(usize, &str)> = found.iter().map(|(n, l)| (*n, l.as_str())).collect();
    assert_eq!(found, expected);
}
