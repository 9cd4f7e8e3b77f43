//! JSON schemas of keys whose names and values depend on the catalogues of effects, methods, robots and
//! units.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::column::ColumnEntry;
use super::grid::{Range, SIMULATION_KEYS, TABLES};
use crate::effects::{self, ParameterKind, ParameterSpec};
use crate::identify;
use crate::io::contract_units;
use crate::robot::{Construction, presets};

fn schema(value: Value) -> Schema {
    Schema::try_from(value).unwrap_or_default()
}

/// A value of a list with its meaning.
fn words(list: impl IntoIterator<Item = (String, String)>) -> Value {
    let one = |(word, meaning)| json!({ "const": word, "description": meaning });
    list.into_iter().map(one).collect()
}

/// Effects that can be added to the base model.
fn added() -> impl Iterator<Item = effects::Description> {
    let all = effects::all().into_iter().map(|e| e.description());
    all.filter(|d| !effects::BASE.contains(&d.id.as_str()))
}

/// Their ids.
pub(super) fn added_ids() -> Vec<String> {
    added().map(|d| d.id).collect()
}

fn effect_words() -> Value {
    words(added().map(|d| (d.id, format!("{}: {}", d.title, d.equation))))
}

/// `[robot]`: a preset, construction data, or a preset with some of them changed.
pub(super) fn robot(generator: &mut SchemaGenerator) -> Schema {
    let mut table = Construction::json_schema(generator).to_value();
    let names = presets().into_iter().map(|p| (p.name.to_string(), String::new()));
    let unknown = ("unknown".to_string(), "no construction data: no path".to_string());
    let preset = words(names.chain([unknown]));
    let needed = table["required"].take();
    table["properties"]["preset"] = json!({
        "type": "string", "oneOf": preset,
        "description": "A robot by name; construction data given here replace those of the preset.",
    });
    if let Some(map) = table.as_object_mut() {
        map.remove("required");
        map.remove("title");
    }
    table["additionalProperties"] = false.into();
    table["anyOf"] = json!([{ "required": ["preset"] }, { "required": needed }]);
    table["description"] = "Preset or construction data; the AmigoBot unless given.".into();
    schema(table)
}

/// `[recordings] columns`: by quantity, the name of a column or a table.
pub(super) fn columns(generator: &mut SchemaGenerator) -> Schema {
    let entry = ColumnEntry::json_schema(generator).to_value();
    let mut keys = Map::new();
    for (key, units) in contract_units() {
        let mut table = entry.clone();
        let unit = &mut table["properties"]["unit"];
        *unit = json!({ "enum": units, "description": unit["description"] });
        if key == "t" {
            table["anyOf"] = json!([{ "required": ["name"] }, { "required": ["period"] }]);
        } else {
            table["required"] = json!(["name"]);
        }
        let name = json!({ "type": "string", "description": "Name of the column in the file." });
        keys.insert(key.into(), json!({ "anyOf": [name, table] }));
    }
    schema(json!({
        "type": "object", "properties": keys, "additionalProperties": false,
        "description": "Where column names or units differ from t, alpha1, alpha2, dalpha1, \
                        dalpha2, M1, M2 in s, rad, rad/s and N m.",
    }))
}

fn parameter_words(p: &ParameterSpec) -> String {
    let unit = if p.unit.is_empty() { "1" } else { &p.unit };
    format!("{} [{unit}], of the order of {}.", p.meaning, p.typical)
}

/// A true value of a simulated robot; shape parameters are limited to their ranges.
fn true_value(p: &ParameterSpec) -> Value {
    let mut out = json!({ "type": "number", "description": parameter_words(p) });
    if p.kind == ParameterKind::Shape && p.range.0.is_finite() && p.range.1.is_finite() {
        out["minimum"] = p.range.0.into();
        out["maximum"] = p.range.1.into();
    }
    out
}

