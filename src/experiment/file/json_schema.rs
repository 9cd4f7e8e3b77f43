//! The JSON schema of experiment files for editors, generated from the types that read the file and from the
//! catalogues, so that they cannot differ.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use super::key_schema::added_ids;
use super::schema::ExperimentFile;
use crate::identify::doc_text;

/// The JSON schema (draft 7) of an experiment file, as text.
///
/// It accepts every file that the program reads, except for unusual spellings of units (`RPM`); conditions on
/// the recordings, or on several keys at once, are checked only by the program.
///
/// # Examples
/// ```
/// let schema = amigo_ident::experiment::json_schema();
/// assert!(schema.contains("turning_scrub") && schema.contains("prediction_error"));
/// ```
#[must_use]
pub fn json_schema() -> String {
    let mut text = format!("{:#}", schema_value());
    text.push('\n');
    text
}

pub(super) fn schema_value() -> Value {
    let settings = SchemaSettings::draft07().with(|s| s.inline_subschemas = true);
    let mut root = settings.into_generator().into_root_schema_for::<ExperimentFile>().to_value();
    without_null(&mut root);
    root["title"] = "Experiment file of amigo-ident".into();
    root["oneOf"] = json!([{ "required": ["recordings"] }, { "required": ["simulation"] }]);
    // without custom effects only those of the catalogue are allowed
    let ids = json!({ "enum": added_ids() });
    let custom =
        json!({ "properties": { "model": { "required": ["custom"] } }, "required": ["model"] });
    root["if"] = json!({ "not": custom });
    root["then"] = json!({ "properties": {
        "model": { "properties": { "effects": { "items": ids } } },
        "simulation": { "properties": { "hidden": { "propertyNames": ids } } },
    } });
    root
}

/// TOML has no null: an optional value is described by the type it has if present.
fn without_null(value: &mut Value) {
    match value {
        Value::Object(map) => {
            map.values_mut().for_each(without_null);
            map.remove("format");
            if let Some(Value::String(text)) = map.get_mut("description") {
                *text = doc_text(text);
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            if let Some(Value::Array(types)) = map.get_mut("type") {
                types.retain(|t| t != "null");
                if let [one] = types.as_slice() {
                    let one = one.clone();
                    map.insert("type".into(), one);
                }
            }
            let null = json!({ "type": "null" });
            let Some(Value::Array(any)) = map.get_mut("anyOf") else { return };
            any.retain(|schema| *schema != null);
            if let [Value::Object(one)] = any.as_slice() {
                let mut one = one.clone();
                map.remove("anyOf");
                one.append(map);
                *map = one;
            }
        }
        Value::Array(values) => values.iter_mut().for_each(without_null),
        _ => {}
    }
}

#[cfg(test)]
mod tests;
