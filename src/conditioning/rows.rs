//! Rows: without a number, of a repeated or backward time, of a clock that was restarted.

use super::align::{Cells, align, without_slow_pair};
use super::cells::{columns, keep};
use super::clock;
use super::finding::{Channel, Finding, Kind};
use super::jitter;
use super::signal::{is_increasing, median_high, median_step};
use super::thresholds::TIMES;
use super::{Conditioned, Context, Settings};

/// Turns the rows round where the newest is first.
pub(super) fn newest_first(work: &mut Conditioned, settings: &Settings) {
    let c = &mut work.channels;
    let falls = c.t.windows(2).filter(|w| w[1] < w[0]).count();
    if !settings.rows || c.t.len() < 2 || (falls as f64) < TIMES.falling * (c.t.len() - 1) as f64 {
        return;
    }
    c.t.reverse();
    c.torque.reverse();
    [&mut c.alpha, &mut c.omega].into_iter().flatten().for_each(|rows| rows.reverse());
    let kind = Kind::NewestFirst { rows: c.t.len() };
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
}

/// Leaves out rows without a number, and resamples slower columns to the rows of the fastest sensor.
pub(super) fn values(work: &mut Conditioned, settings: &Settings, context: &Context) {
    if !settings.rows
        || columns(&work.channels).iter().all(|(_, v)| v.iter().all(|x| x.is_finite()))
    {
        return;
    }
    let count = work.channels.t.len();
    let cells: Vec<Cells> = columns(&work.channels)
        .into_iter()
        .filter(|(channel, _)| *channel != Channel::Time)
        .map(|(channel, v)| (channel, v.iter().map(|x| x.is_finite()).collect()))
        .collect();
    let missing = |cells: &[bool]| cells.iter().filter(|c| !**c).count();
    let is_sparse = |(_, cells): &Cells| {
        let missing = missing(cells);
        missing as f64 > TIMES.slow_column * count as f64 && missing < count
    };
    if cells.iter().any(is_sparse) {
        let cells = without_slow_pair(work, cells, settings, context);
        align(work, &cells, is_sparse, context.commanded);
    }
    let channels = columns(&work.channels);
    let complete: Vec<bool> = (0..work.channels.t.len())
        .map(|k| channels.iter().all(|(_, v)| v[k].is_finite()))
        .collect();
    let rows = complete.iter().filter(|c| !**c).count();
    if rows == 0 || rows == complete.len() {
        return;
    }
    let first = complete.iter().position(|c| !c).unwrap_or(0) + 1;
    keep(&mut work.channels, &complete);
    let kind = Kind::MissingValues { rows, first };
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
}

/// Makes time increase: rows after a restart of the clock are moved behind a gap, those within a tick of a coarse clock
/// are spread over it, and late rows that a receiver stamped alike are put on even times; of the others the longest
/// strictly increasing sequence stays, so that one wrong time stamp removes only one row, whether it is too early or
/// too late.
pub(super) fn times(work: &mut Conditioned, settings: &Settings, context: &Context) {
    let finite = work.channels.t.iter().all(|t| t.is_finite());
    if !settings.rows || !finite || is_increasing(&work.channels.t) {
        return;
    }
    restarts(work);
    clock::coarse(work);
    if is_increasing(&work.channels.t) || received_at_once(work, settings, context) {
        return;
    }
    let flags = longest_increasing(&work.channels.t);
    let rows = flags.iter().filter(|f| !**f).count();
    // a column that hardly ever increases is not a time; the check of the recording reports it
    if 2 * rows > flags.len() {
        return;
    }
    let first = flags.iter().position(|f| !f).unwrap_or(0) + 1;
    keep(&mut work.channels, &flags);
    let kind = Kind::TimeRows { rows, first };
    work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
}

/// Part of a step between rows with equal stamps while even times are sought: small against the delays of a receiver.
const APART: f64 = 1e-3;

