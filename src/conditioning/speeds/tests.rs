//! Lags of speeds against the true values of synthetic data.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::super::{Action, Context, condition};
use super::*;
use crate::conditioning::thresholds::SPEEDS;
use crate::recording::Channels;

const H: f64 = 0.01;

/// Angle at a time.
fn angle(t: f64) -> [f64; 2] {
    [2.0 * (1.0 - (1.7 * t).cos()) + (0.6 * t).sin(), 1.5 * (1.0 - (1.3 * t).cos()) + 0.5 * t]
}

fn speed(t: f64) -> [f64; 2] {
    [3.4 * (1.7 * t).sin() + 0.6 * (0.6 * t).cos(), 1.95 * (1.3 * t).sin() + 0.5]
}

/// Speeds that are `lag` late and have noise of their own.
fn late(lag: f64, noise: f64, seed: u64) -> Channels {
    late_beside(lag, noise, 1e-4, seed)
}

/// The same beside angles of that step \[rad\].
fn late_beside(lag: f64, noise: f64, step: f64, seed: u64) -> Channels {
    of_motion((angle, speed), lag, noise, step, seed)
}

/// The same of a motion, its angle and speed at a time.
pub(super) fn of_motion(
    (angle, speed): (impl Fn(f64) -> [f64; 2], impl Fn(f64) -> [f64; 2]),
    lag: f64,
    noise: f64,
    step: f64,
    seed: u64,
) -> Channels {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let t: Vec<f64> = (0..3000).map(|k| H * f64::from(k)).collect();
    let alpha = t.iter().map(|t| angle(*t).map(|a| (a / step).round() * step)).collect();
    let omega = t.iter().map(|t| speed(t - lag).map(|w| w + noise * normal())).collect();
    let torque = t.iter().map(|t| speed(*t)).collect();
    Channels { t, alpha: Some(alpha), omega: Some(omega), torque }
}

pub(super) fn done(channels: Channels) -> Conditioned {
    condition(channels, &Settings::default(), &Context::default()).unwrap()
}

pub(super) fn lag_of(findings: &[Finding]) -> Option<(f64, f64)> {
    findings.iter().find_map(|f| match f.kind {
        Kind::Lag { lag_s, std_error_s } => Some((lag_s, std_error_s)),
        _ => None,
    })
}

#[test]
fn lags_of_any_part_of_a_row_lie_within_their_intervals() {
    let (mut within, mut all) = (0, 0);
    for lag in [0.004, 0.005, 0.010, 0.023, 0.04] {
        for seed in 0..20 {
            // beside angles that do not say the speed as exactly, speeds that are late by samples are kept
            let step = if lag > 0.015 { 0.01 } else { 1e-4 };
            let done = done(late_beside(lag, 0.02, step, seed));
            let (found, error) =
                lag_of(&done.findings).unwrap_or_else(|| panic!("{lag} {:?}", done.findings));
            within += usize::from((found - lag).abs() < 2.0 * error);
            all += 1;
            // and the speeds agree with the angles again
            let (t, omega) = (&done.channels.t, done.channels.omega.as_ref().unwrap());
            let error = t.iter().zip(omega).skip(20).take(2900).map(|(t, w)| w[0] - speed(*t)[0]);
            let mean_square = error.map(|e| e * e).sum::<f64>() / 2900.0;
            assert!((mean_square.sqrt() / 0.02 - 1.0).abs() < 0.1, "{lag}: {}", mean_square.sqrt());
        }
    }
    // 95.4 % of 100, standard error 2.1 %
    assert!(within >= 89, "{within} of {all}");
}

#[test]
fn speeds_in_time_pass_bit_by_bit() {
    for seed in 0..40 {
        let channels = late(0.0, 0.02, seed);
        let before = channels.omega.clone();
        let done = done(channels);
        assert!(done.channels.omega == before, "{:?}", done.findings);
    }
}

#[test]
fn a_moving_average_of_the_angle_is_recognised_and_left_out() {
    for span in [1, 5] {
        let mut channels = late(0.0, 0.0, 0);
        let alpha = channels.alpha.clone().unwrap();
        let of = |k: usize| {
            let before = k.saturating_sub(span);
            [0, 1].map(|i| (alpha[k][i] - alpha[before][i]) / (span as f64 * H))
        };
        channels.omega = Some((0..3000).map(of).collect());
        let done = done(channels);
        assert!(done.channels.omega.is_none(), "{:?}", done.findings);
        let kind = done.findings[0].kind;
        assert!(matches!(kind, Kind::Differences { samples, .. } if samples == span), "{kind:?}");
        assert_eq!(done.findings[0].action, Action::Corrected("speeds"));
    }
}

