//! Logs as consoles of microcontrollers print them, through `experiment new`, `check` and a run.

use crate::support::{Folder, Row, motion};

/// A line for each row.
fn log(line: impl Fn(usize, &Row) -> String) -> String {
    motion().iter().enumerate().map(|(k, row)| line(k, row) + "\r\n").collect()
}

/// The time of a serial monitor.
fn clock(t: f64) -> String {
    format!("14:30:{t:06.3}")
}

/// Starts an experiment on a log, expects these words, and checks it.
fn started(log: &str, words: &[&str], checked: &[&str]) {
    let folder = Folder::new();
    folder.write("run.txt", log);
    folder.run(&["new", "run.txt", "-o", "e.toml"]).says(0, words);
    folder.run(&["check", "e.toml"]).says(0, checked);
}

/// A log, what is refused of it by `new`.
fn refused(log: &str, words: &[&str]) {
    let folder = Folder::new();
    folder.write("run.txt", log);
    folder.run(&["new", "run.txt", "-o", "e.toml"]).says(2, words);
    assert!(!folder.has("e.toml"));
}

const READ: [&str; 2] = ["600 samples", "100 Hz"];

#[test]
fn labels_with_a_colon_and_a_space_are_names() {
    let names = ["t        = clock", "dalpha1  = w_r", "M2       = tau_l"];
    for between in [" ", ", ", " | ", " || ", "; ", "\t"] {
        let line = |_: usize, [t, w1, w2, m1, m2]: &Row| {
            let pairs = [("w_r", w1), ("w_l", w2), ("tau_r", m1), ("tau_l", m2)];
            let words: Vec<String> = pairs.iter().map(|(n, x)| format!("{n}: {x:.5}")).collect();
            format!("{} -> {}", clock(*t), words.join(between))
        };
        started(&log(line), &names, &READ);
    }
    // in columns, with a state in words and the time as a label
    let line = |_: usize, [t, w1, w2, m1, m2]: &Row| {
        format!(
            "t = {t:6.2} mode = RUN wR = {w1:9.4} wL = {w2:9.4} tauR = {m1:9.5} tauL = {m2:9.5}"
        )
    };
    started(&log(line), &["t        = t", "dalpha1  = wR"], &READ);
}

#[test]
fn words_and_numbers_with_units_are_read_as_printed() {
    let rpm = 60.0 / std::f64::consts::TAU;
    let line = |_: usize, [t, w1, w2, m1, m2]: &Row| {
        let (l, r) = (rpm * w2, rpm * w1);
        format!(
            "[{:6.2}s] PID | L {l:7.3}rpm tau {m2:+.5}  R {r:7.3}rpm tau {m1:+.5} | bat 8.1V",
            t + 9.0
        )
    };
    let text = format!("\n===== two motors =====\nI2C scan: 0x40 0x68\n{}", log(line));
    started(&text, &["t        = clock", "dalpha1  = R [rpm] in rpm", "M1       = R.tau"], &READ);
}

#[test]
fn lines_of_several_kinds_are_parted_by_their_first_word() {
    let line = |_: usize, [t, w1, w2, m1, m2]: &Row| {
        format!("STATE:{t:.2},{w1:.5},{w2:.5},{m1:.5},{m2:.5}\nIMU:0.100,0.020,9.800")
    };
    let columns = "recordings.columns={ t = 'STATE.1', dalpha1 = 'STATE.2', dalpha2 = 'STATE.3', \
                   M1 = 'STATE.4', M2 = 'STATE.5' }";
    for separator in [":", ",", " ", ": "] {
        let folder = Folder::new();
        let between = if separator == " " { " " } else { "," };
        let text = log(line).replace(',', between).replace(':', separator);
        folder.write("run.txt", text);
        folder.run(&["new", "run.txt", "-o", "e.toml"]).says(0, &["wrote e.toml"]);
        assert!(folder.read("e.toml").contains("IMU.3"));
        folder.run(&["check", "e.toml", "--set", columns]).says(0, &READ);
    }
    // kinds with as many numbers each, and the time of the monitor on every line
    let line = |_: usize, [t, w1, w2, m1, m2]: &Row| {
        let clock = clock(*t);
        format!("{clock} -> w,{w1:.5},{w2:.5}\n{clock} -> tau,{m1:.5},{m2:.5}")
    };
    started(&log(line), &["dalpha1  = w.1", "M2       = tau.2"], &READ);
}

#[test]
fn the_time_of_a_serial_monitor_is_a_column_beside_any_table() {
    let cells = |[_, w1, w2, m1, m2]: &Row| format!("{w1:.5},{w2:.5},{m1:.5},{m2:.5}");
    let headed = |_: usize, row: &Row| format!("{} -> {}", clock(row[0]), cells(row));
    let text = format!("14:29:59.000 -> wR,wL,tauR,tauL\n{}", log(headed));
    started(&text, &["t        = clock", "dalpha1  = wR"], &READ);
    let line = |_: usize, row: &Row| format!("{} -> TELEM,{}", clock(row[0]), cells(row));
    let folder = Folder::new();
    folder.write("run.txt", log(line));
    folder.run(&["new", "run.txt", "-o", "e.toml"]).says(0, &["t        = clock"]);
    let columns = "recordings.columns={ t = 'clock', dalpha1 = 'column2', dalpha2 = 'column3', \
                   M1 = 'column4', M2 = 'column5' }";
    folder.run(&["check", "e.toml", "--set", columns]).says(0, &READ);
}

