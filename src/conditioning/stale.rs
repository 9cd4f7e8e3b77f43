//! Rows that the logger wrote before the sensors had a new value, in a log with about the same rate as the sensors.
//!
//! Two clocks of the same period drift against each other (a loop of 20 ms that reads messages of 20 ms): occasionally
//! a row repeats the last value, the following rows are one sample late, and another row skips a sample and is in
//! time again.
//!
//! ```text
//! stale    alpha_k = alpha_(k-1) of both wheels, though a wheel moves by several quanta in the rows around
//! skipped  alpha_s - alpha_(s-1) about twice as large as in the rows around
//! between  v_j := v_(j+1) for k <= j < s - 1,   v_(s-1) := (v_(s-1) + v_s)/2
//! ```
//! If no row skips until the wheels stop or the recording ends, all rows until then are late; a row that repeats
//! while others are late already is due to a slightly slower sensor, and is interpolated alone.
//!
//! A sensor that repeats its values in many rows is slower than the logger, which the refresh of the rows
//! accounts for.

use std::ops::Range;

use super::finding::{Channel, Finding, Kind};
use super::signal::{column, median_high, pieces};
use super::thresholds::ANGLES;
use super::{Conditioned, Settings};
use crate::math::noise::grid;

/// Rows to either side whose digits are those of a row.
const NEAR: usize = 50;
/// Rows to either side whose motion is usual.
const AROUND: usize = 4;

/// Moves late samples to their rows.
pub(super) fn rows(work: &mut Conditioned, settings: &Settings) {
    let Some(late) = late(work) else { return };
    let Some(first) = late.first().map(|late| late.rows.start) else { return };
    let kind = Kind::Stale { rows: late.len(), first: first + 1 };
    work.findings.push(Finding::corrected(Channel::Sensors, kind, "rows", settings.rows));
    if !settings.rows {
        return;
    }
    for channel in [work.channels.alpha.as_mut(), work.channels.omega.as_mut()] {
        let Some(values) = channel else { continue };
        late.iter().for_each(|late| advance(values, late));
    }
}

/// Late rows and the first row after them that is in time; `None` at the end of the recording or of a part.
struct Late {
    rows: Range<usize>,
    until_end: bool,
}

/// Moves the samples of late rows forward by one; the last one is the mean of its neighbours, or is
/// extrapolated.
fn advance(values: &mut [[f64; 2]], late: &Late) {
    let Range { start, end } = late.rows;
    let last = end - 1;
    values.copy_within(start + 1..end, start);
    if late.until_end {
        values[last] = [0, 1].map(|i| 2.0 * values[last - 1][i] - values[last - 2][i]);
    } else {
        values[last] = [0, 1].map(|i| 0.5 * (values[last - 1][i] + values[end][i]));
    }
}

