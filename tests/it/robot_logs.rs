//! Logs of small robots: PWM in whole numbers, timers, marks of missing values, rows in another order, SysId files of a
//! turn, through `experiment new` and `experiment check`.

use std::fmt::Write as _;

use crate::log_styles::{asked, lines, started};
use crate::support::{Folder, Row, motion_of};

#[test]
fn ports_factors_and_ticks_in_headers_are_read() {
    let log = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let head = "Time,Right Wheel/Speed (rad/s):1,Left Wheel/Speed (rad/s):1,Torque Right (N*m):1,Torque Left (N*m):1\n";
    started("run.csv", &format!("{head}{log}"), &["dalpha1  = Right Wheel/Speed (rad/s):1"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!("{:.0}\t{w1}\t{w2}\t{}\t{}\n", 1e3 * t, 10.0 * m1, 10.0 * m2)
    });
    let head = "Time(ms)\tw_right\tw_left\tMotor Amps right [A x10]\tMotor Amps left [A x10]\n";
    started("run.tsv", &format!("{head}{log}"), &["in 0.100000 A"]);
    let log =
        lines(|[t, w1, w2, m1, m2]| format!("{:.0},{w1},{w2},{m1},{m2}\n", 32_768.0 * t + 77.0));
    let words = ["t        = tick", "counts the ticks of a timer, 328 from row to row"];
    let answer = ["recordings.columns.t.scale=3.0517578e-5"];
    asked("run.csv", &format!("tick,w_right,w_left,tau_right,tau_left\n{log}"), &words, &answer);
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!("[{:.0}] wL: {w2} wR: {w1} tauL: {m2} tauR: {m1}\n", 1e3 * t)
    });
    started("run.log", &log, &["t        = clock in ms", "dalpha1  = wR"]);
}

#[test]
fn marks_of_missing_values_and_the_newest_row_first_are_corrected() {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let marked: String = rows
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let (rest, _) = line.rsplit_once(',').unwrap();
            if k % 40 == 3 { format!("{rest},-999\n") } else { format!("{line}\n") }
        })
        .collect();
    let head = "time,w_right,w_left,torque_right_Nm,torque_left_Nm\n";
    let folder = Folder::new();
    folder.write("run.csv", format!("{head}{marked}"));
    folder.run(&["check", "run.csv"]).says(0, &["M2 has 15 isolated wrong samples", "-999"]);
    let newest: Vec<&str> = rows.lines().rev().collect();
    folder.write("newest.csv", format!("{head}{}\n", newest.join("\n")));
    let words = ["600 samples", "the newest row is first", "the rows are turned round"];
    folder.run(&["new", "newest.csv"]).says(0, &words[1..2]);
    folder.run(&["check", "newest.toml", "--jobs", "1"]).says(0, &[words[0], words[2]]);
}

#[test]
fn an_input_that_is_constant_in_each_recording_and_differs_between_them_is_one() {
    let folder = Folder::new();
    for (k, pwm) in [20, 40, 60].into_iter().enumerate() {
        let top = f64::from(pwm) / 4.0;
        let mut log =
            String::from("timestamp_ms,left_speed_rpm,right_speed_rpm,left_pwm,right_pwm\n");
        for row in 0..200 {
            let speed = top * (1.0 - (-0.1 * f64::from(row)).exp());
            let _ = writeln!(log, "{},{speed},{speed},{pwm},{pwm}", 20 * row);
        }
        folder.write(&format!("run_{k}.csv"), log);
    }
    let runs = ["run_0.csv", "run_1.csv", "run_2.csv"];
    let new = [&["new"][..], &runs, &["-o", "e.toml"]].concat();
    let ran = folder.run(&new);
    ran.says(0, &["M1       = right_pwm", "M2       = left_pwm"]);
    assert!(!ran.out.contains("was the input"), "{}", ran.out);
    // one alone does not vary
    folder.run(&["new", "run_0.csv"]).says(0, &["never change: was the input"]);
}

/// A SysId file of a turn on the spot with vibrating wheels of 0.32 m circumference, half a track of 0.3 m apart.
fn turn() -> String {
    let mut json = String::from(
        "{\"sysid\": true, \"test\": \"Drivetrain (Angular)\", \"units\": \"Meters\", \"unitsPerRotation\": 0.32",
    );
    for (k, name) in ["fast-backward", "fast-forward"].iter().enumerate() {
        let sign = if k == 0 { -1.0 } else { 1.0 };
        let row = |j: usize| {
            let t = 0.01 * j as f64;
            let speed = sign * (0.5 + 0.9 * t);
            let turns = sign * (0.5 * t + 0.45 * t * t);
            let shaken = speed * (1.0 + 0.95 * (2.4 * j as f64).sin());
            let heading = turns * 0.32 / 0.3;
            let (start, v) = (10.0 * k as f64, 4.0 * sign);
            format!(
                "[{},{},{v},{},{turns},{},{shaken},{heading},0]",
                start + t,
                -v,
                -turns,
                -shaken
            )
        };
        let rows: Vec<String> = (0..300).map(row).collect();
        let _ = write!(json, ", \"{name}\": [{}]", rows.join(","));
    }
    json + "}"
}