/// `[simulation] hidden`: effects of the catalogue with their parameters, and custom ones.
pub(super) fn hidden(_: &mut SchemaGenerator) -> Schema {
    let mut ids = Map::new();
    for effect in effects::all().iter().filter(|e| !effects::BASE.contains(&e.id().as_str())) {
        let own = effect.parameters();
        let own: Map<_, _> = own.iter().map(|p| (p.symbol.clone(), true_value(p))).collect();
        let description = effect.description().title;
        ids.insert(
            effect.id(),
            json!({ "type": "object", "properties": own, "additionalProperties": false,
                    "description": description }),
        );
    }
    schema(json!({
        "type": "object", "properties": ids,
        "additionalProperties": { "type": "object", "additionalProperties": { "type": "number" } },
        "description": "Effects of the simulated robot that the model may lack: effect, then parameter = value.",
    }))
}

/// Parameters by symbol: those of the catalogue, and others for custom effects.
fn by_symbol(description: &str, value: impl Fn(&ParameterSpec) -> Value, other: Value) -> Schema {
    let all = effects::all().into_iter().flat_map(|e| e.parameters());
    let known: Map<_, _> = all.map(|p| (p.symbol.clone(), value(&p))).collect();
    schema(json!({ "type": "object", "properties": known, "additionalProperties": other,
                   "description": description }))
}

/// `[simulation] truth`.
pub(super) fn truth(_: &mut SchemaGenerator) -> Schema {
    by_symbol(
        "True values of parameters that differ from the construction.",
        |p| json!({ "type": "number", "description": parameter_words(p) }),
        json!({ "type": "number" }),
    )
}

/// `[model] fixed`.
pub(super) fn fixed(_: &mut SchemaGenerator) -> Schema {
    let value = json!([{ "type": "number" }, { "const": "construction" }]);
    by_symbol(
        "Parameters held at a value, or at the construction's (\"construction\", a1 to a5).",
        |p| json!({ "anyOf": value, "description": parameter_words(p) }),
        json!({ "anyOf": value }),
    )
}

/// `[model] effects`: ids of the catalogue are completed; ids of custom effects are arbitrary.
pub(super) fn effects(_: &mut SchemaGenerator) -> Schema {
    schema(json!({
        "type": "array",
        "items": { "anyOf": [{ "oneOf": effect_words() }, { "type": "string" }] },
        "description": "Effects added to the base model (inertia, centrifugal, Coulomb friction).",
    }))
}

/// `[diagnosis] candidates` as a list.
pub(super) fn candidates(_: &mut SchemaGenerator) -> Schema {
    let item = json!({ "anyOf": [{ "oneOf": effect_words() }, { "type": "string" }] });
    schema(json!({ "type": "array", "minItems": 1, "items": item }))
}

/// `[[method]]`: a name, and the options of that method.
pub(super) fn methods(_: &mut SchemaGenerator) -> Schema {
    let blocks: Vec<Value> = identify::all().iter().map(|m| method(m.as_ref())).collect();
    schema(json!({
        "type": "array", "items": { "type": "object", "required": ["name"], "anyOf": blocks },
        "description": "Methods to compare; a sensible set unless given.",
    }))
}

fn method(method: &dyn identify::Identifier) -> Value {
    let described = method.describe();
    let typed = method.schema().to_value();
    let mut keys = Map::new();
    keys.insert("name".into(), json!({ "const": described.name, "description": described.title }));
    keys.extend(typed["properties"].as_object().cloned().unwrap_or_default());
    json!({ "title": described.title, "description": format!("Use: {}.", described.use_when),
            "type": "object", "properties": keys, "required": ["name"],
            "additionalProperties": false })
}

/// `[grid]`: keys of `[simulation]`, or dotted keys of any table, and their values.
pub(super) fn grid(generator: &mut SchemaGenerator) -> Schema {
    let range = Range::json_schema(generator).to_value();
    let axis = json!({ "anyOf": [{ "type": "array", "minItems": 1 }, range] });
    let mut keys: Map<_, _> =
        SIMULATION_KEYS.iter().map(|key| ((*key).to_string(), axis.clone())).collect();
    for table in TABLES {
        keys.insert(table.into(), json!({ "type": "object", "minProperties": 1 }));
    }
    let dotted = format!(r"^({})\.[^.]+(\.[^.]+)*$", TABLES.join("|"));
    schema(json!({
        "type": "object", "properties": keys, "patternProperties": { dotted: axis },
        "additionalProperties": false, "minProperties": 1,
        "description": "The experiment is repeated over all combinations of these keys.",
    }))
}
