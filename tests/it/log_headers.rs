//! Headers of several lines, units in them, a second header within the rows, and JSON with what is no number.

use crate::log_styles::{asked, lines, started};
use crate::support::{Folder, Row, motion};

#[test]
fn the_names_above_lines_of_types_and_blocks_remain() {
    // the Simulation Data Inspector of Simulink: the time is repeated for each block
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w2},{w1},{t:.3},{m2},{m1}\n"));
    let all = |cell: &str| [cell; 6].join(",");
    let head = format!(
        "time,wL:1,wR:1,time,uL:1,uR:1\n{}\nUnits: s,Units: rad/s,Units: rad/s,Units: s,Units: N*m,Units: N*m\n{}\n{}\n",
        all("Type: double"),
        all("BlockPath: m/Plant"),
        all("Interp: linear")
    );
    let words = ["dalpha1  = wR:1 [rad/s]", "dalpha2  = wL:1 [rad/s]", "M1       = uR:1 [N*m]"];
    started("sdi.csv", &format!("{head}{rows}"), &words);
}

#[test]
fn the_line_of_units_of_a_scope_counts_although_one_is_not_known() {
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let ms = (1e3 * t).round();
        format!("{ms}\t{w2}\t{ms}\t{w1}\t{ms}\t{:.0}\t{ms}\t{:.0}\n", 1e3 * m2, 1e3 * m1)
    });
    let line = |word: &str, cells: [&str; 4]| {
        cells.map(|cell| format!("{word}\t{cell}")).join("\t") + "\n"
    };
    let head = [
        "Name\tScope\nFile\trun.svdx\n\n".to_owned(),
        line("Name", ["Left.ActVelo", "Right.ActVelo", "Left.Torque", "Right.Torque"]),
        line("Data-Type", ["REAL64", "REAL64", "INT16", "INT16"]),
        line("Unit", ["deg/s", "deg/s", "0.1%", "0.1%"]),
    ];
    let words = [
        "t        = Time in ms",
        "dalpha1  = Right.ActVelo [deg/s]",
        "`Right.Torque [0.1%]` is in `0.1%`, which is not a known unit for it",
    ];
    let scale = "recordings.columns.M1.scale=0.001";
    let answers = [scale, "recordings.columns.M2.scale=0.001"];
    asked("scope.txt", &format!("{}\n{rows}", head.concat()), &words, &answers);
}

#[test]
fn units_in_words_and_in_quotes_are_those_of_their_columns() {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w2},{w1},{m2},{m1}\n"));
    let of = |names: &str| format!("{names}\n{rows}");
    let tdms = "/'Log'/'Time (s)',/'Log'/'Speed Left (deg/s)',/'Log'/'Speed Right (deg/s)',/'Log'/'T Left (Nm)',/'Log'/'T Right (Nm)'";
    started("tdms.csv", &of(tdms), &["dalpha1  = /'Log'/'Speed Right (deg/s)' in deg/s"]);
    let folder = Folder::new();
    folder.write("run.csv", of("t (sec),wl (rotations per second),wr (rps),ml (Nm),mr (Nm)"));
    folder.write("e.toml", with_speeds_of(""));
    folder.run(&["check", "e.toml"]).says(0, &["600 samples"]);
    folder.write("run.csv", of("t,wl,wr,ml,mr"));
    folder.write("e.toml", with_speeds_of(", unit = \"rotations/s\""));
    folder.run(&["check", "e.toml"]).says(0, &["600 samples"]);
}

/// An experiment whose speeds have this key too.
fn with_speeds_of(key: &str) -> String {
    format!(
        "[recordings]\ntrain = [\"run.csv\"]\n[recordings.columns]\nt = \"t\"\ndalpha1 = {{ name = \"wr\"{key} }}\n\
         dalpha2 = {{ name = \"wl\"{key} }}\nM1 = \"mr\"\nM2 = \"ml\"\n\n[[method]]\nname = \"prediction_error\"\n"
    )
}

#[test]
fn a_second_header_with_another_order_of_the_columns_is_refused() {
    let rows = motion();
    let left = |[t, w1, w2, m1, m2]: &Row| format!("{t:.3},{w2},{w1},{m2},{m1}\n");
    let right = |[t, w1, w2, m1, m2]: &Row| format!("{t:.3},{w1},{w2},{m1},{m2}\n");
    let of = |head: &str, line: &dyn Fn(&Row) -> String, rows: &[Row]| {
        format!("{head}\n{}", rows.iter().map(line).collect::<String>())
    };
    let (l, r) = ("t,w_l,w_r,torque_l,torque_r", "t,w_r,w_l,torque_r,torque_l");
    let first = of(l, &left, &rows[..300]);
    let folder = Folder::new();
    let words =
        ["run.csv", "row 301 (line 302) is a second header", l, r, "to a file of their own"];
    folder.write("run.csv", format!("{first}{}", of(r, &right, &rows[300..])));
    folder.run(&["new", "run.csv"]).says(2, &words);
    // below other lines, as no plain table
    folder.write("log.txt", format!("run 7\n{first}{}", of(r, &right, &rows[300..])));
    folder.run(&["new", "log.txt"]).says(2, &["log.txt", "is a second header", l, r]);
    // the same header again is a row without values
    folder.write("run.csv", format!("{first}{}", of(l, &left, &rows[300..])));
    folder.run(&["new", "run.csv"]).says(0, &["dalpha1  = w_r"]);
    folder.run(&["check", "run.toml"]).says(0, &["600 samples"]);
}

#[test]
fn what_is_no_number_in_json_is_missing() {
    let list = |k: usize| -> Vec<f64> { motion().iter().map(|row| row[k]).collect() };
    let mut log = format!(
        r#"{{"t": {:?}, "left": {{"vel": {:?}, "torque": {:?}}}, "right": {{"vel": {:?}, "torque": {:?}}}}}"#,
        list(0),
        list(2),
        list(4),
        list(1),
        list(3)
    );
    let place = log.find("\"vel\": [").unwrap() + 8;
    log.insert_str(place, "NaN, ");
    let cut = log[place + 5..].find(',').unwrap() + place + 5;
    // in place of the first value
    log.replace_range(place + 5..=cut, "");
    let folder = Folder::new();
    folder.write("run.json", &log);
    folder.run(&["new", "run.json"]).says(0, &["dalpha1  = right.vel"]);
    folder.write("cut.json", &log[..log.len() / 2]);
    let refused = folder.run(&["new", "cut.json"]);
    refused.says(2, &["cut.json cannot be read as JSON: it ends within a list or an object"]);
    assert!(!refused.err.contains("SysId"), "{}", refused.err);
}

#[test]
fn the_motors_in_the_middle_of_six_wheels_are_added_too() {
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let [right, left] = [m1, m2].map(|m| m / 3.0);
        format!(
            "{t:.3},{w2},{w2},{w2},{w1},{w1},{w1},{left},{left},{left},{right},{right},{right}\n"
        )
    });
    let of = |what: &str| {
        ["FL", "ML", "RL", "FR", "MR", "RR"].map(|place| format!("{place}_{what}")).join(",")
    };
    let log = format!("t_s,{},{}\n{rows}", of("speed_rad_s"), of("torque_Nm"));
    let sum = "FR_torque_Nm + MR_torque_Nm + RR_torque_Nm";
    started("six.csv", &log, &[sum]);
}
