//! Styles of logs found in the wild.

use super::*;

fn column(name: &str, f: impl Fn(f64) -> f64) -> PreviewColumn {
    let values = (0..400).map(|k| f(0.05 * f64::from(k))).collect();
    PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
}

fn of<'a>(g: &'a Guess, key: &str) -> &'a Guessed {
    g.columns.iter().find(|c| c.key == key).unwrap()
}

/// Angle of a wheel that turns at up to 20 rad/s \[rad\], and its speed [rad/s].
fn angle(t: f64) -> f64 {
    20.0 * (1.0 - t.cos())
}

fn speed(t: f64) -> f64 {
    20.0 * t.sin()
}

const TURN: f64 = std::f64::consts::TAU;

#[test]
fn of_two_speeds_the_one_that_states_its_unit_is_taken() {
    let rpm = |t| speed(t) * 60.0 / TURN;
    let g = guess(&[
        column("time", |t| t),
        column("left_vel", |t| speed(t) / TURN),
        column("left_rpm", rpm),
        column("right_vel", |t| speed(t) / TURN),
        column("right_rpm", rpm),
        column("left_pulse_count", |t| (angle(t) * 8192.0 / TURN).floor()),
        column("right_pulse_count", |t| (angle(t) * 8192.0 / TURN).floor()),
        column("curL", speed),
        column("curR", speed),
    ]);
    assert_eq!(
        (of(&g, "dalpha1").name.as_str(), of(&g, "alpha1").per_turn),
        ("right_rpm", Some(8192.0))
    );
}

#[test]
fn a_speed_without_unit_is_in_that_in_which_an_encoder_has_its_counts() {
    let logged = |turn: f64, per_unit: f64| {
        guess(&[
            column("time", |t| t),
            column("wL", |t| speed(t) / per_unit),
            column("wR", |t| speed(t) / per_unit),
            column("encL", |t| (angle(t) * turn / TURN).floor()),
            column("encR", |t| (angle(t) * turn / TURN).floor()),
            column("curL", speed),
            column("curR", speed),
        ])
    };
    for (per_unit, unit) in [(1.0, None), (TURN, Some("rev/s")), (TURN / 60.0, Some("rpm"))] {
        let g = logged(8192.0, per_unit);
        // rpm beyond what rad/s may be are asked for
        let asked = per_unit < 0.5;
        let expected = if asked { (None, None) } else { (unit, Some(8192.0)) };
        assert_eq!((of(&g, "dalpha1").unit.as_deref(), of(&g, "alpha1").per_turn), expected);
        assert_eq!(of(&g, "dalpha1").unit_open, asked);
    }
    // 8192 x 0.37 counts per turn are none of an encoder: a speed in a unit of its own does not give them
    let g = logged(8192.0, 1.0 / 0.37);
    assert_eq!(of(&g, "alpha1").per_turn, None);
    assert!(g.questions.iter().any(|q| q.text.contains("how many counts")), "{:?}", g.questions);
}

#[test]
fn steps_of_counts_are_counts_of_a_row() {
    let counts = |t: f64| (angle(t) * 660.0 / TURN).floor();
    let step = |t: f64| counts(t) - counts(t - 0.05);
    let g = guess(&[
        column("t", |t| t),
        column("encL", counts),
        column("encR", counts),
        column("velL", step),
        column("velR", step),
        column("curL", speed),
        column("curR", speed),
    ]);
    let w = of(&g, "dalpha1");
    assert_eq!((w.unit.as_deref(), w.scale), (Some("ticks/s"), Some(20.0)), "{:?}", w.evidence);
    assert!(of(&g, "alpha1").needs_per_turn());
}

#[test]
fn a_time_that_is_left_is_turned_round() {
    let g = guess(&[
        column("Match Time", |t| (135.0 - t).ceil()),
        column("Right Velocity", speed),
        column("Left Velocity", speed),
        column("curR", speed),
        column("curL", speed),
    ]);
    assert_eq!((of(&g, "t").name.as_str(), of(&g, "t").scale), ("Match Time", Some(-1.0)));
}

#[test]
fn speeds_that_lost_their_sign_beside_their_set_points_are_asked_for() {
    let asks = |f: fn(f64) -> f64| {
        let g = guess(&[
            column("t", |t| t),
            column("DesR", speed),
            column("DesL", speed),
            column("Meas_R_rpm", move |t| f(speed(t))),
            column("Meas_L_rpm", move |t| f(speed(t))),
            column("right_pwm", |t| f64::abs(speed(t))),
            column("left_pwm", |t| f64::abs(speed(t))),
        ]);
        g.questions.iter().any(|q| q.text.contains("a magnitude?"))
    };
    assert!(asks(f64::abs) && !asks(|w| w));
}

