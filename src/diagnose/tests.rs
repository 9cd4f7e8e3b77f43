//! The parts of the diagnosis against independent computations.

mod differences;
mod starts;
mod timing;

use super::regression::{Buffers, Regression};
use super::screen::Screen;
use super::smoothed::Smoothed;
use super::*;
use crate::effects::Scale;
use crate::identify::{Task, start};
use crate::model::Model;
use crate::model::base::{A1, A4};
use crate::recording::{Channels, DriveUnit, Recording};
use crate::robot::{Robot, State};
use crate::simulate::{Hold, Input, Movement, NoiseLevel, Recorder, record, simulate};

const NOISE: NoiseLevel = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };

/// A recording of 15 s at 100 Hz of the AmigoBot with effects of the catalogue.
fn recorded(effects: &[(&str, &[f64])], noise: NoiseLevel, seed: u64) -> Recording {
    let ids: Vec<&str> = effects.iter().map(|(id, _)| *id).collect();
    let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
    let mut p = model.initial();
    p.truncate(5);
    effects.iter().for_each(|(_, values)| p.extend_from_slice(values));
    let movement = Movement::rich(model.robot(), seed, 15.0, 12.0);
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed };
    record("synthetic", &model, &p, &movement, &recorder).unwrap()
}

fn started(model: &Model, train: &[Recording]) -> Vec<f64> {
    start::start(&Task { model, train, hold: Hold::Linear, seed: 0 }, "test").unwrap()
}

/// The diagnosis of the base model on two training recordings with `effects` and one of validation.
fn diagnosed(
    effects: &[(&str, &[f64])],
    noise: NoiseLevel,
    seed: u64,
    settings: &Settings,
) -> Diagnosis {
    let model = Model::base(Robot::amigobot());
    let [a, b, c] = [0, 1, 2].map(|r| recorded(effects, noise, seed + r));
    let (train, validation) = ([a, b], [c]);
    let first = started(&model, &train);
    let data =
        Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
    diagnose(&model, &[first], &data, settings).unwrap()
}

fn scale(model: &Model, p: &[f64], recordings: &[&Recording]) -> Scale {
    scale_of(model, p, recordings)
}

#[test]
fn a_single_axis_mapped_to_both_wheels_is_evidence_once() {
    let two = recorded(&[], NOISE, 3);
    let first = |rows: &[[f64; 2]]| rows.iter().map(|r| [r[0]; 2]).collect::<Vec<_>>();
    let channels = Channels {
        t: two.t().to_vec(),
        alpha: Some(first(two.alpha())),
        omega: Some(first(two.omega())),
        torque: first(two.torque()),
    };
    let one = Recording::new("axis", channels, two.drive_unit()).unwrap();
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let degrees = |r: &Recording| {
        let smoothed = Smoothed::new(&[r], 5.0);
        Regression::new(&model, &p, &smoothed, r.top_speed()).unwrap().degrees
    };
    // the other wheel rests a little less or more
    let ratio = degrees(&one) / degrees(&two);
    assert!((ratio - 0.5).abs() < 0.05, "{ratio}");
}

#[test]
fn the_gradient_of_the_windows_is_that_of_their_cost() {
    let recording = recorded(&[], NOISE, 3);
    for ids in [vec!["viscous_friction", "actuator_lag"], vec!["compliance"]] {
        let model = Model::with_effects(Robot::amigobot(), &ids).unwrap();
        let mut p = model.initial();
        let windows = Windows::new(vec![&recording], Hold::Linear, &model, &p);
        p[A1] *= 1.02;
        let free = model.free();
        let found = windows.quadratic(&model, &p, &free).unwrap();
        assert!((found.cost - windows.cost(&model, &p).unwrap()).abs() < 1e-9 * found.cost);
        for (n, &j) in free.iter().enumerate() {
            let h = 1e-6 * p[j].abs();
            let at = |sign: f64| {
                let mut q = p.clone();
                q[j] += sign * h;
                windows.cost(&model, &q).unwrap()
            };
            let slope = (at(1.0) - at(-1.0)) / (2.0 * h);
            // standard deviation of the score: differences across stops and the start that is profiled
            // out agree to a small part of it
            let sigma = found.hessian[(n, n)].sqrt();
            assert!(
                (slope - found.gradient[n]).abs() < 0.2 * sigma + 0.02 * slope.abs(),
                "{ids:?} {j}"
            );
        }
    }
}

