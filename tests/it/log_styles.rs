//! Logs in the styles of loggers, databases and buses, through `experiment new` and `experiment check`.

use crate::support::{Folder, Row, motion};

/// A log in a file of that name: output of `new`, and of `check` with these answers.
pub(crate) fn asked(file: &str, log: &str, words: &[&str], answers: &[&str]) {
    let folder = Folder::new();
    folder.write(file, log);
    folder.run(&["new", file, "-o", "e.toml"]).says(0, words);
    let mut check = vec!["check", "e.toml"];
    if !answers.is_empty() {
        folder.run(&check).says(2, &["is still open"]);
    }
    answers.iter().for_each(|answer| check.extend(["--set", answer]));
    folder.run(&check).says(0, &["600 samples", "100 Hz"]);
}

/// The same of one that leaves nothing open.
pub(crate) fn started(file: &str, log: &str, words: &[&str]) {
    asked(file, log, words, &[]);
}

pub(crate) fn lines(line: impl Fn(&Row) -> String) -> String {
    motion().iter().map(line).collect()
}

#[test]
fn rows_of_numbered_motors_become_the_wheels() {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},1,{w1},{m1}\n{t:.3},2,{w2},{m2}\n"));
    let words = ["dalpha1  = omega.1", "M2       = torque.2", "is the right wheel that of"];
    started("run.csv", &format!("time,motor_id,omega,torque\n{rows}"), &words);
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!("t={t:.3} id=1 omega={w1} tau={m1}\nt={t:.3} id=2 omega={w2} tau={m2}\n")
    });
    started("run.txt", &log, &["dalpha1  = 1.omega", "M2       = 2.tau"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        let of = |side: &str, w: &f64, m: &f64| {
            format!(r#"{{"topic":"{side}","t":{t:.3},"omega":{w},"effort":{m}}}"#)
        };
        format!("{}\n{}\n", of("left", w2, m2), of("right", w1, m1))
    });
    started("run.jsonl", &log, &["dalpha1  = right.omega", "M2       = left.effort"]);
}

#[test]
fn databases_write_points_and_tables_one_below_the_other() {
    let ns = |t: f64| 1_718_020_983_000_000_000_u64 + (1e9 * t).round() as u64;
    let line = lines(|[t, w1, w2, m1, m2]| {
        let at = ns(*t);
        format!(
            "motor,side=l omega={w2},torque={m2} {at}\nmotor,side=r omega={w1},torque={m1} {at}\n"
        )
    });
    started(
        "run.lp",
        &line,
        &["t        = time in ns", "dalpha1  = r.omega", "M2       = l.torque"],
    );
    let mut log = String::from(
        "#group,false,false,false,true,true\n#datatype,string,long,dateTime:RFC3339,double,string\n\
         #default,_result,,,,\n,result,table,_time,_value,_field,side\n",
    );
    for (place, (field, side)) in
        [("omega", "right"), ("omega", "left"), ("torque", "right"), ("torque", "left")]
            .into_iter()
            .enumerate()
    {
        let rows = lines(|row| {
            format!(
                ",,{place},2024-06-10T13:03:{:09.6}Z,{},{field},{side}\n",
                row[0],
                row[place + 1]
            )
        });
        log += &rows;
    }
    started("run.csv", &log, &["dalpha1  = omega.right", "M2       = torque.left"]);
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1} rad/s,{w2} rad/s,{m1},{m2}\n"));
    let names = "\"Time\",\"omega {side: right}\",\"omega {side: left}\",\"torque {side: right}\",\"torque {side: left}\"";
    started("run.csv", &format!("sep=,\n{names}\n{rows}"), &["dalpha1  = omega {side: right}"]);
}