#[test]
fn an_effort_within_one_beside_a_battery_may_be_a_share_of_it() {
    let logged = |battery: &str, most: f64| {
        guess(&[
            column("t", |t| t),
            column("left_rpm", speed),
            column("right_rpm", speed),
            column("left_effort", |t| most * t.sin()),
            column("right_effort", |t| most * t.sin()),
            column(battery, |t| 7.4 - 0.01 * t),
        ])
    };
    let asks =
        |g: &Guess| g.questions.iter().any(|q| q.text.contains("times = \"battery_voltage\""));
    assert!(asks(&logged("battery_voltage", 0.9)));
    assert!(!asks(&logged("battery_voltage", 2.0)) && !asks(&logged("gyro_rate", 0.9)));
}

#[test]
fn numbers_of_a_few_volts_are_no_percent() {
    let logged = |name: [&str; 2], f: fn(f64) -> f64| {
        let g = guess(&[
            column("t", |t| t),
            column("left_rpm", speed),
            column("right_rpm", speed),
            column(name[0], move |t| f(t.sin())),
            column(name[1], move |t| f(t.sin())),
        ]);
        g.asked()
    };
    assert!(logged(["motor_l", "motor_r"], |s| 6.19 * s).contains("volts, as assumed?"));
    assert!(logged(["pwm_l", "pwm_r"], |s| 6.19 * s).contains("is a share"));
    assert!(logged(["motor_l", "motor_r"], |s| (6.0 * s).round()).contains("is a share"));
    assert!(logged(["L.u", "R.u"], |s| 170.0 * s).contains("which cannot be volts"));
    assert!(!logged(["L.u", "R.u"], |s| 7000.0 * s).contains("which cannot be volts"));
}

#[test]
fn speeds_beside_large_currents_are_not_in_milliamperes() {
    let logged = |top: f64| {
        guess(&[
            column("ms", |t| 1e3 * t),
            column("vel_l", |t| (20.0 * speed(t)).round()),
            column("vel_r", |t| (20.0 * speed(t)).round()),
            column("cur_l", move |t| (top * t.cos()).round()),
            column("cur_r", move |t| (top * t.cos()).round()),
        ])
    };
    let g = logged(900.0);
    assert_eq!((of(&g, "dalpha1").unit.as_deref(), of(&g, "dalpha1").unit_open), (None, true));
    assert_eq!((of(&g, "M1").unit.as_deref(), of(&g, "M1").unit_open), (Some("mA"), false));
    // whole amperes up to 150 are as likely milliamperes
    let g = logged(150.0);
    assert!(of(&g, "M2").unit_open && g.questions.iter().any(|q| q.text.contains("in A or mA?")));
    assert!(!of(&logged(5.0), "M1").unit_open);
}

#[test]
fn torques_in_whole_numbers_are_asked_for() {
    let logged = |name: &str, top: f64| {
        guess(&[
            column("ms", |t| 1e3 * t),
            column("vel_l", speed),
            column("vel_r", speed),
            column(&format!("left_{name}"), move |t| (top * t.cos()).round()),
            column(&format!("right_{name}"), move |t| (top * t.cos()).round()),
        ])
    };
    // drives of CiA 402 send per mille of their rated torque
    let g = logged("torque_actual", 612.0);
    assert!(of(&g, "M1").unit_open && of(&g, "M2").unit_open, "{:?}", g.columns);
    assert!(g.questions.iter().any(|q| q.text.contains("per mille of the rated torque")));
    assert!(!of(&logged("torque_actual", 5.0), "M1").unit_open);
    assert!(!of(&logged("torque_mNm", 612.0), "M1").unit_open);
}

#[test]
fn days_of_a_calendar_are_recognised_by_their_size() {
    for start in [739_373.416_7, 45_413.416_7, 19_844.416_7] {
        let g = guess(&[
            column("datenum", |t| start + t / 86_400.0),
            column("w_r", speed),
            column("w_l", speed),
            column("tau_r", speed),
            column("tau_l", speed),
        ]);
        let t = of(&g, "t");
        assert_eq!(t.unit.as_deref(), Some("d"), "{start}");
        assert!(
            t.evidence
                .iter()
                .any(|e| e.contains("days of a calendar (") && e.contains("at 20 Hz)"))
        );
    }
}

#[test]
fn a_column_that_is_called_battery_is_one_where_its_values_are() {
    let logged = |name: &str, volts: fn(f64) -> f64| {
        let g = guess(&[
            column("t", |t| t),
            column("left_rpm", speed),
            column("right_rpm", speed),
            column("pwm_left", |t| (300.0 * t.sin()).round().clamp(-255.0, 255.0)),
            column("pwm_right", |t| (300.0 * t.sin()).round().clamp(-255.0, 255.0)),
            column(name, volts),
        ]);
        (of(&g, "M1").times.clone(), of(&g, "M1").scale)
    };
    for name in ["bat", "battery", "vbatt"] {
        assert_eq!(logged(name, |t| 14.4 - 0.01 * t), (Some(name.into()), Some(1.0 / 255.0)));
    }
    let (times, scale) = logged("battery", |t| 14_400.0 - t);
    assert!(times.is_some() && (scale.unwrap() * 255.0 - 1e-3).abs() < 1e-15);
    // a charge that falls from full, and what is no voltage
    assert_eq!(logged("battery", |t| 1.0 - 0.01 * t).0, None);
    assert_eq!(logged("battery", |t| 50.0 - 2.45 * t).0, None);
}

