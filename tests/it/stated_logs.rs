//! Logs whose units, clocks and inputs are stated in other words, through `experiment new` and `experiment check`.

use crate::log_styles::{asked, lines, started};
use crate::support::{Folder, motion};

#[test]
fn turns_a_second_and_half_turns_are_read_in_any_spelling() {
    use std::f64::consts::{PI, TAU};
    for [right, left] in [
        ["right rotations/s", "left rotations/s"],
        ["Motor right turns_per_s", "Motor left turns_per_s"],
        ["wheel_right_revs_per_sec", "wheel_left_revs_per_sec"],
        ["out.wr_rps.Data", "out.wl_rps.Data"],
    ] {
        let rows =
            lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{},{},{m1},{m2}\n", w1 / TAU, w2 / TAU));
        let log = format!("t,{right},{left},right_Nm,left_Nm\n{rows}");
        started("run.csv", &log, &[&format!("dalpha1  = {right} in rev/s")]);
    }
    let (mut a1, mut a2) = (0.0, 0.0);
    let rows: String = motion()
        .iter()
        .map(|[t, w1, w2, m1, m2]| {
            (a1, a2) = (a1 + 0.01 * w1 / PI, a2 + 0.01 * w2 / PI);
            format!("{t:.3},{a1},{a2},{m1},{m2}\n")
        })
        .collect();
    let log = format!("t,right.halfturns,left.halfturns,right_Nm,left_Nm\n{rows}");
    started("run.csv", &log, &["alpha1   = right.halfturns in 0.500000 rev"]);
}

#[test]
fn seconds_that_a_name_states_stay_seconds_in_slow_logs() {
    let rows: String = motion()
        .iter()
        .enumerate()
        .map(|(k, [_, w1, w2, m1, m2])| format!("{:.2},{w1},{w2},{m1},{m2}\n", 0.66 * k as f64))
        .collect();
    for name in ["t_s", "t"] {
        let folder = Folder::new();
        let log = format!("{name},w_right,w_left,right_Nm,left_Nm\n{rows}");
        folder.write("run.csv", &log);
        let ran = folder.run(&["new", "run.csv", "-o", "e.toml"]);
        assert!(!ran.out.contains("this is ms"), "{name}: {}", ran.out);
    }
}

#[test]
fn the_speed_of_the_vesc_firmware_is_that_of_the_field() {
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let rpm = |w: &f64| 7.0 * w * 60.0 / std::f64::consts::TAU;
        format!("{t:.3},{},{m1},{},{},{m2},{}\n", rpm(w1), 0.1 * w1, rpm(w2), 0.1 * w2)
    });
    let names = ["right", "left"].map(|s| format!("{s}.rpm,{s}.avg_motor_current,{s}.duty_now"));
    let log = format!("t,{}\n{rows}", names.join(","));
    let answers = [1, 2].map(|k| format!("recordings.columns.dalpha{k}.scale=0.142857"));
    let answers: Vec<&str> = answers.iter().map(String::as_str).collect();
    asked("run.csv", &log, &["VESC firmware", "pole pairs"], &answers);
}

#[test]
fn a_command_within_one_is_asked_for_with_the_battery_and_the_back_emf() {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let log = format!("t,omega_r,omega_l,cmd_r,cmd_l\n{rows}");
    let folder = Folder::new();
    folder.write("run.csv", &log);
    let words = ["is `cmd_r` the input", "effects = [\"back_emf\"]", "between -1 and 1"];
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &words);
}
