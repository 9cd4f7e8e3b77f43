//! Inputs without a sign: currents of a driver that measures their magnitude.
//!
//! An input that never changes its sign although its wheel is driven both ways has lost it. With `sign_from_speed` every
//! input takes the sign of the speed of its wheel, whether or not the recording shows that it has none, unless it changes
//! its sign by more than noise:
//!
//! ```text
//! M = |M| sgn(w)      wrong while braking, where M w < 0
//! ```

use super::error::ConditioningError;
use super::finding::{Action, Channel, Finding, Kind};
use super::input::speeds;
use super::signal::{column, median_step, quantile};
use super::thresholds::INPUTS;
use super::{Conditioned, Settings};
use crate::recording::never_moves;

/// Time on either side over which a speed rises \[s\], and smallest number of rows: less than a start takes, and more
/// than the noise of single rows.
const RISE: (f64, usize) = (0.05, 2);
/// Refuses, reports or corrects inputs without a sign.
pub(super) fn sign(work: &mut Conditioned, settings: &Settings) -> Result<(), ConditioningError> {
    let Some(speeds) = speeds(work) else { return Ok(()) };
    let found = magnitudes(work, &speeds);
    for (i, backward) in found.into_iter().enumerate() {
        let channel = Channel::Input(i);
        if settings.sign_from_speed {
            let kind = match backward {
                Some(_) => Kind::Magnitude,
                None => Kind::SpeedSign { share: against(work, &speeds, i) },
            };
            let on = !has_sign(&column(&work.channels.torque, i));
            work.findings.push(Finding::corrected(channel, kind, "sign_from_speed", on));
            if on {
                let rows = work.channels.torque.iter_mut().zip(&speeds);
                rows.for_each(|(m, w)| m[i] = m[i].copysign(w[i]));
            }
        } else if let Some(row) = backward {
            if settings.refuse {
                return Err(ConditioningError::Magnitude {
                    wheel: i + 1,
                    row: row + 1,
                    value: work.channels.torque[row][i],
                    speed: speeds[row][i],
                });
            }
            let action = Action::Noted;
            work.findings.push(Finding { channel, kind: Kind::Magnitude, action });
        }
    }
    Ok(())
}

/// Input `i` as it acts on its wheel: with the sign of the speed, if it has none.
pub(super) fn acting(
    work: &Conditioned,
    values: &[f64],
    i: usize,
    settings: &Settings,
) -> Vec<f64> {
    let Some(speeds) = speeds(work) else { return values.to_vec() };
    let takes = if settings.sign_from_speed {
        !has_sign(values)
    } else {
        magnitudes(work, &speeds)[i].is_some()
    };
    if !takes {
        return values.to_vec();
    }
    values.iter().zip(&speeds).map(|(m, w)| m.copysign(w[i])).collect()
}

/// Whether an input has values of both signs, apart from an offset and single wrong samples.
pub(super) fn has_sign(input: &[f64]) -> bool {
    let of = |share: f64| quantile(input.iter().copied().filter(|m| m.is_finite()), share);
    let (low, high) = (of(INPUTS.signed), of(1.0 - INPUTS.signed));
    low.max(-high) < -INPUTS.offset * high.max(-low)
}

/// The first row of backward motion of each wheel whose input is a magnitude. Both inputs are recorded in the same way: if
/// one of them is a magnitude, so is the other, if it never changes its sign and its wheel turns backward in any row.
fn magnitudes(work: &Conditioned, speeds: &[[f64; 2]]) -> [Option<usize>; 2] {
    let driven = [0, 1].map(|i| Driven::of(work, speeds, i));
    let is_one = driven.iter().flatten().any(|wheel| wheel.both_ways);
    driven.map(|wheel| wheel.filter(|_| is_one)?.backward.first().copied())
}

/// The motion of a wheel whose input never changes its sign.
struct Driven {
    /// Rows in which it turns backward.
    backward: Vec<usize>,
    /// Whether it is driven both ways.
    both_ways: bool,
}

