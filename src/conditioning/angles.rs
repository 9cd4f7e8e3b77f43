//! Angles that wrap, and counters that were reset.
//!
//! The increments of an angle vary little from row to row. A far larger step after which the angle
//! stays is not motion:
//!
//! ```text
//! e_k = (alpha_k - alpha_(k-1)) - median of the increments of the rows around k
//! ```
//! Steps of one and the same size are the period of a wrap (a turn, a half, 2^n counts), others are
//! resets of the counter, unless the angle returns within a few rows: then the samples between are wrong. The steps
//! differ by as much as the increments around them do: a fast wheel accelerates.

use std::f64::consts::TAU;
use std::ops::Range;

use super::finding::{Channel, Finding, Kind};
use super::signal::{column, median_high, pieces, quantile};
use super::thresholds::ANGLES;
use super::{Conditioned, Settings};
use crate::math::noise::grid;

/// Number of rows on either side from which the motion of the angle is estimated.
const AROUND: usize = 4;
/// Share of a step that may be left by one that undoes it: two increments of a tenth each, as `beyond_motion`.
const UNDONE: f64 = 2.0 / ANGLES.beyond_motion;

pub(super) fn unwrap(work: &mut Conditioned, settings: &Settings) {
    let Some(alpha) = &work.channels.alpha else { return };
    let pieces = pieces(&work.channels.t);
    let mut corrected = alpha.clone();
    let mut periods = vec![];
    for i in 0..2 {
        let values = column(alpha, i);
        let steps = steps(&values, &pieces);
        if steps.is_empty() {
            continue;
        }
        let (kinds, shifts) = explained(&values, &steps);
        for kind in kinds {
            if let Kind::Wrapped { period_rad, .. } = kind {
                periods.push(period_rad);
            }
            let channel = Channel::Angle(i);
            work.findings.push(Finding::corrected(channel, kind, "unwrap", settings.unwrap));
        }
        let mut shift = 0.0;
        let mut next = shifts.iter().peekable();
        for (k, row) in corrected.iter_mut().enumerate() {
            if let Some((_, by)) = next.next_if(|(at, _)| *at == k) {
                shift -= by;
            }
            row[i] += shift;
        }
    }
    if let [right, left] = periods[..] {
        start_alike(&mut corrected, right.max(left));
    }
    if settings.unwrap {
        work.channels.alpha = Some(corrected);
    }
}

/// Shifts the left angle to the period of the right one at the start. For an angle that wraps, the turn of
/// each wheel is unknown, and the heading is computed from their difference: angles just below one turn and
/// just above zero must be treated alike.
fn start_alike(alpha: &mut [[f64; 2]], period: f64) {
    let Some([right, left]) = alpha.first().copied() else { return };
    let turns = ((right - left) / period).round();
    alpha.iter_mut().for_each(|row| row[1] += turns * period);
}

/// Rows at which the angle steps by more than motion explains, and by how much.
fn steps(values: &[f64], pieces: &[Range<usize>]) -> Vec<(usize, f64)> {
    let increments = increments(values);
    // a fast wheel wraps in many rows, so that what is usual is that of three quarters of them
    let usual = quantile(increments.iter().map(|d| d.abs()), 0.75);
    let far = far(&increments);
    let range = range(values);
    let inside = |k: usize| pieces.iter().any(|p| p.start < k && k < p.end);
    let mut out = Vec::new();
    for k in 1..values.len() {
        let size = increments[k - 1].abs();
        // a wrap steps through more than half of the range; a reset through more than any motion
        let stepped = (size > ANGLES.wraps * range && size > 2.0 * usual) || size > far;
        if !stepped || !inside(k) {
            continue;
        }
        let near = ordinary(&increments, k, ANGLES.wraps * range);
        let motion = if near.is_empty() { 0.0 } else { median_high(near) };
        out.push((k, increments[k - 1] - motion));
    }
    out
}

/// The angle that no motion reaches from row to row; infinite for a wheel that hardly moves.
fn far(increments: &[f64]) -> f64 {
    let ordinary = quantile(increments.iter().map(|d| d.abs()), 0.98);
    if ordinary > 0.0 { ANGLES.beyond_motion * ordinary } else { f64::INFINITY }
}

