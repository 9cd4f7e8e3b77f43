//! Keys and values of `[grid]`.

use super::super::ExperimentFile;
use super::*;

fn grid_axes(text: &str) -> Result<Vec<GridAxis>, String> {
    axes(&toml::from_str(text).unwrap()).map_err(|e| format!("{}: {}", e.key, e.message))
}

fn numbers(text: &str) -> Vec<f64> {
    grid_axes(text).unwrap()[0].numbers().unwrap()
}

#[test]
fn values_are_lists_counts_and_ranges() {
    assert_eq!(numbers("noise_scale = [0.0, 0.5, 1]"), [0.0, 0.5, 1.0]);
    assert_eq!(numbers("seed = { count = 3 }"), [1.0, 2.0, 3.0]);
    assert_eq!(numbers("seed = { count = 2, from = 7 }"), [7.0, 8.0]);
    assert_eq!(numbers("noise_scale = { from = 1, to = 2, steps = 3 }"), [1.0, 1.5, 2.0]);
    let log = numbers("noise_scale = { from = 0.1, to = 10.0, steps = 3, log = true }");
    // 1e-12: rounding of one power
    assert!(log[0] == 0.1 && (log[1] - 1.0).abs() < 1e-12 && log[2] == 10.0, "{log:?}");
    let whole = grid_axes("train = { from = 1, to = 3, steps = 3 }").unwrap();
    assert_eq!(whole[0].values, [1, 2, 3].map(Value::Integer), "a count of recordings stays whole");
}

#[test]
fn keys_are_bare_for_the_simulation_and_dotted_for_the_rest() {
    let keys = |text: &str| -> Vec<String> {
        grid_axes(text).unwrap().into_iter().map(|a| a.key).collect()
    };
    assert_eq!(keys("seed = [1]\n\"model.effects\" = [[]]"), ["model.effects", "simulation.seed"]);
    assert_eq!(keys("simulation.seed = [1]"), ["simulation.seed"], "dots without quotes");
    assert_eq!(
        keys("emulator.gain = { from = 1, to = 2, steps = 2 }"),
        ["emulator.gain"],
        "a range below a table"
    );
}

#[test]
fn the_bare_keys_are_those_of_the_simulation() {
    // serde itself lists the fields when one is unknown
    let e = toml::from_str::<ExperimentFile>("[simulation]\nzz = 1").unwrap_err();
    let known: Vec<&str> = e.message().split('`').skip(1).step_by(2).skip(1).collect();
    assert_eq!(known, SIMULATION_KEYS);
}

#[test]
fn wrong_keys_and_values_are_named_with_what_was_meant() {
    let said = |text: &str| grid_axes(text).unwrap_err();
    assert!(said("noise_scal = [1]").contains("did you mean `noise_scale`?"));
    assert!(said("\"modl.effects\" = [[]]").contains("did you mean `model`?"));
    assert!(said("seed = 3").contains("seed: = 3 is not a list"));
    assert!(said("seed = { cont = 3 }").contains("cont"));
    assert!(said("seed = { count = 3, steps = 2 }").contains("is not a range"));
    assert!(said("noise_scale = { from = 0, to = 1, steps = 3, log = true }").contains("positive"));
    assert!(said("seed = [1]\n\"simulation.seed\" = [2]").contains("same key"));
    assert!(said("seed = { count = 100000 }\ntrain = { count = 100 }").contains("combinations"));
}