#[test]
fn cells_with_one_unit_are_numbers_in_it() {
    let row = |factor: f64, unit: &str| {
        log(|k, [_, w1, w2, m1, m2]| {
            let t = format!("{:.9}", 0.01 * k as f64 / factor);
            let t = t.trim_end_matches('0').trim_end_matches('.');
            format!("{t} {unit},{w2:.5},{w1:.5},{m2:.5},{m1:.5}")
        })
    };
    for (unit, factor) in [("sec", 1.0), ("ms", 1e-3), ("min", 60.0), ("hr", 3600.0)] {
        let folder = Folder::new();
        folder.write("run.csv", format!("Time,wL,wR,tauL,tauR\r\n{}", row(factor, unit)));
        folder
            .run(&["new", "run.csv", "-o", "e.toml"])
            .says(0, &["t        = Time [", "dalpha1  = wR"]);
        folder.run(&["check", "e.toml"]).says(0, &READ);
        // under its name
        let named = "recordings.columns.t='Time'";
        folder.run(&["check", "e.toml", "--set", named]).says(0, &READ);
    }
    // another unit further down is no number of the first
    let text = row(1.0, "sec").replace("5 sec", "5 min");
    let folder = Folder::new();
    folder.write("run.csv", format!("Time,wL,wR,tauL,tauR\r\n{text}"));
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &[]);
    folder.run(&["check", "e.toml"]).says(2, &["run.csv", "row 6", "expected a number"]);
}

#[test]
fn a_period_stands_for_a_time_that_was_not_recorded() {
    let folder = Folder::new();
    let line = |_: usize, [_, w1, w2, m1, m2]: &Row| format!("{w1},{w2},{m1},{m2}");
    let text = format!("wR,wL,tauR,tauL\r\n{}", log(line));
    folder.write("run.csv", &text).write("bare.csv", log(line));
    let words = ["No column increases steadily", "t = { period = 0.02 }", "to be completed"];
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &words);
    folder.run(&["check", "e.toml"]).says(2, &["columns.t.period", "the sampling period [s]"]);
    for set in ["recordings.columns.t.period=0.01", "recordings.columns.t={ period = 0.01 }"] {
        folder.run(&["check", "e.toml", "--set", set]).says(0, &READ);
    }
    let columns = "dalpha1 = \"wR\"\ndalpha2 = \"wL\"\nM1 = \"tauR\"\nM2 = \"tauL\"\n";
    let file = |t: &str| {
        format!(
            "[recordings]\ntrain = [\"run.csv\"]\n[recordings.columns]\nt = {t}\n{columns}\n[[method]]\nname = \"prediction_error\"\n"
        )
    };
    folder.write("run.toml", file("{ period = 0.01 }"));
    folder.run(&["run.toml"]).says(0, &["run: "]);
    let recording = &folder.results("reports/run")["recordings"][0];
    assert!((recording["duration_s"].as_f64().unwrap() - 5.99).abs() < 1e-9, "{recording}");
    folder.write("e.toml", file("\"?\""));
    folder.run(&["check", "e.toml", "--set", "recordings.columns.t.period=0.01"]).says(0, &READ);
    for wrong in ["{ period = 0.0 }", "{ period = -1.0 }", "{ name = \"t\", period = 0.01 }"] {
        folder.write("e.toml", file(wrong));
        folder.run(&["check", "e.toml"]).says(2, &["columns.t", "t = { period = 0.02 }", "found"]);
    }
    folder.write("e.toml", file("{ unit = \"s\" }"));
    folder.run(&["check", "e.toml"]).says(2, &["missing field `name`"]);
    folder.write("e.toml", file("{ period = 0.01 }").replace("\"wR\"", "{ period = 0.01 }"));
    folder.run(&["check", "e.toml"]).says(2, &["columns.dalpha1", "it is allowed in `t` only"]);
}

#[test]
fn a_period_counts_the_rows_of_a_long_recording() {
    let folder = Folder::new();
    let line = |_: usize, [_, w1, w2, m1, m2]: &Row| format!("{w1},{w2},{m1},{m2}");
    let text = format!("dalpha1,dalpha2,M1,M2\n{}", log(line).repeat(4));
    let file = "[recordings]\ntrain = [\"run.csv\"]\nhold_rows = 1000\n[recordings.columns]\n\
                t = { period = 0.01 }\n[[method]]\nname = \"torque_regression\"\n";
    folder.write("run.csv", text).write("e.toml", file);
    folder.run(&["check", "e.toml"]).says(0, &["2400"]);
}

#[test]
fn a_text_without_numbers_is_quoted_with_the_forms_that_are_read() {
    let words = ["run.txt, line 1 `", "was not understood", "`l: 134 r: -5`"];
    refused("left is fast and right is slow\nleft is slow\n", &words);
    refused(&"<row><l>a</l><r>b</r></row>\n".repeat(20), &words);
    let folder = Folder::new();
    let file = "[recordings]\ntrain = [\"run.txt\"]\n";
    folder.write("run.txt", "left is fast\nright is slow\n").write("e.toml", file);
    folder.run(&["check", "e.toml"]).says(2, &words);
}
