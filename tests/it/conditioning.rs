//! Logs as they come: dirty rows, other names and units, recordings in place of a file.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde_json::Value;

use crate::support::{Folder, Row, csv, motion, motion_of, on, root, text};

/// What conditioning found in the first recording.
fn found(folder: &Folder, results: &str) -> Vec<(String, String, String)> {
    let results = folder.results(results);
    let list = results["recordings"][0]["conditioning"].as_array().unwrap().clone();
    let word = |f: &Value, key: &str| f[key].as_str().unwrap().to_string();
    list.iter().map(|f| (word(f, "channel"), word(f, "finding"), word(f, "action"))).collect()
}

#[test]
fn a_duplicate_row_a_blank_cell_and_a_wrong_stamp_cost_a_row_each_and_are_said() {
    let mut lines: Vec<String> = csv(&motion()).lines().map(String::from).collect();
    lines[100] = lines[99].clone();
    lines[200] = "1.99,,1.0,0.1,0.1".into();
    lines[300] = lines[300].replacen("2.99", "0.0", 1);
    let folder = Folder::new();
    folder.write("run.csv", lines.join("\n")).write("e.toml", on("run.csv"));
    let words = [
        "1 row without a number",
        "row 200",
        "2 rows whose time",
        "rows = false switches this off",
    ];
    folder.run(&["check", "e.toml"]).says(0, &words);
    folder.run(&["e.toml"]).says(0, &["left out"]);
    assert_eq!(folder.results("reports/e")["recordings"][0]["samples"], 597);
    let all = found(&folder, "reports/e");
    assert_eq!(all[0], ("t".into(), "missing_values".into(), "corrected".into()));
    folder.write("strict.toml", format!("[conditioning]\nrows = false\n\n{}", on("run.csv")));
    folder.run(&["check", "strict.toml"]).says(2, &["run.csv, row 100", "does not exceed"]);
}

/// The columns of a table of `columns` in a block of the docs, and their units.
fn columns(block: &toml::Table) -> Vec<(String, String, String)> {
    let Some(columns) = block.get("recordings").and_then(|r| r.get("columns")) else {
        return vec![];
    };
    let mut out = Vec::new();
    for (key, column) in columns.as_table().unwrap() {
        let of = |k: &str| column.get(k).and_then(toml::Value::as_str).unwrap_or_default();
        let name = column.as_str().unwrap_or_else(|| of("name"));
        let unit = if of("sign").is_empty() { of("unit") } else { "magnitude" };
        out.push((key.clone(), name.to_string(), unit.to_string()));
        if !of("sign").is_empty() {
            out.push((key.replace('M', "sign"), of("sign").to_string(), String::new()));
        }
        for other in column.get("plus").and_then(toml::Value::as_array).into_iter().flatten() {
            out.push((key.clone(), other.as_str().unwrap().to_string(), unit.to_string()));
        }
        for other in ["nanoseconds", "times"] {
            if !of(other).is_empty() {
                out.push((other.into(), of(other).to_string(), String::new()));
            }
        }
    }
    out
}

/// A log with those columns that moves like a robot.
fn log(columns: &[(String, String, String)]) -> String {
    let names: BTreeSet<&String> = columns.iter().map(|(_, name, _)| name).collect();
    let mut out = names.iter().map(|n| n.as_str()).collect::<Vec<_>>().join(",") + "\n";
    let rows = motion_of(800);
    let mut angles = [0.0, 0.0];
    for row in &rows {
        (0..2).for_each(|i| angles[i] += 0.01 * row[1 + i]);
        let value = |name: &String| {
            let (key, _, unit) = columns.iter().find(|(_, n, _)| n == name).unwrap();
            let of = |i: usize| match (key.as_str(), unit.as_str()) {
                ("t", "ms") => 1e3 * row[0],
                ("t", "us") => 1e6 * row[0],
                ("t", _) => row[0],
                ("alpha1" | "alpha2", _) => (angles[i] * 8192.0 / std::f64::consts::TAU).round(),
                ("dalpha1" | "dalpha2", "rpm") => row[1 + i] * 60.0 / std::f64::consts::TAU,
                ("dalpha1" | "dalpha2", "m/s") => row[1 + i] * 0.0762,
                ("nanoseconds", _) => 0.0,
                ("times", _) => 12_000.0,
                ("sign1" | "sign2", _) => f64::from(u8::from(row[3 + i] >= 0.0)),
                (_, "magnitude") => row[3 + i].abs(),
                (_, "mA") => 1e3 / 0.05 * row[3 + i],
                _ => row[3 + i],
            };
            of(usize::from(key.ends_with('2'))).to_string()
        };
        out += &names.iter().map(|n| value(n)).collect::<Vec<_>>().join(",");
        out.push('\n');
    }
    out
}

