//! What a logger does to a recording, distinguished from physics, on random steps of the input.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{
    Accounts, Acting, AsRecorded, Course, Known, course_of_input, more_likely_logging,
    speed_filter, timing,
};
use crate::filter::noise_of_jumps;
use crate::identify::{Task, start};
use crate::model::Model;
use crate::model::base::{A1, A4};
use crate::recording::{Channels, DriveUnit, Recording};
use crate::robot::{Robot, State};
use crate::simulate::{Hold, Input, simulate};

/// 30 s at 100 Hz of the AmigoBot with `effects` under torques that step every 0.1 to 0.4 s, held between the rows or
/// not, with speeds that `logged` changes and noise of 0.01 rad/s.
fn stepped(
    effects: &[(&str, f64)],
    held: Hold,
    seed: u64,
    logged: impl Fn(Vec<[f64; 2]>) -> Vec<[f64; 2]>,
) -> Recording {
    let ids: Vec<&str> = effects.iter().map(|(id, _)| *id).collect();
    let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
    let mut p = model.initial();
    p.truncate(5);
    p.extend(effects.iter().map(|(_, value)| value));
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
    let (mut torque, mut now) = (Vec::with_capacity(t.len()), [0.0; 2]);
    let mut left = 0;
    for _ in &t {
        if left == 0 {
            left = rng.random_range(10..40);
            now = [0, 1].map(|i| p[3 + i] * rng.random_range(-3.0..3.0));
        }
        left -= 1;
        torque.push(now);
    }
    torque[0] = [0.0; 2]; // none acts on a robot that rests
    let input = Input { t: &t, torque: &torque, hold: held };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let speeds = logged(motion.iter().map(|s| s.omega).collect());
    let mut noise =
        || 0.01 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let omega = speeds.iter().map(|w| [w[0] + noise(), w[1] + noise()]).collect();
    let channels = Channels { t, alpha: None, omega: Some(omega), torque };
    Recording::new("stepped", channels, DriveUnit::NewtonMetre).unwrap()
}

/// 30 s at 100 Hz of the AmigoBot, whose friction is three times as large at rest as at speed, with a Stribeck speed of
/// 2 rad/s, under torques that rise slowly from zero until the wheels have broken away, and then fall, with noise of
/// 0.01 rad/s.
fn breaking_away() -> Recording {
    let model = Model::with_effects(Robot::amigobot(), &["stribeck"]).unwrap();
    let mut p = model.initial();
    let level = p[A4];
    p[5..].copy_from_slice(&[2.0 * level, 2.0, 0.0, 1.0]);
    let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
    let at = |t: &f64| {
        let (run, now) = ((t / 2.0).floor(), t % 2.0);
        let rises = if now < 1.2 { now / 1.2 } else { 0.4 * (2.0 - now) };
        let way = if run % 2.0 == 0.0 { 1.0 } else { -1.0 };
        // the wheels break away at different times
        [4.0 * level * rises * way, 3.4 * level * rises * way]
    };
    let torque: Vec<[f64; 2]> = t.iter().map(at).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(51);
    let mut noise =
        || 0.01 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let omega = motion.iter().map(|s| s.omega.map(|w| w + noise())).collect();
    let channels = Channels { t, alpha: None, omega: Some(omega), torque };
    Recording::new("breaking away", channels, DriveUnit::NewtonMetre).unwrap()
}

/// Parameters by the balance of the torques; steps of the input are no noise of it.
fn started(model: &Model, recording: &mut Recording) -> Vec<f64> {
    let train = std::slice::from_ref(recording);
    let task = Task { model, train, hold: Hold::Linear, seed: 0 };
    let start = start::start(&task, "test").unwrap();
    recording.set_noise_of_jumps(noise_of_jumps(model, &start, &[recording], Hold::Linear));
    start
}

