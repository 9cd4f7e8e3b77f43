//! Defaults and limits of the schema are those of the code.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use super::{keys, pointed, schema_value};
use crate::experiment::file::{CustomParameter, ExperimentFile};
use crate::experiment::resolve::resolve;
use crate::{diagnose, effects, identify};

/// The keys of a table of the schema with their defaults, and those without one.
fn defaults(own: &Value) -> (toml::Table, BTreeSet<&str>) {
    let mut with = toml::Table::new();
    let mut without = BTreeSet::new();
    for (key, option) in own["properties"].as_object().expect("a table") {
        match option.get("default").filter(|value| !value.is_null()) {
            Some(value) => drop(with.insert(key.clone(), toml::Value::try_from(value).unwrap())),
            None => drop(without.insert(key.as_str())),
        }
    }
    (with, without)
}

/// The schema's defaults, written out, are read as what the code takes for keys that are left out.
#[test]
fn every_default_of_a_section_in_the_schema_is_that_of_the_code() {
    let schema = schema_value();
    let own_or_none =
        ["columns", "hold", "encoder_ticks", "custom", "fixed", "gain", "matrix", "poles"];
    for section in ["recordings", "conditioning", "simulation", "model", "emulator", "diagnosis"] {
        let (mut written, without) = defaults(pointed(&schema, section));
        let mut short = toml::Table::new();
        if section == "recordings" {
            for table in [&mut written, &mut short] {
                table.insert("train".into(), toml::Value::Array(vec!["a.csv".into()]));
            }
        }
        let unknown = without.iter().filter(|key| !own_or_none.contains(key) && **key != "train");
        assert_eq!(unknown.count(), 0, "[{section}] {without:?}: no default in the schema");
        let read = |table: toml::Table| {
            let file = toml::Table::from_iter([(section.to_string(), toml::Value::Table(table))]);
            format!("{:?}", ExperimentFile::from_table(&file).unwrap())
        };
        assert_eq!(read(written), read(short), "[{section}]");
    }
}

#[test]
fn every_default_of_a_custom_parameter_in_the_schema_is_that_of_the_code() {
    let schema = schema_value();
    let place = "/model/custom/items/parameters/additionalProperties";
    let (written, without) = defaults(pointed(&schema, place));
    assert!(without.is_empty(), "{without:?}: no default in the schema");
    let read = |table: toml::Table| format!("{:?}", table.try_into::<CustomParameter>().unwrap());
    assert_eq!(read(written), format!("{:?}", CustomParameter::default()));
}

#[test]
fn every_default_of_a_method_in_the_schema_is_that_of_the_code() {
    for method in identify::all() {
        let (written, _) = defaults(method.schema().as_value());
        let name = method.describe().name;
        let read = method.configure(&written).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(format!("{read:?}"), format!("{method:?}"), "{name}");
    }
}

/// The diagnosis that the library runs by default is the one of an empty `[diagnosis]`.
#[test]
fn the_defaults_of_a_diagnosis_are_those_of_the_contract() {
    let text = "[simulation]\n[diagnosis]\n";
    let file = ExperimentFile::parse("a.toml", text, &[]).unwrap();
    let plan = resolve(Path::new("a.toml"), text, &file).unwrap();
    let asked = plan.diagnosis.unwrap().settings;
    let of =
        |s: &diagnose::Settings| (s.candidates.clone(), s.own.len(), s.false_alarm, s.max_effects);
    assert_eq!(of(&asked), of(&diagnose::Settings::default()));
    assert_eq!(of(&asked), (vec![], 0, 0.05, 3));
}

/// Symbols and limits of the effects' parameters under `[simulation] hidden`.
#[test]
fn every_limit_of_an_effect_in_the_schema_is_that_of_the_code() {
    let schema = schema_value();
    for effect in effects::all() {
        let id = effect.id();
        let Some(table) = pointed(&schema, "simulation/hidden")["properties"].get(&id) else {
            assert!(effects::BASE.contains(&id.as_str()), "{id}");
            continue;
        };
        let parameters = effect.parameters();
        let symbols = parameters.iter().map(|p| p.symbol.clone()).collect();
        assert_eq!(keys(table), symbols, "{id}");
        for p in parameters {
            let own = &table["properties"][&p.symbol];
            let limits = (own["minimum"].as_f64(), own["maximum"].as_f64());
            let shape = p.kind == effects::ParameterKind::Shape;
            let stated = if shape { (Some(p.range.0), Some(p.range.1)) } else { (None, None) };
            assert_eq!(limits, stated, "{id}.{}", p.symbol);
            let words = own["description"].as_str().unwrap();
            let typical = format!("of the order of {}.", p.typical);
            assert!(words.starts_with(&p.meaning) && words.ends_with(&typical), "{id}: {words}");
        }
    }
}
