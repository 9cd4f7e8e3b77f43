//! Lanes against single simulations, and widths against each other.

use super::super::simulate_windows;
use super::realisations::SideBySide;
use super::*;
use crate::effects::BASE;
use crate::math::every_width;
use crate::model::base::{A1, A2, A3, A4, A5};
use crate::robot::Robot;
use rand::{Rng, SeedableRng};

/// Torques that start, reverse and stop both wheels, and rest between.
fn lively(t: &[f64]) -> Vec<[f64; 2]> {
    let push = |t: f64| if t % 7.0 < 5.0 { 1.0 } else { 0.2 };
    let one = |t: f64| [0.35 * (2.1 * t).sin() + 0.05, 0.3 * (1.7 * t + 0.4).sin()];
    t.iter().map(|&t| one(t).map(|m| push(t) * m)).collect()
}

/// Times with steps between 1 ms and 50 ms, which are cut into pieces of 20 ms.
fn uneven(count: usize, rng: &mut impl Rng) -> Vec<f64> {
    let mut t = vec![3.0];
    for k in 1..count {
        let step = if k % 50 == 0 { 0.05 } else { rng.random_range(0.001..0.015) };
        t.push(t[k - 1] + step);
    }
    t
}

fn compare(model: &Model, parameters: &[Vec<f64>], input: &Input, start: State) {
    let measured: Vec<_> = input.t.iter().map(|&t| [3.0 * t.sin(), 2.0 * t.cos()]).collect();
    let many = ise_of_many(model, parameters, input, start, &measured);
    assert_eq!(many.len(), parameters.len());
    if model.effects().iter().map(|effect| effect.id()).eq(BASE) {
        let (vectors, measured) = (&parameters[..parameters.len().min(TOGETHER)], &measured[..]);
        for arch in every_width() {
            let same = arch.dispatch(Together { model, vectors, input, start, measured });
            assert_eq!(same[..], many[..vectors.len()]);
        }
    }
    for (n, (p, lane)) in parameters.iter().zip(many).enumerate() {
        let one = simulate(model, p, input, start).map(|m| ise(input.t, &measured, &m));
        match (one, lane) {
            // rounding: 4000 steps of 1e-16 each, carried on by free wheels
            (Ok(a), Ok(b)) => assert!((a - b).abs() <= 1e-9 * a, "{n} {p:?}: {a} {b}"),
            (a, b) => assert_eq!(a.unwrap_err(), b.unwrap_err(), "{n} {p:?}"),
        }
    }
}

#[test]
fn lanes_equal_single_simulations_through_stops_reversals_and_rest() {
    let model = Model::base(Robot::amigobot());
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let t = uneven(4000, &mut rng);
    let torque = lively(&t);
    let mut parameters: Vec<Vec<f64>> = (0..29)
        .map(|_| model.initial().iter().map(|a| a * rng.random_range(0.5..1.6)).collect())
        .collect();
    parameters[1][A4] = 0.0; // no friction: never sticks
    parameters[2][A5] = -0.1; // counts as none
    parameters[3][A4] = 1.0; // never moves
    parameters[4][A2] = 2.0 * parameters[4][A1]; // no acceleration
    let start = State { alpha: [0.3, -1.0], omega: [0.0, 2.0] };
    for hold in [Hold::Linear, Hold::Constant] {
        compare(&model, &parameters, &Input { t: &t, torque: &torque, hold }, start);
    }
    // nothing pushes: both wheels coast to rest and stay
    let none = vec![[0.0; 2]; t.len()];
    compare(&model, &parameters, &Input { t: &t, torque: &none, hold: Hold::Linear }, start);
}

#[test]
fn a_lane_that_diverges_is_reported_and_leaves_the_others_alone() {
    let model = Model::base(Robot::amigobot());
    let t: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
    let torque = vec![[40.0, -3.0]; 500];
    let mut parameters = vec![model.initial(); 3];
    parameters[1][A1] = 5e-5;
    parameters[1][A2] = 0.0;
    parameters[1][A3] = 0.0;
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let found = ise_of_many(&model, &parameters, &input, State::default(), &torque);
    assert!(matches!(found[1], Err(SimulateError::Diverged { .. })), "{:?}", found[1]);
    compare(&model, &parameters, &input, State::default());
}

#[test]
fn models_with_further_effects_are_simulated_one_by_one() {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let t: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
    let torque = lively(&t);
    let parameters = vec![model.initial(); 3];
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    compare(&model, &parameters, &input, State::default());
}

#[test]
fn realisations_equal_windows_simulated_one_by_one() {
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
    let t = uneven(1500, &mut rng);
    // eleven inputs and initial states: more than a register, and no whole number of them; one diverges
    let torques: Vec<Vec<[f64; 2]>> = (0..11)
        .map(|n| {
            let size = if n == 4 { 1e9 } else { 1.0 };
            let noise = |m: f64, rng: &mut rand_chacha::ChaCha8Rng| {
                size * (m + 0.02 * rng.random_range(-1.0..1.0))
            };
            lively(&t).iter().map(|m| m.map(|m| noise(m, &mut rng))).collect()
        })
        .collect();
    let windows = [0..300, 300..1000, 1000..1500];
    let mut start = |_: i32| State { alpha: [0.0; 2], omega: [0.0, rng.random_range(-2.0..2.0)] };
    let starts: Vec<[State; 3]> = (0..11).map(|_| [0; 3].map(&mut start)).collect();
    let of = |(torque, starts)| Realisation { torque, starts };
    let realisations: Vec<Realisation> =
        torques.iter().map(|t| &t[..]).zip(starts.iter().map(|s| &s[..])).map(of).collect();
    for hold in [Hold::Linear, Hold::Constant] {
        let all = SideBySide {
            model: &model,
            p: &p,
            t: &t,
            hold,
            windows: &windows,
            realisations: &realisations,
        };
        let found = in_lanes(all).unwrap();
        for arch in every_width() {
            let same = arch.dispatch(all).unwrap();
            assert_eq!(format!("{same:?}"), format!("{found:?}"));
        }
        for (one, found) in realisations.iter().zip(&found) {
            let input = Input { t: &t, torque: one.torque, hold };
            let windows: Vec<_> = windows.iter().cloned().zip(one.starts.iter().copied()).collect();
            let states = simulate_windows(&model, &p, &input, t[0], &windows).unwrap();
            let speeds = states.iter().flatten().map(|state| state.omega);
            assert_eq!(found.len(), t.len());
            for (a, b) in found.iter().zip(speeds) {
                for i in 0..2 {
                    // rounding, carried on by free wheels
                    let close = (a[i] - b[i]).abs() < 1e-9 || a[i].is_nan() && b[i].is_nan();
                    assert!(close, "{a:?} {b:?}");
                }
            }
        }
    }
}