#[test]
fn kinds_of_lines_and_frames_are_distinguished() {
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!(
            "IMU {t:.3} 0.1 9.8\nODO {t:.3} omega_l {w2} omega_r {w1}\nMOT {t:.3} tau_l {m2} tau_r {m1}\n"
        )
    });
    started(
        "run.log",
        &log,
        &["t        = time", "dalpha1  = ODO.omega_r", "M2       = MOT.tau_l"],
    );
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let us = (1e6 * t).round();
        format!("ENC, {us}, {w1}, {w2}\nMOT, {us}, {m1}, {m2}\n")
    });
    let head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
                FMT, 200, 31, ENC, Qff, TimeUS,OmegaR,OmegaL\nFMT, 201, 31, MOT, Qff, TimeUS,TauR,TauL\n";
    started("run.log", &format!("{head}{rows}"), &["dalpha1  = ENC.OmegaR", "M2       = MOT.TauL"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        let of = |side: &str, w: &f64, m: &f64| {
            format!(
                "({t:.3}) can0 141 [2] 00 00 :: Motor{side}(Speed: {w} rad/s, Torque: {m} Nm)\n"
            )
        };
        of("Right", w1, m1) + &of("Left", w2, m2)
    });
    started("run.log", &log, &["dalpha1  = MotorRight.Speed [rad/s]"]);
    let folder = Folder::new();
    folder.write("run.log", "(0.010) can0 141#9C1F0000\n(0.020) can0 142#9C1F0000\n");
    folder
        .run(&["new", "run.log", "-o", "e.toml"])
        .says(2, &["frames of a CAN bus", "cantools decode"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!(
            "[INFO] [{:.6}] [base]: omega L: {w2} R: {w1} rad/s, tau L: {m2} R: {m1} Nm\n",
            t + 1_718_020_983.0
        )
    });
    started("run.log", &log, &["t        = clock", "dalpha1  = base omega R [rad/s]"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        let ms = (1e3 * t).round();
        format!(">omega_r:{ms}:{w1}\n>omega_l:{ms}:{w2}\n>tau_r:{ms}:{m1}\n>tau_l:{ms}:{m2}\n")
    });
    started("run.txt", &log, &["t        = time_ms in ms", "dalpha1  = omega_r"]);
}

#[test]
fn headers_of_several_lines_and_none_are_read() {
    let rows = |separator: &str| lines(|row| row.map(|x| format!("{x:.6}")).join(separator) + "\n");
    let two = ",right,left,right,left\ntime,speed,speed,torque,torque\ns,rad/s,rad/s,Nm,Nm\n";
    started("run.csv", &format!("{two}{}", rows(",")), &["dalpha1  = right speed [rad/s]"]);
    let comments = "# column 1: time [s]\n# column 2: right speed [rad/s]\n# column 3: left speed [rad/s]\n\
                    # column 4: right torque [Nm]\n# column 5: left torque [Nm]\n";
    started("run.dat", &format!("{comments}{}", rows(" ")), &["M2       = left torque [Nm]"]);
    let bars = lines(|row| format!("| {} |\n", row.map(|x| format!("{x:.6}")).join(" | ")));
    let head = "| t | wr | wl | tau_r | tau_l |\n|---|---|---|---|---|\n";
    started("run.md", &format!("{head}{bars}"), &["dalpha1  = wr"]);
    let above = "LabVIEW Measurement\nX_Columns\tNo\n***End_of_Header***\n\nX0\t0\t0\t0\t0\n\
                 Delta_X\t0.01\t0.01\t0.01\t0.01\n***End_of_Header***\nX_Value\twr\twl\ttau_r\ttau_l\n";
    let rows = lines(|[_, w1, w2, m1, m2]| format!("\t{w1}\t{w2}\t{m1}\t{m2}\n"));
    started("run.lvm", &format!("{above}{rows}"), &["t        = X_Value [s]", "dalpha1  = wr"]);
    let column = |name: &str, k: usize| {
        let values = lines(|row| format!(" {}\n", row[k]));
        format!("# name: {name}\n# type: matrix\n# rows: 600\n# columns: 1\n{values}\n\n")
    };
    let names = ["t", "w_right", "w_left", "tau_right", "tau_left"];
    let text: String = names.iter().enumerate().map(|(k, name)| column(name, k)).collect();
    started("run.txt", &format!("# Created by Octave 6.4.0\n{text}"), &["dalpha1  = w_right"]);
    let rows = lines(|row| format!("{row:?},")).trim_end_matches(',').to_string();
    let log = format!(r#"{{"columns":["t","wr","wl","tau_r","tau_l"],"data":[{rows}]}}"#);
    started("run.json", &log, &["dalpha1  = wr"]);
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!("<row t=\"{t}\" wr=\"{w1}\" wl=\"{w2}\" tau_r=\"{m1}\" tau_l=\"{m2}\"/>\n")
    });
    started("run.xml", &format!("<log>\n{log}</log>\n"), &["dalpha1  = wr"]);
}