fn range(values: &[f64]) -> f64 {
    quantile(values.iter().copied(), 1.0) - quantile(values.iter().copied(), 0.0)
}

/// Interpretation of the steps, and the amount by which each is corrected.
fn explained(values: &[f64], steps: &[(usize, f64)]) -> (Vec<Kind>, Vec<(usize, f64)>) {
    if let Some(period) = period(values, steps) {
        let turns = |by: f64| (by / period).round();
        let wraps: Vec<(usize, f64)> = steps
            .iter()
            .filter(|(_, by)| turns(*by) != 0.0)
            .map(|(k, by)| (*k, turns(*by) * period))
            .collect();
        return (vec![Kind::Wrapped { period_rad: period, turns: wraps.len() }], wraps);
    }
    let far = far(&increments(values));
    let wrong = returning(steps, far);
    let is_edge = |k: usize| wrong.iter().any(|rows| rows.start == k || rows.end == k);
    let is_reset =
        |(k, by): &(usize, f64)| by.abs() > far && !is_edge(*k) && lasts(values, (*k, *by));
    let lasting: Vec<(usize, f64)> = steps.iter().copied().filter(is_reset).collect();
    let kind = |(k, by): &(usize, f64)| Kind::Reset { row: k + 1, step_rad: *by };
    (lasting.iter().map(kind).collect(), lasting)
}

/// Rows in which the angle is far from those around them, and from which it returns.
pub(super) fn excursions(values: &[f64]) -> Vec<Range<usize>> {
    returning(&steps(values, std::slice::from_ref(&(0..values.len()))), far(&increments(values)))
}

/// Rows between a step of more than `far` and one that undoes it a few rows later.
fn returning(steps: &[(usize, f64)], far: f64) -> Vec<Range<usize>> {
    let (mut out, mut n) = (Vec::new(), 0);
    while let Some(&(from, by)) = steps.get(n) {
        n += 1;
        let later = || steps[n..].iter().take_while(|(k, _)| k - from <= AROUND);
        let undone = later().position(|(_, back)| (by + back).abs() < UNDONE * by.abs());
        if let Some(undone) = undone.filter(|_| by.abs() > far) {
            out.push(from..steps[n + undone].0);
            n += undone + 1;
        }
    }
    out
}

/// Increments from row to row.
fn increments(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|w| w[1] - w[0]).collect()
}

/// Whether the angle stays at its value after the step; after a wrong sample it returns.
fn lasts(values: &[f64], (k, by): (usize, f64)) -> bool {
    let before = median_high(values[k.saturating_sub(AROUND)..k].iter().copied());
    let after = median_high(values[k..(k + AROUND).min(values.len())].iter().copied());
    (after - before - by).abs() < 0.5 * by.abs()
}

/// The period of the steps, if they have one: a known one, within 2 % and what the motion contributes to the steps, that of a
/// counter, or one on which three steps and the range of the angle agree.
fn period(values: &[f64], steps: &[(usize, f64)]) -> Option<f64> {
    let size = median_high(steps.iter().map(|(_, by)| by.abs()));
    let range = range(values);
    let increments = increments(values);
    let moved = |k: usize| spread(&increments, k, ANGLES.wraps * range);
    let moves = |period: f64| steps.iter().all(|(k, _)| moved(*k) < 0.5 * ANGLES.wraps * period);
    let are_alike = |period: f64, apart: f64| {
        steps.iter().all(|(k, by)| (by.abs() - period).abs() < apart + moved(*k))
    };
    let fits = |period: f64, apart: f64| {
        range < 1.05 * period && moves(period) && are_alike(period, apart)
    };
    let turns = [TAU, 0.5 * TAU, 2.0 * TAU].into_iter();
    let known = turns.into_iter().find(|turn| fits(*turn, ANGLES.same_step * turn));
    let known = known.or_else(|| {
        of_counter(values, size).filter(|(period, count)| fits(*period, *count)).map(|of| of.0)
    });
    let alike = |by: f64| (by.abs() / size - 1.0).abs() < ANGLES.same_step;
    let is_one = || steps.len() >= 3 && range < 1.05 * size && steps.iter().all(|s| alike(s.1));
    known.or_else(|| is_one().then_some(size))
}