#[test]
fn the_examples_of_the_docs_are_accepted_as_they_stand() {
    let docs = std::fs::read_to_string(root().join("docs/files.md")).unwrap();
    let blocks: Vec<&str> =
        docs.split("```toml\n").skip(1).map(|b| b.split("```").next().unwrap()).collect();
    assert!(blocks.len() >= 5, "{}", blocks.len());
    for block in blocks {
        let folder = Folder::new();
        let table: toml::Table = toml::from_str(block).unwrap();
        let columns = columns(&table);
        let plain = csv(&motion());
        for file in [
            "run1.csv",
            "run2.csv",
            "log.csv",
            "pwm.csv",
            "magnitudes.csv",
            "counts_per_10ms.csv",
            "drive.csv",
            "skid.csv",
        ] {
            let all = if columns.is_empty() { plain.clone() } else { log(&columns) };
            // a copy of the other one would be no validation
            let rows = all.lines().count() - if file == "run2.csv" { 50 } else { 0 };
            folder
                .write(file, all.lines().take(rows).map(|l| format!("{l}\n")).collect::<String>());
        }
        folder.write("e.toml", block);
        let ran = folder.run(&["check", "e.toml"]);
        assert_eq!(ran.code, 0, "{block}\n{}{}", ran.out, ran.err);
        // counts per turn are a unit, and a voltage has back-EMF
        for absent in [" alpha1 in rad", "the model has no back_emf"] {
            assert!(!ran.out.contains(absent), "{block}\n{}", ran.out);
        }
    }
}

fn odd(rows: &[Row]) -> String {
    text(rows, "time_ms;wR;wL;curR;curL", ";", |x| format!("{x}").replace('.', ","), "\n")
}

#[test]
fn recordings_in_place_of_a_file_run_and_leave_no_file_unless_it_is_named() {
    let folder = Folder::new();
    let mut rows = motion();
    rows.iter_mut().for_each(|r| r[0] *= 1e3);
    folder.write("a.csv", odd(&rows)).write("b.csv", odd(&rows[50..]));
    folder
        .run(&["a.csv", "b.csv"])
        .says(0, &["reports/a/report.html", "dalpha1  = wR", "input in A"]);
    assert!(!folder.has("a.toml"));
    let recordings = folder.results("reports/a")["recordings"].as_array().unwrap().clone();
    let roles: Vec<&str> = recordings.iter().map(|r| r["role"].as_str().unwrap()).collect();
    assert_eq!(roles, ["train", "validation"]);
    folder
        .run(&["run", "a.csv", "b.csv", "-o", "mine.toml"])
        .says(0, &["reports/mine/report.html"]);
    assert!(folder.read("mine.toml").contains("preset = \"unknown\""));
    // the file asks for everything that cannot be determined
    folder.write("c.csv", odd(&rows).replace("curR;curL", "foo;bar"));
    folder.run(&["c.csv"]).says(2, &["which columns hold the torques", "experiment new c.csv"]);
    folder.run(&["new", "c.csv"]).says(0, &["to be completed"]);
    folder.run(&["check", "c.toml"]).says(2, &["columns.M1 = \"?\" is still open"]);
    // an error names the recording, since there is no file
    rows.iter_mut().for_each(|r| (r[1], r[2]) = (0.0, 0.0));
    folder.write("still.csv", odd(&rows));
    let refused = folder.run(&["still.csv"]);
    refused.says(2, &["still.csv: ", "the wheels do not move"]);
    assert!(!refused.err.contains("still.toml"), "{}", refused.err);
}

#[test]
fn a_misspelt_command_is_named_and_run_may_be_written_out() {
    let folder = Folder::new();
    folder.write("run.csv", csv(&motion())).write("e.toml", on("run.csv"));
    folder.run(&["chek", "e.toml"]).says(2, &["did you mean `experiment check`?"]);
    folder.run(&["run", "e.toml"]).says(0, &["e: "]);
    let line = "write `experiment check --jobs 1 e.toml`";
    folder.run(&["--jobs", "1", "check", "e.toml"]).says(2, &[line]);
}

