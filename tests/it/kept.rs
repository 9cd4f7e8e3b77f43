//! Results of other experiments and completed work of an interrupted run are kept.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::support::{Folder, short};

#[test]
fn experiments_of_one_name_do_not_take_each_others_place() {
    let folder = Folder::new();
    for day in ["monday", "tuesday"] {
        std::fs::create_dir(folder.path(day)).unwrap();
        folder.write(&format!("{day}/run.toml"), short(day));
    }
    folder.run(&["monday/run.toml"]).says(0, &[]);
    folder
        .run(&["tuesday/run.toml"])
        .says(2, &["holds the results of", "monday/run.toml", "--out"]);
    // also from folders in which both have the same path
    let inside = |day: &str| folder.run_in(day, &["run.toml", "--out", "../reports"]);
    inside("tuesday").says(2, &["monday/run.toml"]);
    assert_eq!(folder.results("reports/run")["title"], "monday");
    // the same file again, edited and from elsewhere, is the same experiment
    folder.write("monday/run.toml", short("monday again"));
    inside("monday").says(0, &[]);
    assert_eq!(folder.results("reports/run")["title"], "monday again");
    // one that is gone leaves its place
    std::fs::remove_file(folder.path("monday/run.toml")).unwrap();
    inside("tuesday").says(0, &[]);
    // and so do grids
    let grid = short("grid") + "\n[grid]\nnoise_scale = [0.5, 1.0]\n";
    folder.write("run.toml", grid);
    folder.run(&["run.toml"]).says(2, &["tuesday/run.toml"]);
    folder.run(&["run.toml", "--out", "grids"]).says(0, &[]);
    folder.run(&["tuesday/run.toml", "--out", "grids"]).says(2, &["run.toml"]);
}

#[test]
fn recordings_of_one_name_do_not_either_but_their_file_takes_their_place() {
    let folder = Folder::new();
    folder.write("made.toml", short("made").replace("duration_s = 4.0", "duration_s = 20.0"));
    folder.run(&["made.toml"]).says(0, &[]);
    let made = std::fs::read_dir(folder.path("reports/made")).unwrap().flatten();
    let csv = made.map(|e| e.path()).find(|p| p.extension().is_some_and(|e| e == "csv")).unwrap();
    let text = std::fs::read_to_string(csv).unwrap();
    let cut = text.lines().take(1500).collect::<Vec<_>>().join("\n");
    for (day, text) in [("monday", &text), ("tuesday", &cut)] {
        std::fs::create_dir(folder.path(day)).unwrap();
        folder.write(&format!("{day}/run.csv"), text);
    }
    folder.run(&["monday/run.csv"]).says(0, &[]);
    folder.run(&["tuesday/run.csv"]).says(2, &["holds the results of", "monday/run.csv"]);
    folder.run(&["monday/run.csv"]).says(0, &[]);
    folder.run(&["new", "monday/run.csv", "-o", "run.toml"]).says(0, &[]);
    folder.run(&["run.toml"]).says(0, &[]);
}

/// Combinations of a second or so each on one thread.
fn slow_grid() -> String {
    let alone = short("Grid").replace("train      = 1", "train      = 2");
    let alone = alone.replace("duration_s = 4.0", "duration_s = 20.0");
    alone.replace("torque_regression", "output_error") + "\n[grid]\nseed = { count = 10 }\n"
}

#[cfg(unix)]
#[test]
fn a_grid_that_is_interrupted_says_how_to_go_on_and_goes_on() {
    let folder = Folder::new();
    folder.write("g.toml", slow_grid());
    let journal = "reports/g/grid.journal.jsonl";
    let mut child = Command::new(env!("CARGO_BIN_EXE_experiment"))
        .args(["g.toml", "--jobs", "1"])
        .current_dir(folder.path(""))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = || if folder.has(journal) { folder.read(journal).lines().count() } else { 0 };
    while lines() < 2 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(signal.success(), "the grid was done before it was interrupted");
    let ended = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(130), "{said}");
    assert!(said.contains("interrupted: reports keeps the finished combinations"), "{said}");
    assert!(said.contains("the same command runs the others"), "{said}");
    let kept = folder.read(journal);
    let whole: Vec<&str> = kept.split_inclusive('\n').filter(|line| line.ends_with('\n')).collect();
    assert!(whole.len() >= 2 && whole.len() < 10 && !folder.has("reports/g/results.json"));
    // wall times in its lines tell a combination that was kept from one that ran again
    folder.run(&["g.toml"]).says(0, &["10 combinations"]);
    assert!(folder.read(journal).starts_with(&whole.concat()), "finished combinations ran again");
}
