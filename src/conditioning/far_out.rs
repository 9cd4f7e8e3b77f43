//! Samples twenty times beyond all others: the -999 or 65535 with which loggers mark a missing value.
//!
//! Any others are compared with their surroundings (`spikes.rs`); these would be the measure for all, so they are found
//! first. In an input such a sample may be a pulse: it is an error unless the speed changes behind it as nowhere else.

use std::ops::Range;

use super::Conditioned;
use super::input::speeds;
use super::thresholds::SAMPLES;
use crate::math::interpolate;

/// An outlier: its rows, the correct value, and its deviation.
#[derive(Clone, Debug)]
pub(super) struct Spike {
    pub(super) rows: Range<usize>,
    pub(super) value: f64,
    pub(super) out: f64,
}

/// The samples far beyond all others: one or two in a row.
pub(super) fn far_out(t: &[f64], values: &[f64]) -> Vec<Spike> {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let most = (SAMPLES.marks * values.len() as f64) as usize;
    let is_gap = |k: &usize| sizes[*k] > 0.0 && sizes[k - 1] > SAMPLES.mark * sizes[*k];
    let Some(others) = (1..most).rev().find(is_gap).map(|k| sizes[k]) else { return vec![] };
    short_runs(t, values, |k| values[k].abs() > others)
}

/// The wrong samples with the line between their neighbours, if no more of them than two follow each other.
pub(super) fn short_runs(t: &[f64], values: &[f64], is_far: impl Fn(usize) -> bool) -> Vec<Spike> {
    let mut out: Vec<Spike> = vec![];
    let mut k = 0;
    while k < values.len() {
        let end = (k..values.len()).find(|j| !is_far(*j)).unwrap_or(values.len());
        if end - k > SAMPLES.marks_in_a_row {
            return vec![];
        }
        // at an end of the recording the value of the neighbour
        let before = k.checked_sub(1).unwrap_or(end).min(values.len() - 1);
        let after = if end < values.len() { end } else { before };
        for row in k..end {
            let ends = ([t[before], t[after]], [values[before], values[after]]);
            let value =
                if before < after { interpolate(ends.0, ends.1, t[row]) } else { ends.1[0] };
            out.push(Spike { rows: row..row + 1, value, out: values[row] - value });
        }
        k = end.max(k + 1);
    }
    out
}

/// Values with the correct ones in place of wrong samples.
pub(super) fn without(mut values: Vec<f64>, found: &[Spike]) -> Vec<f64> {
    found.iter().for_each(|spike| values[spike.rows.clone()].fill(spike.value));
    values
}

/// Two lists of outliers as one, by rows.
pub(super) fn in_order(mut all: Vec<Spike>, more: Vec<Spike>) -> Vec<Spike> {
    all.extend(more);
    all.sort_by_key(|spike| spike.rows.start);
    all
}

/// Whether the speed of a wheel changes behind some of these samples of its input by more than anywhere else.
pub(super) fn are_felt(work: &Conditioned, far: &[Spike], i: usize) -> bool {
    let Some(speed) = speeds(work).filter(|_| !far.is_empty()) else { return false };
    let near = |k: usize| {
        far.iter().any(|s| (s.rows.start..s.rows.end + SAMPLES.response_rows).contains(&k))
    };
    let largest = |is_near: bool| {
        let changes = (1..speed.len()).filter(|k| near(*k) == is_near);
        changes.map(|k| (speed[k][i] - speed[k - 1][i]).abs()).fold(0.0, f64::max)
    };
    largest(true) > SAMPLES.mark_felt * largest(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditioning::{Channel, Context, Kind, Settings, condition};
    use crate::recording::Channels;

    /// Two wheels of 0.03 kg m^2 under a torque, and under `pulses` of the right one that last a row.
    fn log(pulses: &[usize]) -> Channels {
        let t: Vec<f64> = (0..2000).map(|k| 0.01 * f64::from(k)).collect();
        let mut torque: Vec<[f64; 2]> = t.iter().map(|t| [0.3 * (2.0 * t).sin(); 2]).collect();
        pulses.iter().for_each(|&k| torque[k][0] += 60.0);
        let mut speed = [0.0; 2];
        let mut omega = vec![];
        for m in &torque {
            omega.push(speed);
            (0..2).for_each(|i| speed[i] += 0.01 * m[i] / 0.03);
        }
        Channels { t, alpha: None, omega: Some(omega), torque }
    }

    #[test]
    fn marks_of_missing_values_are_replaced_in_every_channel() {
        let clean = log(&[]);
        let mut marked = clean.clone();
        // more than one in a hundred, two in a row, at the begin, and at standstill
        let rows: Vec<usize> = (0..40).map(|k| 50 * k).chain([501]).collect();
        rows.iter().for_each(|&k| marked.torque[k][0] = -999.0);
        marked.omega.as_mut().unwrap()[777][1] = 65_535.0;
        for commanded in [false, true] {
            let context = Context { commanded, ..Context::default() };
            let done = condition(marked.clone(), &Settings::default(), &context).unwrap();
            let spikes = |channel: Channel| {
                let of = done.findings.iter().filter(|f| f.channel == channel);
                of.filter_map(|f| match f.kind {
                    Kind::Spikes { count, .. } => Some(count),
                    _ => None,
                })
                .sum::<usize>()
            };
            assert_eq!((spikes(Channel::Input(0)), spikes(Channel::Speed(1))), (41, 1));
            // a line over two or three rows of a sine of 2 rad/s deviates by its curvature
            let off = |k: &usize| (done.channels.torque[*k][0] - clean.torque[*k][0]).abs();
            assert!(rows.iter().map(off).fold(0.0, f64::max) < 0.3 * 0.02_f64);
        }
    }

    #[test]
    fn a_pulse_that_moves_the_wheel_stays() {
        let channels = log(&[300, 900]);
        let done = condition(channels.clone(), &Settings::default(), &Context::default()).unwrap();
        assert!(done.channels.torque == channels.torque, "{:?}", done.findings);
    }

    #[test]
    fn a_step_test_and_a_short_motion_have_no_such_samples() {
        let t: Vec<f64> = (0..1000).map(f64::from).collect();
        let step: Vec<f64> = t.iter().map(|t| if *t < 500.0 { 0.01 } else { 7.0 }).collect();
        assert!(far_out(&t, &step).is_empty());
        let motion: Vec<f64> =
            t.iter().map(|t| if (400.0..430.0).contains(t) { 5.0 } else { 0.01 }).collect();
        assert!(far_out(&t, &motion).is_empty());
    }
}
