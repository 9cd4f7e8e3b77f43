use super::*;

mod clocks;
mod wheels;
mod wild;

fn columns(names: &[&str]) -> Vec<PreviewColumn> {
    // 100 Hz in the unit that the name of the time states
    let unit = names.first().and_then(|name| names::named(name).unit);
    let step = match unit {
        Some("ms") => 10.0,
        Some("us") => 1e4,
        _ => 0.01,
    };
    let ramp = |k: usize| if k == 0 { step } else { 0.3 };
    let column = |(k, name): (usize, &&str)| PreviewColumn {
        name: (*name).into(),
        values: (0..100)
            .map(|j| ramp(k) * f64::from(j) * if k == 0 { 1.0 } else { (0.1 * f64::from(j)).sin() })
            .collect(),
        ..PreviewColumn::default()
    };
    names.iter().enumerate().map(column).collect()
}

fn found(g: &Guess) -> Vec<(&str, &str, Option<&str>)> {
    g.columns.iter().map(|c| (c.key, c.name.as_str(), c.unit.as_deref())).collect()
}

/// Names as key, name, unit of what must be found.
fn expect(names: &[&str], expected: &[(&str, &str, Option<&str>)], unit: DriveUnit) {
    let g = guess(&columns(names));
    assert_eq!(found(&g), expected, "{names:?}");
    assert_eq!(g.drive_unit, unit, "{names:?}");
}

#[test]
fn common_names_and_units_are_guessed() {
    let rpm = Some("rpm");
    expect(
        &["time_ms", "right_rpm", "left_rpm", "tau_r", "tau_l"],
        &[
            ("t", "time_ms", Some("ms")),
            ("dalpha1", "right_rpm", rpm),
            ("dalpha2", "left_rpm", rpm),
            ("M1", "tau_r", None),
            ("M2", "tau_l", None),
        ],
        DriveUnit::NewtonMetre,
    );
    expect(
        &["t", "wR", "wL", "curR", "curL"],
        &[
            ("t", "t", None),
            ("dalpha1", "wR", None),
            ("dalpha2", "wL", None),
            ("M1", "curR", None),
            ("M2", "curL", None),
        ],
        DriveUnit::Ampere,
    );
    expect(
        &["stamp", "vel_right [rpm]", "vel_left [rpm]", "i_right_mA", "i_left_mA", "Vbat"],
        &[
            ("t", "stamp", None),
            ("dalpha1", "vel_right [rpm]", rpm),
            ("dalpha2", "vel_left [rpm]", rpm),
            ("M1", "i_right_mA", Some("mA")),
            ("M2", "i_left_mA", Some("mA")),
        ],
        DriveUnit::Ampere,
    );
    expect(
        &["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "V1", "V2", "gyro_angle"],
        &[
            ("t", "t", None),
            ("alpha1", "alpha1", None),
            ("alpha2", "alpha2", None),
            ("dalpha1", "dalpha1", None),
            ("dalpha2", "dalpha2", None),
            ("M1", "V1", None),
            ("M2", "V2", None),
        ],
        DriveUnit::Volt,
    );
}

#[test]
fn what_was_measured_goes_before_what_was_commanded() {
    expect(
        &[
            "t",
            "/commands/wheel_left.velocity",
            "/commands/wheel_right.velocity",
            "/commands/wheel_left.effort",
            "/commands/wheel_right.effort",
            "/states/arm_right.position",
            "/states/wheel_left.velocity",
            "/states/wheel_right.velocity",
        ],
        &[
            ("t", "t", None),
            ("dalpha1", "/states/wheel_right.velocity", None),
            ("dalpha2", "/states/wheel_left.velocity", None),
            ("M1", "/commands/wheel_right.effort", None),
            ("M2", "/commands/wheel_left.effort", None),
        ],
        DriveUnit::NewtonMetre,
    );
    expect(
        &[
            "t",
            "/Drive/LeftVelocityRadPerSec",
            "/Drive/RightVelocityRadPerSec",
            "/Drive/LeftAppliedVolts",
            "/Drive/RightAppliedVolts",
        ],
        &[
            ("t", "t", None),
            ("dalpha1", "/Drive/RightVelocityRadPerSec", None),
            ("dalpha2", "/Drive/LeftVelocityRadPerSec", None),
            ("M1", "/Drive/RightAppliedVolts", None),
            ("M2", "/Drive/LeftAppliedVolts", None),
        ],
        DriveUnit::Volt,
    );
}

#[test]
fn values_say_milliseconds_counts_and_their_number_per_turn() {
    let t: Vec<f64> = (0..1000).map(|k| 20.0 * f64::from(k)).collect();
    let speed: Vec<f64> = t.iter().map(|t| 6.0 * (1e-3 * t).sin()).collect();
    let counts =
        t.iter().map(|t| (6.0 * (1.0 - (1e-3 * t).cos()) * 2048.0 / std::f64::consts::TAU).round());
    let counts: Vec<f64> = counts.collect();
    let column = |name: &str, values: &[f64]| PreviewColumn {
        name: name.into(),
        values: values.to_vec(),
        ..PreviewColumn::default()
    };
    let log = [
        column("clock", &t),
        column("enc_r", &counts),
        column("enc_l", &counts),
        column("w_r", &speed),
        column("w_l", &speed),
        column("u_r", &speed),
        column("u_l", &speed),
    ];
    let g = guess(&log);
    assert_eq!(g.columns[0].unit.as_deref(), Some("ms"));
    assert!(g.columns[0].evidence[0].contains("19980 s at 0.050 Hz"), "{:?}", g.columns[0]);
    assert_eq!(
        (g.columns[1].unit.as_deref(), g.columns[1].per_turn),
        (Some("ticks"), Some(2048.0))
    );
    // without speeds the question is asked
    let g = guess(&log[..3]);
    assert!(g.questions.iter().any(|q| q.text.contains("how many counts")), "{:?}", g.questions);
}

#[test]
fn what_is_missing_is_asked_with_what_is_open() {
    let log = columns(&["t", "wR", "wL", "foo", "bar"]);
    let g = guess(&log);
    assert_eq!(g.questions.len(), 1, "{:?}", g.questions);
    let recordings = [("a.csv".into(), false)];
    let written = Written {
        lengths: &Lengths::default(),
        recordings: &recordings,
        folder: std::path::Path::new(""),
        guess: &g,
        remarks: &[],
        columns: &log,
        hold: None,
    };
    let text = file_text(&written);
    assert!(text.contains("M1 = \"?\", M2 = \"?\"") && text.contains("#   foo "), "{text}");
    let parsed: toml::Table = toml::from_str(&text).unwrap();
    assert_eq!(parsed["recordings"]["columns"]["dalpha1"].as_str(), Some("wR"));
    assert!(parsed["recordings"].get("hold_rows").is_none());
    let long = file_text(&Written { hold: Some((1_300_000, 1.43)), ..written });
    let parsed: toml::Table = toml::from_str(&long).unwrap();
    assert_eq!(parsed["recordings"]["hold_rows"].as_integer(), Some(1_300_000));
}

#[test]
fn one_axis_stands_for_both_wheels() {
    let g = guess(&columns(&["t", "q", "dq", "tau", "q_ref"]));
    assert!(g.one_axis);
    assert_eq!(found(&g)[1..3], [("alpha1", "q", None), ("alpha2", "q", None)]);
}

/// A name with values as a function of time.
type Input<'a> = (&'a str, fn(f64) -> f64);