#[test]
fn results_of_another_file_of_the_same_name_are_not_written_over() {
    let folder = Folder::new();
    for place in ["one", "two"] {
        std::fs::create_dir(folder.path(place)).unwrap();
        folder.write(&format!("{place}/run.csv"), csv(&motion()));
        folder.write(&format!("{place}/e.toml"), on("run.csv"));
    }
    folder.run(&["one/e.toml"]).says(0, &["e: "]);
    folder.run(&["two/e.toml"]).says(2, &["holds the results of", "one/e.toml", "--out"]);
    folder.run(&["one/e.toml"]).says(0, &["e: "]);
    std::fs::remove_file(folder.path("one/e.toml")).unwrap();
    folder.run(&["two/e.toml"]).says(0, &["e: "]);
}

#[test]
fn a_dead_encoder_and_a_current_without_sign_are_refused_with_the_remedy() {
    let mut rows = motion_of(900);
    let folder = Folder::new();
    folder.write("e.toml", on("run.csv"));
    let mut dead = rows.clone();
    dead.iter_mut().for_each(|r| r[2] = 0.0);
    folder.write("run.csv", csv(&dead));
    folder.run(&["e.toml"]).says(2, &["run.csv: the left wheel never moves", "refuse = false"]);
    rows.iter_mut().for_each(|r| r[3] = r[3].abs());
    folder.write("run.csv", csv(&rows));
    folder.run(&["e.toml"]).says(2, &["M1 never changes its sign", "sign_from_speed = true"]);
    folder.write("e.toml", format!("[conditioning]\nsign_from_speed = true\n\n{}", on("run.csv")));
    folder.run(&["check", "e.toml"]).says(0, &["takes the sign of the speed"]);
}

#[test]
fn each_test_of_a_sysid_file_is_a_recording_and_every_kind_of_movement_is_trained_on() {
    // speeds of 0.5 + 1.5 t rad/s and their integral, in turns
    let row = |t: f64, v: f64, speed: f64, turns: f64| {
        format!("[{t},{v},{v},{turns},{turns},{speed},{speed},0,0]")
    };
    let test = |start: f64, sign: f64| {
        let turn = sign / std::f64::consts::TAU;
        let at = |t: f64| {
            let speed = 0.5 + 1.5 * t;
            row(start + t, sign * speed, turn * speed, turn * (0.5 * t + 0.75 * t * t))
        };
        (0..200).map(|k| at(0.02 * f64::from(k))).collect::<Vec<_>>().join(",")
    };
    let mut json = String::from("{\"sysid\": true, \"test\": \"Drivetrain\"");
    for (k, name) in
        ["fast-backward", "fast-forward", "slow-backward", "slow-forward"].iter().enumerate()
    {
        let size = if name.starts_with("slow") { 0.9 } else { 1.0 };
        let sign = if name.ends_with("backward") { -size } else { size };
        let _ = write!(json, ", \"{name}\": [{}]", test(10.0 * k as f64, sign));
    }
    let folder = Folder::new();
    folder.write("s.json", json + "}");
    folder.run(&["new", "s.json"]).says(0, &[]);
    let file = folder.read("s.toml");
    assert!(
        file.contains("train      = [\"s.json#fast-forward\", \"s.json#slow-backward\"]"),
        "{file}"
    );
    assert!(file.contains("effects = [\"back_emf\"]") && file.contains("straight ahead"), "{file}");
    folder.run(&["check", "s.toml"]).says(0, &["s.json#slow-forward: 200 samples", "0 gaps"]);
    folder.write("e.toml", on("s.json#slow-forwards"));
    folder.run(&["check", "e.toml"]).says(2, &["slow-forwards", "slow-forward"]);
}

/// Rows of [`motion`] with counts of an encoder of 1000 a turn: t, counts right and left, torques.
fn counted() -> Vec<[f64; 5]> {
    let mut turns = [0.0, 0.0];
    let rows = motion();
    let count = |r: &Row| {
        (0..2).for_each(|i| turns[i] += 0.01 * r[1 + i] / std::f64::consts::TAU);
        let [right, left] = turns.map(|t: f64| (1000.0 * t).floor());
        [r[0], right, left, r[3], r[4]]
    };
    rows.iter().map(count).collect()
}

