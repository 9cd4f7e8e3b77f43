//! The text of JSON, also with `NaN` and `Infinity`, which are no JSON: Python's `json.dump` writes them.

use serde_json::Value;

/// What stands for a number that is none, the longest first.
const NO_NUMBERS: [&str; 3] = ["-Infinity", "Infinity", "NaN"];
/// Characters of the beginning of a file that a message shows.
const SHOWN: usize = 40;

/// The value of a text in JSON; `NaN`, `Infinity` and `-Infinity` are missing values.
///
/// # Errors
/// A text that is no JSON.
pub(super) fn parsed(text: &str) -> serde_json::Result<Value> {
    serde_json::from_str(text).or_else(|error| match without_nan(text) {
        Some(text) => serde_json::from_str(&text),
        None => Err(error),
    })
}

/// A text with `null` in place of what is no number; `None` where there is none of that. Texts in quotes remain.
fn without_nan(text: &str) -> Option<String> {
    if !NO_NUMBERS.iter().any(|word| text.contains(word)) {
        return None;
    }
    let mut out = String::with_capacity(text.len());
    let (mut rest, mut is_quoted) = (text, false);
    while let Some(c) = rest.chars().next() {
        if let Some(word) = NO_NUMBERS.iter().find(|word| !is_quoted && rest.starts_with(**word)) {
            out.push_str("null");
            rest = &rest[word.len()..];
            continue;
        }
        is_quoted ^= c == '"';
        // the sign behind a backslash ends no text
        let escaped = if is_quoted && c == '\\' { rest.chars().nth(1) } else { None };
        let length = c.len_utf8() + escaped.map_or(0, char::len_utf8);
        out.push_str(&rest[..length]);
        rest = &rest[length..];
    }
    Some(out)
}

/// What is wrong with a text that is no JSON, and the remedy.
pub(super) fn fault(text: &str, error: &serde_json::Error) -> String {
    let begins = text.trim_start().starts_with(['{', '[']);
    if !begins {
        let beginning: String = text.trim().chars().take(SHOWN).collect();
        return format!(
            "it begins with `{beginning}`, and JSON with `{{` or `[`; if it is the page of a web site, get the file itself"
        );
    }
    if error.is_eof() {
        return format!(
            "it ends within a list or an object (line {}), as a log that was cut off; write its end, the brackets among \
             it, or record again",
            error.line()
        );
    }
    format!("{error}; correct this place")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_are_missing_values() {
        let text = r#"{"t": [0, NaN, -Infinity], "a \" NaN": [Infinity, 1, 2]}"#;
        let found = parsed(text).unwrap();
        assert_eq!(found["t"], serde_json::json!([0, null, null]));
        assert_eq!(found["a \" NaN"], serde_json::json!([null, 1, 2]));
    }

    #[test]
    fn a_text_that_is_no_json_differs_from_one_that_is_cut_off() {
        let of = |text: &str| fault(text, &parsed(text).unwrap_err());
        assert!(of(r#"{"t": [0, NaN, 1"#).contains("ends within a list or an object (line 1)"));
        assert!(of("<html></html>").contains("it begins with `<html></html>`"));
        assert!(of("{\"t\": [0,\n x]}").contains("line 2 column 2; correct"), "{}", of("{x}"));
    }
}