/// The period of a counter of n bits whose steps have about this `size`, and a count: its steps are as exact as the motion
/// of their rows, so that no other step is taken for a wrap. No counter has less than six bits.
fn of_counter(values: &[f64], size: f64) -> Option<(f64, f64)> {
    let count = grid(values)?;
    let bits = (size / count).log2().round();
    (bits >= ANGLES.counter_bits).then(|| (count * bits.exp2(), count))
}

/// The increments around a row that do not wrap: those of an angle at rest on the end of its range wrap in every other row.
fn ordinary(increments: &[f64], k: usize, wraps: f64) -> Vec<f64> {
    let near = k.saturating_sub(AROUND + 1)..(k + AROUND).min(increments.len());
    increments[near].iter().copied().filter(|d| d.abs() <= wraps).collect()
}

/// Difference between the largest and the smallest increment around a row, of those that do not wrap: by so much the
/// motion of the row itself, which a step contains, may differ from the median around it.
fn spread(increments: &[f64], k: usize, wraps: f64) -> f64 {
    let near = ordinary(increments, k, wraps);
    let of = |worse: fn(f64, f64) -> f64| near.iter().copied().reduce(worse);
    of(f64::max).zip(of(f64::min)).map_or(0.0, |(most, least)| most - least)
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    fn conditioned(alpha: Vec<[f64; 2]>, h: f64) -> Conditioned {
        let t: Vec<f64> = (0..alpha.len()).map(|k| h * k as f64).collect();
        let torque = t.iter().map(|t| [t.sin(), t.cos()]).collect();
        let channels = Channels { t, alpha: Some(alpha), omega: None, torque };
        condition(channels, &Settings::default(), &Context::default()).unwrap()
    }

    /// Forth and back, up to 12 rad/s.
    fn motion(n: usize, h: f64) -> Vec<[f64; 2]> {
        (0..n)
            .map(|k| h * k as f64)
            .map(|t| [24.0 * (1.0 - (0.5 * t).cos()), 15.0 * (0.4 * t).sin()])
            .collect()
    }

    #[test]
    fn angles_that_wrap_at_a_turn_or_at_a_power_of_two_of_counts_are_unwrapped() {
        for (period, quantum) in [(TAU, 1e-3), (0.5 * TAU, 1e-4), (1024.0 * 0.01, 0.01)] {
            for low in [0.0, -0.5 * period] {
                let truth = motion(2000, 0.02);
                let round = |x: f64| (x / quantum).round() * quantum;
                let wrap = |x: f64| round(x - low).rem_euclid(period) + low;
                let done = conditioned(truth.iter().map(|v| v.map(wrap)).collect(), 0.02);
                let found = done.channels.alpha.unwrap();
                // up to an unknown constant, within rounding
                for i in 0..2 {
                    let by = found[0][i] - truth[0][i];
                    let worst = found.iter().zip(&truth).map(|(a, b)| (a[i] - b[i] - by).abs());
                    let worst = worst.fold(0.0, f64::max);
                    assert!(worst < 1.01 * quantum, "{period} {low} {i}: {worst}");
                }
            }
        }
    }

    #[test]
    fn an_angle_that_wraps_every_few_rows_is_unwrapped() {
        // from rest to four rows a turn within a dozen rows, read to 0.1 degrees, in either direction
        let speed = |k: usize| 1.5 * (1.0 - (-(k as f64) / 4.0).exp());
        for sign in [1.0, -1.0] {
            let rest = [2.687; 20].into_iter();
            let driven = (0..200).scan(2.687, |angle, k| {
                *angle += sign * (speed(k) + 0.1 * (0.7 * k as f64).sin());
                Some(*angle)
            });
            let truth: Vec<f64> = rest.chain(driven).collect();
            let quantum = 0.1_f64.to_radians();
            let wrap = |x: &f64| [((x / quantum).round() * quantum).rem_euclid(TAU); 2];
            let found =
                conditioned(truth.iter().map(wrap).collect(), 0.007).channels.alpha.unwrap();
            let worst = found.iter().zip(&truth).map(|(a, b)| (a[0] - b).abs()).fold(0.0, f64::max);
            assert!(worst < quantum, "{sign}: {worst}");
        }
    }

    #[test]
    fn an_angle_that_rests_on_the_end_of_its_range_wraps() {
        let noise = |k: usize| 1e-3 * ((k * k * 7919 % 1009) as f64 / 504.5 - 1.0);
        let rest = (0..100).map(|_| [0.0; 2]);
        let truth: Vec<[f64; 2]> = rest.chain(motion(2000, 0.02)).collect();
        let truth: Vec<[f64; 2]> = truth
            .iter()
            .enumerate()
            .map(|(k, v)| [v[0] + noise(k), v[1] + noise(k + 5000)])
            .collect();
        let done = conditioned(truth.iter().map(|v| v.map(|x| x.rem_euclid(TAU))).collect(), 0.02);
        let wraps = |f: &Finding| matches!(f.kind, Kind::Wrapped { .. });
        assert!(done.findings.iter().filter(|f| wraps(f)).count() == 2, "{:?}", done.findings);
        let is_step = |f: &Finding| matches!(f.kind, Kind::Reset { .. } | Kind::Spikes { .. });
        assert!(!done.findings.iter().any(is_step), "{:?}", done.findings);
        let found = done.channels.alpha.unwrap();
        for i in 0..2 {
            let by = ((found[0][i] - truth[0][i]) / TAU).round() * TAU;
            assert!(found.iter().zip(&truth).all(|(a, b)| (a[i] - b[i] - by).abs() < 1e-9), "{i}");
        }
    }

    #[test]
    fn wheels_whose_angles_wrap_start_in_the_same_turn() {
        // at rest within noise: one reads a hair less than a turn, the other a hair more than none
        let wrap = |v: [f64; 2]| [(v[0] - 1e-3).rem_euclid(TAU), (v[1] + 1e-3).rem_euclid(TAU)];
        let wrapped: Vec<[f64; 2]> = motion(2000, 0.02).into_iter().map(wrap).collect();
        assert!(wrapped[0][0] - wrapped[0][1] > 6.0);
        let start = conditioned(wrapped, 0.02).channels.alpha.unwrap()[0];
        assert!((start[0] - start[1] + 2e-3).abs() < 1e-9, "{start:?}");
    }

    #[test]
    fn a_counter_that_was_reset_goes_on() {
        let truth = motion(2000, 0.02);
        let reset =
            |(k, v): (usize, &[f64; 2])| if k < 900 { *v } else { [v[0] - truth[900][0], v[1]] };
        let done = conditioned(truth.iter().enumerate().map(reset).collect(), 0.02);
        assert!(
            matches!(done.findings[0].kind, Kind::Reset { row: 901, .. }),
            "{:?}",
            done.findings
        );
        let end = done.channels.alpha.unwrap()[1999];
        // what the wheel moved in the row of the reset is known as the median of its neighbours
        assert!((end[0] - truth[1999][0]).abs() < 0.01);
    }

    #[test]
    fn fast_motion_and_coarse_encoders_are_no_wraps() {
        let coarse: Vec<[f64; 2]> =
            motion(1000, 0.02).iter().map(|v| v.map(|x| (x / 0.3).round() * 0.3)).collect();
        let slow: Vec<[f64; 2]> = (0..300).map(|k| [if k < 200 { 0.0 } else { 0.01 }; 2]).collect();
        for alpha in [motion(1000, 0.1), coarse, slow] {
            let done = conditioned(alpha.clone(), 0.02);
            assert!(done.channels.alpha.as_ref() == Some(&alpha), "{:?}", done.findings);
        }
    }

    #[test]
    fn wrong_samples_close_to_each_other_are_no_reset() {
        for apart in 1..=4 {
            let mut alpha = motion(2000, 0.02);
            let truth = alpha.clone();
            for k in [1000, 1000 + apart] {
                alpha[k][0] += 143.0;
            }
            let done = conditioned(alpha, 0.02);
            let kinds: Vec<&Kind> = done.findings.iter().map(|f| &f.kind).collect();
            let all = matches!(kinds[..], [Kind::Spikes { count: 2, first: 1001, .. }, ..]);
            assert!(all, "{apart}: {:?}", done.findings);
            for (found, is) in done.channels.alpha.unwrap().iter().zip(&truth) {
                // the line over three rows: 3/8 (3 h)^2 of an acceleration of 6 rad/s^2
                assert!((found[0] - is[0]).abs() < 0.01, "{apart}");
            }
        }
    }
}
