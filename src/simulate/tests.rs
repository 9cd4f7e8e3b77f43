//! Simulation against exact solutions and differences.

use super::*;
use crate::model::Model;
use crate::model::base::{A1, A2, A4, COUNT};
use crate::robot::{Robot, State};

fn time(n: usize, step: f64) -> Vec<f64> {
    (0..n).map(|k| step * k as f64).collect()
}

/// Torques that start, reverse and stop both wheels.
fn lively(t: &[f64]) -> Vec<[f64; 2]> {
    t.iter()
        .map(|&t| [0.35 * (2.1 * t).sin() + 0.05, 0.3 * (1.7 * t + 0.4).sin() * (0.3 * t).cos()])
        .collect()
}

#[test]
fn a_wheel_pushed_and_released_follows_the_exact_parabola_and_stops() {
    // straight driving: inertia a1 + a2, both wheels alike; pushed 1 s with 0.2 N m, then coasting
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let (inertia, friction) = (p[A1] + p[A2], p[A4]);
    let t = time(301, 0.01);
    let torque: Vec<_> = t.iter().map(|&t| if t < 0.995 { [0.2; 2] } else { [0.0; 2] }).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let top = (0.2 - friction) / inertia;
    assert!((motion[100].omega[0] - top).abs() < 1e-12); // Runge-Kutta is exact for lines
    let stop = top * inertia / friction;
    let angle = 0.5 * top + 0.5 * top * stop;
    assert_eq!(motion[300].omega, [0.0; 2]);
    assert!((motion[300].alpha[0] - angle).abs() < 1e-8, "event located to 1e-12 of a step");
}

#[test]
fn a_motor_faster_than_the_rows_follows_the_exact_exponential() {
    // straight driving: (a1 + a2) dω = M - a4 - k ω, with time constants of 1, 1/2, 1/5 and 1/20 of a row
    let model = Model::base(Robot::amigobot()).add("back_emf").unwrap();
    let mut p = model.initial();
    let (inertia, friction, row) = (p[A1] + p[A2], p[A4], 0.02);
    let t = time(101, row);
    let input = |t: f64| if ((t / 0.2) as usize).is_multiple_of(2) { [1.0; 2] } else { [0.4; 2] };
    let torque: Vec<_> = t.iter().map(|&t| input(t + 1e-9)).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Constant };
    for per_row in [1.0_f64, 2.0, 5.0, 20.0] {
        let k = per_row / row * inertia;
        p[COUNT] = k;
        let motion = simulate(&model, &p, &input, State::default()).unwrap();
        let decay = (-per_row).exp();
        let (mut omega, mut worst) = (0.0, 0.0_f64);
        for (now, next) in torque.iter().zip(&motion[1..]) {
            let rest = (now[0] - friction) / k;
            omega = rest + (omega - rest) * decay;
            worst = worst.max((next.omega[0] - omega).abs() * k);
        }
        // the distance from the equilibrium is at most 1 N m/k: the error of a step is 2.6e-4 of it, less what decays
        // since; beyond ten steps per row by what is left of it
        assert!(worst < 5e-4, "{per_row}: {worst}");
    }
}

#[test]
fn the_step_size_does_not_matter_even_through_reversals() {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let p = model.initial();
    let fine = time(40_001, 0.0005);
    let coarse = time(1001, 0.02);
    let coarse_torque = lively(&coarse);
    // the same piecewise linear input, given at forty times the rate
    let fine_torque: Vec<_> = fine
        .iter()
        .map(|&t| {
            let k = ((t / 0.02).floor() as usize).min(999);
            let c = t / 0.02 - k as f64;
            [0, 1].map(|i| coarse_torque[k][i] * (1.0 - c) + coarse_torque[k + 1][i] * c)
        })
        .collect();
    let run = |t: &[f64], m: &[[f64; 2]]| {
        let input = Input { t, torque: m, hold: Hold::Linear };
        simulate(&model, &p, &input, State::default()).unwrap()
    };
    let (a, b) = (run(&coarse, &coarse_torque), run(&fine, &fine_torque));
    let worst = (0..1001)
        .flat_map(|k| (0..2).map(move |i| (k, i)))
        .map(|(k, i)| (a[k].omega[i] - b[40 * k].omega[i]).abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-7, "{worst}"); // 20 ms against 0.5 ms: fourth order between events
}

