//! Angle and speed of a wheel against each other: units and signs.
//!
//! ```text
//! g = median over windows of  (integral of the speed) / (change of the angle)
//! ```
//! is 1, or the factor of a unit, a sign or a gear.

use std::f64::consts::{PI, TAU};

use super::finding::{Action, Channel, Finding, Kind};
use super::signal::{column, median_high, median_step, pieces, quantile};
use super::thresholds::{ANGLES, IMPORT};
use super::{Conditioned, Context, Settings};

/// Length of a window \[s\], and its rows at least: long enough for the steps of an encoder to be
/// small against the motion, short against the motion itself.
const WINDOW: (f64, usize) = (0.2, 6);

/// The channel that is converted, and its name.
#[derive(Clone, Copy, PartialEq)]
enum Target {
    Speed,
    Angle,
    Time,
}

pub(super) fn units_and_signs(work: &mut Conditioned, settings: &Settings, context: &Context) {
    if work.channels.alpha.is_none() || work.channels.omega.is_none() {
        return;
    }
    let ratios = [0, 1].map(|i| ratio(work, i));
    units(work, settings, context, ratios);
    for (i, ratio) in ratios.into_iter().enumerate() {
        if ratio.is_some_and(|g| g < 0.0) {
            sign(work, settings, i);
        }
    }
    for i in [0, 1] {
        gain(work, i);
    }
}

/// Records a speed that is a few per cent larger or smaller than the slope of its angle.
fn gain(work: &mut Conditioned, i: usize) {
    let Some((ratio, std_error)) = windows(work, i).and_then(|pairs| slope(&pairs)) else { return };
    let off = (ratio - 1.0).abs();
    let is_gear = ratio.max(1.0 / ratio) > ANGLES.gears[0];
    if !is_gear && ratio > 0.0 && off > IMPORT.gain_off && off > IMPORT.gain_errors * std_error {
        let (channel, kind) = (Channel::Speed(i), Kind::Gain { ratio, std_error });
        work.findings.push(Finding { channel, kind, action: Action::Noted });
    }
}

/// Slope through zero of way over change of the angle, with the standard error that the scatter of the windows gives.
/// Noise of the angle lowers that of least squares, noise of the speed raises the inverse one of the other regression:
/// of the two, the one nearer to one.
fn slope(pairs: &[(f64, f64)]) -> Option<(f64, f64)> {
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let (aa, wa, ww) = (sum(&|(_, a)| a * a), sum(&|(w, a)| w * a), sum(&|(w, _)| w * w));
    if pairs.len() < ANGLES.compared_windows || aa <= 0.0 || wa <= 0.0 {
        return None;
    }
    let (low, high) = (wa / aa, ww / wa);
    let slope = 1.0_f64.clamp(low, high.max(low));
    // each window counts by its own residual
    let scatter = sum(&|(w, a)| ((w - slope * a) * a).powi(2));
    Some((slope, scatter.sqrt() / aa))
}

/// Speed over slope of the angle, where the windows agree on one.
fn ratio(work: &Conditioned, i: usize) -> Option<f64> {
    let pairs = windows(work, i)?;
    let fast = ANGLES.turns * quantile(pairs.iter().map(|(_, a)| a.abs()), 0.95);
    let ratios: Vec<f64> =
        pairs.iter().filter(|(_, a)| fast > 0.0 && a.abs() > fast).map(|(w, a)| w / a).collect();
    let middle = median_high(ratios.iter().copied());
    let spread = median_high(ratios.iter().map(|g| (g / middle - 1.0).abs()));
    (ratios.len() >= ANGLES.compared_windows
        && spread < ANGLES.scattered_ratio * ANGLES.known_factor)
        .then_some(middle)
}

/// Integral of the speed and change of the angle in every window; `None` without one of the two.
fn windows(work: &Conditioned, i: usize) -> Option<Vec<(f64, f64)>> {
    let (t, c) = (&work.channels.t, &work.channels);
    let (alpha, omega) = (column(c.alpha.as_ref()?, i), column(c.omega.as_ref()?, i));
    let step = median_step(t);
    let length = ((WINDOW.0 / step).round() as usize).clamp(WINDOW.1, t.len().max(WINDOW.1));
    let mut pairs = Vec::new();
    for piece in pieces(t) {
        let mut from = piece.start;
        while from + length < piece.end {
            let rows = from..from + length;
            let way = rows.clone().map(|k| 0.5 * (t[k + 1] - t[k]) * (omega[k] + omega[k + 1]));
            pairs.push((way.sum::<f64>(), alpha[from + length] - alpha[from]));
            from += length;
        }
    }
    Some(pairs)
}

