//! Which columns are those of the two wheels.

use super::*;

/// The name that was found for a key.
fn name_of<'a>(g: &'a Guess, key: &str) -> Option<&'a str> {
    g.columns.iter().find(|c| c.key == key).map(|c| c.name.as_str())
}

fn asked(g: &Guess, words: &[&str]) -> bool {
    g.questions.iter().any(|q| words.iter().all(|w| q.text.contains(w)))
}

#[test]
fn the_unit_of_a_motors_name_says_more_than_the_word_motor() {
    let g = guess(&columns(&[
        "t",
        "chassis_left_rpm",
        "chassis_right_rpm",
        "left_motor_rpm",
        "right_motor_rpm",
        "left_duty",
        "right_duty",
    ]));
    assert_eq!(name_of(&g, "dalpha1"), Some("right_motor_rpm"));
    assert_eq!((name_of(&g, "M1"), g.drive_unit), (Some("right_duty"), DriveUnit::Volt));
    let g =
        guess(&columns(&["t", "motor_left_deg", "motor_right_deg", "left_power", "right_power"]));
    assert_eq!(found(&g)[1], ("alpha1", "motor_right_deg", Some("deg")));
    assert_eq!(name_of(&g, "M1"), Some("right_power"));
}

#[test]
fn of_more_wheels_than_two_it_is_asked() {
    let of = |q: &str| (0..4).map(|k| format!("field.{q}{k}")).collect::<Vec<String>>();
    let names = [vec!["t".to_string()], of("velocity"), of("effort")].concat();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let g = guess(&columns(&names));
    assert_eq!(g.columns.len(), 1, "{:?}", g.columns);
    assert!(asked(&g, &["`field.velocity1`", "`field.velocity3`", "dalpha1"]), "{:?}", g.questions);
    assert!(asked(&g, &["`field.effort0`", "`field.effort2`", "M1"]), "{:?}", g.questions);
    let g = guess(&columns(&["pwm", "m1", "m2", "m3"]));
    assert!(
        g.columns.iter().all(|c| c.key == "t") && asked(&g, &["`m1`", "`m3`"]),
        "{:?}",
        g.columns
    );
    // three motors, and an arm beside wheels
    let g = guess(&columns(&["t", "m1_speed", "m2_speed", "m3_speed"]));
    assert_eq!(name_of(&g, "dalpha1"), None);
    let arm = [
        "t",
        "velocity.lift1_joint",
        "velocity.lift2_joint",
        "velocity.w1_joint",
        "velocity.w2_joint",
    ];
    let g = guess(&columns(&arm));
    assert_eq!(name_of(&g, "dalpha1"), None, "{:?}", g.columns);
    // variants of one pair are no other motors
    let g = guess(&columns(&["t", "speed1", "speed2", "speed_raw1", "speed_raw2"]));
    assert_eq!(name_of(&g, "dalpha1"), Some("speed1"));
}

#[test]
fn axes_of_space_and_of_a_motors_field_are_no_wheels() {
    for pair in
        [["x_position", "y_position"], ["d_axis_current", "q_axis_current"], ["vel_x", "vel_y"]]
    {
        let g = guess(&columns(&["t", pair[0], pair[1]]));
        assert_eq!(g.columns.len(), 1, "{:?}", g.columns);
    }
    let g = guess(&columns(&["t", "x_position", "y_position", "wl", "wr", "tau_l", "tau_r"]));
    assert_eq!((name_of(&g, "alpha1"), name_of(&g, "dalpha1")), (None, Some("wr")));
}

#[test]
fn one_axis_goes_before_a_pair_that_nothing_drives() {
    let g = guess(&columns(&["t", "r", "omega", "omega_m", "u", "theta1", "theta2", "e"]));
    assert!(g.one_axis, "{:?}", g.columns);
    assert_eq!((name_of(&g, "dalpha1"), name_of(&g, "M1")), (Some("omega"), Some("u")));
    assert_eq!(name_of(&g, "alpha1"), None);
    let g = guess(&columns(&[
        "time_s",
        "actual_velocity_mps",
        "torque_nm",
        "p_term_nm",
        "i_term_nm",
        "d_term_nm",
        "steering_deg",
    ]));
    assert_eq!(
        (name_of(&g, "dalpha2"), name_of(&g, "M1")),
        (Some("actual_velocity_mps"), Some("torque_nm"))
    );
    assert_eq!(name_of(&g, "alpha1"), None);
    // the columns of a speed controller of one motor
    let g = guess(&columns(&[
        "ms_today",
        "current_motor",
        "current_in",
        "d_axis_current",
        "q_axis_current",
        "erpm",
        "tachometer",
        "tachometer_abs",
    ]));
    assert!(g.one_axis && g.drive_unit == DriveUnit::Ampere, "{:?}", g.columns);
    assert_eq!(
        (name_of(&g, "M1"), name_of(&g, "alpha1")),
        (Some("current_motor"), Some("tachometer"))
    );
}