#[test]
fn factors_of_units_in_names_are_scales() {
    let log = lines(|[t, w1, w2, m1, m2]| {
        format!("{:.0},{},{},{},{}\n", 100.0 * t, 1e3 * w1, 1e3 * w2, 1e4 * m1, 1e4 * m2)
    });
    let head = "time [10ms],wr_mrad_s,wl_mrad_s,torque_r [x0.1 mNm],torque_l [x0.1 mNm]\n";
    let words =
        ["t        = time [10ms] in 10.000000 ms", "wr_mrad_s in mrad/s", "in 0.100000 mN m"];
    started("run.csv", &format!("{head}{log}"), &words);
}

#[test]
fn directions_in_columns_of_their_own_give_the_sign() {
    for (forward, backward, said) in
        [("1", "0", "backward = \"0\""), ("F", "R", "backward = \"R\"")]
    {
        let dir = |m: &f64| if *m < 0.0 { backward } else { forward };
        let rows = lines(|[t, w1, w2, m1, m2]| {
            format!("{t},{w1},{w2},{},{},{},{}\n", m1.abs(), dir(m1), m2.abs(), dir(m2))
        });
        let folder = Folder::new();
        folder.write("run.csv", format!("t,wr,wl,torque_r,dir_r,torque_l,dir_l\n{rows}"));
        folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &["dir_r"]);
        let text = folder.read("e.toml");
        assert!(text.contains("sign = \"dir_r\"") && text.contains(said), "{text}");
        folder.run(&["check", "e.toml"]).says(0, &["600 samples"]);
    }
    // without the column of the direction the sign is unknown
    let folder = Folder::new();
    folder.write("run.csv", "t,wr,wl,torque_r,torque_l\n0,1,1,1,1\n1,1,1,1,1\n");
    let file = "[recordings]\ntrain = [\"run.csv\"]\ncolumns = { dalpha1 = \"wr\", dalpha2 = \"wl\", M2 = \"torque_l\", M1 = { name = \"torque_r\", sign = \"dir\" } }\n";
    folder.write("e.toml", file);
    folder.run(&["check", "e.toml"]).says(2, &["dir"]);
}

#[test]
fn units_and_a_mirrored_wheel_are_asked_for() {
    let rpm = 60.0 / std::f64::consts::TAU;
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t},{},{},{m1},{m2}\n", rpm * w1, rpm * w2));
    let unit = ["recordings.columns.dalpha1.unit='rpm'", "recordings.columns.dalpha2.unit='rpm'"];
    let words = ["dalpha1  = speed_r in \"?\"", "in rad/s, rpm, deg/s"];
    asked("run.csv", &format!("t,speed_r,speed_l,torque_r,torque_l\n{rows}"), &words, &unit);
}

/// Two runs one below the other, each from t = 0, with a column before that says which.
fn runs(head: &str, name: &str, words: [&str; 2], row: impl Fn(&Row) -> String) -> String {
    let run = |word: &str| lines(|r| format!("{word},{}", row(r)));
    format!("{name},{head}\n{}{}", run(words[0]), run(words[1]))
}

#[test]
fn runs_one_after_the_other_are_no_wheels() {
    let both = |[t, w1, w2, m1, m2]: &Row| format!("{t:.3},{w1},{w2},{m1},{m2}\n");
    let (names, rows) = ("t,omega_r,omega_l,tau_r,tau_l", &["1200 samples"]);
    for (name, words) in
        [("run", ["A", "B"]), ("mode", ["AUTO", "MANUAL"]), ("log", ["fwd", "back"])]
    {
        let folder = Folder::new();
        folder.write("run.csv", runs(names, name, words, both));
        let said = ["dalpha1  = omega_r\n", "M2       = tau_l\n"];
        folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &said);
        folder.run(&["check", "e.toml"]).says(0, rows);
    }
    let one = |[t, w1, _, m1, _]: &Row| format!("{t:.3},{w1},{m1}\n");
    let folder = Folder::new();
    folder.write("run.csv", runs("t,omega,tau", "run", ["A", "B"], one));
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &["one axis is used for both wheels"]);
    // of motors measured one after the other it is asked
    folder.write("motors.csv", runs("t,omega,tau", "motor", ["L", "R"], one));
    folder.run(&["new", "motors.csv", "-o", "m.toml"]).says(
        0,
        &["`motor` names the motor of each row (L, R): were the motors measured one after"],
    );
}

