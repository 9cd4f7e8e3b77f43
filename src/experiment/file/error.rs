//! What is wrong with an experiment file, in words.

/// What is wrong with an experiment file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileError {
    /// Not TOML, an unknown key or a wrong type; the message shows the line.
    #[error("{file}: {message}")]
    Syntax {
        /// File.
        file: String,
        /// Line, excerpt and what was expected.
        message: String,
    },
    /// An override of the command line.
    #[error("--set {entry}: {message}")]
    Override {
        /// As typed.
        entry: String,
        /// What was expected.
        message: String,
    },
    /// A value that makes no sense.
    #[error("{file}: {key} {message}")]
    Value {
        /// File.
        file: String,
        /// Dotted key.
        key: String,
        /// What is wrong, what was expected.
        message: String,
    },
}

/// Turns a TOML error into ours, with line, excerpt and the key that was meant.
pub(super) fn with_words<T>(
    file: &str,
    text: &str,
    result: Result<T, toml::de::Error>,
) -> Result<T, FileError> {
    result.map_err(|e| {
        let line = e.span().map(|span| line_of(text, span.start));
        let place = line.as_ref().map_or(String::new(), |(number, content)| {
            format!("line {number}: {}\n    {}\n", with_hint(e.message()), content.trim_end())
        });
        let message = if place.is_empty() { with_hint(e.message()) } else { place };
        FileError::Syntax { file: file.into(), message: message.trim_end().into() }
    })
}

/// The number (from 1) and text of the line at a byte offset.
fn line_of(text: &str, offset: usize) -> (usize, String) {
    let offset =
        (0..=offset.min(text.len())).rev().find(|&o| text.is_char_boundary(o)).unwrap_or(0);
    let number = text[..offset].matches('\n').count() + 1;
    let line = text.lines().nth(number - 1).unwrap_or_default();
    (number, line.to_string())
}

/// Adds the key that was meant to serde's "unknown field `a`, expected one of `b`, `c`".
///
/// The names are read off the sentence because there is no other place: `serde::de::Error::unknown_field` hands them
/// to toml, whose error keeps the sentence and the span only. The tests of this module fail if its form changes.
pub(super) fn with_hint(message: &str) -> String {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if !message.starts_with("unknown") || names.len() < 2 {
        return message.to_string();
    }
    let unknown = names[0];
    let near = names[1..]
        .iter()
        .map(|name| (strsim::jaro_winkler(name, unknown), *name))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match near {
        Some((score, name)) if score > 0.75 => {
            let head = message.split(", expected").next().unwrap_or(message);
            format!("{head}; did you mean `{name}`?")
        }
        _ => message.to_string(),
    }
}