#[test]
fn a_fit_by_windows_is_at_the_true_values_within_its_errors() {
    let recordings = [recorded(&[], NOISE, 5), recorded(&[], NOISE, 6)];
    let model = Model::base(Robot::amigobot());
    let all: Vec<&Recording> = recordings.iter().collect();
    let first = started(&model, &recordings);
    let windows = Windows::new(all.clone(), Hold::Linear, &model, &first);
    let fit = fit(&windows, &model, &first, &scale(&model, &first, &all)).unwrap();
    for (j, truth) in model.initial().iter().enumerate() {
        let error = fit.covariance[(j, j)].sqrt();
        assert!((fit.p[j] - truth).abs() < 4.5 * error, "{j}: {} {truth} {error}", fit.p[j]);
        assert!(error < 0.1 * truth.abs(), "{j}: {error}");
    }
}

#[test]
fn the_regression_finds_the_coefficient_and_the_timing_of_the_input() {
    let b = 0.01;
    let recording = recorded(&[("viscous_friction", &[b])], NOISE, 7);
    let model = Model::base(Robot::amigobot());
    let first = started(&model, std::slice::from_ref(&recording));
    let all = vec![&recording];
    let scale = scale(&model, &first, &all);
    let smoothed = Smoothed::new(&all, scale.bandwidth);
    let regression = Regression::new(&model, &first, &smoothed, scale.speed).unwrap();
    let named = ["viscous_friction".to_string()];
    let found = candidates(&model, &first, &named, &[], &all, &scale);
    let (ratio, estimate) = regression.ratio(&found[0], &mut Buffers::default());
    // an effect of eight tenths of the friction at top speed is certain
    assert!(ratio > 50.0 && (estimate[0] - b).abs() < 0.1 * b, "{ratio} {estimate:?}");
}

#[test]
fn a_column_that_no_motion_of_the_robot_shows_is_left_out() {
    let named = ["wheel_radius_mismatch".to_string()];
    // the centre of mass of the tank drive is on its axle: a3 = 0, and no centrifugal torque
    for (preset, columns) in [("amigobot", 2), ("frc_tank_drive", 1)] {
        let robot = Robot::from_preset(preset).unwrap();
        let model = Model::base(robot);
        let recording = recorded(&[], NOISE, 7);
        let p = model.initial();
        let all = vec![&recording];
        let found = candidates(&model, &p, &named, &[], &all, &scale(&model, &p, &all));
        assert_eq!((found[0].columns(), found[0].parameters()), (columns, columns), "{preset}");
    }
}

#[test]
fn windows_that_hang_on_one_row_of_the_input_weigh_less() {
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let level = p[A4];
    // a second of driving, and one in which a single row breaks the wheels away from rest
    let t: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
    let torque = |k: usize| match k {
        0..100 => 1.8 * level,
        150 => 3.0 * level,
        _ => 0.0,
    };
    let torque: Vec<[f64; 2]> = (0..200).map(|k| [torque(k); 2]).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let c = Channels {
        t: t.clone(),
        alpha: Some(motion.iter().map(|s| s.alpha).collect()),
        omega: Some(motion.iter().map(|s| s.omega).collect()),
        torque: torque.clone(),
    };
    let recording = Recording::new("hangs", c, DriveUnit::NewtonMetre).unwrap();
    let plain = Windows::new(vec![&recording], Hold::Linear, &model, &p);
    let sampled = plain.clone().sampled(&model, &p);
    assert_eq!(sampled.windows.len(), 2);
    let share = |n: usize| {
        let of = |windows: &Windows| windows.weights(&windows.windows[n])[40][0];
        of(&sampled) / of(&plain)
    };
    // a third of a breakaway of some rad/s against rounding of the speeds
    assert!(share(0) > 0.8 && share(1) < 0.05, "{} {}", share(0), share(1));
}

#[test]
fn the_first_order_gain_of_a_small_torque_is_that_of_its_fit() {
    let recordings =
        [recorded(&[("viscous_friction", &[0.002])], NOISE, 9), recorded(&[], NOISE, 10)];
    let model = Model::base(Robot::amigobot());
    let all: Vec<&Recording> = recordings[..1].iter().collect();
    let first = started(&model, &recordings[..1]);
    let scale = scale(&model, &first, &all);
    let windows = Windows::new(all.clone(), Hold::Linear, &model, &first);
    let base = fit(&windows, &model, &first, &scale).unwrap();
    let screen = Screen::new(&model, &base.p, &windows, 1000.0).unwrap();
    let named = ["viscous_friction".to_string()];
    let found = candidates(&model, &base.p, &named, &[], &all, &scale);
    let (ratio, estimate) = screen.ratio(&found[0]);
    let with = model.add("viscous_friction").unwrap();
    let mut from = base.p.clone();
    from.push(estimate[0]);
    let refit = fit(&windows, &with, &from, &scale).unwrap();
    let exact = 1000.0 * (base.cost / refit.cost).ln();
    // stops inside windows are not linear in the parameters, here by a sixth
    assert!((ratio - exact).abs() < 0.2 * exact, "{ratio} {exact}");
    assert!((estimate[0] - refit.p[5]).abs() < 0.15 * refit.p[5], "{estimate:?} {:?}", refit.p);
}