/// The rows that are one sample late, from each that repeats the last sample to that which skips one; `None` where rows
/// repeat so often that the sensor is slower, or hardly ever.
fn late(work: &Conditioned) -> Option<Vec<Late>> {
    let c = &work.channels;
    let alpha = c.alpha.as_ref()?;
    let repeats = |k: usize| {
        alpha[k] == alpha[k - 1] && c.omega.as_ref().is_none_or(|omega| omega[k] == omega[k - 1])
    };
    // the motion of most logs need not be examined
    if (1..alpha.len()).filter(|&k| repeats(k)).count() < ANGLES.fewest_stale {
        return None;
    }
    let columns = [column(alpha, 0), column(alpha, 1)];
    let least = [0, 1].map(|i| ANGLES.stale_quanta * grid(&columns[i]).unwrap_or(0.0));
    // a logger of so many digits rounds large angles more coarsely
    let rounds = |i: usize, k: usize| {
        let near = &columns[i][k.saturating_sub(NEAR)..(k + NEAR).min(columns[i].len())];
        ANGLES.stale_quanta * grid(near).unwrap_or(0.0)
    };
    let mut out: Vec<Late> = Vec::new();
    let to = |from: usize, end: usize| Late { rows: from..end, until_end: false };
    let (mut moving, mut stale) = (0_u32, 0_usize);
    for piece in pieces(&c.t) {
        let mut open: Option<usize> = None;
        for k in piece.start + 1..piece.end.saturating_sub(1) {
            let usual = [0, 1].map(|i| usual(&columns[i], k, &piece));
            let moves = [0, 1].map(|i| usual[i].abs() > least[i] && usual[i] != 0.0);
            if !moves[0] && !moves[1] {
                out.extend(open.take().map(|from| to(from, k)));
                continue;
            }
            moving += 1;
            let step = |i: usize| columns[i][k] - columns[i][k - 1];
            // a wheel that stops or reverses within a row is slow in the neighbouring rows
            let goes_on = |i: usize| {
                let slow = ANGLES.stale_beside * usual[i].abs();
                [k - 1, k + 1].iter().all(|&j| (columns[i][j] - columns[i][j - 1]).abs() >= slow)
            };
            let is_clear = |i: usize| usual[i].abs() > rounds(i, k);
            if repeats(k) && (0..2).all(|i| !moves[i] || (k > 1 && goes_on(i) && is_clear(i))) {
                stale += 1;
                out.extend(open.replace(k).map(|from| to(from, from + 1)));
            } else if (0..2).all(|i| !moves[i] || is_skipped(step(i) / usual[i])) {
                out.extend(open.take().map(|from| to(from, k)));
            }
        }
        let until_end = |from| Late { rows: from..piece.end, until_end: true };
        out.extend(open.filter(|from| from + 2 < piece.end).map(until_end));
    }
    (stale >= ANGLES.fewest_stale && stale as f64 <= ANGLES.most_stale * f64::from(moving))
        .then_some(out)
}

/// Whether a motion of a row, in usual motions, skips a sample.
fn is_skipped(motion: f64) -> bool {
    let [least, most] = ANGLES.skipped;
    (least..most).contains(&motion)
}

