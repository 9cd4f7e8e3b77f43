//! Wrong speeds in the first one or two rows of a start: a sensor that measures the time between pulses has no pulse
//! before the first.
//!
//! ```text
//! rest, then w_k [, w_(k+1)] > 5/4 of every later speed under the same input,
//! the next speed < 1/2 of them, from which the wheel goes on accelerating
//! ```
//! Under an input that stays a wheel approaches its final speed; it does not begin above it, lose half of its speed within a
//! row and accelerate again.

use super::cells::keep;
use super::far_out::Spike;
use super::finding::{Channel, Finding, Kind};
use super::signal::{column, quantile};
use super::thresholds::SAMPLES;
use super::{Conditioned, Settings};
use crate::math::interpolate;

/// Leaves out the rows of wrong speeds at starts.
pub(super) fn rows(work: &mut Conditioned, settings: &Settings) {
    let mut kept = vec![true; work.channels.t.len()];
    for i in 0..2 {
        let found = wrong(work, i);
        let Some(first) = found.first().map(|s| s.rows.start + 1) else { continue };
        let largest = found.iter().map(|s| s.out.abs()).fold(0.0, f64::max);
        let kind = Kind::Onset { count: found.len(), first, largest };
        let finding = Finding::corrected(Channel::Speed(i), kind, "spikes", settings.spikes);
        work.findings.push(finding);
        found.iter().for_each(|spike| kept[spike.rows.start] = false);
    }
    if settings.spikes && kept.contains(&false) {
        keep(&mut work.channels, &kept);
    }
}

/// The wrong speeds of a wheel.
fn wrong(work: &Conditioned, i: usize) -> Vec<Spike> {
    let Some(omega) = &work.channels.omega else { return vec![] };
    let (t, speed, input) = (&work.channels.t, column(omega, i), column(&work.channels.torque, i));
    let rests = SAMPLES.stopping * quantile(speed.iter().map(|w| w.abs()), 0.95);
    let is_start = |k: &usize| {
        speed[*k].abs() > rests
            && speed[k - SAMPLES.onset_rest..*k].iter().all(|w| w.abs() <= rests)
    };
    let starts = (SAMPLES.onset_rest..speed.len()).filter(is_start);
    let wrong = starts.filter_map(|k| Some((k, wrong_at(k, &speed, &input)?)));
    let line = |(k, end): (usize, usize)| {
        let (ends, values) = ([t[k - 1], t[end]], [speed[k - 1], speed[end]]);
        (k..end).map(move |row| (row, interpolate(ends, values, t[row])))
    };
    let spike =
        |(row, value): (usize, f64)| Spike { rows: row..row + 1, value, out: speed[row] - value };
    wrong.flat_map(line).map(spike).collect()
}

/// The row behind the wrong speeds of a start in row `k`, if they are wrong.
fn wrong_at(k: usize, speed: &[f64], input: &[f64]) -> Option<usize> {
    let stays = |m: &&f64| (**m - input[k]).abs() <= SAMPLES.onset_input * input[k].abs();
    let held = k + input[k..].iter().take_while(stays).count();
    let sign = speed[k].signum();
    let is_wrong = |end: &usize| {
        if end + SAMPLES.response_rows > held {
            return false;
        }
        let first = speed[k..*end].iter().map(|w| sign * w).fold(f64::INFINITY, f64::min);
        let later = speed[*end..held].iter().map(|w| sign * w).fold(f64::NEG_INFINITY, f64::max);
        let next = sign * speed[*end];
        let accelerates = sign * speed[end + SAMPLES.response_rows - 1] > next;
        next > 0.0 && 2.0 * next < first && first > SAMPLES.onset_above * later && accelerates
    };
    (k + 1..=k + SAMPLES.marks_in_a_row).find(is_wrong)
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// A motor of 0.1 s under 9 V from 2 s on, whose first speeds are these.
    fn log(first: &[f64]) -> Channels {
        let t: Vec<f64> = (0..300).map(|k| 0.02 * f64::from(k)).collect();
        let speed = |t: f64| if t < 2.0 { 0.0 } else { 11.0 * (1.0 - (-(t - 1.98) / 0.1).exp()) };
        let mut omega: Vec<[f64; 2]> = t.iter().map(|t| [speed(*t); 2]).collect();
        omega[100..].iter_mut().zip(first).for_each(|(w, first)| *w = [*first; 2]);
        let torque = t.iter().map(|t| [if *t < 1.99 { 0.0 } else { 9.0 }; 2]).collect();
        Channels { t, alpha: None, omega: Some(omega), torque }
    }

    fn found(channels: Channels) -> (Option<Kind>, usize) {
        let context = Context { commanded: true, ..Context::default() };
        let done = condition(channels, &Settings::default(), &context).unwrap();
        let is_onset = |kind: &Kind| matches!(kind, Kind::Onset { .. });
        let kind = done.findings.iter().map(|f| f.kind).find(is_onset);
        (kind, done.channels.t.len())
    }

    #[test]
    fn one_or_two_wrong_speeds_at_a_start_are_left_out() {
        for first in [&[16.0, 16.7][..], &[16.0]] {
            let (kind, rows) = found(log(first));
            let count = first.len();
            let is_right = |kind: &Kind| matches!(kind, Kind::Onset { count: n, first: 101, .. } if *n == count);
            assert!(kind.as_ref().is_some_and(is_right), "{kind:?}");
            assert_eq!(rows, 300 - count);
        }
    }

    #[test]
    fn an_overshoot_and_a_fast_start_are_no_wrong_speeds() {
        assert_eq!(found(log(&[])).0, None);
        // a start that is fast against the rows, and one that swings
        assert_eq!(found(log(&[11.0, 11.1, 10.9, 11.0])).0, None);
        assert_eq!(found(log(&[15.0, 9.0, 12.0, 10.5])).0, None);
        assert_eq!(found(log(&[16.0, 16.7, 16.2])).0, None);
    }
}