/// [`late`] of a motion with several frequencies: smoothing changes the amplitude of a single one alone, as a factor on
/// the speeds would.
fn lively(lag: f64, seed: u64) -> Channels {
    let waves = [[(2.0, 1.1), (0.8, 3.7), (0.3, 8.3)], [(1.5, 0.9), (0.7, 4.3), (0.25, 9.1)]];
    let angle = |t: f64| waves.map(|w| w.iter().map(|(a, f)| a * (f * t).sin()).sum::<f64>());
    let speed = |t: f64| waves.map(|w| w.iter().map(|(a, f)| a * f * (f * t).cos()).sum::<f64>());
    of_motion((angle, speed), lag, 0.02, 1e-4, seed)
}

#[test]
fn speeds_that_are_only_delayed_are_used_beside_angles_that_suffice() {
    let (mut within, mut used) = (0, 0);
    for lag in [0.037, 0.05, 0.06] {
        for seed in 0..20 {
            let found = done(lively(lag, seed));
            let (value, error) = lag_of(&found.findings).unwrap_or((f64::NAN, 0.0));
            within += usize::from((value - lag).abs() < 2.0 * error);
            used += usize::from(found.channels.omega.is_some());
        }
    }
    // one of 400 delays of a wheel fails by chance; 95.4 % of 60, standard error 2.7 %
    assert!(used >= 58 && within >= 52, "{used} and {within} of 60");
}

#[test]
fn a_moving_average_of_an_own_sensor_is_no_delay() {
    for (span, seed) in [(5, 1), (5, 2), (9, 3), (9, 4)] {
        let mut channels = lively(0.0, seed);
        let own = channels.omega.clone().unwrap();
        let mean = |k: usize, i: usize| {
            let rows = k.saturating_sub(span - 1)..=k;
            let count = rows.clone().count() as f64;
            rows.map(|j| own[j][i]).sum::<f64>() / count
        };
        channels.omega = Some((0..own.len()).map(|k| [mean(k, 0), mean(k, 1)]).collect());
        let found = done(channels);
        let lag = 0.5 * (span - 1) as f64 * H;
        assert!(
            matches!(found.findings[0].kind, Kind::Filtered { lag_s, .. } if (lag_s - lag).abs() < 0.003),
            "{span}: {:?}",
            found.findings
        );
        assert!(found.channels.omega.is_none());
    }
}

#[test]
fn a_filter_that_lags_by_samples_leaves_the_angles_alone() {
    let mut channels = late(0.0, 0.05, 3);
    // a first-order low pass of 50 ms
    let mut last = [0.0; 2];
    for w in channels.omega.as_mut().unwrap() {
        last = [0, 1].map(|i| last[i] + (H / (0.05 + H)) * (w[i] - last[i]));
        *w = last;
    }
    let done = done(channels);
    assert!(
        matches!(done.findings[0].kind, Kind::Filtered { lag_s, .. } if (lag_s - 0.05).abs() < 0.01),
        "{:?}",
        done.findings
    );
    assert!(done.channels.omega.is_none());
}

#[test]
fn a_recording_too_short_to_show_its_lag_takes_that_of_the_others() {
    let long = done(late_beside(0.04, 0.02, 0.01, 3));
    let common = common_lag([long.findings.as_slice(), &[]].into_iter());
    let common = common.expect("the long recording shows its lag");
    let mut short = late_beside(0.04, 0.02, 0.01, 4);
    let rows = 150;
    short.t.truncate(rows);
    short.torque.truncate(rows);
    [&mut short.alpha, &mut short.omega].into_iter().flatten().for_each(|c| c.truncate(rows));
    assert_eq!(lag_of(&done(short.clone()).findings), None);
    let context = Context { speed_lag: SpeedLag::Known(common), ..Context::default() };
    let together = condition(short, &Settings::default(), &context).unwrap();
    assert_eq!(lag_of(&together.findings), Some((common[0].value, common[0].std_error)));
    // a recording that shows that its speeds are in time keeps them
    let sound = condition(late(0.0, 0.02, 5), &Settings::default(), &context).unwrap();
    assert_eq!(lag_of(&sound.findings), None);
}

/// Channels whose angles have white noise of 1e-4 rad, and speeds made of them, or measured, by `of`.
fn noisy(of: impl Fn(&[f64], &mut dyn FnMut() -> f64) -> Vec<f64>) -> Channels {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let t: Vec<f64> = (0..4000).map(|k| H * f64::from(k)).collect();
    let wheel =
        [0, 1].map(|i| t.iter().map(|t| angle(*t)[i] + 1e-4 * normal()).collect::<Vec<f64>>());
    let speeds = wheel.each_ref().map(|alpha| of(alpha, &mut normal));
    let both = |v: &[Vec<f64>; 2]| (0..t.len()).map(|k| [v[0][k], v[1][k]]).collect::<Vec<_>>();
    let (alpha, omega) = (Some(both(&wheel)), Some(both(&speeds)));
    let torque = t.iter().map(|t| speed(*t)).collect();
    Channels { t, alpha, omega, torque }
}