#[test]
fn set_points_are_no_measured_speeds() {
    let g = guess(&columns(&["t", "cmd_vel_left", "cmd_vel_right", "torque_left", "torque_right"]));
    assert_eq!((name_of(&g, "dalpha1"), name_of(&g, "M1")), (None, Some("torque_right")));
    assert!(asked(&g, &["`cmd_vel_right`", "set-points"]), "{:?}", g.questions);
}

#[test]
fn letters_of_motors_are_no_amperes() {
    for names in [
        ["t", "speed_a", "speed_b", "pwm_a", "pwm_b"],
        ["t", "rpmA", "rpmB", "pwmA", "pwmB"],
        ["t", "encA", "encB", "pwmA", "pwmB"],
    ] {
        let g = guess(&columns(&names));
        let motion = name_of(&g, "dalpha1").or_else(|| name_of(&g, "alpha1"));
        assert_eq!(
            (motion, name_of(&g, "M2")),
            (Some(names[1]), Some(names[4])),
            "{:?}",
            g.columns
        );
        assert!(asked(&g, &["is the right wheel that of"]));
    }
}

#[test]
fn names_that_mean_something_else_beside_others_are_read_so() {
    // a ground speed and an input, whose unit is asked for
    let g = guess(&columns(&["t", "v_left", "v_right", "pwm_left", "pwm_right"]));
    assert_eq!((name_of(&g, "dalpha1"), name_of(&g, "M1")), (Some("v_right"), Some("pwm_right")));
    assert!(
        g.columns.iter().any(|c| c.unit_open) && asked(&g, &["`v_right` has values up to", "m/s"])
    );
    // and a voltage where nothing else is one
    assert_eq!(
        name_of(&guess(&columns(&["t", "wL", "wR", "v_left", "v_right"])), "M1"),
        Some("v_right")
    );
    // terms of a controller
    let names = [
        "t",
        "right_p",
        "right_i",
        "right_d",
        "left_p",
        "left_i",
        "left_d",
        "left_vel",
        "right_vel",
    ];
    let g = guess(&columns(&names));
    assert_eq!((name_of(&g, "dalpha1"), name_of(&g, "M1")), (Some("right_vel"), None));
    // the present value of what is set
    let g = guess(&columns(&[
        "t",
        "current_left",
        "current_right",
        "target_left",
        "target_right",
        "pwm_left",
        "pwm_right",
    ]));
    assert_eq!((name_of(&g, "M1"), g.drive_unit), (Some("pwm_right"), DriveUnit::Volt));
    assert!(asked(&g, &["`current_left`", "measured speeds"]), "{:?}", g.questions);
}

#[test]
fn columns_that_hold_nothing_are_passed_over() {
    let mut log =
        columns(&["t", "vel_l", "vel_r", "torque_l", "torque_r", "current_l", "current_r"]);
    for k in [3, 4] {
        log[k].values.iter_mut().for_each(|v| *v = f64::NAN);
    }
    assert_eq!(guess(&log).drive_unit, DriveUnit::Ampere);
    for k in [3, 4] {
        log[k].values.iter_mut().for_each(|v| *v = 0.0);
    }
    let g = guess(&log);
    let said = |g: &Guess| g.columns.iter().flat_map(|c| c.evidence.clone()).collect::<String>();
    assert_eq!(g.drive_unit, DriveUnit::Ampere);
    assert!(
        said(&g).contains("`torque_r` and `torque_l` never change")
            && !said(&g).contains("magnitude")
    );
    // nothing else is there
    let g = guess(&log[..5]);
    assert!(name_of(&g, "M1").is_none() && asked(&g, &["never change", "was the input"]));
    assert!(asked(&guess(&log[..3]), &["this log contains no input"]));
    // one question on one column
    let mut log = columns(&["t", "speed", "voltage_V"]);
    log[2].values.fill(8.0);
    let questions = guess(&log).asked();
    assert!(questions.contains("`voltage_V` never changes: was the input"), "{questions}");
    assert!(!questions.contains("contains no input"), "{questions}");
}

#[test]
fn units_that_nothing_states_are_asked_or_printed() {
    let mut log = columns(&["t", "vel_l", "vel_r", "left_voltage", "right_voltage"]);
    log[4].values.iter_mut().for_each(|v| *v *= 1e3);
    log[2].values.iter_mut().for_each(|v| *v *= 100.0);
    let g = guess(&log);
    // both wheels have one unit
    assert_eq!(g.columns.iter().filter(|c| c.unit_open).count(), 2, "{:?}", g.columns);
    let units: Vec<Option<&str>> =
        g.columns.iter().filter(|c| c.key.starts_with('M')).map(|c| c.unit.as_deref()).collect();
    assert_eq!(units, [Some("mV"); 2]);
    let g = guess(&columns(&["time", "w_l", "w_r", "tau_l [Nm]", "tau_r [Nm]"]));
    let words = g.words();
    assert!(
        words.contains("no unit is stated: t in s, dalpha1 in rad/s, dalpha2 in rad/s\n"),
        "{words}"
    );
}
