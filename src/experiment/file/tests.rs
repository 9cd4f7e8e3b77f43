//! Valid experiment files, and all kinds of invalid ones.

use super::*;

const FULL: &str = r#"
title = "Floor run of 3 March <script>"
[robot]
preset = "amigobot"
[recordings]
train = ["run1.csv", "run2.csv"]
validation = ["run3.csv"]
columns = { t = "time", dalpha1 = { name = "right_rpm", unit = "rpm" }, M1 = "tau_r" }
drive_unit = "N m"
[model]
effects = ["viscous_friction"]
fixed = { a3 = 2.9e-4, a1 = "construction" }
[[method]]
name = "output_error"
[emulator]
gain = 0.0
[diagnosis]
candidates = "all"
false_alarm = 0.05
max_effects = 3
[grid]
noise_scale = [0.0, 0.5, 1, 2, 4]
seed = { count = 100 }
"#;

fn error(text: &str) -> String {
    ExperimentFile::parse("a.toml", text, &[]).unwrap_err().to_string()
}

#[test]
fn the_file_of_the_contract_is_read() {
    let file = ExperimentFile::parse("a.toml", FULL, &[]).unwrap();
    assert_eq!(file.title.as_deref(), Some("Floor run of 3 March <script>"));
    let recordings = file.recordings.unwrap();
    assert_eq!(recordings.columns["dalpha1"].unit.as_deref(), Some("rpm"));
    assert_eq!(recordings.columns["t"].name, "time");
    assert_eq!(file.model.fixed["a3"], FixedEntry::Value(2.9e-4));
    assert!(file.grid.unwrap().contains_key("seed"));
}

#[test]
fn an_unknown_key_is_named_with_line_and_the_key_that_was_meant() {
    let e = error("[simulation]\nmovement = \"paper\"\n\n[model]\nefects = []\n");
    assert!(e.contains("a.toml: line 5") && e.contains("did you mean `effects`?"), "{e}");
}

#[test]
fn an_unknown_key_of_a_column_is_named_with_the_key_that_was_meant() {
    let e = error("[recordings]\ntrain = [\"a\"]\n[recordings.columns]\nM1 = { nme = \"tau\" }\n");
    assert!(e.contains("line 4") && e.contains("did you mean `name`?"), "{e}");
}

#[test]
fn a_wrong_type_is_named_with_its_line() {
    let e = error("[simulation]\nmovement = \"paper\"\nseed = \"one\"\n");
    assert!(e.contains("line 3") && e.contains("seed = \"one\""), "{e}");
}

#[test]
fn values_that_make_no_sense_are_named_with_their_key() {
    let s = "[simulation]\nmovement = \"paper\"\n";
    assert!(error("title = \"x\"\n").contains("[recordings] is missing"));
    assert!(error("[recordings]\ntrain = []\n").contains("recordings.train is empty"));
    let named = error("[simulation]\nmovement = \"loop\"\n");
    assert!(named.contains("line 2: expected \"paper\", \"rich\"") && named.contains("\"loop\""));
    assert!(error("[simulation]\nnoise = { dalpha = -1.0 }\n").contains("simulation.noise"));
    assert!(error(&format!("{s}[diagnosis]\nfalse_alarm = 2.0\n")).contains("between 0 and 1"));
    assert!(
        error(&format!("{s}[emulator]\ngain = 1.0\npoles = [-1.0, -2.0]\n")).contains("keep one")
    );
}

#[test]
fn overrides_change_any_key_and_are_checked_like_the_file() {
    let text = "[simulation]\nmovement = \"paper\"\n";
    let set = |entry: &str| ExperimentFile::parse("a.toml", text, &[entry.to_string()]);
    assert_eq!(set("simulation.seed=7").unwrap().simulation.unwrap().seed, 7);
    assert_eq!(set("title=plain words").unwrap().title.as_deref(), Some("plain words"));
    assert_eq!(set("model.effects=[\"slope\"]").unwrap().model.effects, ["slope"]);
    let e = set("simulation.sede=7").unwrap_err().to_string();
    assert!(e.contains("--set") && e.contains("did you mean `seed`?"), "{e}");
    assert!(set("nonsense").unwrap_err().to_string().contains("KEY=VALUE"));
}

proptest::proptest! {
    #[test]
    fn any_text_gives_a_file_or_an_error_and_never_a_panic(text in ".{0,200}") {
        let _ = ExperimentFile::parse("a.toml", &text, &[]);
    }
}

#[test]
fn what_is_open_and_how_a_named_column_is_written_can_be_set() {
    let text = "[recordings]\ntrain = [\"a\"]\n[recordings.columns]\nM1 = \"pwm\"\n\
                alpha1 = { name = \"e\", per_turn = \"?\" }\n";
    assert!(error(text).contains("per_turn = \"?\" is still open"));
    let set = |key: &str| format!("recordings.columns.{key}");
    let sets = [set("alpha1.per_turn=512"), set("M1.scale=0.5")];
    let columns = ExperimentFile::parse("a.toml", text, &sets).unwrap().recordings.unwrap().columns;
    assert_eq!(columns["alpha1"].per_turn, Some(512.0));
    assert_eq!((columns["M1"].name.as_str(), columns["M1"].scale), ("pwm", Some(0.5)));
}
