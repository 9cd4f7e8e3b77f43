//! The time of the input against known shifts of it.

use super::*;
use crate::compare::unresolved;
use crate::simulate::PhysicalDynamics;

/// The recording with an input that is recorded `late` seconds before it acts, and otherwise as it was.
fn recorded_before(recording: &Recording, late: f64) -> Recording {
    recording.with_torque(shifted(recording, recording.torque(), -late))
}

#[test]
fn a_shift_of_the_input_is_found_to_a_fraction_of_a_row() {
    let model = Model::base(Robot::amigobot());
    for rows in [-0.5, 0.3, 2.0, 2.5, 3.0] {
        let recording = recorded(&[], NOISE, 18);
        let moved = shifted(&recording, recording.torque(), -rows * 0.01);
        let c = Channels {
            t: recording.t().to_vec(),
            alpha: Some(recording.alpha().to_vec()),
            omega: Some(recording.omega().to_vec()),
            torque: moved,
        };
        let moved = Recording::new("moved", c, DriveUnit::NewtonMetre).unwrap();
        let first = started(&model, std::slice::from_ref(&moved));
        let found = timing(&model, &first, &[&moved], Hold::Linear).unwrap();
        let error = found.dead_time_s - rows * 0.01;
        // a twentieth of a row is what interpolation and the sampling of the input leave
        assert!(error.abs() < 5e-4 + 3.0 * found.std_error_s, "{rows}: {found:?}");
        let expected = if rows > 0.5 { 0.0 } else { found.dead_time_s };
        assert!((found.correction_s - expected).abs() < 1e-12, "{rows}: {found:?}");
    }
}

#[test]
fn recordings_of_a_logger_that_was_started_anew_have_a_phase_each() {
    let model = Model::base(Robot::amigobot());
    // of the rows of 10 ms; the third one is held out
    let late = [0.000, 0.006, 0.008];
    let all: Vec<Recording> =
        (18..).zip(late).map(|(s, l)| recorded_before(&recorded(&[], NOISE, s), l)).collect();
    let all: Vec<&Recording> = all.iter().collect();
    let first = started(&model, &[all[0].clone(), all[1].clone()]);
    let found = phases(&model, &first, &all, 2, Hold::Linear).unwrap();
    for (phase, late) in found.iter().zip(late) {
        // a fiftieth of a row is what interpolation leaves
        let error = phase.shift_s - (late - 0.003);
        assert!(error.abs() < 2e-4 + 3.0 * phase.std_error_s, "{phase:?}");
    }
    let same: Vec<Recording> =
        (18..20).map(|s| recorded_before(&recorded(&[], NOISE, s), 0.004)).collect();
    assert_eq!(phases(&model, &first, &same.iter().collect::<Vec<_>>(), 1, Hold::Linear), None);
    // of a robot that the model does not describe a phase proves nothing
    let friction: &[(&str, &[f64])] = &[("viscous_friction", &[0.02])];
    let other: Vec<Recording> =
        (18..).zip(late).map(|(s, l)| recorded_before(&recorded(friction, NOISE, s), l)).collect();
    assert_eq!(phases(&model, &first, &other.iter().collect::<Vec<_>>(), 2, Hold::Linear), None);
}

#[test]
fn the_time_of_a_held_input_is_as_certain_as_that_of_a_line() {
    let model = Model::base(Robot::amigobot());
    let recording = recorded(&[], NOISE, 18);
    let first = started(&model, std::slice::from_ref(&recording));
    let of = |hold| timing(&model, &first, &[&recording], hold).unwrap();
    let (line, held) = (of(Hold::Linear), of(Hold::Constant));
    // rows of a smooth input that are held are late by half a row of 10 ms, which the time makes up for
    let apart = line.dead_time_s - held.dead_time_s - 0.005;
    assert!(apart.abs() < 5e-4, "{line:?} {held:?}");
    assert!(held.std_error_s < 1.5 * line.std_error_s, "{line:?} {held:?}");
}

#[test]
fn speeds_without_angles_may_be_late_by_a_row() {
    let model = Model::base(Robot::amigobot());
    let recording = recorded_before(&recorded(&[], NOISE, 18), 0.008);
    let alone = Channels {
        t: recording.t().to_vec(),
        alpha: None,
        omega: Some(recording.omega().to_vec()),
        torque: recording.torque().to_vec(),
    };
    let alone = Recording::new("speeds", alone, DriveUnit::NewtonMetre).unwrap();
    let first = started(&model, std::slice::from_ref(&recording));
    let of = |r: &Recording| timing(&model, &first, &[r], Hold::Linear).unwrap();
    assert_eq!(of(&recording).correction_s, 0.0);
    let found = of(&alone);
    assert!((found.correction_s - 0.008).abs() < 5e-4 + 3.0 * found.std_error_s, "{found:?}");
}

