//! The experiment file as a JSON schema, with which editors complete and check it: generated from
//! the types that read the file and from the catalogues, so that it cannot drift from either.

use schemars::generate::SchemaSettings;
use serde_json::{Value, json};

use super::key_schema::added_ids;
use super::schema::ExperimentFile;
use crate::identify::doc_text;

/// The JSON schema (draft 7) of an experiment file, as text.
///
/// It refuses nothing that the program reads, but for unusual spellings of units (`RPM`); what
/// depends on the recordings, or on several keys at once, only the program can tell.
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
    // without effects written as formulas there are those of the catalogue only
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

/// TOML has no null: what may be left out is described by what it is when it is there.
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