#[test]
fn friction_never_makes_energy() {
    let model = Model::base(Robot::amigobot());
    let p = model.initial();
    let t = time(2001, 0.01);
    let torque = lively(&t);
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let motion = simulate(&model, &p, &input, State::default()).unwrap();
    let energy = |s: &State| {
        let w = s.omega;
        0.5 * p[A1] * (w[0] * w[0] + w[1] * w[1]) + p[A2] * w[0] * w[1]
    };
    for k in 1..t.len() {
        // work of the input over the sample, Simpson with the middle from the mean speed
        let work: f64 = (0..2)
            .map(|i| {
                let (m, w) = (
                    [torque[k - 1][i], torque[k][i]],
                    [motion[k - 1].omega[i], motion[k].omega[i]],
                );
                0.01 * (m[0] * w[0] + m[1] * w[1] + (m[0] + m[1]) * (w[0] + w[1])) / 6.0
            })
            .sum();
        let gained = energy(&motion[k]) - energy(&motion[k - 1]);
        assert!(gained <= work + 1e-4, "sample {k}: {gained} > {work}");
    }
}

#[test]
fn sensitivities_equal_central_differences_through_stops_and_reversals() {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let p = model.initial();
    let t = time(601, 0.01);
    let torque = lively(&t);
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let start = State { alpha: [0.1, -0.2], omega: [0.5, -0.3] };
    let (motion, s) = simulate_with_sensitivities(&model, &p, &input, start).unwrap();
    assert_eq!(motion, simulate(&model, &p, &input, start).unwrap());
    for j in 0..p.len() {
        let h = 1e-4 * p[j].abs().max(1e-3);
        let run = |sign: f64| {
            let mut q = p.clone();
            q[j] += sign * h;
            simulate(&model, &q, &input, start).unwrap()
        };
        let (up, down) = (run(1.0), run(-1.0));
        for k in (0..601).step_by(20) {
            for i in 0..2 {
                let d = (up[k].omega[i] - down[k].omega[i]) / (2.0 * h);
                let e = s.at(k, 2 + i, j);
                // truncation of the differences, h^2 times the third derivative
                assert!((d - e).abs() < 1e-4 * (1.0 + d.abs()), "{j} {k} {i}: {d} {e}");
            }
        }
    }
    for j in 0..2 {
        let run = |sign: f64| {
            let mut x = start;
            x.omega[j] += sign * 1e-6;
            simulate(&model, &p, &input, x).unwrap()
        };
        let (up, down) = (run(1.0), run(-1.0));
        let d = (up[600].alpha[0] - down[600].alpha[0]) / 2e-6;
        let e = s.at(600, 0, p.len() + 2 + j);
        assert!((d - e).abs() < 1e-4 * (1.0 + d.abs()), "{d} {e}");
    }
}

#[test]
fn a_speed_along_a_direction_that_friction_holds_at_the_start_changes_nothing_later() {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let p = model.initial();
    let t = time(201, 0.01);
    // at rest the torques exceed the friction from 0.4 s on; beside a turning wheel only that of the other one holds
    let torque: Vec<[f64; 2]> = t.iter().map(|t| [0.25 * t, 0.2 * t + 0.05]).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    for (omega, held) in [([0.0, 0.0], [true, true]), ([0.0, 9.0], [true, false])] {
        let start = State { alpha: [0.0; 2], omega };
        let (motion, s) = simulate_with_sensitivities(&model, &p, &input, start).unwrap();
        assert!(motion[200].omega.iter().all(|w| *w > 0.1));
        for j in 0..2 {
            let step = 1e-5;
            let mut ahead = start;
            ahead.omega[j] += step;
            let ahead = simulate(&model, &p, &input, ahead).unwrap();
            let column = p.len() + 2 + j;
            assert_eq!(s.at(0, 2 + j, column), 1.0);
            for k in (1..=200).step_by(10) {
                for i in 0..2 {
                    let d = (ahead[k].omega[i] - motion[k].omega[i]) / step;
                    // to the first order in the step: the wheel stops after 1e-6 s
                    assert!((d - s.at(k, 2 + i, column)).abs() < 1e-3, "{held:?} {j} {k} {i}: {d}");
                }
            }
            assert_eq!(held[j], s.at(1, 2 + j, column) == 0.0);
        }
    }
}

#[test]
fn a_speed_of_a_wheel_that_is_about_to_break_away_lasts() {
    let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
    let p = model.initial();
    let t = time(101, 0.01);
    // 1 mN m below the friction, which the torques exceed after 4 ms: a speed of 0.02 rad/s falls by 0.3 % until then
    let torque: Vec<[f64; 2]> = t.iter().map(|t| [p[A4] - 1e-3 + 0.25 * t; 2]).collect();
    let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
    let start = State::default();
    let (motion, s) = simulate_with_sensitivities(&model, &p, &input, start).unwrap();
    let step = 0.02;
    let ahead = State { omega: [step; 2], ..start };
    let ahead = simulate(&model, &p, &input, ahead).unwrap();
    for k in (10..=100).step_by(10) {
        let d = (ahead[k].omega[0] - motion[k].omega[0]) / step;
        let e = s.at(k, 2, p.len() + 2) + s.at(k, 2, p.len() + 3);
        assert!((d - e).abs() < 0.01, "{k}: {d} {e}");
    }
}