/// A log of wheels that turn both ways, with an input of the given shape for each name.
fn driven(inputs: &[Input], left: f64) -> Vec<PreviewColumn> {
    let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
    let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
        name: name.into(),
        values: t.iter().map(|t| of(*t)).collect(),
        ..PreviewColumn::default()
    };
    let mut out = vec![
        column("t", &|t| t),
        column("vel_r", &|t| 6.0 * t.sin()),
        column("vel_l", &|t| left * 6.0 * (t + 0.1).sin()),
    ];
    out.extend(inputs.iter().map(|(name, of)| column(name, of)));
    out
}

#[test]
fn a_current_without_sign_gives_way_to_a_voltage_with_one() {
    let log = driven(
        &[
            ("current_r", |t| t.sin().abs()),
            ("current_l", |t| t.sin().abs()),
            ("volt_r", f64::sin),
            ("volt_l", f64::sin),
        ],
        1.0,
    );
    let g = guess(&log);
    assert_eq!(g.drive_unit, DriveUnit::Volt);
    assert!(g.columns.iter().any(|c| c.evidence.iter().any(|e| e.contains("current_r"))));
    // nothing else is there: it stays, and is refused where it is read
    assert_eq!(guess(&log[..5]).drive_unit, DriveUnit::Ampere);
}

#[test]
fn wheels_that_turn_against_each_other_raise_a_question() {
    let inputs: [Input; 2] = [("tau_r", f64::cos), ("tau_l", f64::cos)];
    let asked = |left: f64| guess(&driven(&inputs, left)).asked();
    assert!(asked(-1.0).contains("mirrored"), "{}", asked(-1.0));
    assert!(!asked(1.0).contains("mirrored"), "{}", asked(1.0));
}

fn column(name: &str, of: impl Fn(f64) -> f64) -> PreviewColumn {
    let values = (0..1000).map(|k| of(0.01 * f64::from(k))).collect();
    PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
}