#[test]
fn the_lines_of_a_console_ask_for_the_counts_of_a_turn_and_take_them() {
    let line = |[t, r, l, mr, ml]: &[f64; 5]| {
        format!("t={:.0},l={l},r={r},tau_l={ml},tau_r={mr}\n", 1e3 * t)
    };
    let folder = Folder::new();
    folder.write("log.txt", format!("boot ok\n{}", counted().iter().map(line).collect::<String>()));
    folder.run(&["new", "log.txt"]).says(0, &["to be completed", "how many counts has a turn"]);
    let file = folder.read("log.toml");
    assert!(file.contains("name = \"r\", unit = \"ticks\", per_turn = \"?\""), "{file}");
    assert!(file.contains("600 samples"), "{file}");
    let open = ["alpha1.per_turn = \"?\" is still open", "alpha2.per_turn: write the counts"];
    folder.run(&["check", "log.toml"]).says(2, &open);
    let set = |i| format!("recordings.columns.alpha{i}.per_turn=1000");
    let (one, two) = (set(1), set(2));
    folder.run(&["check", "log.toml", "--set", &one, "--set", &two]).says(0, &["600 samples"]);
    folder.run(&["log.txt", "--set", &one, "--set", &two]).says(0, &["reports/log/report.html"]);
    folder.run(&["log.txt"]).says(2, &["how many counts has a turn"]);
}

#[test]
fn words_above_the_table_are_passed_over_and_columns_without_names_are_asked_for() {
    let rows = motion();
    let head = "LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\n";
    let names = "X_Value\tright_omega\tleft_omega\tright_current\tleft_current";
    let folder = Folder::new();
    folder.write("a.lvm", format!("{head}{}", text(&rows, names, "\t", |x| x.to_string(), "\r\n")));
    folder
        .run(&["new", "a.lvm", "-o", "a.toml"])
        .says(0, &["dalpha1  = right_omega", "input in A"]);
    folder.run(&["check", "a.toml"]).says(0, &["600 samples"]);
    let bare = csv(&rows);
    folder.write("b.csv", bare.split_once('\n').unwrap().1);
    folder.run(&["new", "b.csv"]).says(0, &["t        = column1", "to be completed"]);
    assert!(folder.read("b.toml").contains("#   column2 "));
    let mut file = folder.read("b.toml");
    for (key, place) in [("dalpha1", 2), ("dalpha2", 3), ("M1", 4), ("M2", 5)] {
        file = file.replace(&format!("{key} = \"?\""), &format!("{key} = \"column{place}\""));
    }
    folder.write("b.toml", file);
    folder.run(&["check", "b.toml"]).says(0, &["600 samples"]);
    folder.write("e.toml", on("b.csv"));
    folder.run(&["check", "e.toml"]).says(2, &["the first line contains numbers", "column1"]);
}

#[test]
fn a_duty_cycle_times_the_battery_is_a_voltage() {
    let rows = motion();
    let mut log = String::from("t,w_r,w_l,duty_r,duty_l,battery_mV\n");
    for (k, [t, wr, wl, mr, ml]) in rows.iter().enumerate() {
        // the battery is measured every tenth row, and falls
        let volts = 12.0 - 0.1 * (k / 10) as f64 / 6.0;
        let battery = if k % 10 == 0 { format!("{}", 1e3 * volts) } else { String::new() };
        let _ = writeln!(log, "{t},{wr},{wl},{},{},{battery}", mr / volts, ml / volts);
    }
    let folder = Folder::new();
    folder.write("log.csv", log).write("plain.csv", csv(&rows));
    folder.run(&["new", "log.csv"]).says(0, &["duty_r times battery_mV", "the full voltage"]);
    folder.run(&["log.toml"]).says(0, &["log: "]);
    folder.write("plain.toml", folder.read("log.toml").replace("log.csv", "plain.csv"));
    let plain = folder.read("plain.toml");
    let columns = plain.lines().find(|l| l.starts_with("columns")).unwrap().to_string();
    folder.write("plain.toml", plain.replace(&columns, ""));
    folder.run(&["plain.toml"]).says(0, &["plain: "]);
    let value = |name: &str, k: usize| {
        folder.results(name)["methods"][0]["parameters"][k]["value"].as_f64().unwrap()
    };
    for k in 0..5 {
        let (a, b) = (value("reports/log", k), value("reports/plain", k));
        // printed digits alone
        assert!((a - b).abs() < 1e-6 * b.abs(), "{k}: {a} {b}");
    }
}