#[test]
#[ignore = "a measurement: the coverage of dead times over 60 seeds each, half a minute"]
#[expect(clippy::print_stdout, reason = "a measurement that is run by hand")]
fn the_intervals_of_dead_times_cover_the_true_value() {
    let model = Model::base(Robot::amigobot());
    for delay in [0.0, 0.020, 0.023, 0.025, 0.030] {
        // a command is held for a millisecond
        let truth = delay + 0.0005;
        let z: Vec<f64> = (0..60)
            .map(|seed| {
                let recording = recorded(&[("actuator_delay", &[delay])], NOISE, 100 + seed);
                let first = started(&model, std::slice::from_ref(&recording));
                let found = timing(&model, &first, &[&recording], Hold::Linear).unwrap();
                (found.dead_time_s - truth) / found.std_error_s
            })
            .collect();
        let inside = z.iter().filter(|z| z.abs() < 1.96).count();
        let mean = z.iter().sum::<f64>() / 60.0;
        println!(
            "{:.0} ms: {inside} of 60 intervals of 95 % cover it, mean z {mean:.2}",
            1e3 * delay
        );
        // of 60 true 95 % intervals 50 or fewer cover it once in two thousand times
        assert!(inside > 50, "{delay}: {inside}");
    }
}

#[test]
fn both_folds_have_windows_where_the_logger_paused_for_more_than_a_third_of_the_time() {
    let r = recorded(&[], NOISE, 4);
    let pause = |k: usize| if k < r.len() / 2 { 0.0 } else { 20.0 };
    let channels = Channels {
        t: r.t().iter().enumerate().map(|(k, t)| t + pause(k)).collect(),
        alpha: Some(r.alpha().to_vec()),
        omega: Some(r.omega().to_vec()),
        torque: r.torque().to_vec(),
    };
    let paused = Recording::new("paused", channels, DriveUnit::NewtonMetre).unwrap();
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let windows = Windows::new(vec![&paused], Hold::Linear, &model, &p);
    for fold in 0..2 {
        let part = windows.only(|n| windows.fold(n) == fold);
        assert!(part.windows.len() > 3, "{}", part.windows.len());
    }
    let none = windows.only(|_| false);
    assert!(fit(&none, &model, &p, &scale(&model, &p, &[&paused])).is_none());
}

#[test]
fn a_lag_is_distinguished_from_a_delay_of_its_length_where_the_input_is_noisy() {
    // the noise of the input is a tenth of what it moves; a lag of a row halves it
    let noise = NoiseLevel { torque: 0.015, ..NOISE };
    let named = ["actuator_delay", "actuator_lag"].map(String::from).to_vec();
    let settings = Settings { candidates: named.clone(), ..Settings::default() };
    for (truth, seed) in [(0, 30), (0, 33), (1, 36), (1, 39)] {
        // a command is held for a millisecond
        let hidden: &[(&str, &[f64])] = &[(&named[truth], &[0.012])];
        let found = diagnosed(hidden, noise, seed, &settings);
        assert_eq!(found.steps[0].id, named[truth], "{seed}");
    }
}

#[test]
fn a_delay_is_proven_by_its_time_where_noise_of_the_input_hides_it_from_the_error() {
    let named = ["actuator_delay", "actuator_lag"].map(String::from).to_vec();
    let settings = Settings { candidates: named, ..Settings::default() };
    for (delay, torque, count) in [(Some(0.02), 0.03, 1), (Some(0.014), 0.02, 1), (None, 0.03, 0)] {
        let size: Vec<f64> = delay.into_iter().collect();
        let effect = [("actuator_delay", size.as_slice())];
        let hidden = &effect[..size.len()];
        for seed in [50, 53, 56] {
            let noise = NoiseLevel { torque, ..NOISE };
            let found = diagnosed(hidden, noise, seed, &settings);
            assert_eq!(found.steps.len(), count, "{delay:?} {seed}");
        }
    }
}