fn log(names: &[&str], f: impl Fn(f64) -> f64 + Copy) -> Guess {
    let mut all = vec![column("t", |t| t)];
    all.extend(names.iter().map(|name| column(name, f)));
    guess(&all)
}

#[test]
fn outputs_of_controllers_are_inputs_where_nothing_else_is() {
    for (right, left) in [
        ("right_pwr", "left_pwr"),
        ("output_right", "output_left"),
        ("ctrl_r", "ctrl_l"),
        ("pid_r", "pid_l"),
        ("R_OUT", "L_OUT"),
    ] {
        let g = log(&["rpm_r", "rpm_l", right, left], |t| 10.0 * speed(t));
        assert_eq!(of(&g, "M1").name, right, "{:?}", g.questions);
        assert!(g.asked().contains("is a share of the battery voltage"));
        let g = log(&["rpm_r", "rpm_l", right, left, "amps_r", "amps_l"], speed);
        assert_eq!(of(&g, "M1").name, "amps_r");
    }
    let g = log(&["rpm_r", "rpm_l", "pwm_pct_r", "pwm_pct_l"], speed);
    assert!(g.asked().contains("with 100 for the full"), "{:?}", g.questions);
    // of one axis a command, with the column of its direction
    let dir = column("dir", |t| speed(t).signum());
    let pwm = column("pwm_cmd", |t| speed(t).abs());
    let g = guess(&[column("t", |t| t), column("rpm", speed), pwm, dir]);
    assert_eq!(
        (of(&g, "M2").name.as_str(), of(&g, "M2").sign.as_deref()),
        ("pwm_cmd", Some("dir"))
    );
}

#[test]
fn measured_values_beside_their_set_points_are_the_speeds() {
    for names in [
        ["soll_l", "soll_r", "ist_l", "ist_r", "u_l", "u_r"],
        ["L_SP", "R_SP", "L_PV", "R_PV", "L_OUT", "R_OUT"],
        ["wl_ref", "wr_ref", "wl_meas", "wr_meas", "pwm_l", "pwm_r"],
    ] {
        let g = log(&names, speed);
        assert_eq!(
            (of(&g, "dalpha1").name.as_str(), of(&g, "M1").name.as_str()),
            (names[3], names[5])
        );
    }
    let g = log(&["target_mmps", "spd_l", "spd_r", "duty_l", "duty_r"], |t| 20.0 * speed(t));
    assert_eq!(
        (of(&g, "dalpha1").unit.as_deref(), of(&g, "dalpha1").unit_open),
        (Some("mm/s"), false)
    );
}

#[test]
fn angles_that_turn_too_fast_and_positions_with_their_slopes_are_asked_for() {
    let of_log = |names: [&str; 2], factor: f64, speeds: Option<[&str; 2]>| {
        let mut all = vec![column("t", |t| t)];
        all.extend(names.map(|name| column(name, |t| factor * angle(t))));
        all.extend(speeds.into_iter().flatten().map(|name| column(name, |t| factor * speed(t))));
        all.extend(["torque_r", "torque_l"].map(|name| column(name, speed)));
        let g = guess(&all);
        (of(&g, "alpha1").unit_open, g.columns.iter().any(|c| c.key == "dalpha1" && c.unit_open))
    };
    assert_eq!(of_log(["theta_r", "theta_l"], 1.0, None), (false, false));
    assert_eq!(of_log(["theta_r", "theta_l"], 360.0 / TURN, None), (true, false));
    let pair = |a: &'static str, b: &'static str| Some([a, b]);
    let speeds = pair("vel_r", "vel_l");
    assert_eq!(of_log(["pos_r", "pos_l"], 0.05, speeds), (true, true));
    assert_eq!(of_log(["theta_r", "theta_l"], 1.0, pair("omega_r", "omega_l")), (false, false));
    let joints = pair("joint_r.velocity", "joint_l.velocity");
    assert_eq!(of_log(["joint_r.position", "joint_l.position"], 1.0, joints), (false, false));
}

#[test]
fn columns_that_are_all_proportional_are_reported_as_no_slopes() {
    let constant = |name: &str, by: f64| column(name, move |t| by + 1e-3 * t);
    let g =
        guess(&[column("t", |t| t), constant("a", 1.0), constant("b", 2.0), constant("c", 3.0)]);
    assert!(!g.asked().contains("is the slope of"), "{:?}", g.questions);
}
