mod defaults;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Map;

use super::super::grid::TABLES;
use super::*;
use crate::identify;
use crate::io::contract_units;
use crate::robot::Construction;

/// What of a value the schema refuses: the places. A check of the keywords that the schema uses; it
/// fails on any other, so that none is passed over.
fn refused(schema: &Value, value: &Value, place: &str, out: &mut Vec<String>) {
    let Some(schema) = schema.as_object() else {
        if *schema == Value::Bool(false) {
            out.push(format!("{place} is not allowed"));
        }
        return;
    };
    let fits = |schema: &Value| {
        let mut errors = vec![];
        refused(schema, value, place, &mut errors);
        errors.is_empty()
    };
    let fitting = |list: &Value| list.as_array().unwrap().iter().filter(|s| fits(s)).count();
    let (number, length) = (value.as_f64(), value.as_array().map(Vec::len));
    let size = value.as_object().map(Map::len);
    for (keyword, wanted) in schema {
        let limit = wanted.as_f64();
        let good = match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "then" | "additionalProperties" => {
                true
            }
            "properties" | "patternProperties" | "propertyNames" => true,
            "type" => is_a(value, wanted.as_str().expect("one type")),
            "const" => value == wanted,
            "enum" => wanted.as_array().unwrap().contains(value),
            "anyOf" => fitting(wanted) > 0,
            "oneOf" => fitting(wanted) == 1,
            "not" => !fits(wanted),
            "if" => !fits(wanted) || fits(&schema["then"]),
            "required" => {
                wanted.as_array().unwrap().iter().all(|key| {
                    value.as_object().is_none_or(|v| v.contains_key(key.as_str().unwrap()))
                })
            }
            "minimum" => number.is_none_or(|x| x >= limit.unwrap()),
            "maximum" => number.is_none_or(|x| x <= limit.unwrap()),
            "exclusiveMinimum" => number.is_none_or(|x| x > limit.unwrap()),
            "exclusiveMaximum" => number.is_none_or(|x| x < limit.unwrap()),
            "minItems" => length.is_none_or(|n| n as f64 >= limit.unwrap()),
            "maxItems" => length.is_none_or(|n| n as f64 <= limit.unwrap()),
            "minProperties" => size.is_none_or(|n| n as f64 >= limit.unwrap()),
            "maxProperties" => size.is_none_or(|n| n as f64 <= limit.unwrap()),
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    let own =
                        wanted.as_array().map_or(wanted, |tuple| &tuple[i.min(tuple.len() - 1)]);
                    refused(own, item, &format!("{place}[{i}]"), out);
                }
                true
            }
            other => panic!("the check has no case for `{other}`"),
        };
        if !good {
            out.push(format!("{place} = {value}: {keyword}"));
        }
    }
    for (key, value) in value.as_object().into_iter().flatten() {
        let place = format!("{place}.{key}");
        if let Some(names) = schema.get("propertyNames") {
            refused(names, &key.as_str().into(), &place, out);
        }
        // the one pattern of the schema: dotted keys of [grid]
        let dotted = || {
            let patterns = schema.get("patternProperties")?.as_object()?;
            let (table, rest) = key.split_once('.')?;
            let fits = TABLES.contains(&table) && rest.split('.').all(|part| !part.is_empty());
            patterns.values().next().filter(|_| fits)
        };
        let own = schema.get("properties").and_then(|p| p.get(key)).or_else(dotted);
        if let Some(own) = own.or_else(|| schema.get("additionalProperties")) {
            refused(own, value, &place, out);
        }
    }
}

fn is_a(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("no type `{other}`"),
    }
}

fn complaints(text: &str) -> Vec<String> {
    let table: toml::Table = toml::from_str(text).unwrap_or_else(|e| panic!("{text}: {e}"));
    let mut out = vec![];
    refused(&schema_value(), &serde_json::to_value(table).unwrap(), "", &mut out);
    out
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

#[test]
fn the_schema_that_ships_is_the_present_one() {
    let path = root().join("schemas/experiment.schema.json");
    let shipped = fs::read_to_string(&path).unwrap();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(path, json_schema()).unwrap();
    }
    let remedy = "experiment schema > schemas/experiment.schema.json";
    assert!(shipped == json_schema(), "out of date; run: {remedy}");
}