#[test]
fn angles_alone_give_the_timing_of_a_robot_that_answers_within_a_row() {
    let model = Model::with_effects(Robot::amigobot(), &["back_emf"]).unwrap();
    let mut p = model.initial();
    // volts: (a1 + a2)/k_e is 24 ms, a row 20 ms
    p[..5].copy_from_slice(&[0.0095, 0.0012, 0.0, 0.6, 0.6]);
    p[model.index_of("k_e").unwrap()] = 0.45;
    let t: Vec<f64> = (0..1500).map(|k| 0.02 * f64::from(k)).collect();
    let steps = [5.0, -3.0, 6.0, 2.0, -6.0, 0.5, 3.0, -5.0, -1.0, 4.0, -2.0];
    let torque: Vec<[f64; 2]> = (0..t.len())
        .map(|k| [steps[k / 17 % 11] + (3.0 * t[k]).sin(), steps[k / 23 % 11] + t[k].cos()])
        .collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
    let states = simulate(&model, &p, &input, State::default()).unwrap();
    let degrees = |v: f64| v.to_degrees().round().to_radians();
    let alpha = Some(states.iter().map(|s| s.alpha.map(degrees)).collect());
    let channels = Channels { t, alpha, omega: None, torque };
    let recording = Recording::new("angles", channels, DriveUnit::Volt).unwrap();
    // differences of the angles over two rows lag and smooth: by them the input came 8 ms too late
    for (hold, late) in [(Hold::Constant, 0.0), (Hold::Linear, 0.01)] {
        let found = timing(&model, &p, &[&recording], hold).unwrap();
        let off = (found.dead_time_s - late).abs();
        assert!(off < 0.002 && off < 3.0 * found.std_error_s, "{hold:?} {found:?}");
    }
}

/// Recordings of 40 s at 50 Hz of a heavy robot whose controller holds its torque from row to row and follows a speed
/// that jumps about once a second: between the jumps every other row contains all information, at a jump little of it.
fn under_steps(model: &Model, p: &[f64], seed: u32) -> Recording {
    let targets = [3.0, -2.0, 4.0, 1.0, -4.0, 0.0, 2.5, -3.0];
    let target = |k: u32, every: u32| targets[((k / every + seed) % 8) as usize];
    let t: Vec<f64> = (0..2000).map(|k| 0.02 * f64::from(k)).collect();
    let mut state = State::default();
    let (mut states, mut torque) = (Vec::new(), Vec::new());
    for k in 0..2000 {
        let error = [target(k, 61) - state.omega[0], target(k, 83) - state.omega[1]];
        let m = [0, 1].map(|i| (5.0 * error[i] + 1.2 * error[i].signum()).clamp(-12.0, 12.0));
        states.push(state);
        torque.push(m);
        let row = Input { t: &[0.0, 0.02], torque: &[m, m], hold: Hold::Constant };
        state = *simulate(model, p, &row, state).unwrap().last().unwrap();
    }
    let noise = |k: usize| 0.03 * ((k * (k + 5 + seed as usize)) as f64).sin();
    let omega = states.iter().enumerate().map(|(k, s)| s.omega.map(|w| w + noise(k)));
    let (omega, alpha) = (omega.collect(), states.iter().map(|s| s.alpha).collect());
    let channels = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
    Recording::new("steps", channels, DriveUnit::NewtonMetre).unwrap()
}

#[test]
fn an_effect_is_found_where_sampling_might_err_by_more_than_the_model_does() {
    let robot = Robot::amigobot();
    let base = Model::base(robot.clone());
    let hidden = Model::with_effects(robot, &["viscous_friction"]).unwrap();
    let candidates = ["viscous_friction", "turning_scrub"].map(str::to_owned).into();
    let settings = Settings { candidates, ..Settings::default() };
    for (b, expected) in [(0.05, vec!["viscous_friction"]), (0.0, vec![])] {
        let p = [0.23, 0.02, 0.0, 0.8, 0.8, b];
        let [a, c] = [1, 4].map(|seed| under_steps(&hidden, &p, seed));
        let (train, validation) = ([a], [c]);
        let first = started(&base, &train);
        // as if the hold were not known
        let hold = Hold::Linear;
        let data = Data { train: &train, validation: &validation, hold, corrected_s: 0.0 };
        let found = diagnose(&base, &[first], &data, &settings).unwrap();
        let ids: Vec<&str> = found.steps.iter().map(|s| s.id.as_str()).collect();
        assert_eq!(ids, expected, "{b}");
        let judge = Judge::new(validation.to_vec(), hold);
        let open = judge.unresolved(&found.base.model, &found.base.p);
        let error = judge.judge(&found.base.model, &found.base.p).unwrap().window_rms;
        // the case at hand: what sampling leaves open is more than all of the error
        assert!(open > error, "{open} {error}");
    }
}
