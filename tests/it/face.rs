//! Commands, result folder and `results.json`, as users and other programs meet them.

use serde_json::Value;

use crate::exported::{is_here, run};
use crate::support::{Folder, csv, motion};

/// A robot whose tyres resist turning, which the model lacks.
const SMALL: &str = r#"# a comment at the top
title = "Small"

[simulation]
movement   = "rich"          # a comment beside a key
hidden     = { turning_scrub = { f_t = 0.02 } }
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
seed       = 2
train      = 1
validation = 1
duration_s = 8

[[method]]
name = "prediction_error"

[diagnosis]
candidates  = ["turning_scrub", "viscous_friction", "slope"]
max_effects = 1
"#;

fn small() -> Folder {
    let folder = Folder::new();
    folder.write("small.toml", SMALL);
    folder
}

/// The movement of 8 s turns one way only and does not distinguish scrub from unequal Coulomb levels; the
/// longer ones pivot both ways.
fn long() -> String {
    SMALL.replace("train      = 1", "train      = 2").replace("duration_s = 8", "duration_s = 25")
}

#[test]
fn the_result_folder_has_all_that_the_contract_names() {
    let folder = small();
    let ran = folder.run(&["small.toml", "--out", "out"]);
    ran.says(0, &["small: ", "out/small/report.html"]);
    for file in ["report.html", "results.json", "experiment.toml", "estimates.parquet"] {
        assert!(folder.has(&format!("out/small/{file}")), "{file}");
    }
    assert_eq!(folder.read("out/small/experiment.toml"), SMALL);
    let page = folder.read("out/small/report.html");
    for outside in ["src=\"http", "href=\"http", "@import", "url(http"] {
        assert!(!page.contains(outside), "the page opens offline: {outside}");
    }
}

#[test]
fn every_figure_is_there_as_png_and_as_svg() {
    let folder = small();
    folder.run(&["small.toml", "--out", "out"]).says(0, &[]);
    let names: Vec<_> = std::fs::read_dir(folder.path("out/small"))
        .unwrap()
        .map(|e| e.unwrap().path())
        // the picture of the index is no figure
        .filter(|p| p.extension().is_some_and(|e| e == "png") && !p.ends_with("thumbnail.png"))
        .collect();
    assert!(!names.is_empty(), "no PNG");
    let page = folder.read("out/small/report.html");
    // the page has everything in it but the SVG files, and opens at once
    assert!(page.len() < 3_500_000, "{} bytes", page.len());
    for name in names {
        let bytes = std::fs::read(&name).unwrap();
        assert!(bytes.starts_with(b"\x89PNG"), "{}", name.display());
        let drawing = std::fs::read_to_string(name.with_extension("svg")).unwrap();
        assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>"));
        let link = format!("href=\"{}.svg\"", name.file_stem().unwrap().to_string_lossy());
        assert!(page.contains(&link), "{link}");
    }
}

/// Checks that an object has these keys.
fn keys(value: &Value, place: &str, keys: &[&str]) {
    let object = value.as_object().unwrap_or_else(|| panic!("{place} is no object: {value}"));
    for key in keys {
        assert!(object.contains_key(*key), "{place} has no `{key}`: {:?}", object.keys());
    }
}

fn each<'a>(value: &'a Value, place: &str) -> &'a Vec<Value> {
    let list = value.as_array().unwrap_or_else(|| panic!("{place} is not a list: {value}"));
    assert!(!list.is_empty(), "{place} is empty");
    list
}

#[test]
fn results_json_has_the_keys_of_the_contract() {
    let folder = Folder::new();
    folder.write("small.toml", long());
    folder.run(&["small.toml"]).says(0, &["turning_scrub"]);
    let r = folder.results("reports/small");
    keys(&r, "results", &["schema", "experiment", "recordings", "methods", "noise_floor"]);
    keys(&r, "results", &["failures", "diagnosis"]);
    assert_eq!(r["schema"], 1);
    assert_eq!(r["experiment"], "small");
    for entry in each(&r["recordings"], "recordings") {
        keys(entry, "recording", &["role", "file", "samples", "duration_s", "noise"]);
        keys(&entry["noise"], "noise", &["dalpha1", "dalpha2", "M1", "M2"]);
        assert!(entry["samples"].as_u64().unwrap() > 100);
    }
    for entry in each(&r["methods"], "methods") {
        method(entry);
    }
    for quantity in ["ise", "window_rms"] {
        roles(&r["noise_floor"][quantity], quantity);
    }
    for entry in each(&r["failures"], "failures") {
        keys(entry, "failure", &["regime", "wheel", "share_of_ise", "ratio_to_noise", "p_value"]);
    }
    diagnosis(&r["diagnosis"]);
}