#[test]
fn a_dead_time_is_no_low_pass_of_the_sensor() {
    let model = Model::base(Robot::amigobot());
    let recording = recorded_before(&recorded(&[], NOISE, 30), 0.020);
    let speeds = Channels {
        t: recording.t().to_vec(),
        alpha: None,
        omega: Some(recording.omega().to_vec()),
        torque: recording.torque().to_vec(),
    };
    let speeds = Recording::new("speeds", speeds, DriveUnit::NewtonMetre).unwrap();
    let first = started(&model, std::slice::from_ref(&speeds));
    let filter = speed_filter(&AsRecorded::new(&model, &first, &[&speeds], Hold::Linear));
    assert!(filter.is_none(), "{filter:?}");
    let found = timing(&model, &first, &[&speeds], Hold::Linear).unwrap();
    let error = found.dead_time_s - 0.020;
    assert!(error.abs() < 5e-4 + 3.0 * found.std_error_s, "{found:?}");
}

#[test]
fn an_input_that_was_interpolated_keeps_the_noise_of_its_rows() {
    let recording = recorded(&[], NoiseLevel { torque: 0.01, ..NOISE }, 18);
    let before = recording.noise().torque;
    let moved = with_later_input(&recording, 0.005, Hold::Linear);
    assert_eq!(moved.noise().torque, before);
    // between the rows the mean of four remains, whose fourth differences lack what is fastest
    let plain = recording.with_torque(moved.torque().to_vec()).noise().torque;
    assert!(plain[0] < 0.6 * before[0], "{plain:?} {before:?}");
}

#[test]
fn an_input_that_was_interpolated_keeps_what_is_unknown_between_its_rows() {
    // a controller that compensates friction steps within a row at every reversal
    let recording = recorded(&[], NoiseLevel { torque: 0.0, ..NOISE }, 18);
    let model = Model::base(Robot::amigobot());
    let dynamics = PhysicalDynamics { p: model.initial(), model };
    let unknown =
        |r: &Recording| unresolved(&dynamics, std::slice::from_ref(r), Hold::Linear).unwrap();
    let moved = with_later_input(&recording, 0.004, Hold::Linear);
    let ratio = unknown(&moved) / unknown(&recording);
    // the starts of the windows are the same; a shift by a part of a row moves its end effects only
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
    // of the interpolated rows themselves a part is left, because they are already means of neighbours
    let plain = unknown(&recording.with_torque(moved.torque().to_vec())) / unknown(&recording);
    assert!(plain < 0.6, "{plain}");
}

#[test]
fn friction_that_decides_the_motion_is_not_taken_for_a_shift_of_the_input() {
    // a tank drive of 57 kg: friction of six times the acceleration torque at 4 rad/s²
    let robot = Robot::from_preset("frc_tank_drive").unwrap();
    let model = Model::base(robot);
    let p = model.initial();
    let movement = Movement::rich(model.robot(), 4, 25.0, 12.0);
    let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.02 };
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed: 4 };
    let recording = record("tank", &model, &p, &movement, &recorder).unwrap();
    let first = started(&model, std::slice::from_ref(&recording));
    let found = timing(&model, &first, &[&recording], Hold::Linear).unwrap();
    // a twentieth of a row is what the sampling of the input leaves
    assert!(found.dead_time_s.abs() < 5e-4 + 3.0 * found.std_error_s, "{found:?}");
}

#[test]
fn a_shift_that_stands_in_for_a_missing_effect_is_not_taken_out() {
    let model = Model::base(Robot::amigobot());
    // friction of up to twice the level at top speed: the base model misses every slope, and an input that acts
    // earlier or later is a little better
    let mut refused = 0;
    for (seed, viscous) in (21..27).flat_map(|seed| [0.006, 0.02].map(|v| (seed, v))) {
        let recording = recorded(&[("viscous_friction", &[viscous])], NOISE, seed);
        let first = started(&model, std::slice::from_ref(&recording));
        match timing(&model, &first, &[&recording], Hold::Linear) {
            Ok(found) => assert_eq!(found.correction_s, 0.0, "{seed}: {found:?}"),
            Err(reason) => {
                assert_eq!(reason, Untimed::AboveFloor);
                refused += 1;
            }
        }
    }
    assert!(refused > 0, "the model follows all recordings at some time: the test shows nothing");
}

/// Speeds of a motor of 12 V under steps and waves that differ from one `seed` to the next, with that lag.
fn driven_through_a_lag(tau: f64, seed: usize) -> Recording {
    let robot = Robot::from_preset("regbot").unwrap();
    let model = Model::with_effects(robot, &["back_emf", "actuator_lag"]).unwrap();
    let p = [0.0091, 0.0006, 0.0006, 0.27, 0.23, 0.19, tau];
    let t: Vec<f64> = (0..2000).map(|k| 0.01 * k as f64).collect();
    let steps = [5.0, -3.0, 6.0, 2.0, -6.0, 0.5, 3.0, -5.0, -1.0, 4.0, -2.0];
    let step = |k: usize, rows: usize| steps[(k / rows + 3 * seed) % 11];
    let mut input: Vec<[f64; 2]> = (0..t.len())
        .map(|k| [step(k, 47) + (3.0 * t[k]).sin(), step(k, 61) + (2.0 * t[k]).cos()])
        .collect();
    input[0] = [0.0; 2]; // none acts on a robot that rests
    let forced = Input { t: &t, torque: &input, hold: Hold::Linear };
    let states = simulate(&model, &p, &forced, State::default()).unwrap();
    let alpha = Some(states.iter().map(|s| s.alpha).collect());
    let noise = |k: usize| 0.02 * ((k * (k + 7 + seed)) as f64).sin();
    let omega = states.iter().enumerate().map(|(k, s)| s.omega.map(|w| w + noise(k))).collect();
    Recording::new(
        "volts",
        Channels { t, alpha, omega: Some(omega), torque: input },
        DriveUnit::Volt,
    )
    .unwrap()
}

