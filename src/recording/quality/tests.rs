//! Simulated recordings of a known robot: a clean one has no finding, and every defect is named.

use super::*;
use crate::model::Model;
use crate::recording::{Channels, DriveUnit, Recording};
use crate::simulate::{Movement, NoiseLevel, Recorder, Segment, record};

const NOISE: NoiseLevel = NoiseLevel { dalpha: 0.02, alpha: 0.0005, torque: 0.004 };

fn input(movement: &Movement, ticks: Option<f64>) -> Recording {
    let model = Model::base(Robot::amigobot());
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise: NOISE, ticks, seed: 7 };
    record("run.csv", &model, &model.initial(), movement, &recorder).unwrap()
}

fn rich(seed: u64) -> Recording {
    input(&Movement::rich(&Robot::amigobot(), seed, 25.0, 12.0), Some(9550.0))
}

fn segments(wheels: &[(f64, f64)]) -> Recording {
    let segment = |&(speed_m_s, turn_rad_s): &(f64, f64)| Segment {
        speed_m_s,
        turn_rad_s,
        blend_s: 0.8,
        hold_s: 1.5,
    };
    input(&Movement { segments: wheels.iter().map(segment).collect() }, None)
}

/// The recording with its columns changed.
fn with(r: &Recording, change: impl FnOnce(&mut Channels)) -> Recording {
    let mut channels = Channels {
        t: r.t().to_vec(),
        alpha: r.measured().alpha.then(|| r.alpha().to_vec()),
        omega: r.measured().omega.then(|| r.omega().to_vec()),
        torque: r.torque().to_vec(),
    };
    change(&mut channels);
    Recording::new("run.csv", channels, DriveUnit::NewtonMetre).unwrap()
}

fn alpha(c: &mut Channels) -> &mut Vec<[f64; 2]> {
    c.alpha.as_mut().unwrap()
}

fn omega(c: &mut Channels) -> &mut Vec<[f64; 2]> {
    c.omega.as_mut().unwrap()
}

/// Warnings and problems in one text.
fn said(r: &Recording) -> String {
    let quality = quality(r, &Robot::amigobot());
    quality.at_least(Severity::Warning).map(|f| format!("{f}\n")).collect()
}

/// Expects exactly these words, one finding a line.
fn finds(r: &Recording, words: &[&[&str]]) {
    let said = said(r);
    assert_eq!(said.lines().count(), words.len(), "{said}");
    for (line, words) in said.lines().zip(words) {
        assert!(words.iter().all(|w| line.contains(w)), "{words:?}: {line}");
    }
}

#[test]
fn clean_recordings_raise_no_warning() {
    for seed in 0..12 {
        finds(&rich(seed), &[]);
        finds(&with(&rich(seed), |c| c.alpha = None), &[]);
        finds(&with(&rich(seed), |c| c.omega = None), &[]);
    }
    let q = quality(&rich(1), &Robot::amigobot());
    assert!((q.rate_hz - 100.0).abs() < 1e-6 && q.jitter < 1e-9 && q.gaps == Gaps::default());
}

#[test]
fn the_movement_of_the_paper_raises_notes_alone() {
    let r = input(&Movement::paper(), None);
    finds(&r, &[]);
    let q = quality(&r, &Robot::amigobot());
    assert!(q.findings.iter().any(|f| f.what() == "wheel 1 (right) turns forward only"));
}