/// Puts rows on even times of which a receiver stamped some alike, because the earlier of them was late; whether it
/// did. A copy of the row before is no row of its own and is left out.
fn received_at_once(work: &mut Conditioned, settings: &Settings, context: &Context) -> bool {
    let t = &work.channels.t;
    if t.windows(2).any(|w| w[1] < w[0]) {
        return false;
    }
    let channels = columns(&work.channels);
    let is_copy = |k: usize| k > 0 && channels.iter().all(|(_, v)| v[k] == v[k - 1]);
    let flags: Vec<bool> = (0..t.len()).map(|k| !is_copy(k)).collect();
    let mut trial = work.clone();
    keep(&mut trial.channels, &flags);
    let apart = APART * median_step(&trial.channels.t);
    let t = &mut trial.channels.t;
    if t.len() < TIMES.fewest_rows || !(apart > 0.0) {
        return false;
    }
    (1..t.len()).for_each(|k| t[k] = t[k].max(t[k - 1] + apart));
    let before = trial.findings.len();
    if let Some(first) = flags.iter().position(|f| !f) {
        let rows = flags.iter().filter(|f| !**f).count();
        let kind = Kind::TimeRows { rows, first: first + 1 };
        trial.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
    }
    jitter::even_times(&mut trial, settings, context);
    let is_even = matches!(
        trial.findings[before..].last().map(|f| f.kind),
        Some(Kind::Jitter { .. } | Kind::Batches { .. })
    );
    if is_even {
        *work = trial;
    }
    is_even
}

/// Periods of timers \[s\]: counters of 16 and 32 bits of milliseconds, and of 32 bits of microseconds; a day, half a
/// day, an hour and a minute of a clock.
const TIMERS: [f64; 7] = [65.536, 4_294_967.296, 4_294.967_296, 86_400.0, 43_200.0, 3600.0, 60.0];

/// Moves the rows after a restart behind those before it, with a gap between them. A clock that goes back by
/// the period of a timer was not restarted: it wrapped, and there is no gap.
fn restarts(work: &mut Conditioned) {
    let t = &mut work.channels.t;
    let step = median_high(t.windows(2).map(|w| w[1] - w[0]).filter(|h| *h > 0.0));
    let mut restarts: Option<(usize, usize, f64)> = None;
    let mut wraps: Option<(usize, usize, f64)> = None;
    for k in TIMES.restarted_rows..t.len().saturating_sub(TIMES.restarted_rows) {
        let before = t[k - TIMES.restarted_rows..k].iter().copied().fold(f64::INFINITY, f64::min);
        let after =
            t[k..k + TIMES.restarted_rows].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if t[k] >= t[k - 1] || after >= before {
            continue;
        }
        let back_s = t[k - 1] - t[k];
        let is_wrap = |period: &&f64| (back_s + step - **period).abs() < TIMES.after_wrap * step;
        let (found, size, shift) = match TIMERS.iter().find(is_wrap) {
            Some(period) => (&mut wraps, *period, *period),
            None => (&mut restarts, back_s, back_s + GAP_STEPS * step),
        };
        t[k..].iter_mut().for_each(|t| *t += shift);
        let (count, ..) = found.get_or_insert((0, k + 1, size));
        *count += 1;
    }
    let kinds = [
        wraps.map(|(count, row, period_s)| Kind::ClockWrap { count, row, period_s }),
        restarts.map(|(count, row, back_s)| Kind::ClockRestart { count, row, back_s }),
    ];
    for kind in kinds.into_iter().flatten() {
        work.findings.push(Finding::corrected(Channel::Time, kind, "rows", true));
    }
}

/// Length of the gap after a restart in steps: well above the four that define a gap, and
/// negligible in the length of the recording.
const GAP_STEPS: f64 = 10.0;