/// The usual motion of a row around row `k`, without its own; none where the wheel starts, stops or turns round there.
fn usual(values: &[f64], k: usize, piece: &Range<usize>) -> f64 {
    let of = |rows: Range<usize>| median_high(rows.map(|j| values[j] - values[j - 1]));
    let before = of(k.saturating_sub(AROUND).max(piece.start + 1)..k);
    let after = of(k + 1..(k + 1 + AROUND).min(piece.end));
    // no motion, or two that differ by more than a row which skips a sample from one which does not
    let ratio = before / after;
    if ratio > 0.5 && ratio < 2.0 { 0.5 * (before + after) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;

    fn motion(t: f64) -> [f64; 2] {
        [20.0 * t - 3.0 * t.cos(), 15.0 * t + 2.0 * t.sin()]
    }

    /// Rows of 20 ms with the sample `of(k)` of a sensor of 20 ms.
    fn work(of: impl Fn(usize) -> usize) -> Conditioned {
        let t: Vec<f64> = (0..1000).map(|k| 0.02 * k as f64).collect();
        let at = |k: usize| 0.02 * of(k) as f64;
        let alpha = Some((0..1000).map(|k| motion(at(k))).collect());
        let speed = |t: f64| [20.0 + 3.0 * t.sin(), 15.0 + 2.0 * t.cos()];
        let omega = Some((0..1000).map(|k| speed(at(k))).collect());
        let torque = vec![[0.1; 2]; t.len()];
        Conditioned { channels: Channels { t, alpha, omega, torque }, findings: vec![] }
    }

    #[test]
    fn rows_that_came_late_stand_where_they_were_measured() {
        // late in rows 300 and 400 alone, and in rows 600 to 640
        let is_late = |k| [300, 400].contains(&k) || (600..=640).contains(&k);
        let mut late = work(|k| if is_late(k) { k - 1 } else { k });
        rows(&mut late, &Settings::default());
        assert!(
            matches!(
                late.findings[..],
                [Finding { kind: Kind::Stale { rows: 3, first: 301 }, .. }]
            ),
            "{:?}",
            late.findings
        );
        for (k, found) in late.channels.alpha.unwrap().iter().enumerate() {
            let is = motion(0.02 * k as f64);
            // a chord over two rows: 3 h^2/2
            assert!((0..2).all(|i| (found[i] - is[i]).abs() < 7e-4), "{k}: {found:?} {is:?}");
        }
    }

    #[test]
    fn rows_that_stay_late_are_moved_to_the_end() {
        let mut late = work(|k| if k >= 700 || [300, 400].contains(&k) { k - 1 } else { k });
        rows(&mut late, &Settings::default());
        for (k, found) in late.channels.alpha.unwrap().iter().enumerate() {
            let is = motion(0.02 * k as f64);
            assert!((0..2).all(|i| (found[i] - is[i]).abs() < 2e-3), "{k}: {found:?} {is:?}");
        }
    }

    #[test]
    fn rows_in_time_and_slow_sensors_stay() {
        for of in [|k| k, |k: usize| k - k % 4] {
            let (mut rows_of, before) = (work(of), work(of));
            rows(&mut rows_of, &Settings::default());
            assert!(rows_of.findings.is_empty(), "{:?}", rows_of.findings);
            assert_eq!(rows_of.channels.alpha, before.channels.alpha);
        }
        let mut left = work(|k| if [300, 400, 500].contains(&k) { k - 1 } else { k });
        rows(&mut left, &Settings { rows: false, ..Settings::default() });
        assert_eq!(left.findings.len(), 1);
        assert_eq!(left.channels.alpha.unwrap()[300], motion(0.02 * 299.0));
    }

    #[test]
    fn digits_that_a_logger_leaves_out_are_no_late_rows() {
        // six digits: steps of 1e-4 below 100 rad and of 1e-3 beyond, on which a wheel of 0.1 rad/s repeats itself
        let digits =
            |x: f64| if x < 100.0 { (1e4 * x).round() / 1e4 } else { (1e3 * x).round() / 1e3 };
        let angle = |t: f64| if t < 10.0 { 9.99 * t } else { 99.9 + 0.1 * (t - 10.0) };
        let t: Vec<f64> = (0..8000).map(|k| 0.005 * f64::from(k)).collect();
        let alpha = t.iter().map(|t| [digits(angle(*t)), digits(0.9 * angle(*t) + 11.0)]).collect();
        let channels =
            Channels { torque: vec![[0.1; 2]; t.len()], t, alpha: Some(alpha), omega: None };
        let mut work = Conditioned { channels, findings: vec![] };
        rows(&mut work, &Settings::default());
        assert!(work.findings.is_empty(), "{:?}", work.findings);
    }

    #[test]
    fn a_wheel_that_stops_repeats_its_angle() {
        // at rest for one row between two movements of the same direction, again and again
        let pause = |k: usize| {
            let (part, row) = ((k / 20) as f64, (k % 20) as f64);
            part + (row - 19.0 / std::f64::consts::TAU * (std::f64::consts::TAU * row / 19.0).sin())
                / 19.0
        };
        let mut paused = work(|k| k);
        paused.channels.alpha = Some((0..1000).map(|k| [pause(k), 0.8 * pause(k)]).collect());
        paused.channels.omega = None;
        rows(&mut paused, &Settings::default());
        assert!(paused.findings.is_empty(), "{:?}", paused.findings);
        // an encoder of 512 counts that comes to rest and starts again, gently and by six counts per row more in each
        let step = std::f64::consts::TAU / 512.0;
        let gently = |t: f64| 4.0 * (t + (2.0 * t).sin() / 2.0);
        let sharply = |t: f64| 0.5 * 6.0 * step * ((t - 10.0).max(0.0) / 0.02).powi(2);
        for angle in [&gently as &dyn Fn(f64) -> f64, &sharply] {
            let t: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
            let alpha = Some(t.iter().map(|t| [(angle(*t) / step).floor() * step; 2]).collect());
            let channels = Channels { torque: vec![[0.1; 2]; t.len()], t, alpha, omega: None };
            let mut work = Conditioned { channels, findings: vec![] };
            rows(&mut work, &Settings::default());
            assert!(work.findings.is_empty(), "{:?}", work.findings);
        }
    }
}