/// Converts both wheels where both ratios, or the one there is, are the same known factor.
fn units(work: &mut Conditioned, settings: &Settings, context: &Context, ratios: [Option<f64>; 2]) {
    let there: Vec<f64> = ratios.into_iter().flatten().map(f64::abs).collect();
    let Some(&first) = there.first() else { return };
    if there.iter().any(|g| (g / first - 1.0).abs() > ANGLES.known_factor) {
        return;
    }
    let known = known(context);
    let mut fits =
        known.iter().filter(|(factor, ..)| (first / factor - 1.0).abs() < ANGLES.known_factor);
    // of two that fit either may be it
    let (factor, unit, target) = match (fits.next(), fits.next()) {
        (Some(one), None) => one,
        (None, _) => return gear(work, first),
        _ => return,
    };
    if unit.is_empty() {
        return;
    }
    let channels: Vec<Channel> = match target {
        Target::Speed => vec![Channel::Speed(0), Channel::Speed(1)],
        Target::Angle => vec![Channel::Angle(0), Channel::Angle(1)],
        Target::Time => vec![Channel::Time],
    };
    for channel in channels {
        let kind = Kind::Unit { factor: first, unit };
        work.findings.push(Finding::corrected(channel, kind, "units", settings.units));
    }
    if !settings.units {
        return;
    }
    let c = &mut work.channels;
    let scale = |rows: Option<&mut Vec<[f64; 2]>>, by: f64| {
        rows.into_iter().flatten().for_each(|v| *v = v.map(|x| by * x));
    };
    match target {
        Target::Speed => scale(c.omega.as_mut(), 1.0 / factor),
        Target::Angle => scale(c.alpha.as_mut(), *factor),
        Target::Time => c.t.iter_mut().for_each(|t| *t /= factor),
    }
}

/// Records that speeds and angles belong to different shafts: a motor and the wheel after its gear.
fn gear(work: &mut Conditioned, ratio: f64) {
    let [least, most] = ANGLES.gears;
    if (least..most).contains(&ratio) || (least..most).contains(&(1.0 / ratio)) {
        let found = [0, 1].map(|i| Finding {
            channel: Channel::Speed(i),
            kind: Kind::Gear { ratio },
            action: Action::Noted,
        });
        work.findings.extend(found);
    }
}

/// Ratios of speed to derivative of the angle, and their interpretation.
fn known(context: &Context) -> Vec<(f64, &'static str, Target)> {
    let degree = PI / 180.0;
    let mut known = vec![
        (1.0, "", Target::Speed),
        (60.0 / TAU, "rpm", Target::Speed),
        (1.0 / degree, "deg/s", Target::Speed),
        (1.0 / TAU, "rev/s", Target::Speed),
        (degree, "deg", Target::Angle),
        (TAU, "rev", Target::Angle),
        (PI, "half-turns", Target::Angle),
        (1e3, "ms", Target::Time),
        (1e6, "us", Target::Time),
        (1e9, "ns", Target::Time),
    ];
    if let Some(r) = context.wheel_radius {
        known.push((r, "m/s", Target::Speed));
        known.push((1.0 / r, "m", Target::Angle));
    }
    known
}