#[test]
fn one_current_for_both_wheels_is_no_input_of_each() {
    let log = [
        column("time", |t| t),
        column("left_encoder_counts", |t| (900.0 * t.sin()).floor()),
        column("right_encoder_counts", |t| (800.0 * t.sin()).floor()),
        column("left_pwm", |t| (100.0 * t.cos()).floor()),
        column("right_pwm", |t| (90.0 * t.cos()).floor()),
        column("current_mA", |t| 900.0 * t.cos().abs()),
        column("battery_voltage_mV", |t| 14_000.0 - t),
    ];
    let g = guess(&log);
    let m1 = g.columns.iter().find(|c| c.key == "M1").unwrap();
    assert_eq!((m1.name.as_str(), m1.times.as_deref()), ("right_pwm", Some("battery_voltage_mV")));
    // the values do not reach the end of a scale; 8 bits of millivolts are offered
    assert!(m1.scale_open && m1.scale.is_none(), "{:?}", m1.scale);
    assert!(g.questions.iter().any(|q| q.text.contains("3.922e-6 for 255")), "{:?}", g.questions);
    assert!(g.columns.iter().any(|c| c.needs_per_turn()));
    // without the battery the full scale is asked for
    let g = guess(&log[..6]);
    assert!(g.questions.iter().any(|q| q.text.contains("scale = 0.04706")), "{:?}", g.questions);
}

#[test]
fn a_pulse_of_a_servo_stands_at_1500_us() {
    let log = [
        column("t", |t| t),
        column("w_r", f64::sin),
        column("w_l", f64::sin),
        column("pwm_us_r", |t| 1500.0 + 400.0 * t.cos()),
        column("pwm_us_l", |t| 1500.0 + 300.0 * t.cos()),
    ];
    let g = guess(&log);
    let m1 = g.columns.iter().find(|c| c.key == "M1").unwrap();
    assert_eq!((m1.offset, g.drive_unit), (Some(-1500.0), DriveUnit::Volt));
}

#[test]
fn nanoseconds_belong_to_the_seconds_of_the_same_stamp() {
    let log = [
        column("timestamp", |t| 1.7e9 + t),
        column("header.stamp.sec", |t| 1.7e9 + t.floor()),
        column("header.stamp.nsec", |t| 1e9 * t.fract()),
        column("w_r", f64::sin),
        column("w_l", f64::sin),
    ];
    let t = |log: &[PreviewColumn]| guess(log).columns.remove(0);
    let found = t(&log);
    assert_eq!(found.name, "header.stamp.sec");
    assert_eq!(found.nanoseconds.as_deref(), Some("header.stamp.nsec"));
    let other = [log[0].clone(), log[2].clone(), log[3].clone(), log[4].clone()];
    assert_eq!((t(&other).name.as_str(), t(&other).nanoseconds), ("timestamp", None));
}

#[test]
fn motors_b_and_c_are_the_wheels_and_which_is_right_is_asked() {
    let log = [
        column("t", |t| t),
        column("B_degrees", |t| 900.0 * t.sin()),
        column("C_degrees", |t| 800.0 * t.sin()),
        column("B_power", |t| 60.0 * t.cos()),
        column("C_power", |t| 50.0 * t.cos()),
    ];
    let g = guess(&log);
    assert_eq!(
        found(&g)[1..],
        [
            ("alpha1", "B_degrees", Some("deg")),
            ("alpha2", "C_degrees", Some("deg")),
            ("M1", "B_power", None),
            ("M2", "C_power", None),
        ]
    );
    assert_eq!(
        g.questions.iter().filter(|q| q.text.contains("is the right wheel that of")).count(),
        1
    );
}

#[test]
fn speeds_that_are_the_slope_of_the_counts_are_counts_a_second() {
    let log = [
        column("t", |t| t),
        column("M1_enc", |t| (9000.0 * t.sin()).floor()),
        column("M2_enc", |t| (8000.0 * t.sin()).floor()),
        column("M1_speed", |t| (9000.0 * t.cos()).round()),
        column("M2_speed", |t| (8000.0 * t.cos()).round()),
    ];
    let g = guess(&log);
    let speed = g.columns.iter().find(|c| c.key == "dalpha1").unwrap();
    assert_eq!(speed.unit.as_deref(), Some("ticks/s"));
    assert!(g.columns.iter().all(|c| c.per_turn.is_none()), "{:?}", g.columns);
}

#[test]
fn a_speed_without_a_name_is_recognised_as_the_slope_of_its_angle() {
    let log = [
        column("column1", |t| t),
        column("column2", |t| 3.0 * t.sin()),
        column("column3", |t| 2.0 * (1.7 * t).sin()),
        column("column4", |t| 3.0 * t.cos()),
        column("column5", |t| 3.4 * (1.7 * t).cos()),
        column("column6", |t| 0.3 * (2.3 * t).sin()),
    ];
    let g = guess(&log);
    let hints: Vec<&str> = g
        .questions
        .iter()
        .map(|q| q.text.as_str())
        .filter(|q| q.contains("the slope of"))
        .collect();
    assert_eq!(hints.len(), 2, "{hints:?}");
    assert!(hints[0].contains("`column4` is the slope of `column2`"), "{hints:?}");
}