fn roles(value: &Value, place: &str) {
    keys(value, place, &["train", "validation"]);
    for role in ["train", "validation"] {
        for v in each(&value[role], place) {
            assert!(v.as_f64().unwrap() > 0.0, "{place}.{role}: {v}");
        }
    }
}

fn method(m: &Value) {
    keys(m, "method", &["method", "status", "seconds", "parameters", "ise", "window_rms"]);
    keys(m, "method", &["ise_emulator"]);
    assert_eq!(m["status"], "converged");
    assert_eq!(each(&m["parameters"], "parameters").len(), 5);
    for p in each(&m["parameters"], "parameters") {
        keys(p, "parameter", &["symbol", "value", "std_error", "ci95", "unit", "identifiable"]);
        let ci = each(&p["ci95"], "ci95");
        let (low, value, high) = (ci[0].as_f64(), p["value"].as_f64(), ci[1].as_f64());
        assert!(low < value && value < high, "{p}");
    }
    roles(&m["ise"], "ise");
    roles(&m["window_rms"], "window_rms");
    keys(&m["ise_emulator"], "ise_emulator", &["parallel", "serial_parallel"]);
    keys(&m["ise_emulator"]["parallel"], "parallel", &["validation"]);
    keys(&m["ise_emulator"]["serial_parallel"], "serial_parallel", &["validation"]);
}

fn diagnosis(d: &Value) {
    let names = ["verdict", "found", "ranking", "staircase", "unexplained_fraction", "next_run"];
    keys(d, "diagnosis", &names);
    assert_eq!(d["verdict"], "effects_missing");
    assert_eq!(d["found"], serde_json::json!(["turning_scrub"]));
    for c in each(&d["ranking"], "ranking") {
        keys(c, "candidate", &["effect", "probability", "indistinguishable", "p_value"]);
        keys(c, "candidate", &["delta_bic", "ise_validation_before", "ise_validation_after"]);
        keys(c, "candidate", &["parameters"]);
    }
    let best = &d["ranking"][0];
    assert_eq!(best["effect"], "turning_scrub");
    for p in each(&best["parameters"], "parameters") {
        keys(p, "parameter", &["symbol", "value", "std_error", "unit"]);
    }
    let stairs = each(&d["staircase"], "staircase");
    for step in stairs {
        keys(step, "step", &["added", "ise_validation", "window_rms_validation"]);
    }
    assert!(stairs[0]["added"].is_null());
    assert_eq!(stairs[1]["added"], "turning_scrub");
}

fn without_seconds(mut value: Value) -> Value {
    for method in value["methods"].as_array_mut().unwrap() {
        method.as_object_mut().unwrap().remove("seconds");
    }
    value
}

#[test]
fn the_same_file_and_seed_give_the_same_results_whatever_the_jobs() {
    let folder = small();
    let ran = |jobs: &str| {
        let out = format!("out{jobs}");
        folder.run(&["small.toml", "--out", &out, "--jobs", jobs]).says(0, &[]);
        without_seconds(folder.results(&format!("{out}/small")))
    };
    let one = ran("1");
    assert_eq!(ran("2"), one);
    assert_eq!(ran("5"), one);
    folder.run(&["small.toml", "--jobs", "0"]).says(2, &["--jobs 0"]);
    folder.run(&["small.toml", "--jobs", "x"]).says(2, &["--jobs"]);
}

