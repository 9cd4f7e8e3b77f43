//! The input: commands of a few levels, magnitudes without sign, offsets at rest.

use super::error::ConditioningError;
use super::finding::{Action, Channel, Finding, Kind};
use super::signal::{FEW_LEVELS, column, levels, median_step, quantile};
use super::thresholds::INPUTS;
use super::{Conditioned, Context, Settings};
use crate::math::Moments;
use crate::recording::never_moves;

/// Time on either side over which a speed rises \[s\], and smallest number of rows: less than a start takes, and more
/// than the noise of single rows.
const RISE: (f64, usize) = (0.05, 2);

/// Inputs of a few levels: their jumps are commands, not noise.
pub(super) fn few_levels(work: &mut Conditioned) {
    for i in 0..2 {
        let levels = levels(&work.channels.torque, i);
        if levels > 1 && levels <= FEW_LEVELS {
            let kind = Kind::FewLevels { levels };
            work.findings.push(Finding { channel: Channel::Input(i), kind, action: Action::Used });
        }
    }
}

/// An input that never changes its sign although its wheel is driven both ways. A wheel whose sensors show noise alone
/// is not driven.
pub(super) fn sign(work: &mut Conditioned, settings: &Settings) -> Result<(), ConditioningError> {
    let Some(speeds) = speeds(work) else { return Ok(()) };
    for i in 0..2 {
        let speed = column(&speeds, i);
        let mut input = column(&work.channels.torque, i);
        let sensors = [work.channels.alpha.as_ref(), work.channels.omega.as_ref()];
        if sensors.into_iter().flatten().all(|s| never_moves(&column(s, i), &input)) {
            continue;
        }
        let of = |input: &[f64], share: f64| {
            quantile(input.iter().copied().filter(|m| m.is_finite()), share)
        };
        if of(&input, 0.5) < 0.0 {
            input.iter_mut().for_each(|m| *m = -*m);
        }
        let range = of(&input, 0.95);
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
        let negative = of(&input, 0.0) < -INPUTS.negative * range;
        if negative || range <= 0.0 || !driven || !enough(backward.len()) || !enough(forward) {
            continue;
        }
        let (row, channel) = (backward[0], Channel::Input(i));
        if settings.sign_from_speed {
            let rows = work.channels.torque.iter_mut().zip(&speed);
            rows.for_each(|(m, w)| m[i] = m[i].copysign(*w));
            let action = Action::Corrected("sign_from_speed");
            work.findings.push(Finding { channel, kind: Kind::Magnitude, action });
        } else if settings.refuse {
            return Err(ConditioningError::Magnitude {
                wheel: i + 1,
                row: row + 1,
                value: work.channels.torque[row][i],
                speed: speed[row],
            });
        } else {
            let action = Action::Noted;
            work.findings.push(Finding { channel, kind: Kind::Magnitude, action });
        }
    }
    Ok(())
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

/// Speeds as recorded, or else slopes of the angles.
pub(super) fn speeds(work: &Conditioned) -> Option<Vec<[f64; 2]>> {
    let c = &work.channels;
    if let Some(omega) = &c.omega {
        return Some(omega.clone());
    }
    let alpha = c.alpha.as_ref()?;
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(2), (k + 2).min(alpha.len() - 1));
        [0, 1].map(|i| (alpha[to][i] - alpha[from][i]) / (c.t[to] - c.t[from]))
    };
    Some((0..alpha.len()).map(slope).collect())
}

