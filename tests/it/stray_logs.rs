//! Logs as other programs write them, through `experiment new` and `experiment check`.

use crate::support::{Folder, HEADER, csv, motion};

/// The rows of a simulated robot as lines, the first the header.
fn lines() -> Vec<String> {
    csv(&motion()).lines().map(String::from).collect()
}

/// Starts an experiment on a log, expects these words, and checks it.
fn started(log: &str, words: &[&str], checked: &[&str]) {
    let folder = Folder::new();
    folder.write("run.csv", log);
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, words);
    folder.run(&["check", "e.toml"]).says(0, checked);
}

#[test]
fn stray_lines_cost_their_rows() {
    let mut log = lines();
    log[100] = "Guru Meditation Error: Core 0".into();
    log[200] = HEADER.into();
    log[300] = format!("{}{}", log[300], log[301]);
    log.insert(1, "Logging started".into());
    started(&log.join("\n"), &["dalpha1"], &["597 samples", "4 rows without a number"]);
}

#[test]
fn separators_at_the_end_of_rows_or_of_the_header_name_nothing() {
    let log = lines();
    let rows: Vec<String> = log[1..].iter().map(|row| format!("{row},")).collect();
    let plain = ["dalpha1  = dalpha1"];
    started(&format!("{HEADER}\n{}", rows.join("\n")), &plain, &["600 samples"]);
    started(&format!("{HEADER},\n{}", log[1..].join("\n")), &plain, &["600 samples"]);
    let rows: Vec<String> = log[1..].iter().map(|row| format!("csv,{row}")).collect();
    started(&format!("ready\n{HEADER}\n{}", rows.join("\n")), &plain, &["600 samples"]);
}

#[test]
fn a_state_in_words_is_no_joint() {
    let of = |k: usize| if k % 40 < 20 { "TURN" } else { "DRIVE" };
    let rows: Vec<String> =
        lines()[1..].iter().enumerate().map(|(k, row)| format!("{},{row}", of(k))).collect();
    let log = format!("state,{HEADER}\n{}", rows.join("\n"));
    started(&log, &["dalpha1  = dalpha1"], &["600 samples", "0 gaps"]);
}

#[test]
fn messages_of_several_kinds_in_one_table_keep_the_names_of_their_columns() {
    let rows = motion();
    let both = |row: &[f64; 5]| {
        let [t, w1, w2, m1, m2] = row;
        format!("{t:.3},speed,{w1},{w2},,\n{t:.3},torque,,,{m1},{m2}\n")
    };
    let log: String = rows.iter().map(both).collect();
    let log = format!("t,stream,omega_right,omega_left,torque_right,torque_left\n{log}");
    started(&log, &["dalpha1  = omega_right\n", "M2       = torque_left\n"], &["600 samples"]);
}

#[test]
fn a_clock_of_tenths_of_a_second_is_spread_over_its_rows() {
    let rows: Vec<String> = motion()
        .iter()
        .map(|[t, w1, w2, m1, m2]| {
            format!("{:.1},{w1},{w2},{m1},{m2}", (10.0 * t + 1e-6).floor() / 10.0)
        })
        .collect();
    let log = format!("{HEADER}\n{}", rows.join("\n"));
    started(
        &log,
        &["dalpha1"],
        &["600 samples", "100 Hz", "in steps of 0.1 s, each with 10.0 rows"],
    );
    // a time that stands still is none: the period is asked for, and nothing panics
    let still: String = motion()
        .iter()
        .map(|[_, w1, w2, m1, m2]| format!("1.718e+09,{w1},{w2},{m1},{m2}\n"))
        .collect();
    let folder = Folder::new();
    folder.write("run.csv", format!("{HEADER}\n{still}"));
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &["wrote e.toml"]);
    folder.run(&["check", "e.toml"]).says(2, &["e.toml", "t.period", "write the sampling period"]);
}

#[test]
fn tables_of_ros_messages_are_read() {
    let of = |row: &[f64; 5]| {
        let [t, w1, w2, m1, m2] = row;
        let names = "\"['wheel_left', 'wheel_right']\"";
        format!("{t},{names},\"({w2}, {w1})\",\"({m2}, {m1})\"\n")
    };
    let rows: String = motion().iter().map(of).collect();
    let words = ["dalpha1  = wheel_right.velocity", "M2       = wheel_left.effort"];
    started(&format!("Time,name,velocity,effort\n{rows}"), &words, &["600 samples"]);
    let of = |row: &[f64; 5]| {
        let [t, w1, w2, m1, m2] = row;
        let ns = (1e9 * t).round();
        format!(
            "header:\n  stamp:\n    sec: {}\n    nanosec: {}\nname:\n- wheel_left\n- wheel_right\n\
             velocity:\n- {w2}\n- {w1}\neffort:\n- {m2}\n- {m1}\n---\n",
            (ns / 1e9).floor(),
            ns % 1e9
        )
    };
    let rows: String = motion().iter().map(of).collect();
    started(&rows, &words, &["600 samples", "100 Hz"]);
}

#[test]
fn steps_in_place_of_times_are_summed() {
    let rows = motion();
    let log: String =
        rows.iter().map(|[_, w1, w2, m1, m2]| format!("10,{w1},{w2},{m1},{m2}\n")).collect();
    let log = format!("dt_ms,wR,wL,tauR,tauL\n{log}");
    started(&log, &["t        = dt_ms in ms"], &["600 samples", "100 Hz"]);
    let log: String = rows
        .iter()
        .enumerate()
        .map(|(k, [_, w1, w2, m1, m2])| format!("{k},{w1},{w2},{m1},{m2}\n"))
        .collect();
    let folder = Folder::new();
    folder.write("run.csv", format!("sample,wR,wL,tauR,tauL\n{log}"));
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &["it counts rows", "to be completed"]);
    folder.run(&["check", "e.toml"]).says(2, &["columns.t.scale", "the sampling period [s]"]);
    folder
        .run(&["check", "e.toml", "--set", "recordings.columns.t.scale=0.01"])
        .says(0, &["600 samples", "100 Hz"]);
}