#[test]
fn every_experiment_file_of_the_project_fits_the_schema() {
    let mut seen = 0;
    for folder in ["experiments", "measured", "benchmarks"] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "toml") {
                let wrong = complaints(&fs::read_to_string(&path).unwrap());
                assert!(wrong.is_empty(), "{}: {wrong:?}", path.display());
                seen += 1;
            }
        }
    }
    assert!(seen >= 10, "{seen} files");
}

/// The examples of the guide: every fenced block of TOML with a table that only experiment files
/// have.
#[test]
fn the_examples_of_the_guide_fit_the_schema() {
    let mut seen = 0;
    for name in ["docs/files.md", "docs/grids.md"] {
        let text = fs::read_to_string(root().join(name)).unwrap();
        for block in text.split("```toml\n").skip(1) {
            let block = block.split("```").next().unwrap();
            if !block.contains("[recordings]") && !block.contains("[simulation]") {
                continue;
            }
            let wrong = complaints(block);
            assert!(wrong.is_empty(), "{name}: {wrong:?}\n{block}");
            seen += 1;
        }
    }
    assert!(seen > 0);
}

/// Keys that the parser names when it meets one that it does not have.
fn keys_of_parser(text: &str) -> BTreeSet<String> {
    let message = toml::from_str::<ExperimentFile>(text).unwrap_err().message().to_string();
    assert!(message.starts_with("unknown field `zzz`"), "{message}\n{text}");
    message.split('`').skip(3).step_by(2).map(str::to_string).collect()
}

fn keys(schema: &Value) -> BTreeSet<String> {
    schema["properties"].as_object().expect("a table").keys().cloned().collect()
}

#[test]
fn parser_and_schema_have_the_same_keys_in_every_table() {
    let schema = schema_value();
    let tables = [
        ("", "zzz = 1"),
        ("/recordings", "[recordings]\ntrain = []\nzzz = 1"),
        (
            "/recordings/columns/M1/anyOf/1",
            "[recordings]\ntrain=[]\ncolumns = { M1 = { zzz = 1 } }",
        ),
        ("/simulation", "[simulation]\nzzz = 1"),
        ("/simulation/noise", "[simulation]\nnoise = { zzz = 1 }"),
        ("/model", "[model]\nzzz = 1"),
        ("/model/custom/items", "[[model.custom]]\nzzz = 1"),
        (
            "/model/custom/items/parameters/additionalProperties",
            "[[model.custom]]\nid = \"a\"\ntorque1 = \"b\"\nparameters = { k = { zzz = 1 } }",
        ),
        ("/emulator", "[emulator]\nzzz = 1"),
        ("/diagnosis", "[diagnosis]\nzzz = 1"),
    ];
    for (place, text) in tables {
        let own = pointed(&schema, place);
        assert_eq!(keys(own), keys_of_parser(text), "{place}");
        assert_eq!(own["additionalProperties"], Value::Bool(false), "{place}");
    }
    let segment = &pointed(&schema, "/simulation/movement")["anyOf"][1]["items"];
    let expected = ["speed_m_s", "turn_rad_s", "blend_s", "hold_s"];
    assert_eq!(keys(segment), expected.map(String::from).into());
    let robot = Construction::amigobot();
    let expected = robot.values().map(|(key, _)| key.to_string()).chain(["preset".into()]);
    assert_eq!(keys(pointed(&schema, "/robot")), expected.collect());
}

/// The schema at a path of keys; `items`, `anyOf` and the like are keywords.
fn pointed<'a>(schema: &'a Value, place: &str) -> &'a Value {
    let mut at = schema;
    for part in place.split('/').filter(|p| !p.is_empty()) {
        at = match part.parse::<usize>() {
            Ok(index) => &at[index],
            Err(_) if ["items", "anyOf", "additionalProperties"].contains(&part) => &at[part],
            Err(_) => &at["properties"][part],
        };
    }
    at
}