#[test]
fn parts_of_a_second_are_added_to_the_seconds() {
    for (head, size) in [("sec,usec", 1e6), ("tv_sec,tv_usec", 1e6), ("s,ms", 1e3)] {
        let rows = lines(|[t, w1, w2, m1, m2]| {
            let (whole, part) = ((t + 0.5).floor(), ((t + 0.5).fract() * size).round());
            format!("{},{part},{w1},{w2},{m1},{m2}\n", 1_718_020_983.0 + whole)
        });
        let log = format!("{head},omega_r,omega_l,tau_r,tau_l\n{rows}");
        let (seconds, part) = head.split_once(',').unwrap();
        started("run.csv", &log, &[&format!("t        = {seconds} and {part}")]);
    }
}

#[test]
fn a_named_clock_goes_before_a_column_that_rises() {
    let log = |clock: &str| {
        let rows = lines(|[t, w1, w2, m1, m2]| {
            format!("{},{:.0},{w1},{w2},{m1},{m2}\n", 0.3 * t, 1e3 * t)
        });
        format!("x,{clock},omega_r,omega_l,tau_r,tau_l\n{rows}")
    };
    started("run.csv", &log("tick_ms"), &["t        = tick_ms in ms"]);
    started("run.csv", &log("HAL_tick"), &["t        = HAL_tick in ms"]);
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{},10,{w1},{w2},{m1},{m2}\n", 0.3 * t));
    let log = format!("x,dt,omega_r,omega_l,tau_r,tau_l\n{rows}");
    started("run.csv", &log, &["t        = dt in ms", "the time is its sum"]);
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let words = ["t        = x in \"?\"", "is it the time?"];
    let log = format!("x,omega_r,omega_l,tau_r,tau_l\n{rows}");
    asked("run.csv", &log, &words, &["recordings.columns.t.unit='s'"]);
}

#[test]
fn names_in_cells_and_attributes_above_the_names_are_read() {
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let ns = 1_718_020_983_000_000_000_u64 + (1e9 * t).round() as u64;
        format!("{ns},right_joint,left_joint,{w1},{w2},{m1},{m2}\n")
    });
    let head =
        "%time,field.name0,field.name1,field.velocity0,field.velocity1,field.effort0,field.effort1";
    let words = ["dalpha1  = right_joint.velocity", "M2       = left_joint.effort"];
    started("run.csv", &format!("{head}\n{rows}"), &words);
    let rows = lines(|[t, w1, w2, m1, m2]| {
        let ms = (1e3 * t).round();
        format!("{ms}\t{w1}\t{ms}\t{w2}\t{ms}\t{m1}\t{ms}\t{m2}\n")
    });
    let head = "Name\tScope Project\nFile\trun.tcscopex\n\n\
                Name\tAxisR.ActVelo\tName\tAxisL.ActVelo\tName\tAxisR.ActTorque\tName\tAxisL.ActTorque\n\
                Data-Type\tREAL64\tData-Type\tREAL64\tData-Type\tREAL64\tData-Type\tREAL64\n\
                Unit\trad/s\tUnit\trad/s\tUnit\tNm\tUnit\tNm\nScale\t1\tScale\t1\tScale\t1\tScale\t1\n\n";
    started("run.csv", &format!("{head}{rows}"), &["dalpha1  = AxisR.ActVelo [rad/s]"]);
    let rows = lines(|row| format!(",{}\n", row.map(|x| format!("{x:.6}")).join(",")));
    let head =
        "name,Time,omega_r,omega_l,tau_r,tau_l\nunit,s,rad/s,rad/s,Nm,Nm\ntrace_values,,,,,\n";
    started("run.csv", &format!("{head}{rows}"), &["dalpha1  = omega_r [rad/s]"]);
}

