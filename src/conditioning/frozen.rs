//! A speed sensor that keeps its last value while the wheel stands still.
//!
//! Sensors that measure the time between pulses have a new value only with each pulse. While a wheel turns, each
//! value corresponds to an angle of about one pulse:
//!
//! ```text
//! turned = |w| (time that the value stands)
//! ```
//! A value that corresponds to many times that angle, while the input is less than half of that at such a speed, is the
//! last one before a rest, if it is close to the value before it (an outlier is not) and far from the next one. Its
//! rows contain the time at which the wheel moves again, and no speed.

use std::ops::Range;

use super::cells::keep;
use super::finding::{Channel, Finding, Kind};
use super::magnitude::has_sign;
use super::signal::{changes, column, median_high, median_step, quantile};
use super::thresholds::SPEEDS;
use super::{Conditioned, Settings};

/// Leaves out the rows in which a speed is kept at rest, except the first.
pub(super) fn rows(work: &mut Conditioned, settings: &Settings) {
    // angles determine rest themselves
    if work.channels.alpha.is_some() {
        return;
    }
    let frozen = [0, 1].map(|i| frozen(work, i));
    let mut kept = vec![true; work.channels.t.len()];
    for (i, runs) in frozen.iter().enumerate() {
        let Some(first) = runs.first() else { continue };
        let rows = runs.iter().map(ExactSizeIterator::len).sum();
        let kind = Kind::Frozen { rows, first: first.start + 1 };
        work.findings.push(Finding::corrected(Channel::Speed(i), kind, "rows", settings.rows));
        runs.iter().for_each(|run| kept[run.clone()].fill(false));
    }
    if settings.rows && kept.contains(&false) {
        keep(&mut work.channels, &kept);
    }
}

/// The rows of wheel `i` that repeat a speed at rest.
fn frozen(work: &Conditioned, i: usize) -> Vec<Range<usize>> {
    let c = &work.channels;
    let Some(omega) = &c.omega else { return vec![] };
    let (t, speed) = (&c.t, column(omega, i));
    let starts = changes(&speed);
    let ends = starts.iter().skip(1).copied().chain([t.len()]);
    let runs: Vec<Range<usize>> = starts.iter().copied().zip(ends).map(|(a, b)| a..b).collect();
    let step = median_step(t);
    let turned =
        |run: &Range<usize>| speed[run.start].abs() * (t[run.end - 1] - t[run.start] + step);
    let moving = || runs.iter().filter(|run| speed[run.start] != 0.0);
    let usual = quantile(moving().map(turned), 0.9);
    let has_sign = has_sign(&column(&c.torque, i));
    let drives = |k: usize| match has_sign {
        true => c.torque[k][i] * speed[k].signum(),
        // a current without sign drives backward too
        false => c.torque[k][i].abs(),
    };
    let input = median_high((0..t.len()).filter(|&k| speed[k] != 0.0).map(drives));
    let is_frozen = |run: &&Range<usize>| {
        let inner = run.start + 1..run.end;
        let mean = inner.clone().map(drives).sum::<f64>() / inner.len().max(1) as f64;
        let value = speed[run.start];
        let next = speed.get(run.end).map_or(f64::INFINITY, |next| (next - value).abs());
        let last = run.start.checked_sub(1).map_or(0.0, |k| (speed[k] - value).abs());
        run.len() >= SPEEDS.kept_rows
            && turned(run) > SPEEDS.kept_angle * usual
            && mean < SPEEDS.kept_half * input
            && last < SPEEDS.kept_half * value.abs()
            && next > SPEEDS.kept_half * value.abs()
    };
    moving().filter(is_frozen).map(|run| run.start + 1..run.end).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// A wheel that drives for 2 s and rests for 1 s, over and over, by the time between pulses of 0.3 rad.
    fn log(keeps: bool) -> Channels {
        let (h, tau) = (0.01, 0.1);
        let (mut alpha, mut omega, mut last, mut since, mut shown) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let mut c = Channels { t: vec![], alpha: None, omega: Some(vec![]), torque: vec![] };
        for k in 0..3000 {
            let t = h * f64::from(k);
            let volts = if t % 3.0 < 2.0 { 6.0 + (5.0 * t).sin() } else { 0.0 };
            // friction stops the wheel at once
            omega = if volts > 0.0 { omega + h / tau * (2.0 * volts - omega) } else { 0.0 };
            alpha += h * omega;
            since += h;
            if alpha - last >= 0.3 {
                (shown, last, since) = ((alpha - last) / since, alpha, 0.0);
            } else if !keeps && omega == 0.0 {
                shown = 0.0;
            }
            c.t.push(t);
            c.torque.push([volts; 2]);
            c.omega.as_mut().unwrap().push([shown; 2]);
        }
        c
    }

    #[test]
    fn speeds_that_a_sensor_keeps_at_rest_are_left_out() {
        let done =
            |keeps| condition(log(keeps), &Settings::default(), &Context::default()).unwrap();
        let found = done(true);
        // ten rests of a second, each until the first pulse behind it
        let frozen = |done: &super::super::Conditioned| {
            done.findings.iter().map(|f| f.kind).find(|kind| matches!(kind, Kind::Frozen { .. }))
        };
        let kind = frozen(&found);
        assert!(matches!(kind, Some(Kind::Frozen { rows: 990..1100, .. })), "{kind:?}");
        assert!((1900..2010).contains(&found.channels.t.len()));
        assert_eq!(frozen(&done(false)), None);
        let left = Settings { rows: false, ..Settings::default() };
        let left = condition(log(true), &left, &Context::default()).unwrap();
        assert_eq!(left.channels.t.len(), 3000);
    }

    #[test]
    fn a_steady_speed_that_a_logger_rounds_is_no_rest() {
        let t: Vec<f64> = (0..3000).map(|k| 0.01 * f64::from(k)).collect();
        let level = |t: f64| [8.0, 3.0, -6.0, 0.0][(t / 2.0) as usize % 4];
        let speed = |t: f64| {
            let (now, before) = (level(t), if t < 2.0 { 0.0 } else { level(t - 2.0) });
            (100.0 * (now + (before - now) * (-(t % 2.0) / 0.1).exp())).round() / 100.0
        };
        let omega: Vec<[f64; 2]> = t.iter().map(|t| [speed(*t); 2]).collect();
        let signs: [&dyn Fn(f64) -> f64; 2] = [&|m| m, &f64::abs];
        for (sign, sign_from_speed) in signs.into_iter().zip([false, true]) {
            let torque = t.iter().map(|t| [sign(level(*t)); 2]).collect();
            let (t, omega) = (t.clone(), Some(omega.clone()));
            let channels = Channels { t, alpha: None, omega, torque };
            let settings = Settings { sign_from_speed, ..Settings::default() };
            let done = condition(channels, &settings, &Context::default()).unwrap();
            assert!(!done.findings.iter().any(|f| matches!(f.kind, Kind::Frozen { .. })));
        }
    }
}
