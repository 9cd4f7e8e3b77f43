//! A clock that is coarser than the rows: seconds, tenths, or the first ten digits of a calendar's seconds.
//!
//! ```text
//! stamps  12:00:01 12:00:01 12:00:01 12:00:01 12:00:02 …      four rows a tick
//! t       1.00     1.25     1.50     1.75     2.00     …
//! ```

use std::ops::Range;

use super::Conditioned;
use super::cells::columns;
use super::finding::{Channel, Finding, Kind};
use super::jitter::by_number;
use super::signal::{changes, is_increasing, median_high};
use super::thresholds::TIMES;
use crate::math::{Line, mean};
use crate::recording::REGULAR;

/// Spreads the rows of each tick evenly over it, where ticks hold nearly the same number of rows. Where one rate
/// fits all stamps to within a tick, the rows have that rate.
pub(super) fn coarse(work: &mut Conditioned) {
    let t = &work.channels.t;
    let ticks = ticks(t);
    // the first and the last may be cut
    let inner = ticks.get(1..ticks.len().saturating_sub(1)).unwrap_or_default();
    if t.windows(2).any(|w| w[1] < w[0]) || inner.len() < 2 || is_twice(work) {
        return;
    }
    let mean = mean(inner.iter().map(|r| r.len() as f64));
    if mean < TIMES.rows_a_tick {
        return;
    }
    let tick = median_high(ticks.windows(2).map(|w| t[w[1].start] - t[w[0].start]));
    // a coarse clock advances by whole ticks; a receiver that reads at intervals has a finer clock
    if share_of_multiples(t, &ticks, tick) < REGULAR {
        return in_batches(work, &ticks, mean);
    }
    let usual = median_high(inner.iter().map(|r| r.len() as f64));
    let allowed = (TIMES.tick_rows * usual).max(1.0);
    let regular = inner.iter().filter(|r| (r.len() as f64 - usual).abs() <= allowed).count();
    if (regular as f64) < REGULAR * inner.len() as f64 {
        return;
    }
    let t = at_one_rate(t, &ticks, tick).unwrap_or_else(|| spread(t, &ticks, tick, tick / mean));
    work.channels.t = t;
    let kind = Kind::CoarseClock { tick_s: tick, rows: mean };
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
}

/// Moves the rows of a receiver, which stamps all rows since its last reading, to the equidistant times at which they
/// were sent.
fn in_batches(work: &mut Conditioned, ticks: &[Range<usize>], rows: f64) {
    let starts: Vec<usize> = ticks.iter().map(|tick| tick.start).collect();
    let even = by_number(&work.channels.t, &starts);
    if is_increasing(&even) {
        work.channels.t = even;
        work.findings.push(Finding::corrected(Channel::Time, Kind::Batches { rows }, "rows", true));
    }
}

/// Share of the steps from stamp to stamp that are whole ticks.
fn share_of_multiples(t: &[f64], ticks: &[Range<usize>], tick: f64) -> f64 {
    let steps = || ticks.windows(2).map(|w| (t[w[1].start] - t[w[0].start]) / tick);
    let whole = steps().filter(|n| (n - n.round().max(1.0)).abs() < TIMES.tick_rounded).count();
    whole as f64 / steps().count().max(1) as f64
}

/// The runs of rows with one stamp.
fn ticks(t: &[f64]) -> Vec<Range<usize>> {
    let starts = changes(t);
    let ends = starts.iter().skip(1).copied().chain([t.len()]);
    starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect()
}

/// Whether rows with a repeated stamp repeat all other values too, although the robot moves.
fn is_twice(work: &Conditioned) -> bool {
    let columns = columns(&work.channels);
    let t = &work.channels.t;
    let same = |k: usize| columns.iter().all(|(_, v)| v[k] == v[k - 1]);
    let count = |of: &dyn Fn(usize) -> bool| (1..t.len()).filter(|k| of(*k)).count();
    let repeated = count(&|k| t[k] == t[k - 1]);
    let twice = count(&|k| t[k] == t[k - 1] && same(k));
    let still =
        count(&|k| t[k] != t[k - 1] && columns.iter().skip(1).all(|(_, v)| v[k] == v[k - 1]));
    // a robot that stands repeats its rows across ticks as well
    twice as f64 > TIMES.written_twice * repeated as f64 && 2 * still < t.len() - repeated
}

/// Times at the one rate that fits best (least squares) the rows in which the stamp changes, if no row is off by more
/// than a tick. Those rows come less than a step after their stamp, the others up to a tick.
fn at_one_rate(t: &[f64], ticks: &[Range<usize>], tick: f64) -> Option<Vec<f64>> {
    let changes = || ticks[1..].iter().map(|rows| (rows.start as f64, t[rows.start] - t[0]));
    let line = Line::through(changes());
    let even: Vec<f64> = (0..t.len()).map(|k| t[0] + line.at(k as f64)).collect();
    let fits = line.slope > 0.0 && even.iter().zip(t).all(|(a, b)| (a - b).abs() <= tick);
    fits.then_some(even)
}