#[test]
fn tags_before_rows_and_names_of_loggers_are_left_out() {
    let rows = lines(|row| format!("@D {}\n", row.map(|x| format!("{x:.6}")).join(",")));
    let head = "@D INFO fw=1.4\n@D COLS t,omega_r,omega_l,tau_r,tau_l\n";
    started("run.txt", &format!("{head}{rows}"), &["t        = t\n", "dalpha1  = omega_r\n"]);
    let rows = lines(|[t, w1, w2, m1, m2]| {
        format!(
            "2024-06-10 12:03:{t:06.3} - INFO - robot.drive - wr={w1:.6} wl={w2:.6} tr_nm={m1:.6} tl_nm={m2:.6}\n"
        )
    });
    folder_says("run.log", &rows, &["dalpha1  = wr\n"]);
    let rows = lines(|row| format!("{};\n", row.map(|x| format!("{x:.6}")).join(" ")));
    let log = format!("data = [ % t wr wl tau_r tau_l\n{rows}];\n");
    folder_says("run.m", &log, &["t        = t\n", "M2       = tau_l\n"]);
}

/// What `new` says of a log in a file of that name.
fn folder_says(file: &str, log: &str, words: &[&str]) {
    let folder = Folder::new();
    folder.write(file, log);
    folder.run(&["new", file, "-o", "e.toml"]).says(0, words);
}

#[test]
fn subscripts_and_names_of_controllers_are_read() {
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},{w1},{w2},{m1},{m2}\n"));
    let head = "time,omega(:,1),omega(:,2),torque(:,1),torque(:,2)\n";
    started("run.csv", &format!("{head}{rows}"), &["dalpha1  = omega(:,1)"]);
    // a counter that is not connected is no motion
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3},0,{w1},{m1},{w2},{m2}\n"));
    let head = "timestamp,distance,odrv1.axis0.pos_vel_mapper.vel,odrv1.axis0.motor.foc.Iq_measured,\
                odrv0.axis0.pos_vel_mapper.vel,odrv0.axis0.motor.foc.Iq_measured\n";
    let words = ["dalpha1  = odrv1.axis0.pos_vel_mapper.vel in rev/s", "input in A"];
    started("run.csv", &format!("{head}{rows}"), &words);
}

#[test]
fn of_many_columns_those_that_vary_are_listed_first() {
    let constants = |text: &dyn Fn(usize) -> String| (0..60).map(text).collect::<String>();
    let zeros = constants(&|_| ",0".into());
    let rows = lines(|[t, w1, w2, m1, m2]| format!("{t:.3}{zeros},{w1},{w2},{m1},{m2}\n"));
    let names = constants(&|k| format!(",param{k}"));
    let folder = Folder::new();
    folder.write("run.csv", format!("t{names},first,second,third,fourth\n{rows}"));
    folder.run(&["new", "run.csv", "-o", "e.toml"]).says(0, &["which columns hold"]);
    let text = folder.read("e.toml");
    let listed = |name: &str| text.contains(&format!("#   {name} "));
    assert!(listed("first") && listed("fourth") && !listed("param59"), "{text}");
}

#[test]
fn names_of_other_languages_state_quantity_and_side() {
    let rows = lines(|row| row.map(|x| format!("{x:.6}").replace('.', ",")).join(";") + "\n");
    for (head, right) in [
        (
            "Temps (s);Vitesse roue droite (rad/s);Vitesse roue gauche (rad/s);Couple moteur droit (Nm);Couple moteur gauche (Nm)",
            "Vitesse roue droite (rad/s)",
        ),
        (
            "tempo;velocita_dx [rad/s];velocita_sx [rad/s];coppia_dx;coppia_sx",
            "velocita_dx [rad/s]",
        ),
        ("時間[s];右速度[rad/s];左速度[rad/s];右トルク[Nm];左トルク[Nm]", "右速度[rad/s]"),
        ("tiempo (s);vel_der (rad/s);vel_izq (rad/s);par_der;par_izq", "vel_der (rad/s)"),
        (
            "Tid (s);Varvtal höger (varv/min);Varvtal vänster (varv/min);Vridmoment höger (Nm);Vridmoment vänster (Nm)",
            "Varvtal höger (varv/min)",
        ),
        (
            "Tijd [s];snelheid rechts [graden/s];snelheid links [graden/s];koppel rechts [Nm];koppel links [Nm]",
            "snelheid rechts [graden/s]",
        ),
        (
            "czas;prędkość_prawy [rad/s];prędkość_lewy [rad/s];moment_prawy;moment_lewy",
            "prędkość_prawy [rad/s]",
        ),
    ] {
        started("run.csv", &format!("{head}\n{rows}"), &[&format!("dalpha1  = {right}")]);
    }
}