#[test]
fn every_option_of_every_method_is_typed_and_read_back_from_its_default() {
    let schema = schema_value();
    let blocks = schema["properties"]["method"]["items"]["anyOf"].as_array().unwrap();
    assert_eq!(blocks.len(), identify::all().len());
    for (method, block) in identify::all().iter().zip(blocks) {
        let said = method.describe();
        let mut expected: BTreeSet<String> = method.options().into_iter().map(|o| o.key).collect();
        expected.insert("name".into());
        assert_eq!(keys(block), expected, "{}", said.name);
        for option in method.options() {
            let (key, default) = (&option.key, &option.default);
            let typed = &block["properties"][key];
            let known = ["type", "anyOf", "oneOf", "enum"].iter().any(|k| typed.get(k).is_some());
            assert!(known, "{}.{key}: {typed}", said.name);
            // without a default there is no value
            let Ok(table) = toml::from_str::<toml::Table>(&format!("{key} = {default}")) else {
                assert_eq!(default, "unset", "{}.{key}", said.name);
                continue;
            };
            assert!(method.configure(&table).is_ok(), "{}.{key} = {default}", said.name);
            let mut wrong = vec![];
            refused(typed, &serde_json::to_value(&table[key]).unwrap(), key, &mut wrong);
            assert!(wrong.is_empty(), "{}: {wrong:?}", said.name);
        }
        let unknown: toml::Table = toml::from_str("zzz = 1").unwrap();
        assert!(method.configure(&unknown).is_err(), "{}", said.name);
    }
}

/// Whether the program reads the text, and whether the schema lets it pass.
fn judged(text: &str) -> (bool, bool) {
    let read = ExperimentFile::parse("a.toml", text, &[]).and_then(|file| {
        let path = Path::new("a.toml");
        crate::experiment::resolve::resolve(path, text, &file).map_err(|e| {
            super::super::FileError::Value {
                file: String::new(),
                key: String::new(),
                message: e.to_string(),
            }
        })
    });
    (read.is_ok(), complaints(text).is_empty())
}

#[test]
fn every_bound_of_the_schema_is_the_bound_of_the_program() {
    let schema = schema_value();
    let mut seen = 0;
    for table in ["simulation", "diagnosis"] {
        for (key, own) in schema["properties"][table]["properties"].as_object().unwrap() {
            let bounds = ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"];
            for bound in bounds.iter().filter_map(|b| Some((b, own.get(b)?.as_f64()?))) {
                let (name, at) = bound;
                let down = name.to_lowercase().contains("minimum");
                let beyond = if down { at - 0.5 } else { at + 0.5 };
                let whole = own["type"] == "integer";
                let beyond = if whole { (at - 1.0).to_string() } else { format!("{beyond:?}") };
                let text = |value: &str| {
                    let source = if table == "diagnosis" { "[simulation]\n" } else { "" };
                    format!("{source}[{table}]\n{key} = {value}\n")
                };
                let file = |text: &str| ExperimentFile::parse("a.toml", text, &[]).is_ok();
                assert!(!file(&text(&beyond)), "{table}.{key} = {beyond} is read");
                assert!(!complaints(&text(&beyond)).is_empty(), "{table}.{key} = {beyond} passes");
                let end = if whole { at.to_string() } else { format!("{at:?}") };
                let open = name.starts_with("exclusive");
                assert_eq!(file(&text(&end)), !open, "{table}.{key} = {end}");
                seen += 1;
            }
        }
    }
    assert!(seen >= 12, "{seen} bounds");
}