/// Rows before the wheels first move: those in which no sensor changes, or changes by no more than its noise.
/// With noisy sensors the last quarter is left out, since the input begins before the motion exceeds the
/// noise.
fn rows_at_rest(work: &Conditioned) -> usize {
    let c = &work.channels;
    let count = c.t.len();
    let stays = |rows: Option<&Vec<[f64; 2]>>, k: usize| rows.is_none_or(|v| v[k] == v[0]);
    let exact = (0..count)
        .take_while(|&k| stays(c.alpha.as_ref(), k) && stays(c.omega.as_ref(), k))
        .count();
    if exact >= INPUTS.at_rest_rows || count <= 2 * INPUTS.at_rest_rows {
        return exact;
    }
    let (mut rest, mut is_slow) = (count, true);
    for (signal, is_speed) in [(c.alpha.as_ref(), false), (c.omega.as_ref(), true)] {
        let Some(signal) = signal else { continue };
        for values in [0, 1].map(|i| column(signal, i)) {
            let first = &values[..INPUTS.at_rest_rows];
            let Moments { count, mean, variance } = Moments::of(first.iter().copied());
            let (square, deviation) = ((count - 1.0) * variance, variance.sqrt());
            let near = |v: &&f64| (**v - mean).abs() <= INPUTS.rest_errors * deviation;
            rest = rest.min(values.iter().take_while(near).count());
            // a steady drive is no rest
            is_slow &= !is_speed
                || mean.abs()
                    <= INPUTS.rest_errors * deviation / (INPUTS.at_rest_rows as f64).sqrt();
            // from row to row, white noise changes more than motion does
            let changes = first.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>();
            is_slow &= changes >= square;
            is_slow &= deviation < INPUTS.turns * quantile(values.iter().map(|v| v.abs()), 0.99);
        }
    }
    if is_slow { rest * 3 / 4 } else { exact }
}

/// The mean of a measured input before the robot first moves.
pub(super) fn at_rest(work: &mut Conditioned, context: &Context) {
    if context.commanded {
        return;
    }
    let c = &work.channels;
    let rows = rows_at_rest(work);
    if rows < INPUTS.at_rest_rows || rows == c.t.len() {
        return;
    }
    let mut found = Vec::new();
    for i in 0..2 {
        let still = column(&c.torque[..rows], i);
        let sample = Moments::of(still.iter().copied());
        let (mean, std_error) = (sample.mean, sample.std_error());
        let range = quantile(c.torque[rows..].iter().map(|m| m[i].abs()), 0.95);
        if mean.abs() > INPUTS.offset_errors * std_error
            && mean != 0.0
            && mean.abs() < INPUTS.offset * range
            && std_error > 0.0
        {
            let kind = Kind::RestOffset { mean, std_error };
            found.push(Finding { channel: Channel::Input(i), kind, action: Action::Noted });
        }
    }
    work.findings.extend(found);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;

    /// A wheel that rests for 1 s and then moves, with a current of that offset and noise.
    fn started(offset: f64, noisy: bool) -> Vec<Finding> {
        let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let noise = |k: usize, n: usize| ((k * (k + n) * 7919 % 1009) as f64 / 504.5) - 1.0;
        let since = |k: usize| (t[k] - 1.0).max(0.0);
        let sensor = |k: usize, n: usize| if noisy { 0.03 * noise(k, n) } else { 0.0 };
        let omega = (0..1000)
            .map(|k| {
                [0, 1].map(|i| 5.0 * (since(k) * (1.0 + 0.1 * i as f64)).sin() + sensor(k, 3 + i))
            })
            .collect();
        let torque = (0..1000)
            .map(|k| [0, 1].map(|i| since(k).sin() + offset + 0.01 * noise(k, 11 + i)))
            .collect();
        let channels = Channels { alpha: None, omega: Some(omega), torque, t };
        let mut work = Conditioned { channels, findings: vec![] };
        at_rest(&mut work, &Context::default());
        work.findings
    }

    /// Wheels at these speeds, with these inputs.
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

    #[test]
    fn an_offset_at_rest_is_seen_behind_the_noise_of_the_speeds() {
        for noisy in [false, true] {
            let found = started(0.07, noisy);
            assert!(
                matches!(
                    found[..],
                    [Finding { kind: Kind::RestOffset { mean, .. }, .. }, _] if (mean - 0.07).abs() < 0.005
                ),
                "{noisy}: {found:?}"
            );
            assert!(started(0.0, noisy).is_empty(), "{noisy}");
        }
    }
}