#[test]
fn a_wheel_that_reverses_for_a_few_slow_rows_turns_both_ways() {
    // rows of a sixth of a second: a window of eight rows is longer than the reversal
    let reversal = |back: bool| {
        let speed = |k: usize| if back && (203..208).contains(&k) { -0.8 } else { 2.0 };
        let rows = |k: usize| [speed(k) + 0.02 * (k as f64).sin(), 2.0 + 0.02 * (k as f64).cos()];
        let channels = Channels {
            t: (0..400).map(|k| f64::from(k) / 6.0).collect(),
            alpha: None,
            omega: Some((0..400).map(rows).collect()),
            torque: (0..400).map(|k| [0.1 + 0.01 * (f64::from(k) / 5.0).sin(), 0.1]).collect(),
        };
        let r = Recording::new("run.csv", channels, DriveUnit::NewtonMetre).unwrap();
        let found = quality(&r, &Robot::amigobot()).findings;
        [0, 1].map(|i| found.iter().any(|f| f.issue == Issue::OneWay(i, true)))
    };
    assert_eq!(reversal(false), [true, true]);
    assert_eq!(reversal(true), [false, true]);
}

#[test]
fn speeds_in_a_wrong_unit_are_named_with_their_unit() {
    let r = rich(2);
    let scaled = |factor: f64, wheel: usize| {
        with(&r, |c| omega(c).iter_mut().for_each(|w| w[wheel] *= factor))
    };
    finds(&scaled(9.5493, 0), &[&["dalpha1 is 9.5", "dalpha1 is in rpm"]]);
    finds(&scaled(-1.0, 1), &[&["dalpha2 is -1 times", "sign", "scale = -1"]]);
    finds(&scaled(1.27, 1), &[&["dalpha2 is 1.2", "gear ratio"]]);
    finds(&scaled(0.05, 0), &[&["dalpha1 is 0.0", "dalpha1 is in m/s"]]);
    let degrees = said(&scaled(57.2958, 0));
    assert!(degrees.contains("dalpha1 is in deg/s") && degrees.contains("rad/s, "), "{degrees}");
}

#[test]
fn angles_and_times_in_a_wrong_unit_are_named_with_their_unit() {
    let r = rich(3);
    let degrees = with(&r, |c| alpha(c).iter_mut().for_each(|a| *a = a.map(f64::to_degrees)));
    finds(&degrees, &[&["alpha1 is in deg"], &["alpha2 is in deg"]]);
    let text = said(&with(&r, |c| c.t.iter_mut().for_each(|t| *t *= 1000.0)));
    assert!(text.contains("t is in ms") && text.contains("check the unit of t"), "{text}");
}

#[test]
fn exchanged_wheels_are_named_in_speeds_and_in_inputs() {
    let r = rich(4);
    let swap = |rows: &mut Vec<[f64; 2]>| rows.iter_mut().for_each(|v| v.swap(0, 1));
    finds(&with(&r, |c| swap(omega(c))), &[&["dalpha1 follows alpha2", "swap them"]]);
    finds(&with(&r, |c| swap(&mut c.torque)), &[&["M1 moves wheel 2", "swap them"]]);
    // all three exchanged is another robot, not a contradiction
    let all = with(&r, |c| {
        swap(omega(c));
        swap(alpha(c));
        swap(&mut c.torque);
    });
    finds(&all, &[]);
}

#[test]
fn an_input_with_the_wrong_sign_is_named() {
    for seed in 0..6 {
        let flipped = with(&rich(seed), |c| c.torque.iter_mut().for_each(|m| m[1] = -m[1]));
        finds(&flipped, &[&["M2 pushes wheel 2 (left) against its motion", "scale = -1 for M2"]]);
    }
}