#[test]
fn set_overrides_a_key_and_quiet_prints_nothing() {
    let folder = small();
    let ran = folder.run(&[
        "small.toml",
        "--set",
        "simulation.seed=7",
        "--set",
        "model.effects=[\"turning_scrub\"]",
        "--set",
        "title=Other",
        "--quiet",
    ]);
    ran.says(0, &[]);
    assert_eq!(ran.out, "");
    let results = folder.results("reports/small");
    let symbols: Vec<&str> = results["methods"][0]["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["symbol"].as_str().unwrap())
        .collect();
    assert_eq!(symbols, ["a1", "a2", "a3", "a4", "a5", "f_t"]);
    assert!(folder.read("reports/small/report.html").contains("Other"));
    folder.run(&["small.toml", "--set", "simulation.sede=7"]).says(2, &["`seed`"]);
    folder.run(&["small.toml", "--set", "nonsense"]).says(2, &["KEY=VALUE"]);
    folder.run(&["small.toml", "--set", "title.a=1"]).says(2, &["--set"]);
}

#[test]
fn check_says_what_would_be_done_and_writes_nothing() {
    let folder = small();
    let words =
        ["small.toml: Small", "a1, a2, a3, a4, a5", "prediction_error", "simulated train 1"];
    folder.run(&["check", "small.toml"]).says(0, &words);
    assert!(!folder.has("reports"));
    folder.run(&["check", "small.toml", "gone.toml"]).says(2, &["Small", "gone.toml"]);
    folder.run(&["check"]).says(2, &[]);
    folder.run(&[]).says(2, &["Usage"]);
}

#[test]
fn the_catalogues_list_all_and_tell_one_in_full() {
    let folder = Folder::new();
    let listed = folder.run(&["effects"]);
    listed.says(0, &[]);
    for id in "viscous_friction viscous_friction_1 viscous_friction_2 back_emf coulomb_asymmetry \
               stribeck quadratic_drag torque_offset slope turning_scrub yaw_viscous caster_drag \
               payload lateral_com wheel_radius_mismatch actuator_lag actuator_delay torque_gain \
               torque_saturation backlash_deadzone torque_ripple wheel_eccentricity \
               friction_warmup load_transfer_friction wheel_slip compliance"
        .split_whitespace()
    {
        assert!(listed.out.lines().any(|l| l.starts_with(&format!("{id} "))), "{id}");
        folder.run(&["effects", id]).says(0, &[id, "equation", "in data", "parameters"]);
    }
    folder.run(&["effects", "slop"]).says(2, &["slop", "did you mean `slope`?"]);
    folder.run(&["methods"]).says(0, &["prediction_error", "fuzzy"]);
    folder.run(&["methods", "prediction_error"]).says(0, &["prediction_error"]);
    folder.run(&["methods", "predictionerror"]).says(2, &["did you mean `prediction_error`?"]);
    folder.run(&["efects"]).says(2, &[]);
}

#[test]
fn the_manual_page_has_one_title_and_every_command_with_its_options() {
    let folder = Folder::new();
    let page = folder.run(&["man"]);
    let commands = ["new", "run", "add", "check", "export", "merge", "effects", "methods"];
    let heads = commands.map(|c| format!(".SH \"experiment {c}\""));
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    page.says(0, &[&heads[..], &["EXIT STATUS", ".SS OPTIONS", "experiment new"]].concat());
    let titles: Vec<&str> = page.out.lines().filter(|line| line.starts_with(".TH")).collect();
    assert!(titles.len() == 1 && titles[0].starts_with(".TH experiment 1"), "{titles:?}");
    for shell in ["bash", "zsh", "fish"] {
        folder.run(&["completions", shell]).says(0, &["export", "completions"]);
    }
}

#[test]
fn new_writes_a_file_that_check_accepts_and_that_is_never_overwritten() {
    let folder = Folder::new();
    folder.write("a.csv", csv(&motion())).write("b.csv", csv(&motion()[50..]));
    folder.run(&["new", "a.csv", "b.csv", "-o", "my.toml"]).says(0, &["wrote my.toml"]);
    folder.run(&["check", "my.toml"]).says(0, &["a.csv: 600 samples", "b.csv", "100 Hz"]);
    let written = folder.read("my.toml");
    assert!(written.contains('#'));
    folder.run(&["new", "a.csv", "-o", "my.toml"]).says(2, &["my.toml", "already"]);
    assert_eq!(folder.read("my.toml"), written);
    folder.run(&["new", "a.csv"]).says(0, &["wrote a.toml"]);
    folder.run(&["a.toml", "--out", "out"]).says(0, &["out/a/report.html"]);
    folder.run(&["new", "gone.csv"]).says(2, &["gone.csv"]);
    assert!(!folder.has("gone.toml"));
    // a log of another program: other names, other units, and a file in another folder
    let odd =
        csv(&motion()).replace("t,dalpha1,dalpha2,M1,M2", "time,right_rpm,left_rpm,tau_r,tau_l");
    std::fs::create_dir(folder.path("logs")).unwrap();
    folder.write("logs/odd.csv", odd);
    folder.run(&["new", "logs/odd.csv", "-o", "odd.toml"]).says(0, &["right_rpm in rpm"]);
    folder.run(&["check", "odd.toml"]).says(0, &["odd.csv: 600 samples"]);
    folder.run(&["new", "logs/odd.csv", "-o", "logs/deep.toml"]).says(0, &[]);
    folder.run(&["check", "logs/deep.toml"]).says(0, &["odd.csv: 600 samples"]);
}

#[test]
fn the_schema_is_printed_and_new_files_name_one_that_lies_beside_them() {
    let folder = Folder::new();
    folder.write("a.csv", csv(&motion()));
    let schema = folder.run(&["schema"]).says(0, &[]).out.clone();
    let parsed: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(parsed["$schema"], "http://json-schema.org/draft-07/schema#");
    folder.run(&["new", "a.csv", "-o", "without.toml"]).says(0, &[]);
    assert!(!folder.read("without.toml").contains("#:schema"));
    folder.write("experiment.schema.json", schema);
    folder.run(&["new", "a.csv", "-o", "with.toml"]).says(0, &[]);
    assert!(folder.read("with.toml").starts_with("#:schema ./experiment.schema.json\n"));
    folder.run(&["check", "with.toml"]).says(0, &[]);
}

/// The 2 s simulation error on validation of the first method.
fn window_error(folder: &Folder) -> f64 {
    folder.results("reports/small")["methods"][0]["window_rms"]["validation"][0].as_f64().unwrap()
}

#[test]
fn a_formula_of_the_file_is_tried_beside_the_catalogue_and_can_be_added() {
    let folder = Folder::new();
    let hidden = "{ cubic = { k3 = 2e-4 } }";
    let formula = "[[model.custom]]\nid = \"cubic\"\ntorque1 = \"k3 * w^3\"\n\
                   parameters = { k3 = { range = [0.0, 1.0], typical = 1e-4 } }\n";
    let text = SMALL
        .replace("{ turning_scrub = { f_t = 0.02 } }", hidden)
        .replace("[\"turning_scrub\", \"viscous_friction\", \"slope\"]", "\"all\"");
    folder.write("mine.toml", format!("{text}\n{formula}"));
    folder.run(&["check", "mine.toml"]).says(0, &["all effects and the formulas cubic"]);
    folder.run(&["mine.toml"]).says(0, &["Missing: cubic"]);
    folder.run(&["add", "cubic", "mine.toml"]).says(0, &["added cubic", "Nothing is missing"]);
}

#[test]
fn add_keeps_the_comments_and_lowers_the_error() {
    let folder = Folder::new();
    let text = long();
    folder.write("small.toml", &text);
    folder.run(&["small.toml"]).says(0, &[]);
    let before = window_error(&folder);
    folder
        .run(&["add", "turning_scrub", "small.toml"])
        .says(0, &["added turning_scrub", "->", " % less)"]);
    assert!(window_error(&folder) < 0.5 * before, "{before} -> {}", window_error(&folder));
    let written = folder.read("small.toml");
    for line in text.lines() {
        assert!(written.contains(line), "lost: {line}");
    }
    assert!(written.contains("effects = [\"turning_scrub\"]"), "{written}");
    folder.run(&["add", "turning_scrub", "small.toml"]).says(2, &["small.toml", "turning_scrub"]);
    folder.run(&["add", "turning_scrap", "small.toml"]).says(2, &["did you mean `turning_scrub`?"]);
    folder.run(&["add", "slope", "gone.toml"]).says(2, &["gone.toml"]);
    assert_eq!(folder.read("small.toml"), written);
}

#[test]
fn a_key_that_does_nothing_is_named_and_equal_findings_are_said_once() {
    let folder = Folder::new();
    let file = "title = \"\"\n[simulation]\nmovement = \"paper\"\nduration_s = 60\ntrain = 2\n\
                [[method]]\nname = \"torque_regression\"\n";
    folder.write("e.toml", file);
    let unused = "warning     simulation.duration_s has no effect";
    let note = "note        all 3 recordings: wheel 1 (right) turns forward only";
    let ran = folder.run(&["check", "e.toml"]);
    ran.says(0, &["e.toml: e\n", unused, note]);
    let ran = folder.run(&["e.toml"]);
    ran.says(0, &["e: 2 s simulation error"]);
    assert!(ran.err.contains("warning: e: simulation.duration_s has no effect"), "{}", ran.err);
    assert!(folder.read("reports/e/report.html").contains("<h1>e</h1>"));
}

#[test]
fn progress_is_shown_on_a_terminal_and_nowhere_else() {
    let folder = small();
    let piped = folder.run(&["small.toml", "--quiet"]);
    assert_eq!((piped.out.as_str(), piped.err.as_str()), ("", ""));
    assert!(!folder.run(&["small.toml"]).err.contains("fitting"));
    // a terminal is what `script` of util-linux gives
    if !is_here("script") {
        return;
    }
    folder.write("long.toml", long());
    let command = format!("{} long.toml", env!("CARGO_BIN_EXE_experiment"));
    let shown =
        run(&folder, "script", &["--quiet", "--return", "--command", &command, "/dev/null"]);
    assert!(shown.contains("long: fitting") && shown.contains("of this round"), "{shown}");
}
