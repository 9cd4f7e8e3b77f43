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
    assert!(finding.contains("are not conditioned"), "{finding}");
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

/// A log with angles in place of speeds, in rows that are read block by block.
fn angles(of: impl Fn(usize) -> [f64; 2]) -> String {
    let rows = motion_of(ROWS).into_iter().enumerate().map(|(k, [t, _, _, m1, m2])| {
        let [a1, a2] = of(k);
        format!("{t},{a1},{a2},{m1},{m2}\n")
    });
    std::iter::once("t,alpha1,alpha2,M1,M2\n".to_owned()).chain(rows).collect()
}

#[test]
fn errors_that_are_corrected_in_memory_alone_refuse_a_long_recording() {
    let angle = |k: usize| {
        let t = 0.01 * k as f64;
        [5.0 / 1.3 * (1.0 - (1.3 * t).cos()), 4.0 / 2.1 * (1.0 - (2.1 * t).cos())]
    };
    let mut spikes = motion_of(ROWS);
    for k in [700, 3100, 9000] {
        spikes[k][1] = 250.0;
    }
    let cases = [
        (csv(&spikes), "spikes = false"),
        (angles(|k| angle(k).map(|a| a.rem_euclid(std::f64::consts::TAU))), "unwrap = false"),
        (angles(|k| angle(8 * (k / 8))), "which holds all rows (0.1 GB)"),
    ];
    for (log, said) in cases {
        let folder = Folder::new();
        folder.write("run.csv", log);
        let file = |hold_rows: usize| {
            format!(
                "[recordings]\ntrain = [\"run.csv\"]\nhold_rows = {hold_rows}\n\n\
                 [[method]]\nname = \"torque_regression\"\n"
            )
        };
        folder.write("long.toml", file(5000));
        let limit = "hold_rows = 100000 under [recordings]";
        folder.run(&["check", "long.toml"]).says(2, &["12500 rows", limit, said]);
        folder.write("held.toml", file(100_000));
        folder.run(&["check", "held.toml"]).says(0, &["12500 samples"]);
    }
}