/// The rows of each tick evenly over the time to the next stamp; those of the first before its end, which it began
/// before, and those of the last and before missing rows at the usual step.
fn spread(t: &[f64], ticks: &[Range<usize>], tick: f64, step: f64) -> Vec<f64> {
    let mut out = t.to_vec();
    for (k, rows) in ticks.iter().enumerate() {
        let start = t[rows.start];
        let next = ticks
            .get(k + 1)
            .map(|r| t[r.start])
            .filter(|next| next - start < TIMES.next_tick * tick);
        let (from, step) = match next {
            Some(next) if k == 0 => {
                let step = step.min(tick / rows.len() as f64);
                (next - step * rows.len() as f64, step)
            }
            Some(next) => (start, (next - start) / rows.len() as f64),
            None => (start, step.min(tick / rows.len() as f64)),
        };
        rows.clone().enumerate().for_each(|(j, row)| out[row] = from + step * j as f64);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::{Context, Settings, condition};
    use super::*;
    use crate::recording::Channels;

    /// Two wheels whose true times are given, with the stamps that a clock of this tick writes.
    fn stamped(times: &[f64], tick: f64) -> Channels {
        let of = |f: fn(f64) -> f64| times.iter().map(|t| [f(*t), f(*t + 0.2)]).collect();
        Channels {
            t: times.iter().map(|t| ((t / tick + 1e-9).floor()) * tick).collect(),
            alpha: None,
            omega: Some(of(f64::sin)),
            torque: of(f64::cos),
        }
    }

    fn done(channels: Channels) -> Conditioned {
        condition(channels, &Settings::default(), &Context::default()).unwrap()
    }

    #[test]
    fn the_rows_of_a_coarse_clock_are_spread_over_its_ticks() {
        for (rate, tick) in [(10.0, 1.0), (50.0, 0.1), (4.0, 1.0), (200.0, 0.01), (30.0, 1.0)] {
            let times: Vec<f64> = (0..600).map(|k| 0.35 * tick + f64::from(k) / rate).collect();
            let found = done(stamped(&times, tick));
            let t = &found.channels.t;
            assert_eq!(t.len(), 600, "{rate} {tick} {:?}", found.findings);
            assert!(matches!(found.findings[0].kind, Kind::CoarseClock { .. }));
            let step = (t[599] - t[0]) / 599.0;
            assert!((step * rate - 1.0).abs() < 1e-6, "{rate} {tick} {step}");
            assert!(t.windows(2).all(|w| ((w[1] - w[0]) / step - 1.0).abs() < 1e-6));
        }
    }

    #[test]
    fn stamps_of_a_receiver_that_looks_now_and_then_are_no_coarse_clock() {
        // rows of 2 ms, taken every 3 to 6 ms and stamped in milliseconds
        let times: Vec<f64> = (0..600).map(|k| 0.002 * f64::from(k)).collect();
        let mut polls = vec![0.0];
        let mut at = 0.0;
        while at < 1.3 {
            at += 1e-3 * [4.0, 4.0, 3.0, 5.0, 6.0, 4.0][polls.len() % 6];
            polls.push(at);
        }
        let mut channels = stamped(&times, 1e-9);
        let late = |t: &f64| polls.iter().copied().find(|poll| *poll >= *t - 1e-9);
        channels.t = times.iter().filter_map(late).collect();
        let found = done(channels);
        assert!(matches!(found.findings[0].kind, Kind::Batches { .. }), "{:?}", found.findings);
        // 2 ms on average after they were sent, and a line through a hundred stamps that scatter by 1.3 ms
        for (a, b) in found.channels.t.iter().zip(&times) {
            assert!((a - b - 0.002).abs() < 7e-4, "{a} {b}");
        }
    }

    #[test]
    fn rows_that_are_missing_leave_the_others_in_their_ticks() {
        // 20 rows per second; a pause of four seconds
        let times = (0..400).map(|k| 0.05 * f64::from(k) + if k < 230 { 0.0 } else { 4.0 });
        let times: Vec<f64> = times.collect();
        let found = done(stamped(&times, 1.0)).channels.t;
        assert!(is_increasing(&found));
        assert!(found.iter().zip(&times).all(|(a, b)| (a - b).abs() < 0.6), "{found:?}");
    }

    #[test]
    fn rows_written_twice_and_times_that_stand_still_are_not_spread() {
        let times: Vec<f64> = (0..400).map(|k| 0.02 * f64::from(k / 2)).collect();
        let found = done(stamped(&times, 1e-9));
        assert_eq!(found.channels.t.len(), 200);
        assert!(matches!(found.findings[0].kind, Kind::TimeRows { rows: 200, .. }));
        // no time at all: nothing is changed, and the check of the recording reports it
        let mut channels = stamped(&times, 1.0);
        channels.t = vec![1.718e9; 400];
        assert_eq!(done(channels.clone()).channels.t, channels.t);
    }
}