/// A symmetric or other filter of the slope of the angle; `taps` from `-taps.len()/2` on, copies at the ends.
fn filtered(alpha: &[f64], taps: &[f64]) -> Vec<f64> {
    let at = |k: isize| alpha[k.clamp(0, alpha.len() as isize - 1) as usize];
    let sum = |k: usize| {
        let from = k as isize - (taps.len() / 2) as isize;
        taps.iter().enumerate().map(|(j, tap)| tap * at(from + j as isize)).sum::<f64>() / H
    };
    (0..alpha.len()).map(sum).collect()
}

/// Runs a low-pass of first order forward and backward.
fn forward_and_backward(mut values: Vec<f64>, keep: f64) -> Vec<f64> {
    for _ in 0..2 {
        let mut last = values[0];
        for v in &mut values {
            last = keep * last + (1.0 - keep) * *v;
            *v = last;
        }
        values.reverse();
    }
    values
}

/// Speeds of a wheel's angles.
type Made<'a> = &'a dyn Fn(&[f64]) -> Vec<f64>;

#[test]
fn speeds_that_any_filter_made_of_the_angles_are_left_out() {
    let central = [-0.5, 0.0, 0.5];
    // of second order over seven samples (Savitzky and Golay, Anal. Chem. 36, 1964, table III)
    let savitzky_golay = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|j| j / 28.0);
    let made: [Made; 3] =
        [&|alpha| filtered(alpha, &central), &|alpha| filtered(alpha, &savitzky_golay), &|alpha| {
            forward_and_backward(filtered(alpha, &central), 0.7)
        }];
    for (n, of) in made.iter().enumerate() {
        let recorded = noisy(|alpha, _| of(alpha));
        let done = done(recorded.clone());
        let kind = done.findings[0].kind;
        assert!(matches!(kind, Kind::OfAngle { share } if share < 0.01), "{n}: {kind:?}");
        assert!(done.channels.omega.is_none());
        let off = Settings { speeds: false, ..Settings::default() };
        let kept = condition(recorded.clone(), &off, &Context::default()).unwrap();
        assert!(kept.channels.omega == recorded.omega, "the key leaves them");
        // also where they were printed with few digits
        let mut printed = recorded;
        let digits = |w: f64| (w / 5e-4).round() * 5e-4;
        printed.omega.iter_mut().flatten().for_each(|w| *w = w.map(digits));
        assert!(self::done(printed).channels.omega.is_none(), "{n}");
    }
}

#[test]
fn a_tachometer_is_none_of_them_however_exact_it_is() {
    for noise in [0.0, 1e-5, 1e-3, 0.02] {
        let exact = |i: usize| (0..4000).map(move |k| speed(H * f64::from(k))[i]);
        let mut channels = noisy(|_, normal| {
            let w = exact(0).map(|w| w + noise * normal());
            w.collect()
        });
        let right: Vec<f64> = channels.omega.iter().flatten().map(|w| w[0]).collect();
        let rows = right.iter().zip(exact(1)).map(|(w, left)| [*w, left]);
        channels.omega = Some(rows.collect());
        let before = channels.omega.clone();
        let done = done(channels);
        assert!(done.channels.omega == before, "{noise}: {:?}", done.findings);
    }
}

#[test]
fn a_recording_that_cannot_show_it_follows_the_others_of_its_log() {
    let make = || noisy(|alpha, _| filtered(alpha, &[-0.5, 0.0, 0.5]));
    let shown = common_share([done(make()).findings.as_slice()].into_iter());
    let context = Context { speeds_of_angles: shown, ..Context::default() };
    let of = |channels| condition(channels, &Settings::default(), &context).unwrap();
    // angles that a filter has smoothed show no noise
    let mut smooth = make();
    let angles = smooth.alpha.clone().unwrap();
    let wheels =
        [0, 1].map(|i| forward_and_backward(forward_and_backward(column(&angles, i), 0.7), 0.7));
    smooth.alpha = Some((0..angles.len()).map(|k| [wheels[0][k], wheels[1][k]]).collect());
    let speeds = wheels.each_ref().map(|w| filtered(w, &[-0.5, 0.0, 0.5]));
    smooth.omega = Some((0..angles.len()).map(|k| [speeds[0][k], speeds[1][k]]).collect());
    assert!(shown.is_some() && of(smooth).channels.omega.is_none());
    assert!(of(late(0.0, 0.02, 5)).channels.omega.is_some(), "a tachometer contradicts");
}