impl Driven {
    /// `None` if the input changes its sign, and for a wheel whose sensors show noise alone, which is not driven.
    fn of(work: &Conditioned, speeds: &[[f64; 2]], i: usize) -> Option<Self> {
        let speed = column(speeds, i);
        let mut input = column(&work.channels.torque, i);
        let sensors = [work.channels.alpha.as_ref(), work.channels.omega.as_ref()];
        if sensors.into_iter().flatten().all(|s| never_moves(&column(s, i), &input)) {
            return None;
        }
        let range = range_of_one_sign(&input)?;
        input.iter_mut().for_each(|m| *m = m.abs());
        let fast = INPUTS.turns * quantile(speed.iter().map(|w| w.abs()), 0.99);
        let backward: Vec<usize> = (0..speed.len()).filter(|&k| speed[k] < -fast).collect();
        let forward = speed.iter().filter(|w| **w > fast).count();
        let enough = |n: usize| {
            n >= INPUTS.both_ways_rows && n as f64 > INPUTS.both_ways * speed.len() as f64
        };
        // backward motion must occur under a substantial input, not while the wheel coasts: most of the time where
        // friction is large, as it gains speed where inertia is
        let is_input =
            |rows: &[usize]| quantile(rows.iter().map(|&k| input[k]), 0.5) > INPUTS.offset * range;
        let driven = is_input(&backward) || is_input(&gaining(&work.channels.t, &speed, &backward));
        let both_ways = driven && enough(backward.len()) && enough(forward);
        Some(Self { backward, both_ways })
    }
}

/// The range of the magnitude of an input, if its values have one sign apart from noise.
fn range_of_one_sign(input: &[f64]) -> Option<f64> {
    let of = |share: f64, sign: f64| {
        quantile(input.iter().map(|m| sign * m).filter(|m| m.is_finite()), share)
    };
    let sign = if of(0.5, 1.0) < 0.0 { -1.0 } else { 1.0 };
    let range = of(0.95, sign);
    (range > 0.0 && of(0.0, sign) >= -INPUTS.negative * range).then_some(range)
}

/// Share of the rows in which an input has another sign than the speed of its wheel.
fn against(work: &Conditioned, speeds: &[[f64; 2]], i: usize) -> f64 {
    let rows = work.channels.torque.iter().zip(speeds);
    rows.filter(|(m, w)| m[i] * w[i] < 0.0).count() as f64 / speeds.len() as f64
}

