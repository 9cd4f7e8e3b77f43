//! The commands that a report names as the next step, typed as they stand there.

use crate::support::Folder;

/// Tyres resist turning; two recordings to fit and one to judge.
const SCRUB: &str = r#"[simulation]
movement   = "rich"
hidden     = { turning_scrub = { f_t = 0.02 } }
noise      = { dalpha = 0.05, alpha = 0.001, M = 0.005 }
seed       = 2
train      = 2
validation = 1
duration_s = 25
[[method]]
name = "torque_regression"
[diagnosis]
candidates  = ["turning_scrub", "viscous_friction"]
max_effects = 1
"#;

/// The commands of the paragraph that begins with "Next step".
fn commands(folder: &Folder, report: &str) -> Vec<String> {
    let html = folder.read(report);
    let step = html.split("<p>Next step").nth(1).expect("a next step");
    let step = step.split("</p>").next().unwrap();
    let codes = step.split("<code>").skip(1).filter_map(|s| s.split("</code>").next());
    codes.map(|code| code.replace("&quot;", "\"")).collect()
}

/// Types commands as a shell splits them: at spaces outside quotes.
fn type_all(folder: &Folder, commands: &[String]) {
    for command in commands {
        let mut words: Vec<String> = vec![];
        for (k, piece) in command.split('"').enumerate() {
            match k % 2 {
                1 => words.push(piece.to_owned()),
                _ => words.extend(piece.split_whitespace().map(str::to_owned)),
            }
        }
        assert_eq!(words.remove(0), "experiment", "{command}");
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        folder.run(&words).says(0, &[]);
    }
}

#[test]
fn a_file_in_a_folder_is_named_with_its_folder() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("runs")).unwrap();
    folder.write("runs/scrub.toml", SCRUB).run(&["runs/scrub.toml"]).says(0, &[]);
    let found = commands(&folder, "reports/scrub/report.html");
    assert_eq!(found, ["experiment add turning_scrub runs/scrub.toml"]);
    type_all(&folder, &found);
}

#[test]
fn recordings_without_a_file_get_one_first() {
    let folder = Folder::new();
    folder.write("made.toml", SCRUB).run(&["made.toml"]).says(0, &[]);
    let names = ["floor run 1.csv", "floor run 2.csv", "floor run 3.csv"];
    for (name, made) in names.iter().zip(["train_1", "train_2", "validation_1"]) {
        folder.write(name, folder.read(&format!("reports/made/simulated_{made}.csv")));
    }
    folder.run(&[&names[..], &["--out", "out"]].concat()).says(0, &["turning_scrub"]);
    let found = commands(&folder, "out/floor run 1/report.html");
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found[0].ends_with("-o \"floor run 1.toml\"") && found[1].ends_with("--out out"),
        "{found:?}"
    );
    type_all(&folder, &found);
    assert!(folder.read("floor run 1.toml").contains("\"turning_scrub\""));
}

/// The pile of a carpet in recordings that a simulation made; the candidates leave it out.
const PILE: &str = include_str!("../../experiments/outside_catalogue.toml");

#[test]
fn what_the_catalogue_does_not_have_is_written_as_a_formula_that_removes_the_error() {
    let folder = Folder::new();
    folder.write("pile.toml", PILE).run(&["pile.toml"]).says(0, &["as a resistance to the motion"]);
    let diagnosis = |name: &str| -> serde_json::Value {
        let results = folder.read(&format!("reports/{name}/results.json"));
        serde_json::from_str(&results).unwrap()
    };
    let results = diagnosis("pile");
    assert_eq!(results["diagnosis"]["verdict"], "unknown_effect");
    assert_eq!(results["diagnosis"]["found"].as_array().map(Vec::len), Some(0));
    let formula = &results["diagnosis"]["formula"];
    assert_eq!(formula["id"], "heading_resistance");
    let floor = results["noise_floor"]["window_rms"]["validation"][0].as_f64().unwrap();
    let error = formula["window_rms"].as_f64().unwrap();
    // the series holds the pile, so that what is left is noise and what its estimates scatter by
    assert!(error < 1.2 * floor, "{error} {floor}");
    let block = formula["toml"].as_str().unwrap();
    folder.write("with.toml", format!("{PILE}\n{block}"));
    let added = folder.run(&["add", "heading_resistance", "with.toml"]);
    added.says(0, &["Nothing is missing"]);
}