#[test]
fn jumps_and_wraps_of_an_angle_are_counted() {
    let r = rich(5);
    let wrapped = with(&r, |c| {
        alpha(c).iter_mut().for_each(|a| a[0] = a[0].rem_euclid(std::f64::consts::TAU));
    });
    let text = said(&wrapped);
    assert!(text.starts_with("alpha1 has") && text.contains("wraps at a full turn"), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    let lost = with(&r, |c| alpha(c)[1200..].iter_mut().for_each(|a| a[1] -= 5.0));
    finds(&lost, &[&["alpha2 has 1 jump (first at t = 12.000 s: -", "counts were lost"]]);
    let no_speed = with(&lost, |c| c.omega = None);
    assert!(said(&no_speed).contains("alpha2 has 1 jump"), "{}", said(&no_speed));
}

#[test]
fn a_motion_that_turns_between_two_slow_rows_is_no_spike() {
    // accelerations of 15 rad/s^2 to either side at 5 Hz beside a smooth motion
    let r = with(&rich(6), |c| {
        let turn = 0.01 * 1000.0;
        let by = |t: f64| 6.0 * (1.0 - (t - turn).abs() / 0.4).max(0.0);
        let rows: Vec<usize> = (0..c.t.len()).step_by(20).collect();
        let t: Vec<f64> = rows.iter().map(|&k| c.t[k]).collect();
        let old = c.omega.take().unwrap();
        let pick = |v: &[[f64; 2]]| rows.iter().map(|&k| v[k]).collect::<Vec<_>>();
        let smooth = |t: f64| [2.0 + (0.3 * t).sin() + by(t), 2.0 + (0.4 * t).cos()];
        assert_eq!(old.len(), c.t.len());
        c.alpha = None;
        c.omega = Some(t.iter().map(|t| smooth(*t)).collect());
        c.torque = pick(&c.torque);
        c.t = t;
    });
    assert!(!said(&r).contains("spike"), "{}", said(&r));
}

#[test]
fn spikes_are_counted_and_the_first_is_shown() {
    let mut r = rich(6);
    r = with(&r, |c| {
        for k in [400, 900, 1700] {
            omega(c)[k][0] += 9.0;
        }
        c.torque[1000][1] -= 2.0;
    });
    finds(&r, &[&["dalpha1 has 3 spikes (first at t = 4.000 s"]]);
    // a torque can jump: that is a note
    let notes = quality(&r, &Robot::amigobot()).findings;
    let is_noted = |notes: &[Finding]| {
        notes.iter().any(|f| f.what().contains("M2 has 1 spike (first at t = 10.000 s"))
    };
    assert!(is_noted(&notes));
    // the wheel reverses in the row of that torque
    let felt = with(&r, |c| omega(c)[1000..].iter_mut().for_each(|w| w[1] -= 4.0));
    assert!(!is_noted(&quality(&felt, &Robot::amigobot()).findings));
}

#[test]
fn an_input_at_its_limit_is_named() {
    let r = rich(7);
    let limited = with(&r, |c| {
        c.torque.iter_mut().for_each(|m| m[0] = m[0].clamp(-0.25, 0.25));
    });
    finds(&limited, &[&["M1 is exactly", "0.25 N m at its extreme", "limit"]]);
}

#[test]
fn a_wheel_that_stands_and_an_input_that_is_zero_are_named() {
    let r = rich(8);
    let still = with(&r, |c| {
        omega(c).iter_mut().for_each(|w| w[1] = 0.0);
        alpha(c).iter_mut().for_each(|a| a[1] = 0.0);
    });
    assert!(said(&still).contains("wheel 2 (left) never moves"), "{}", said(&still));
    let idle = with(&r, |c| c.torque.iter_mut().for_each(|m| *m = [0.0; 2]));
    finds(&idle, &[&["M1 is zero throughout", "right"], &["M2 is zero throughout", "left"]]);
}

#[test]
fn driving_that_hides_parameters_is_named() {
    let straight = segments(&[(0.0, 0.0), (0.2, 0.0), (-0.2, 0.0), (0.1, 0.0), (0.0, 0.0)]);
    finds(&straight, &[&["drives straight only", "a3 not at all"]]);
    let pivots = segments(&[(0.0, 0.0), (0.0, 1.5), (0.0, -1.5), (0.0, 1.0), (0.0, 0.0)]);
    finds(&pivots, &[&["turns on the spot only", "a1 - a2"]]);
    // turns in one recording determine what faster straight runs in others do not
    let fast: Vec<(f64, f64)> = [0.0, 0.6, -0.6].repeat(6).into_iter().map(|v| (v, 0.0)).collect();
    let turns = segments(&[(0.0, 0.0), (0.1, 0.3), (-0.1, 0.3), (0.0, 0.0)]);
    assert_eq!(lacking(&[segments(&fast), straight.clone()]), Some(Lacking::Turns));
    assert_eq!(lacking(&[segments(&fast), straight, turns]), None);
}

#[test]
fn gaps_jitter_short_and_slow_recordings_are_named() {
    let r = rich(9);
    let gap = with(&r, |c| c.t[1000..].iter_mut().for_each(|t| *t += 1.5));
    let q = quality(&gap, &Robot::amigobot());
    assert_eq!(q.gaps.count, 1);
    assert!((q.gaps.longest - 1.51).abs() < 1e-9);
    assert!(q.findings.iter().any(|f| f.what().starts_with("1 gap in time, the longest 1.51")));
    let uneven = with(&r, |c| {
        for k in (1..c.t.len()).step_by(2) {
            c.t[k] += 0.006;
        }
    });
    // steps of 16 and 4 ms in turn, the median 16 ms: sqrt(0.75^2 / 2) = 53 %
    assert!(said(&uneven).contains("the step in time varies by 53 %"), "{}", said(&uneven));
    assert!(said(&r.cut(0..200).unwrap()).contains("lasts 1.99 s"));
}

#[test]
fn tiny_and_constant_recordings_are_checked_without_a_panic() {
    let flat = |n: usize, w: f64| Channels {
        t: (0..n).map(|k| 0.01 * k as f64).collect(),
        alpha: Some(vec![[0.0; 2]; n]),
        omega: Some(vec![[w; 2]; n]),
        torque: vec![[0.0; 2]; n],
    };
    for n in [10, 11, 100, 3000] {
        for w in [0.0, 1.0, 1e9] {
            let r = Recording::new("x", flat(n, w), DriveUnit::Volt).unwrap();
            assert!(!quality(&r, &Robot::amigobot()).findings.is_empty());
        }
    }
}

/// A servo of one axis at 500 Hz over that many rows, with speeds of white noise, by M = 0.04 dw + 0.3 sgn(w) + 0.02 w.
fn servo(rows: usize, sign: f64) -> Recording {
    let noise = |k: usize| ((k * 7919 + k * k * 104_729) % 1009) as f64 / 504.5 - 1.0;
    let t: Vec<f64> = (0..rows).map(|k| 0.002 * k as f64).collect();
    let (amplitude, rate) = (20.0, 25.0);
    let speed = |t: f64| amplitude * (1.0 - (rate * t).cos()) + 1.0;
    let omega = t.iter().enumerate().map(|(k, t)| [speed(*t) + 0.05 * noise(k); 2]).collect();
    let input = |t: f64| 0.04 * amplitude * rate * (rate * t).sin() + 0.3 + 0.02 * speed(t);
    let torque = t.iter().map(|t| [sign * input(*t); 2]).collect();
    let channels = Channels { alpha: None, omega: Some(omega), torque, t };
    Recording::new("run.csv", channels, DriveUnit::NewtonMetre).unwrap()
}

#[test]
fn the_sign_of_an_input_shows_in_a_quarter_of_a_second() {
    let issues = |r: &Recording| -> Vec<Issue> {
        quality(r, &Robot::amigobot()).findings.iter().map(|f| f.issue).collect()
    };
    let reversed = issues(&servo(140, -1.0));
    assert!(reversed.contains(&Issue::OpposingInput(0)), "{reversed:?}");
    let right = issues(&servo(140, 1.0));
    assert!(!right.iter().any(|i| matches!(i, Issue::OpposingInput(_) | Issue::SignUntested(_))));
    // too few rows for that
    assert!(issues(&servo(60, -1.0)).contains(&Issue::SignUntested(0)));
    assert!(!issues(&servo(2000, 1.0)).iter().any(|i| matches!(i, Issue::SignUntested(_))));
}