/// A motor that reaches its speed within two windows and stays there; speeds over 100 ms, sensors every 20 ms.
fn step_response(tau: f64) -> Channels {
    let t: Vec<f64> = (0..600).map(|k| 0.005 * f64::from(k)).collect();
    let angle = |t: f64| {
        let since = (t - 0.06).max(0.0);
        360.0 * (since - tau * (1.0 - (-since / tau).exp()))
    };
    let read = |t: f64| (t / 0.02 + 1e-9).floor() * 0.02;
    let printed = |x: f64| (1e6 * x).round() / 1e6;
    let alpha = t.iter().map(|t| [printed(angle(read(*t))); 2]).collect();
    let speed = |t: f64| (angle(read(t)) - angle(read(t) - 0.1)) / 0.1;
    let omega = t.iter().map(|t| [printed(speed(*t)); 2]).collect();
    Channels { torque: vec![[7.0; 2]; t.len()], alpha: Some(alpha), omega: Some(omega), t }
}

#[test]
fn a_lag_is_that_of_the_windows_in_which_the_speed_changes() {
    // 50 ms late; all that shows it is in two windows, far off the others at constant speed
    let (lag, _) = lag_of(&done(step_response(0.018)).findings).unwrap();
    // to the standard deviation of an unknown instant within a sample
    assert!((lag - 0.05).abs() < 0.02 * SPEEDS.lag_rows, "{lag}");
    // at constant speed nothing shows one, unless another recording does
    let mut steady = step_response(0.018);
    for c in [&mut steady.alpha, &mut steady.omega].into_iter().flatten() {
        c.drain(..60);
    }
    steady.t.truncate(540);
    steady.torque.truncate(540);
    assert_eq!(lag_of(&done(steady).findings), None);
}

#[test]
fn a_speed_does_not_lead_its_angle_by_more_than_a_row() {
    for (lead, step) in [(0.025, 0.01), (0.06, 0.01)] {
        let found = done(late_beside(-lead, 0.02, step, 1));
        assert_eq!(lag_of(&found.findings), None, "{lead}");
    }
    let (lag, _) = lag_of(&done(late_beside(-0.006, 0.02, 0.01, 1)).findings).unwrap();
    assert!((lag + 0.006).abs() < 1e-3, "{lag}");
}

#[test]
fn wheels_with_lags_of_their_own_are_each_brought_to_their_angle() {
    for [right, left] in [[0.03, 0.01], [0.03, 0.0]] {
        let mut log = late_beside(right, 0.02, 0.01, 1);
        let other = late_beside(left, 0.02, 0.01, 2).omega.unwrap();
        log.omega.iter_mut().flatten().zip(&other).for_each(|(w, other)| w[1] = other[1]);
        let done = done(log);
        let of = |i: usize| {
            let found: Vec<Finding> =
                done.findings.iter().filter(|f| f.channel == Channel::Speed(i)).copied().collect();
            lag_of(&found)
        };
        for (i, lag) in [right, left].into_iter().enumerate() {
            let (value, error) = of(i).unwrap_or((0.0, 0.0));
            assert!((value - lag).abs() <= 3.0 * error, "{i}: {value} {lag} {error}");
            let (t, omega) = (&done.channels.t, done.channels.omega.as_ref().unwrap());
            let errors = t.iter().zip(omega).skip(20).take(2900).map(|(t, w)| w[i] - speed(*t)[i]);
            let mean_square = errors.map(|e| e * e).sum::<f64>() / 2900.0;
            assert!((mean_square.sqrt() / 0.02 - 1.0).abs() < 0.1, "{i}: {}", mean_square.sqrt());
        }
        // and recordings that do not show them take each wheel's
        let common = common_lag([done.findings.as_slice()].into_iter()).unwrap();
        assert_eq!(common.map(|lag| lag.value), [0, 1].map(|i| of(i).map_or(0.0, |lag| lag.0)));
    }
}

#[test]
fn recordings_that_contradict_each_other_are_not_corrected() {
    let [one, same, other] = [(0.04, 1), (0.04, 2), (0.02, 3)]
        .map(|(lag, seed)| done(late_beside(lag, 0.02, 0.01, seed)).findings);
    let differ = |all: &[&Vec<Finding>]| lags_differ(all.iter().map(|f| (f.as_slice(), H)));
    assert!(!differ(&[&one, &same]) && differ(&[&one, &same, &other]));
    let context = Context { speed_lag: SpeedLag::Disputed, ..Context::default() };
    let log = late_beside(0.04, 0.02, 0.01, 1);
    let left = condition(log.clone(), &Settings::default(), &context).unwrap();
    assert!(left.channels.omega == log.omega);
    let kind = left.findings.iter().find(|f| matches!(f.kind, Kind::LagsDiffer { .. }));
    assert_eq!(kind.unwrap().action, Action::Noted);
}
