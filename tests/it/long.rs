//! Recordings of more rows than are held, and experiments of very many recordings.

use serde_json::Value;

use crate::support::{Folder, csv, motion_of};

/// Rows of the recording: two and a half windows of 5000.
const ROWS: u32 = 12_500;

fn results(hold_rows: usize) -> Value {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion_of(ROWS)));
    let text = format!(
        "[recordings]\ntrain = [\"run.csv\"]\nhold_rows = {hold_rows}\n\n\
         [[method]]\nname = \"torque_regression\"\n\n\
         [[method]]\nname = \"constrained_regression\"\n"
    );
    folder.write("e.toml", text);
    folder.run(&["e.toml"]).says(0, &["2 s simulation error"]);
    folder.results("reports/e")
}

#[test]
fn a_recording_that_is_not_held_gives_the_parameters_of_one_that_is() {
    let (read, held) = (results(5000), results(1_000_000));
    assert_eq!(read["recordings"][0]["samples"], ROWS);
    let finding = read["recordings"][0]["findings"][0].as_str().unwrap();
    assert!(finding.starts_with("12500 rows are more than are held"), "{finding}");
    let of = |results: &Value, method: usize| results["methods"][method].clone();
    let (one, other) = (of(&read, 0), of(&held, 0));
    for j in 0..5 {
        let at = |v: &Value, key: &str| v["parameters"][j][key].as_f64().unwrap();
        // the windows are all of the recording, so cut-off and speed near rest are the same too
        let apart = (at(&one, "value") - at(&other, "value")).abs() / at(&other, "std_error");
        let ratio = at(&one, "std_error") / at(&other, "std_error") - 1.0;
        assert!(apart < 1e-6 && ratio.abs() < 1e-6, "{j}: {apart:e}, {ratio:e}");
    }
    assert!(one["notes"].to_string().contains("All 12500 rows were read block by block"), "{one}");
    let fit = of(&read, 1)["notes"].to_string();
    assert!(fit.contains("Fitted to 3 windows"), "{fit}");
}

#[test]
fn a_limit_that_is_too_small_is_refused() {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion_of(600)));
    folder.write("e.toml", "[recordings]\ntrain = [\"run.csv\"]\nhold_rows = 10\n");
    folder.run(&["check", "e.toml"]).says(2, &["hold_rows = 10 must be 1000 or more"]);
}