#[test]
fn a_sysid_file_of_a_turn_gives_the_lengths_and_asks_for_no_sign() {
    let folder = Folder::new();
    folder.write("turn.json", turn());
    let ran = folder.run(&["new", "turn.json"]);
    ran.says(0, &["r_m = 0.0509 m: unitsPerRotation = 0.32 meters", "l1_m = 0.3000 m", "(95 %:"]);
    assert!(!ran.out.contains("question"), "{}", ran.out);
    let file = folder.read("turn.toml");
    assert!(file.contains("\nl1_m = 0.3000 ") && file.contains("\nr_m  = 0.0509 "), "{file}");
}

#[test]
fn the_error_of_short_recordings_is_named_by_their_length() {
    let log: String = motion_of(60)
        .iter()
        .map(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"))
        .collect();
    let folder = Folder::new();
    folder.write("run.csv", format!("time,w_right,w_left,torque_right_Nm,torque_left_Nm\n{log}"));
    folder.run(&["run.csv", "--out", "out"]).says(0, &["0.6 s simulation error"]);
    folder.run(&["check", "run.csv"]).says(0, &["as long as its recording, 0.59 s at most"]);
}

#[test]
fn the_factor_of_a_command_is_open_unless_its_full_scale_is_shown() {
    let log = |name: &str, of: &dyn Fn(f64) -> f64, battery: &str| {
        let cell = if battery.is_empty() { "" } else { ",12000" };
        let rows = lines(|[t, w1, w2, m1, m2]| {
            format!("{t:.3},{w1},{w2},{:.0},{:.0}{cell}\n", of(*m1), of(*m2))
        });
        format!("t,omega_r,omega_l,{name}_r,{name}_l{battery}\n{rows}")
    };
    let part = |m: f64| 500.0 * m;
    let limited = |m: f64| (3000.0 * m).clamp(-255.0, 255.0);
    let answers = |scale: &str| [1, 2].map(|k| format!("recordings.columns.M{k}.scale={scale}"));
    let ask = |log: &str, word: &str, scale: &str| {
        let answers = answers(scale);
        asked("run.csv", log, &[word], &answers.each_ref().map(String::as_str));
    };
    let of_battery = "which value is the full voltage of `battery_mV` (12.0 to 12.0 V)";
    ask(&log("pwm", &part, ",battery_mV"), of_battery, "2.5e-6");
    ask(
        &log("pwm", &limited, ""),
        "with scale = 3.922e-3 one volt of the results is the full command",
        "0.047",
    );
    // a controller limits its output to the end of the scale
    let shown = log("pwm", &limited, ",battery_mV");
    started("run.csv", &shown, &["is 255 the full voltage of `battery_mV`"]);
    started("run.csv", &log("pwm_percent", &|m| 99.0 * m, ",battery_mV"), &["is 100 the full"]);
}

#[test]
fn corners_and_paths_of_topics_are_read() {
    let rows =
        lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w2},{w2},{w1},{w1},{m2},{m2},{m1},{m1}\n"));
    let names = ["velocity (rad/s)", "current (A)"]
        .map(|of| ["LF", "LB", "RF", "RB"].map(|corner| format!("{corner} {of}")).join(","));
    let words = ["dalpha1  = RF velocity (rad/s)", "`RB current (A)` on the same side: added up"];
    started("run.csv", &format!("t,{}\n{rows}", names.join(",")), &words);
    let mut counts = [0.0; 2];
    let count = |[t, w1, w2, m1, m2]: Row| {
        counts = [counts[0] + 2.0 * w1, counts[1] + 2.0 * w2];
        format!("{t:.3},{:.0},{:.0},{m1},{m2}\n", counts[0], counts[1])
    };
    let rows: String = motion_of(600).into_iter().map(count).collect();
    let head = "t,right_wheel_encoder/tick,left_wheel_encoder/tick,tau_right,tau_left";
    let answers = [1, 2].map(|k| format!("recordings.columns.alpha{k}.per_turn=1257"));
    let log = format!("{head}\n{rows}");
    let words = ["alpha1   = right_wheel_encoder/tick"];
    asked("run.csv", &log, &words, &answers.each_ref().map(String::as_str));
}