#[test]
fn speeds_behind_a_low_pass_of_their_sensor_are_distinguished_from_a_lag_of_the_actuator() {
    let model = Model::base(Robot::amigobot());
    // exponential moving average: mean delay h (1 - a)/a, which the pole of the low-pass, -h/ln(1 - a), exceeds
    let (h, share) = (0.01, 0.3);
    let low = |rows: Vec<[f64; 2]>| {
        let mut y = rows[0];
        let next = |w: &[f64; 2]| {
            y = [0, 1].map(|i| y[i] + share * (w[i] - y[i]));
            y
        };
        rows.iter().map(next).collect()
    };
    for seed in [31, 32] {
        let mut filtered = stepped(&[], Hold::Linear, seed, low);
        let first = started(&model, &mut filtered);
        let found =
            speed_filter(&AsRecorded::new(&model, &first, &[&filtered], Hold::Linear)).unwrap();
        let (mean, pole) = (h * (1.0 - share) / share, -h / (1.0_f64 - share).ln());
        // no continuous low-pass has both; a tenth for the row between them
        let time = found.low_pass.time_s;
        assert!(time > 0.9 * mean && time < 1.1 * pole, "{seed}: {found:?}");

        for effect in [("actuator_lag", 0.03), ("actuator_delay", 0.025)] {
            let mut late = stepped(&[effect], Hold::Linear, seed, |rows| rows);
            let first = started(&model, &mut late);
            let found = speed_filter(&AsRecorded::new(&model, &first, &[&late], Hold::Linear));
            assert_eq!(found, None, "{seed} {effect:?}");
        }
    }
}

/// The input between its rows, if it is known not to be on the line.
fn known(given: &AsRecorded) -> Option<Known> {
    match course_of_input(given) {
        Course::Known(known) => Some(known),
        Course::Line | Course::LineOrHeld => None,
    }
}

#[test]
fn an_input_that_is_held_between_the_rows_is_distinguished_from_one_that_runs_on() {
    let model = Model::base(Robot::amigobot());
    for seed in [41, 42] {
        for truth in [Hold::Constant, Hold::Linear] {
            let mut recording = stepped(&[], truth, seed, |rows| rows);
            let first = started(&model, &mut recording);
            let recordings = [&recording];
            let given = AsRecorded::new(&model, &first, &recordings, Hold::Linear);
            let held = (truth == Hold::Constant).then_some(Acting::Held);
            assert_eq!(known(&given).map(|known| known.acting), held, "{seed}");
        }
    }
}

#[test]
fn rows_that_are_means_of_a_held_input_up_to_there_are_found_with_the_right_inertia() {
    let model = Model::base(Robot::amigobot());
    let mut recording = stepped(&[], Hold::Constant, 41, |rows| rows);
    let truth = model.initial();
    // each row is what was held until it: a row later than what is held from it on
    let mut late = recording.torque().to_vec();
    late.rotate_right(1);
    late[0] = late[1];
    recording = recording.with_torque(late);
    let first = started(&model, &mut recording);
    let known = known(&AsRecorded::new(&model, &first, &[&recording], Hold::Linear)).unwrap();
    assert_eq!(known.acting, Acting::Held);
    let held = known.p;
    // the balance of torques a row late is off by more
    let off = |p: &[f64]| (p[A1] / truth[A1] - 1.0).abs();
    assert!(off(&held) < 0.03 && off(&first) > 2.0 * off(&held), "{held:?} {first:?}");
    let found = timing(&model, &held, &[&recording], Hold::Constant).unwrap();
    let row = recording.step();
    assert!((found.dead_time_s + row).abs() < 0.1 * row, "{found:?}");
}

#[test]
fn an_input_that_is_recorded_after_it_acted_is_shifted_whatever_is_missing() {
    let model = Model::base(Robot::amigobot());
    let mut recording = stepped(&[("turning_scrub", 0.02)], Hold::Linear, 43, |rows| rows);
    let mut late = recording.torque().to_vec();
    late.rotate_right(1);
    late[0] = late[1];
    recording = recording.with_torque(late);
    let first = started(&model, &mut recording);
    let found = timing(&model, &first, &[&recording], Hold::Linear).unwrap();
    let row = recording.step();
    // a standard error of a seventh of a row, and as much by the scrub that the model lacks
    assert!((found.correction_s + row).abs() < 0.3 * row, "{found:?}");
}

/// Time of the fine rows of [`waves`], of which 20 are one of the log \[s\].
const FINE_S: f64 = 1e-3;

