//! Error messages for invalid TOML, with the key that was probably meant.
//!
//! The keys are taken from the schema of the file; the text of serde's errors is not parsed.

use serde_json::Value as Schema;
use toml::{Table, Value};

use super::error::FileError;
use super::json_schema::schema_value;
use crate::catalogue::nearest;

/// The error in the text of a file: line, excerpt and the key that was probably meant.
pub(super) fn refused(file: &str, text: &str, error: &toml::de::Error) -> FileError {
    let (schema, table) = (schema_value(), toml::from_str(text).unwrap_or_default());
    let message = match error.span() {
        None => meant(&schema, &table, |_| true).unwrap_or_else(|| error.message().into()),
        Some(span) => {
            let place = text.get(span.clone()).unwrap_or_default().trim_matches(['"', '\'']);
            // the place is the key, or the table that contains it
            let is_there = |key: &str| key == place || place.contains('=') && place.contains(key);
            let message = meant(&schema, &table, is_there);
            let message = message.unwrap_or_else(|| error.message().into());
            let (number, line) = line_of(text, span.start);
            format!("line {number}: {message}\n    {}", line.trim_end())
        }
    };
    FileError::Syntax { file: file.into(), message: message.trim_end().into() }
}

/// The error in a table of the file, at `place`.
pub(super) fn refused_table(place: &[&str], table: &Table, error: &toml::de::Error) -> String {
    let schema = schema_value();
    let schema = place.iter().fold(&schema, |schema, key| &schema["properties"][key]);
    meant(schema, table, |_| true).unwrap_or_else(|| error.message().into())
}

/// The number (from 1) and text of the line at a byte offset.
fn line_of(text: &str, offset: usize) -> (usize, &str) {
    let offset =
        (0..=offset.min(text.len())).rev().find(|&o| text.is_char_boundary(o)).unwrap_or(0);
    let number = text[..offset].matches('\n').count() + 1;
    (number, text.lines().nth(number - 1).unwrap_or_default())
}

/// The first key of a table that is not in its schema and for which `counts` holds, with the most similar
/// key; `None` if there is no such key, or none is similar.
fn meant(schema: &Schema, table: &Table, counts: impl Fn(&str) -> bool) -> Option<String> {
    let mut found = vec![];
    unknown_keys(schema, table, &mut found);
    let mut counted = found.into_iter().filter(|(key, _)| counts(key));
    let (key, near) = counted.find_map(|(key, known)| Some((key, nearest(key, known)?)))?;
    Some(format!("unknown key `{key}`; did you mean `{near}`?"))
}

/// Keys that are not in the schema of their table, with those that are.
fn unknown_keys<'a>(
    schema: &'a Schema,
    table: &'a Table,
    found: &mut Vec<(&'a str, Vec<&'a str>)>,
) {
    // for a block that may be one of several tables its own parser finds the error
    let [schema] =
        alternatives(schema).filter(|s| s["properties"].is_object()).collect::<Vec<_>>()[..]
    else {
        return;
    };
    let Some(properties) = schema["properties"].as_object() else { return };
    let is_closed =
        schema["additionalProperties"] == false && schema["patternProperties"].is_null();
    for (key, value) in table {
        match properties.get(key) {
            Some(of_key) => below(of_key, value, found),
            None if is_closed => {
                found.push((key, properties.keys().map(String::as_str).collect()));
            }
            None => below(&schema["additionalProperties"], value, found),
        }
    }
}

fn below<'a>(schema: &'a Schema, value: &'a Value, found: &mut Vec<(&'a str, Vec<&'a str>)>) {
    match value {
        Value::Table(table) => unknown_keys(schema, table, found),
        Value::Array(values) => {
            let items = alternatives(schema).find(|s| s["items"].is_object());
            for value in items.into_iter().flat_map(|_| values) {
                below(items.map_or(schema, |s| &s["items"]), value, found);
            }
        }
        _ => {}
    }
}

/// A schema and its alternatives.
fn alternatives(schema: &Schema) -> impl Iterator<Item = &Schema> {
    let of = |word: &str| schema[word].as_array().into_iter().flatten();
    std::iter::once(schema).chain(of("anyOf")).chain(of("oneOf"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> Option<String> {
        meant(&schema_value(), &toml::from_str(text).unwrap(), |_| true)
    }

    #[test]
    fn the_key_that_was_meant_is_found_at_any_depth() {
        for (text, near) in [
            ("[simulatio]\nseed = 1", "simulation"),
            ("[recordings.columns]\nt = { nme = \"time\" }", "name"),
            ("[simulation]\nmovement = [{ speed_ms = 0.1 }]", "speed_m_s"),
            ("[simulation.hidden.slope]\ng_x = 0.1", "g_c"),
            ("[[model.custom]]\ntorque = \"w\"", "torque1"),
            ("[model.custom]\n", ""),
        ] {
            let said = said(text);
            let expected = (!near.is_empty()).then(|| format!("did you mean `{near}`?"));
            let ends = match (&said, &expected) {
                (Some(said), Some(expected)) => said.ends_with(expected.as_str()),
                (said, expected) => said.is_none() && expected.is_none(),
            };
            assert!(ends, "{text}: {said:?}");
        }
    }

    #[test]
    fn what_has_readers_of_its_own_or_any_name_is_left_to_them() {
        for text in [
            "[[method]]\nname = \"prediction_error\"\nhorizon = 1",
            "[simulation.hidden.mine]\nq = 1.0",
            "[model.fixed]\na9 = 1.0",
            "[grid]\n\"model.effects\" = [[]]",
        ] {
            assert_eq!(said(text), None, "{text}");
        }
    }
}