/// Which rows belong to the longest strictly increasing subsequence (patience sorting).
fn longest_increasing(t: &[f64]) -> Vec<bool> {
    let mut tails: Vec<usize> = Vec::new();
    let mut before = vec![usize::MAX; t.len()];
    for k in 0..t.len() {
        let place = tails.partition_point(|&j| t[j] < t[k]);
        before[k] = if place > 0 { tails[place - 1] } else { usize::MAX };
        if place == tails.len() {
            tails.push(k);
        } else {
            tails[place] = k;
        }
    }
    let mut flags = vec![false; t.len()];
    let mut k = tails.last().copied().unwrap_or(usize::MAX);
    while k != usize::MAX {
        flags[k] = true;
        k = before[k];
    }
    flags
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;
    use rand::{Rng, SeedableRng};

    fn work(t: Vec<f64>) -> Conditioned {
        let torque = t.iter().map(|t| [*t, 0.0]).collect();
        let omega = Some(vec![[1.0; 2]; t.len()]);
        Conditioned { channels: Channels { t, alpha: None, omega, torque }, findings: vec![] }
    }

    fn even(n: usize) -> Vec<f64> {
        (0..n).map(|k| 0.01 * k as f64).collect()
    }

    #[test]
    fn one_wrong_stamp_costs_one_row_whichever_way_it_errs() {
        for wrong in [-5.0, 0.31, 0.50, 1e9] {
            let mut t = even(200);
            t[50] = wrong;
            let mut w = work(t);
            times(&mut w, &Settings::default(), &Context::default());
            let expected = if wrong == 0.50 { 0 } else { 1 };
            assert_eq!(w.channels.t.len(), 200 - expected, "{wrong}");
            assert_eq!(w.findings.len(), expected);
            assert!(w.channels.t.windows(2).all(|p| p[0] < p[1]));
        }
    }

    #[test]
    fn rows_with_the_newest_first_are_turned_round() {
        let mut w = work(even(100).into_iter().rev().collect());
        newest_first(&mut w, &Settings::default());
        assert_eq!(w.channels.t, even(100));
        // every value stays in the row of its time
        assert!(w.channels.torque.iter().zip(&w.channels.t).all(|(m, t)| m[0] == *t));
        assert!(matches!(w.findings[..], [Finding { kind: Kind::NewestFirst { rows: 100 }, .. }]));
        let mut w = work(even(100));
        newest_first(&mut w, &Settings::default());
        assert!(w.findings.is_empty());
    }

    #[test]
    fn a_clock_that_was_restarted_goes_on_behind_a_gap() {
        let t: Vec<f64> = even(100).into_iter().chain(even(80)).collect();
        let mut w = work(t);
        times(&mut w, &Settings::default(), &Context::default());
        assert!(matches!(
            w.findings[..],
            [Finding { kind: Kind::ClockRestart { count: 1, row: 101, .. }, .. }]
        ));
        assert_eq!(w.channels.t.len(), 180);
        // 0.99 s, then a gap of ten steps
        assert!((w.channels.t[100] - 1.09).abs() < 1e-12);
    }

    #[test]
    fn a_timer_that_wraps_goes_on_without_a_gap() {
        // a counter of milliseconds in 16 bits, and the time of day about midnight, rows every 20 ms
        for (from, period) in [(60_000, 65_536), (86_390_000, 86_400_000)] {
            let t = (0..1000).map(|k| 1e-3 * f64::from((from + 20 * k) % period)).collect();
            let mut w = work(t);
            times(&mut w, &Settings::default(), &Context::default());
            assert!(matches!(
                w.findings[..],
                [Finding { kind: Kind::ClockWrap { count: 1, .. }, .. }]
            ));
            // stamps of a day have 11 decimals
            let even = w.channels.t.windows(2).all(|p| (p[1] - p[0] - 0.02).abs() < 1e-9);
            assert!(even && w.channels.t.len() == 1000);
        }
    }

    #[test]
    fn rows_without_a_number_are_left_out_and_slow_columns_are_read_between_their_rows() {
        let mut w = work(even(100));
        w.channels.torque[7][1] = f64::NAN;
        w.channels.omega =
            Some((0..100).map(|k| [if k % 10 == 5 { f64::NAN } else { k as f64 }, 1.0]).collect());
        values(&mut w, &Settings::default(), &Context::default());
        assert!(matches!(w.findings[0], Finding { channel: Channel::Speed(0), .. }));
        assert!(matches!(w.findings[1].kind, Kind::MissingValues { rows: 1, first: 8 }));
        assert_eq!(w.channels.t.len(), 99);
        assert_eq!(w.channels.omega.unwrap()[5][0], 5.0);
    }

    #[test]
    fn late_rows_with_equal_stamps_keep_their_places() {
        // delays of a receiver with exponential tails, a fifth of a row on average, that never change the order
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let mut stamp = 0.0_f64;
        let t: Vec<f64> = (0..2000)
            .map(|k| {
                stamp = stamp.max(0.01 * k as f64 - 0.002 * (1.0 - rng.random::<f64>()).ln());
                stamp
            })
            .collect();
        assert!(t.windows(2).any(|w| w[0] == w[1]));
        let mut w = work(t);
        let motion = |t: f64| [9.0 * t + 3.0 * (1.7 * t).sin(), 8.0 * t + 2.0 * (2.3 * t).cos()];
        w.channels.alpha = Some(even(2000).into_iter().map(motion).collect());
        times(&mut w, &Settings::default(), &Context::default());
        assert!(matches!(w.findings[..], [Finding { kind: Kind::Jitter { .. }, .. }]));
        assert_eq!(w.channels.t.len(), 2000);
        // 2 ms late on average; the ends of a line through a hundred stamps that scatter by as much
        for (found, is) in w.channels.t.iter().zip(even(2000)) {
            assert!((found - is - 0.002).abs() < 1.2e-3, "{found} {is}");
        }
    }

    #[test]
    fn increasing_times_are_not_touched() {
        let mut w = work(even(100));
        times(&mut w, &Settings::default(), &Context::default());
        assert!(w.findings.is_empty() && w.channels.t == even(100));
    }
}