/// Of these rows of backward motion those in which the wheel gains speed most steeply.
fn gaining(t: &[f64], speed: &[f64], backward: &[usize]) -> Vec<usize> {
    let step = median_step(t);
    let half = ((RISE.0 / step).round() as usize).max(RISE.1);
    let rise = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half).min(t.len() - 1));
        (speed[from] - speed[to]) / (t[to] - t[from])
    };
    let mut rows = backward.to_vec();
    rows.sort_by(|a, b| rise(*b).total_cmp(&rise(*a)));
    rows.truncate((INPUTS.steepest * rows.len() as f64).ceil() as usize);
    rows
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// Wheels at these speeds, with these inputs.
    fn log(speed: impl Fn(f64) -> [f64; 2], input: impl Fn(f64) -> [f64; 2]) -> Channels {
        let t: Vec<f64> = (0..600).map(|k| 0.1 * f64::from(k)).collect();
        let omega = Some(t.iter().map(|t| speed(*t)).collect());
        let torque = t.iter().map(|t| input(*t)).collect();
        Channels { alpha: None, omega, torque, t }
    }

    /// Wheels at this speed, with this input.
    fn driven(speed: impl Fn(f64) -> f64, input: impl Fn(f64) -> f64) -> Option<String> {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let omega = Some(t.iter().map(|t| [speed(*t); 2]).collect());
        let torque = t.iter().map(|t| [input(*t); 2]).collect();
        let channels = Channels { alpha: None, omega, torque, t };
        let mut work = Conditioned { channels, findings: vec![] };
        sign(&mut work, &Settings::default()).err().map(|e| e.to_string())
    }

    #[test]
    fn a_magnitude_is_refused_under_friction_and_under_inertia() {
        let speed = |t: f64| 8.0 * (1.3 * t).sin();
        let (friction, inertia) = (|t: f64| (1.3 * t).sin(), |t: f64| (1.3 * t).cos());
        for input in [&friction as &dyn Fn(f64) -> f64, &inertia] {
            let refused = driven(speed, |t| input(t).abs()).unwrap();
            assert!(refused.contains("M1 never changes its sign"), "{refused}");
            assert_eq!(driven(speed, input), None);
        }
        // a wheel that rolls back by itself under an input that drives it forward alone
        assert_eq!(driven(speed, |t| (1.3 * t).cos().max(0.0)), None);
        // noise of a speed sensor at rest goes both ways as well
        let noise = |t: f64| 0.02 * (1e4 * t * t).sin();
        assert_eq!(driven(noise, |t| 0.5 + 0.1 * t.sin()), None);
    }

    /// Speeds of a log that reverses for a short time: the right wheel for 1.6 s, the left one for 0.5 s; and the friction
    /// and inertia that move them.
    fn reversing(t: f64) -> ([f64; 2], [f64; 2]) {
        let level = |t: f64| {
            let (forward, backward) = (3.0 + (0.7 * t).sin(), -2.5 - 0.3 * (9.0 * t).sin());
            let is_backward = |length: f64| (30.0..30.0 + length).contains(&t);
            [1.6, 0.5].map(|length| if is_backward(length) { backward } else { forward })
        };
        let (now, next) = (level(t), level(t + 0.1));
        (now, [0, 1].map(|i| now[i].signum() + 0.2 * (next[i] - now[i])))
    }

    #[test]
    fn a_magnitude_is_recognised_by_a_short_reversal_and_both_inputs_are_of_one_kind() {
        let settings = Settings { refuse: false, ..Settings::default() };
        let findings = |input: &dyn Fn(f64) -> [f64; 2]| {
            let channels = log(|t| reversing(t).0, input);
            condition(channels, &settings, &Context::default()).unwrap().findings
        };
        let magnitude = |i| Finding {
            channel: Channel::Input(i),
            kind: Kind::Magnitude,
            action: Action::Noted,
        };
        let found = findings(&|t| reversing(t).1.map(f64::abs));
        assert!((0..2).all(|i| found.contains(&magnitude(i))), "{found:?}");
        let signed = findings(&|t| reversing(t).1);
        assert!(!signed.iter().any(|f| matches!(f.kind, Kind::Magnitude)), "{signed:?}");
    }

    #[test]
    fn the_key_is_obeyed_also_where_the_recording_does_not_show_a_magnitude() {
        let settings = Settings { sign_from_speed: true, ..Settings::default() };
        // half a second backward, and not at all
        let motions: [&dyn Fn(f64) -> [f64; 2]; 2] =
            [&|t| [reversing(t).0[1]; 2], &|t| [3.0 + t.sin(); 2]];
        for (speed, share) in motions.into_iter().zip([5.0 / 600.0, 0.0]) {
            let channels = log(speed, |_| [1.2, 1.4]);
            let mut work = Conditioned { channels, findings: vec![] };
            sign(&mut work, &settings).unwrap();
            let channels = &work.channels;
            for (m, w) in channels.torque.iter().zip(channels.omega.as_ref().unwrap()) {
                assert_eq!(*m, [1.2_f64.copysign(w[0]), 1.4_f64.copysign(w[1])]);
            }
            let kinds: Vec<Kind> = work.findings.iter().map(|f| f.kind).collect();
            assert_eq!(kinds, [Kind::SpeedSign { share }; 2]);
        }
    }
}
