//! Dead, blocked and healthy wheels of a robot that is integrated here.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::super::{Context, condition};
use super::*;
use crate::recording::Channels;

const H: f64 = 0.01;

/// A robot of two coupled wheels with static friction, driven by steps.
struct Robot {
    /// Static over Coulomb friction.
    stiction: f64,
    /// Rows from input to torque.
    late: usize,
    /// Times in which both wheels stand against a wall.
    wall: Range<f64>,
    /// Input of wheel `i` at a time.
    input: fn(f64, usize) -> f64,
}

/// Steps of 0.8 s of both signs, each fourth of them zero, differing between the wheels.
fn steps(t: f64, i: usize) -> f64 {
    let k = (t / 0.8) as usize;
    let level = |k: usize| ((k * k * 31 + k * 17 + i * 13) % 29) as f64 / 14.0 - 1.0;
    if k % 4 == 3 { 0.0 } else { 0.9 * level(k) }
}

impl Default for Robot {
    fn default() -> Self {
        Self { stiction: 1.3, late: 0, wall: -1.0..-1.0, input: steps }
    }
}

impl Robot {
    /// True angles and speeds with the inputs, by the equations [a1 a2; a2 a1] w' = M - c sgn(w) - b w.
    fn run(&self, rows: usize) -> Channels {
        let (a1, a2, c, b, fine) = (0.030, 0.008, 0.12, 0.05, 10);
        let determinant = a1 * a1 - a2 * a2;
        let (mut w, mut angle) = ([0.0_f64; 2], [0.0_f64; 2]);
        let (mut alpha, mut omega, mut torque): (Vec<_>, Vec<_>, Vec<[f64; 2]>) =
            Default::default();
        for k in 0..rows {
            let t = H * k as f64;
            torque.push([0, 1].map(|i| (self.input)(t, i)));
            alpha.push(angle);
            omega.push(w);
            let m = torque[k.saturating_sub(self.late)];
            for _ in 0..fine {
                let f: [f64; 2] = [0, 1].map(|i| {
                    let held = c * self.stiction;
                    if w[i] == 0.0 && m[i].abs() <= held {
                        0.0
                    } else {
                        let way = if w[i] == 0.0 { m[i].signum() } else { w[i].signum() };
                        m[i] - c * way - b * w[i]
                    }
                });
                let h = H / fine as f64;
                let rate = [a1 * f[0] - a2 * f[1], a1 * f[1] - a2 * f[0]].map(|x| x / determinant);
                for i in 0..2 {
                    let is_held = w[i] == 0.0 && m[i].abs() <= c * self.stiction;
                    let next = if is_held { 0.0 } else { w[i] + h * rate[i] };
                    w[i] = if w[i] * next < 0.0 || self.wall.contains(&t) { 0.0 } else { next };
                    angle[i] += h * w[i];
                }
            }
        }
        let t = (0..rows).map(|k| H * k as f64).collect();
        Channels { t, alpha: Some(alpha), omega: Some(omega), torque }
    }
}

/// Angles in counts alone.
fn counted(mut c: Channels, per_turn: f64) -> Channels {
    c.omega = None;
    let count = |a: f64| (a * per_turn / TAU).floor() * TAU / per_turn;
    c.alpha.iter_mut().flatten().for_each(|a| *a = a.map(count));
    c
}

/// Speeds with noise alone.
fn noisy(mut c: Channels) -> Channels {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    c.alpha = None;
    c.omega.iter_mut().flatten().for_each(|w| *w = w.map(|w| w + 0.02 * normal()));
    c
}

/// The sensors of the right wheel stop in some rows: angles and, where `holds`, speeds at the last value.
fn stopped(mut c: Channels, rows: Range<usize>, holds: bool) -> Channels {
    for k in rows.clone() {
        if let Some(alpha) = &mut c.alpha {
            alpha[k][0] = alpha[rows.start][0];
        }
        if let Some(omega) = &mut c.omega {
            omega[k][0] = if holds { omega[rows.start][0] } else { 0.0 };
        }
    }
    c
}

fn dead(c: Channels) -> (usize, Vec<(Channel, Kind)>) {
    let done = condition(c, &Settings::default(), &Context::default()).unwrap();
    let dead = done.findings.iter().filter(|f| matches!(f.kind, Kind::Dead { .. }));
    (done.channels.t.len(), dead.map(|f| (f.channel, f.kind)).collect())
}

#[test]
fn rows_of_an_encoder_that_dies_are_left_out() {
    for stop in [3000..6000, 5500..6000, 3610..3910] {
        let whole = Robot::default().run(6000);
        let logs = [counted(whole.clone(), 4096.0), noisy(whole.clone())];
        for (n, log) in logs.into_iter().enumerate() {
            let (rows, found) = dead(stopped(log, stop.clone(), false));
            let [(channel, Kind::Dead { stretches: 1, from_s, to_s, or_blocked, .. })] = found[..]
            else {
                panic!("{stop:?} {n}: {found:?}");
            };
            assert_eq!(channel, if n == 0 { Channel::Angle(0) } else { Channel::Speed(0) });
            let (from, to) = (H * stop.start as f64, H * (stop.end - 1) as f64);
            // a wheel may be at rest as its sensor dies
            assert!((from - from_s).abs() < 0.5 && (to - to_s).abs() < 0.5, "{from_s} {to_s}");
            assert!(rows <= 6000 - stop.len() && rows > 5900 - stop.len(), "{rows}");
            assert!(!or_blocked, "the steps push both ways");
        }
        // a speed that is repeated, which may also look like one kept at rest
        let (rows, _) = dead(stopped(noisy(whole), stop.clone(), true));
        assert!(rows <= 6001 - stop.len() && rows > 5900 - stop.len(), "{rows}");
    }
}

