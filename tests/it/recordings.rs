//! Recordings of a robot in a 3-D physics engine, whose equations of motion are not this
//! project's: the diagnosis must name what was hidden, and the fit must find the construction.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::support::{Folder, root};

/// The folder of a case: shipped with the project, or beside it, where the others may be.
fn case(name: &str) -> Option<PathBuf> {
    let places = [
        root().join("recordings/simulated_3d").join(name),
        root().join("../shared/recordings/simulated_3d").join(name),
    ];
    let found = places.iter().find(|p| p.join("train_1.csv").exists());
    if found.is_none() {
        println!("skipped: the recordings of {name} are not in {}", places[1].display());
    }
    found.cloned()
}

fn results(recordings: &Path, more: &str) -> Value {
    let folder = Folder::new();
    let file = |name: &str| format!("{:?}", recordings.join(name).display().to_string());
    let text = format!(
        "[recordings]\ntrain = [{}, {}]\nvalidation = [{}]\n\n\
         [[method]]\nname = \"prediction_error\"\n\n{more}",
        file("train_1.csv"),
        file("train_2.csv"),
        file("validation.csv")
    );
    folder.write("e.toml", text);
    folder.run(&["e.toml"]).says(0, &[" rad/s, noise floor "]);
    folder.results("reports/e")
}

/// What the diagnosis says of a case.
fn diagnosis(name: &str) -> Option<Value> {
    case(name).map(|folder| results(&folder, "[diagnosis]\nmax_effects = 2\n")["diagnosis"].clone())
}

fn found(d: &Value) -> Vec<&str> {
    d["found"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect()
}

/// The first effect found is the hidden one, and the verdict is that an effect is missing.
fn names_first(name: &str) {
    let Some(d) = diagnosis(name) else { return };
    assert_eq!(d["verdict"], "effects_missing", "{}", d["sentence"]);
    assert_eq!(found(&d).first(), Some(&name), "{}", d["ranking"]);
}

#[test]
fn slope_is_named_in_the_shipped_recordings() {
    assert!(case("slope").is_some(), "these recordings ship with the project");
    names_first("slope");
}

#[test]
fn the_construction_is_found_once_the_slope_is_in_the_model() {
    let r = results(&case("slope").unwrap(), "[model]\neffects = [\"slope\"]\n");
    let m = &r["methods"][0];
    // Values of plain least squares on the noise-free engine. Tolerances: 1 % of a1 (noise of the
    // torques is 0.5 % of their rms) for the inertias, of which a2 is a small difference; tyre
    // contacts of the engine slip a little, which moves a3 and the friction levels by a few percent.
    let expected = [
        ("a1", 0.03185, 3e-4),
        ("a2", -0.00242, 3e-4),
        ("a3", 0.000293, 3e-5),
        ("a4", 0.125, 0.004),
        ("a5", 0.125, 0.004),
    ];
    for (symbol, value, tolerance) in expected {
        let list = m["parameters"].as_array().unwrap();
        let p = list.iter().find(|p| p["symbol"] == symbol).unwrap();
        let error = p["value"].as_f64().unwrap() - value;
        assert!(error.abs() < tolerance, "{symbol}: {p}");
    }
}

#[test]
fn nothing_is_missing_where_nothing_was_hidden() {
    let Some(d) = diagnosis("nothing") else { return };
    assert_eq!(d["verdict"], "model_sufficient", "{}", d["ranking"]);
    assert!(found(&d).is_empty());
}

#[test]
fn turning_scrub_is_named() {
    names_first("turning_scrub");
}

#[test]
fn actuator_lag_is_named() {
    names_first("actuator_lag");
}

#[test]
fn viscous_friction_is_named_with_what_is_indistinguishable_from_it() {
    let Some(d) = diagnosis("viscous_friction") else { return };
    assert_eq!(d["verdict"], "effects_missing");
    // two unequal constants: one for both wheels and then the difference, or one for each wheel
    let found = found(&d);
    let class = ["viscous_friction", "back_emf"].contains(&found[0]);
    let each = found.len() == 2 && found.iter().all(|f| f.starts_with("viscous_friction_"));
    assert!(class || each, "{found:?}: {}", d["ranking"]);
}