/// Reverses the sign of the angle or the speed, whichever gives a negative work of the input:
/// inertia and friction absorb energy, so that work must be positive.
fn sign(work: &mut Conditioned, settings: &Settings, i: usize) {
    let c = &mut work.channels;
    let (Some(alpha), Some(omega)) = (c.alpha.as_mut(), c.omega.as_mut()) else { return };
    let way = |k: usize| alpha[k + 1][i] - alpha[k][i];
    let energy: f64 = (0..c.t.len() - 1).map(|k| c.torque[k][i] * way(k)).sum();
    let (channel, rows) =
        if energy >= 0.0 { (Channel::Speed(i), omega) } else { (Channel::Angle(i), alpha) };
    work.findings.push(Finding::corrected(channel, Kind::Sign, "signs", settings.signs));
    if settings.signs {
        rows.iter_mut().for_each(|v| v[i] = -v[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::condition;
    use super::*;
    use crate::recording::Channels;

    fn channels() -> Channels {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let alpha = t.iter().map(|t| [4.0 * (1.0 - t.cos()), 3.0 * (1.0 - (0.7 * t).cos()) / 0.7]);
        let omega = t.iter().map(|t| [4.0 * t.sin(), 3.0 * (0.7 * t).sin()]).collect();
        // friction and inertia
        let torque =
            t.iter().map(|t| [t.sin() + 0.3 * t.cos(), (0.7 * t).sin() + 0.2 * (0.7 * t).cos()]);
        Channels { alpha: Some(alpha.collect()), omega: Some(omega), torque: torque.collect(), t }
    }

    fn changed(change: impl Fn(&mut Channels)) -> Conditioned {
        let mut c = channels();
        change(&mut c);
        let context = Context { wheel_radius: Some(0.05), ..Context::default() };
        condition(c, &Settings::default(), &context).unwrap()
    }

    fn differ(a: Option<&Vec<[f64; 2]>>, b: Option<&Vec<[f64; 2]>>) -> f64 {
        let pairs = a.unwrap().iter().flatten().zip(b.unwrap().iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn wheels_whose_rows_repeat_leave_a_few_rows_or_an_error() {
        // wheel 1 refreshes every 12 rows, wheel 2 every 15: four rows remain
        let mut c = channels();
        c.t.truncate(60);
        c.torque.truncate(60);
        for values in [&mut c.alpha, &mut c.omega].into_iter().flatten() {
            values.truncate(60);
            let read = values.clone();
            for k in 0..60 {
                values[k] = [read[k - k % 12][0], read[k - k % 15][1]];
            }
        }
        let _either = condition(c, &Settings::default(), &Context::default());
    }

    #[test]
    fn every_known_unit_is_recognised_and_converted() {
        let right = channels();
        for (factor, unit, target) in
            known(&Context { wheel_radius: Some(0.05), ..Context::default() })
        {
            let done = changed(|c| match target {
                Target::Speed => {
                    c.omega.iter_mut().flatten().for_each(|v| *v = v.map(|x| x * factor))
                }
                Target::Angle => {
                    c.alpha.iter_mut().flatten().for_each(|v| *v = v.map(|x| x / factor))
                }
                Target::Time => c.t.iter_mut().for_each(|t| *t *= factor),
            });
            let found: Vec<&str> = done
                .findings
                .iter()
                .filter_map(
                    |f| if let Kind::Unit { unit, .. } = f.kind { Some(unit) } else { None },
                )
                .collect();
            assert_eq!(found.first().copied().unwrap_or_default(), unit);
            assert!(differ(done.channels.omega.as_ref(), right.omega.as_ref()) < 1e-9, "{unit}");
            assert!(differ(done.channels.alpha.as_ref(), right.alpha.as_ref()) < 1e-9, "{unit}");
            assert!((done.channels.t[1999] - 19.99).abs() < 1e-9);
        }
    }

    #[test]
    fn speeds_of_a_motor_beside_angles_of_the_wheel_are_reported() {
        let said = |factor: f64| {
            let done = changed(|c| {
                c.omega.iter_mut().flatten().for_each(|v| *v = v.map(|x| x * factor));
            });
            crate::conditioning::stated(&done.findings)
                .iter()
                .map(ToString::to_string)
                .collect::<String>()
        };
        assert!(
            said(30.0).contains("write scale = 0.033334 in dalpha1 and dalpha2"),
            "{}",
            said(30.0)
        );
        assert!(said(0.0125).contains("write scale = 0.012500 in alpha1 and alpha2"));
        // a radius of 0.05 m makes the same of metres
        assert!(said(20.0).contains("in m (or a gear of 19.99"), "{}", said(20.0));
        assert!(said(1.1).contains("1.1000 times the slope of its angle"), "{}", said(1.1));
        assert_eq!(said(1.01), "");
    }

    #[test]
    fn a_speed_whose_gain_is_a_few_per_cent_off_is_reported() {
        let done = changed(|c| c.omega.iter_mut().flatten().for_each(|v| v[0] *= 1.05));
        let [found] = done.findings[..] else { panic!("{:?}", done.findings) };
        assert!(matches!(found.channel, Channel::Speed(0)), "{found:?}");
        let text = crate::conditioning::Stated::of(&found).to_string();
        assert!(text.contains("write scale = 0.9524 in dalpha1"), "{text}");
        // a speed that lags contradicts no gain
        let lagged = changed(|c| {
            let rows = c.omega.clone().into_iter().flatten();
            c.omega = Some(std::iter::repeat_n([0.0; 2], 3).chain(rows).take(2000).collect());
        });
        assert!(lagged.findings.iter().all(|f| !matches!(f.kind, Kind::Gain { .. })));
    }

    #[test]
    fn the_channel_that_the_input_works_against_is_turned() {
        let right = channels();
        let done = changed(|c| c.omega.iter_mut().flatten().for_each(|v| v[1] = -v[1]));
        assert!(matches!(
            done.findings[..],
            [Finding { channel: Channel::Speed(1), kind: Kind::Sign, .. }]
        ));
        assert_eq!(done.channels.omega, right.omega);
        let done = changed(|c| c.alpha.iter_mut().flatten().for_each(|v| v[0] = -v[0]));
        assert!(matches!(done.findings[..], [Finding { channel: Channel::Angle(0), .. }]));
        assert_eq!(done.channels.alpha.unwrap()[700], right.alpha.unwrap()[700]);
    }
}