#[test]
fn a_speed_that_is_repeated_is_that_of_a_dead_sensor() {
    // driven forward on the mean, by inputs that vary
    fn forward(t: f64, i: usize) -> f64 {
        0.5 + 0.4 * steps(t, i)
    }
    let whole = Robot { input: forward, ..Robot::default() }.run(4000);
    let (rows, found) = dead(stopped(noisy(whole), 2000..3000, true));
    assert!(
        matches!(found[..], [(Channel::Speed(0), Kind::Dead { or_blocked: false, .. })]),
        "{found:?}"
    );
    assert!((2990..=3001).contains(&rows), "{rows}");
}

#[test]
fn healthy_wheels_that_rest_or_are_coarse_keep_their_rows() {
    fn zero(t: f64, i: usize) -> f64 {
        if (10.0..20.0).contains(&t) { 0.0 } else { steps(t, i) }
    }
    // below static friction for 5 s, above Coulomb friction
    fn held(t: f64, i: usize) -> f64 {
        if (10.0..12.0).contains(&t) {
            0.0
        } else if (12.0..17.0).contains(&t) {
            0.2
        } else {
            steps(t, i)
        }
    }
    // slow, by steps just above friction
    fn slow(t: f64, i: usize) -> f64 {
        let level = [0.16, 0.0, -0.15, 0.14, 0.0, -0.17][(t / 4.0) as usize % 6];
        level * (1.0 + 0.05 * i as f64)
    }
    let robot =
        |input: fn(f64, usize) -> f64, stiction| Robot { input, stiction, ..Robot::default() };
    let late = Robot { late: 40, ..Robot::default() };
    let logs = [
        ("steps", robot(steps, 1.3).run(4000)),
        ("rest", robot(zero, 1.3).run(4000)),
        ("held by static friction", robot(held, 1.9).run(4000)),
        ("slow", robot(slow, 1.0).run(6000)),
        ("dead time of 0.4 s", late.run(4000)),
    ];
    for (name, log) in logs {
        let rows = log.t.len();
        for per_turn in [16.0, 64.0, 4096.0] {
            let (kept, found) = dead(counted(log.clone(), per_turn));
            assert_eq!((kept, found), (rows, vec![]), "{name}, {per_turn} counts");
        }
        let mut coarse = log.clone();
        coarse.alpha = None;
        coarse.omega.iter_mut().flatten().for_each(|w| *w = w.map(|w| (w / 0.7).round() * 0.7));
        assert_eq!(dead(coarse).1, vec![], "{name}, coarse speeds");
        assert_eq!(dead(noisy(log)).1, vec![], "{name}, noise");
    }
}

#[test]
fn wheels_against_a_wall_are_dead_or_blocked() {
    fn push(t: f64, i: usize) -> f64 {
        if (12.0..17.0).contains(&t) { 0.8 } else { steps(t, i) }
    }
    let robot = Robot { wall: 12.0..17.0, input: push, ..Robot::default() };
    let (rows, found) = dead(counted(robot.run(4000), 4096.0));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|(_, kind)| matches!(kind, Kind::Dead { or_blocked: true, .. })));
    assert!((3400..=3500).contains(&rows), "{rows}");
}

#[test]
fn too_short_a_rest_of_the_log_is_refused_with_the_rows() {
    for stop in [150, 380] {
        let log = stopped(noisy(Robot::default().run(2000)), stop..2000, false);
        let error = condition(log, &Settings::default(), &Context::default()).unwrap_err();
        let ConditioningError::DeadFor { wheel: "right", rows: [first, 2000], .. } = error else {
            panic!("{error}");
        };
        assert!(first.abs_diff(stop) < 50, "{first}");
    }
    // a sensor that never gives a value has its own message
    let log = stopped(noisy(Robot::default().run(2000)), 0..2000, false);
    let error = condition(log, &Settings::default(), &Context::default()).unwrap_err();
    assert!(matches!(error, ConditioningError::Dead { rows: 2000, .. }), "{error}");
}

#[test]
fn a_wheel_that_stops_and_starts_at_speed_within_a_row_has_a_dead_sensor() {
    // weak steps, then a cruise under an input below static friction, at which a wheel might also rest
    fn cruise(t: f64, i: usize) -> f64 {
        match t {
            20.0..20.5 => 0.35,
            20.5..30.0 => 0.22,
            _ => 0.4 * steps(t, i),
        }
    }
    let robot = |wall| Robot { input: cruise, stiction: 1.9, wall, ..Robot::default() };
    let log = counted(stopped(robot(-1.0..-1.0).run(4000), 2400..2700, false), 4096.0);
    let (rows, found) = dead(log);
    assert!(
        matches!(found[..], [(Channel::Angle(0), Kind::Dead { stretches: 1, .. })]),
        "{found:?}"
    );
    assert!((3690..=3710).contains(&rows), "{rows}");
    // a wall stops the wheels at once too, but they do not return to their speed at once
    assert_eq!(dead(counted(robot(24.0..27.0).run(4000), 4096.0)).0, 4000);
}