#[test]
fn the_schema_refuses_what_the_program_refuses_and_lets_pass_what_it_reads() {
    let short = "[simulation]\nmovement = \"rich\"\nduration_s = 2.0\ntrain = 1\nvalidation = 0\n";
    let cases = [
        ("", true),
        ("[model]\neffects = [\"turning_scrub\"]", true),
        ("[model]\neffects = [\"turning_scrib\"]", false),
        ("[model]\neffects = [\"inertia\"]", false),
        ("[model]\nfixed = { a3 = \"construction\", a1 = 0.03 }", true),
        ("[model]\nfixed = { a3 = \"built\" }", false),
        ("[robot]\npreset = \"e_puck\"", true),
        ("[robot]\npreset = \"e_pück\"", false),
        ("[robot]\npreset = \"amigobot\"\nl1_m = 0.2", true),
        ("[robot]\nl1_m = 0.2", false),
        ("[robot]\npreset = \"amigobot\"\nl1_m = \"0.2\"", false),
        ("[[method]]\nname = \"weak_form\"\nhalf_width_s = 0.1", true),
        ("[[method]]\nname = \"weak_form\"\niterations = 5", false),
        ("[[method]]\nname = \"fuzzy_gradient\"\nrange = [0.0, 30.0]\nmemberships = 5", true),
        ("[[method]]\nname = \"fuzzy_gradient\"\nrange = \"dada\"", false),
        ("[[method]]\nname = \"fuzzy_least_squares\"\nstructure = \"parallel\"", false),
        ("[[method]]\nhalf_width_s = 0.1", false),
        ("[emulator]\ngain = 1", true),
        ("[emulator]\ngain = 1.0\npoles = [1.0, 2.0]", false),
        ("[emulator]\npoles = [1.0, 2.0, 3.0]", false),
        ("[diagnosis]\ncandidates = [\"slope\"]", true),
        // a formula of the file may have any name; the program finds which there are
        ("[diagnosis]\ncandidates = [3]", false),
        ("[diagnosis]\ncandidates = \"some\"", false),
        ("[recordings]\ntrain = [\"a.csv\"]", false),
        ("[grid]\n\"model.effects\" = [[], [\"slope\"]]\nseed = { count = 2 }", true),
        ("[grid]\nsede = [1]", false),
        ("[grid]\nseed = { cuont = 2 }", false),
        ("[grid]", false),
    ];
    for (more, good) in cases {
        let text = format!("{short}{more}\n");
        let (read, passed) = judged(&text);
        // the keys of [grid] are judged when the experiment is loaded, not by the parser
        let read = read && (good || !more.starts_with("[grid]"));
        assert_eq!((read, passed), (good, good), "{more}: {:?}", complaints(&text));
    }
    let hidden = |table: &str| format!("{short}hidden = {{ {table} }}\n");
    assert_eq!(judged(&hidden("slope = { }")), (true, true));
    assert_eq!(judged(&hidden("turning_scrub = { f_t = 0.02 }")), (true, true));
    assert_eq!(judged(&hidden("turning_scrub = { f_s = 0.02 }")), (false, false));
    assert_eq!(judged(&hidden("turning_scrib = { f_t = 0.02 }")), (false, false));
}

#[test]
fn units_of_columns_are_those_that_the_program_converts() {
    for (key, units) in contract_units() {
        for unit in units {
            let column = |more: &str| {
                format!(
                    "[recordings]\ntrain = [\"a\"]\ncolumns = {{ {key} = {{ name = \"x\", unit = \"{unit}\"{more} }} }}\n"
                )
            };
            assert!(complaints(&column("")).is_empty(), "{key} in {unit}");
            // with what some units need, one of the units of the input reads every spelling
            let read = ["N m", "V", "A"].iter().any(|input| {
                let unit_of_input = toml::from_str::<ExperimentFile>(&format!(
                    "{}drive_unit = \"{input}\"\n",
                    column(match *input {
                        "N m" => ", per_turn = 500.0, torque_constant = 0.1",
                        _ => ", per_turn = 500.0",
                    })
                ));
                let entry = unit_of_input.unwrap().recordings.unwrap();
                let mut map = crate::io::ColumnMap::new(entry.drive_unit, Some(0.1));
                map.put(key, entry.columns[key].clone().into()).is_ok()
            });
            assert!(read, "{key} in {unit}");
        }
    }
    let knots =
        "[recordings]\ntrain = [\"a\"]\ncolumns = { dalpha1 = { name = \"x\", unit = \"knots\" } }";
    assert!(!complaints(knots).is_empty());
}