/// 40 s at 50 Hz of the AmigoBot under torques of several frequencies up to 6 Hz, with speeds of noise 0.005 rad/s. The
/// input of every row is what `recorded` makes of its number and of the torques in fine rows.
fn waves(recorded: impl Fn(usize, &[[f64; 2]]) -> [f64; 2]) -> Recording {
    let (model, fine, rows) = (Model::base(Robot::amigobot()), 20, 2000);
    let p = model.initial();
    let t: Vec<f64> = (0..rows * fine).map(|k| FINE_S * k as f64).collect();
    let wave = |t: f64, i: usize| {
        let of = |rate: f64, phase: f64| (std::f64::consts::TAU * rate * t + phase).sin();
        p[A4] * (1.5 * of(0.31, i as f64) + 1.2 * of(2.3, 0.4) + of(5.9 - 0.7 * i as f64, 1.1))
    };
    let torque: Vec<[f64; 2]> = t.iter().map(|&t| [wave(t, 0), wave(t, 1)]).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(61);
    let mut noise =
        || 0.005 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng);
    let of_rows = motion.iter().step_by(fine);
    let omega = of_rows.map(|s| s.omega.map(|w| w + noise())).collect();
    let recorded = (0..rows).map(|row| recorded(row * fine, &torque)).collect();
    let t = (0..rows).map(|row| FINE_S * (row * fine) as f64).collect();
    let channels = Channels { t, alpha: None, omega: Some(omega), torque: recorded };
    Recording::new("waves", channels, DriveUnit::NewtonMetre).unwrap()
}

/// The same, of which every row records the mean over the row before it.
fn averaged_input() -> Recording {
    // the line between fine rows has the mean of its ends
    waves(|now, torque| {
        let steps = now.saturating_sub(20)..now.max(20);
        let mid =
            |k: usize, i: usize| 0.5 * (torque[k][i] + torque[(k + 1).min(torque.len() - 1)][i]);
        [0, 1].map(|i| steps.clone().map(|k| mid(k, i)).sum::<f64>() / 20.0)
    })
}

#[test]
fn a_smooth_input_that_acts_a_part_of_a_row_late_is_not_held() {
    let model = Model::base(Robot::amigobot());
    for late in [8, 17, 33] {
        let mut recording = waves(|now, torque| torque[(now + late).min(torque.len() - 1)]);
        let first = started(&model, &mut recording);
        let recordings = [&recording];
        let given = AsRecorded::new(&model, &first, &recordings, Hold::Linear);
        assert!(known(&given).is_none(), "{late}: {:?}", course_of_input(&given));
    }
}

#[test]
fn rows_that_are_means_of_an_input_that_varies_within_them_are_found_with_the_right_inertia() {
    let model = Model::base(Robot::amigobot());
    let mut recording = averaged_input();
    let first = started(&model, &mut recording);
    let recordings = [&recording];
    let given = AsRecorded::new(&model, &first, &recordings, Hold::Linear);
    let known = known(&given).unwrap();
    let Acting::Mean { shift_s } = known.acting else { panic!("{known:?}") };
    let row = recording.step();
    assert!((shift_s + row).abs() < 0.02 * row, "{shift_s}");
    // the fit on the line between the values lacks a quarter of the swiftest wave in every row
    let off = |p: &[f64]| (p[A1] / model.initial()[A1] - 1.0).abs();
    let line = given.fitted().unwrap();
    assert!(off(&known.p) < 0.003 && off(line) > 3.0 * off(&known.p), "{known:?} {line:?}");
}

#[test]
fn friction_that_is_larger_at_rest_is_no_low_pass_of_the_speeds() {
    let model = Model::base(Robot::amigobot());
    let mut recording = breaking_away();
    let first = started(&model, &mut recording);
    assert_eq!(speed_filter(&AsRecorded::new(&model, &first, &[&recording], Hold::Linear)), None);
    let averages = Accounts { averages: true, steps: false };
    assert!(
        more_likely_logging(
            &AsRecorded::new(&model, &first, &[&recording], Hold::Linear),
            averages
        )
        .is_none()
    );
}