#[test]
fn a_lag_that_the_base_fit_took_for_inertia_is_found() {
    let model = Model::with_effects(Robot::from_preset("regbot").unwrap(), &["back_emf"]).unwrap();
    let candidates = ["actuator_lag", "actuator_delay"].map(str::to_owned).into();
    let settings = Settings { candidates, ..Settings::default() };
    for tau in [0.04, 0.29] {
        let [a, b, c] = [0, 1, 2].map(|seed| driven_through_a_lag(tau, seed));
        let (train, validation) = ([a, b], [c]);
        let first = started(&model, &train);
        let data =
            Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
        let found = diagnose(&model, &[first], &data, &settings).unwrap();
        let first = &found.steps[0];
        let at = first.fit.p.last().unwrap();
        // noise leaves half a percent
        assert!(first.id == "actuator_lag" && (at / tau - 1.0).abs() < 0.02, "{tau}: {at}");
    }
}

#[test]
fn a_balance_without_a_minimum_inside_its_range_gives_no_time() {
    // steps of one size, which dry friction of that size explains at any time
    let model = Model::with_effects(Robot::amigobot(), &["back_emf"]).unwrap();
    let p = [3.5e-4, 0.0, 0.0, 0.12, 0.12, 0.0193];
    let steps = |size: f64| {
        let t: Vec<f64> = (0..600).map(|k| 0.005 * f64::from(k)).collect();
        let volts = |late: usize| (0..600).map(move |k| [if k > late { size } else { 0.0 }; 2]);
        // the motor has it 60 ms later
        let acting: Vec<[f64; 2]> = volts(12).collect();
        let input = Input { t: &t, torque: &acting, hold: Hold::Constant };
        let rest = State { alpha: [0.0; 2], omega: [0.0; 2] };
        let states = simulate(&model, &p, &input, rest).unwrap();
        let channels = Channels {
            alpha: Some(states.iter().map(|s| s.alpha).collect()),
            omega: Some(states.iter().map(|s| s.omega).collect()),
            torque: volts(0).collect(),
            t,
        };
        Recording::new("step", channels, DriveUnit::Volt).unwrap()
    };
    let both = [steps(7.0), steps(-7.0)];
    let first = started(&model, &both);
    let found = timing(&model, &first, &both.iter().collect::<Vec<_>>(), Hold::Constant);
    let right = |f: &Timing| (f.dead_time_s - 0.06).abs() < 0.005 + 3.0 * f.std_error_s;
    assert!(found.as_ref().ok().is_none_or(|f| right(f) && f.correction_s == 0.0), "{found:?}");
}

#[test]
fn friction_at_rest_that_is_larger_than_in_motion_is_no_dead_time() {
    // a motor of 12 V under a command that rises until the wheels break away, at 2.3 and 1.7 V; in motion they need 1.1
    // V
    let robot = Robot::from_preset("regbot").unwrap();
    let sticks = Model::with_effects(robot.clone(), &["back_emf", "stribeck"]).unwrap();
    let p = [0.0091, 0.0006, 0.0006, 1.1, 1.1, 0.19, 0.9, -0.3, 0.3, 2.0];
    let t: Vec<f64> = (0..250).map(|k| 0.011 * f64::from(k)).collect();
    let command = |t: f64| (6.0 * t).min(2.4) + 0.3 * (1.3 * t).sin();
    let input: Vec<[f64; 2]> = t.iter().map(|&t| [command(t), 0.98 * command(t)]).collect();
    let forced = Input { t: &t, torque: &input, hold: Hold::Constant };
    let states = simulate(&sticks, &p, &forced, State::default()).unwrap();
    let noise = |k: usize| 0.02 * ((k * (k + 7)) as f64).sin();
    let omega: Vec<[f64; 2]> =
        states.iter().enumerate().map(|(k, s)| s.omega.map(|w| w + noise(k))).collect();
    let late = omega.iter().position(|w| w[0] > 0.5).unwrap();
    assert!(t[late] > 0.25, "the wheels move at once: {late}");
    let channels = Channels { t, alpha: None, omega: Some(omega), torque: input };
    let recording = Recording::new("rise", channels, DriveUnit::Volt).unwrap();
    let model = Model::with_effects(robot, &["back_emf"]).unwrap();
    let first = started(&model, std::slice::from_ref(&recording));
    let found = timing(&model, &first, &[&recording], Hold::Constant);
    assert!(found.as_ref().ok().is_none_or(|f| !f.is_late()), "{found:?}");
}
