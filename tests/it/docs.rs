//! What the documentation says of the program is what the program does.

use std::fs;
use std::path::Path;

use amigo_ident::conditioning::{CONDITIONING, IMPORT};
use amigo_ident::diagnose::{Settings, THRESHOLDS};
use amigo_ident::effects;
use amigo_ident::identify::{self, MethodOption, options_schema};
use amigo_ident::report::format;

/// The options of a method; those that all fuzzy methods share stand under the name `fuzzy`.
fn options(name: &str) -> Option<Vec<MethodOption>> {
    let of = |name: &str| identify::find(name).map(|method| method.options());
    let own = of("fuzzy_anfis")?;
    let shared: Vec<MethodOption> =
        of("fuzzy_genetic")?.into_iter().filter(|option| own.contains(option)).collect();
    match name {
        "fuzzy" => Some(shared),
        _ if name.starts_with("fuzzy_") => {
            Some(of(name)?.into_iter().filter(|option| !shared.contains(option)).collect())
        }
        _ => of(name),
    }
}

fn table(options: &[MethodOption]) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    let row =
        |o: &MethodOption| format!("| `{}` | `{}` | {} |\n", o.key, o.default, cell(&o.meaning));
    let rows: String = options.iter().map(row).collect();
    format!("| option | default | meaning |\n|---|---|---|\n{rows}")
}

/// The page with every table between `<!-- options of NAME -->` and `<!-- end -->` made anew.
fn with_tables(page: &str) -> String {
    let mut parts = page.split("<!-- options of ");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once(" -->\n").expect("the mark of a table ends its line");
        let (_, after) = rest.split_once("<!-- end -->").expect("a table ends with its mark");
        let options = options(name).unwrap_or_else(|| panic!("no method `{name}`"));
        out.push_str(&format!(
            "<!-- options of {name} -->\n{}<!-- end -->{after}",
            table(&options)
        ));
    }
    out
}

#[test]
fn the_tables_of_options_are_those_of_the_methods() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/methods.md");
    let page = fs::read_to_string(&path).unwrap();
    for method in identify::all() {
        let name = method.describe().name;
        let own = options(&name).unwrap();
        let mark = format!("<!-- options of {name} -->");
        assert!(own.is_empty() || page.contains(&mark), "docs/methods.md has no table {mark}");
    }
    let present = with_tables(&page);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &present).unwrap();
    }
    assert!(page == present, "docs/methods.md is out of date; run the test with UPDATE_DOCS=1");
}

fn project_file(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

#[test]
fn the_pages_of_the_effects_state_the_parameters_of_the_catalogue() {
    for effect in effects::all() {
        let id = effect.id();
        let page = project_file(&format!("docs/effects/{id}.md"));
        for p in effect.parameters() {
            let unit = if p.unit.is_empty() { "1" } else { &p.unit };
            let range = [p.range.0, p.range.1].map(format::number).join(" to ");
            let row = format!("| `{}` | {} | {unit} | {range} |", p.symbol, p.meaning);
            assert!(page.contains(&row), "docs/effects/{id}.md lacks the row {row}");
        }
    }
}

#[test]
fn python_diagnoses_with_the_defaults_of_the_library() {
    let text = project_file("python/amigo_ident/_study.py");
    let Settings { false_alarm, max_effects, .. } = Settings::default();
    for default in [
        format!("false_alarm: float = {false_alarm},"),
        format!("max_effects: int = {max_effects},"),
    ] {
        assert!(text.contains(&default), "python/amigo_ident/_study.py lacks `{default}`");
    }
}

/// Limits with their schema: a table, or, of a list by subject, a heading and a table for each.
fn limits<T: schemars::JsonSchema + serde::Serialize>(limits: &T) -> String {
    let schema = serde_json::to_value(options_schema::<T>()).unwrap();
    let values = serde_json::to_value(limits).unwrap();
    tables(&schema["properties"], &values, &serde_json::to_string(limits).unwrap())
}

/// The same of the fields of a struct and their values, in the order in which they are `written`, where "the same" means
/// the one above.
fn tables(fields: &serde_json::Value, values: &serde_json::Value, written: &str) -> String {
    let place = |key: &String| written.find(&format!("\"{key}\":")).unwrap();
    let mut fields: Vec<_> = fields.as_object().unwrap().iter().collect();
    fields.sort_by_key(|(key, _)| place(key));
    let meaning =
        |field: &serde_json::Value| field["description"].as_str().unwrap().replace('\n', " ");
    if values.as_object().unwrap().values().any(serde_json::Value::is_object) {
        let subject = |(key, field): (&String, &serde_json::Value)| {
            let table = tables(&field["properties"], &values[key], &written[place(key)..]);
            format!("### `{key}`\n{}\n\n{table}", meaning(field))
        };
        return fields.into_iter().map(subject).collect::<Vec<_>>().join("\n");
    }
    let row = |(key, field): (&String, &serde_json::Value)| {
        format!("| `{key}` | {} | {} |\n", values[key], meaning(field))
    };
    let rows: String = fields.into_iter().map(row).collect();
    format!("| threshold | value | reason |\n|---|---|---|\n{rows}")
}

/// The page with other tables behind a mark.
fn with_limits(page: &str, mark: &str, tables: &str) -> String {
    let (before, rest) = page.split_once(mark).unwrap();
    let (_, after) = rest.split_once("<!-- end -->").unwrap();
    format!("{before}{mark}\n{tables}<!-- end -->{after}")
}

#[test]
fn the_page_of_thresholds_is_that_of_the_code() {
    let page = project_file("docs/thresholds.md");
    let present = with_limits(&page, "<!-- thresholds -->", &limits(&THRESHOLDS));
    let present = with_limits(&present, "<!-- import -->", &limits(&IMPORT));
    let present = with_limits(&present, "<!-- conditioning -->", &limits(&CONDITIONING));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/thresholds.md");
        fs::write(path, &present).unwrap();
    }
    assert!(page == present, "docs/thresholds.md is out of date; run the test with UPDATE_DOCS=1");
}
