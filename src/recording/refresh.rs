//! Sensors that are slower than the logger.

use std::f64::consts::{PI, TAU};

use super::Channels;
use crate::math::median_high;
use crate::math::noise::quantum;

/// Share of repeated rows during motion above which the sensors may be slower than the rows.
const REPEATED: f64 = 0.4;
/// Smallest change of a slow sensor between two new values, in quantisation steps. A coarse sensor at full
/// rate changes by one step, occasionally by two.
const STEPS: f64 = 2.5;
/// Share of equal intervals between changes above which they are regular, for sensors and clocks.
pub(crate) const REGULAR: f64 = 0.8;
/// Ratio of large to small changes above which they are not all equal to one step.
const VARIES: f64 = 1.02;
/// Tolerance for multiples of a step, as a share of the step: rounding of a logger, far below a change of the
/// speed.
const EXACT: f64 = 0.01;
/// Changes from which a period is determined.
const MOST_CHANGES: usize = 400;
/// Frequencies per reciprocal length of these changes at which a period is sought.
const FINE: f64 = 4.0;
/// Rows per reading from which on a sensor is slow.
const SHORTEST: f64 = 2.0;
/// Logarithm of the probability below which regular changes are no accident: one in a million.
const UNLIKELY: f64 = -13.8;
/// A standstill is longer than this many refresh intervals.
const STANDSTILL: usize = 3;

/// Rows with new values, from the measured channels. All rows are new, unless more than 40 % of the samples
/// in motion repeat the previous one and the changes in between exceed one step of the channel; then only
/// rows that differ from the previous one are new, and rows within a long standstill. A channel that is
/// coarse at full rate also repeats its rows, but then changes by single steps.
#[must_use]
pub fn refreshed(channels: &Channels) -> Vec<bool> {
    let count = channels.t.len();
    let of = |rows: Option<&Vec<[f64; 2]>>, k: usize| rows.is_none_or(|v| v[k] == v[k - 1]);
    let same: Vec<bool> = (0..count)
        .map(|k| k > 0 && of(channels.alpha.as_ref(), k) && of(channels.omega.as_ref(), k))
        .collect();
    let moving = moving(channels, &same);
    let moves = moving.iter().filter(|m| **m).count();
    let repeats = (0..count).filter(|&k| moving[k] && same[k]).count();
    if repeats as f64 <= REPEATED * moves as f64 || moves == 0 {
        return vec![true; count];
    }
    match grain(channels, &same) {
        Grain::Coarse => return vec![true; count],
        Grain::Mixed => return readings(&same).unwrap_or_else(|| vec![true; count]),
        Grain::Fine => {}
    }
    let period = run(&same, &moving).max(1);
    let longest = STANDSTILL * period;
    let mut since = 0;
    let mut fresh: Vec<bool> = same
        .iter()
        .map(|same| {
            since = if *same { since + 1 } else { 0 };
            // beyond a few refresh intervals it is a real standstill
            since % longest == 0
        })
        .collect();
    // the value before a change is as old as the refresh interval and does not determine when the motion
    // began
    for k in (0..count).filter(|&k| !same[k]) {
        let before = k.saturating_sub(period - 1)..k;
        before.filter(|&j| same[j]).for_each(|j| fresh[j] = false);
    }
    fresh
}

/// Rows between two changes that are close to each other, which excludes standstills.
fn moving(channels: &Channels, same: &[bool]) -> Vec<bool> {
    let changes: Vec<usize> = (0..same.len()).filter(|&k| !same[k]).collect();
    let mut out = vec![false; channels.t.len()];
    if changes.len() < 2 {
        return out;
    }
    let usual = median_high(changes.windows(2).map(|w| (w[1] - w[0]) as f64)) as usize;
    for w in changes.windows(2).filter(|w| w[1] - w[0] <= STANDSTILL * usual) {
        out[w[0]..w[1]].fill(true);
    }
    out
}

/// Median number of rows between changes.
fn run(same: &[bool], moving: &[bool]) -> usize {
    let changes = (0..same.len()).filter(|&k| moving[k] && !same[k]).count();
    let rows = moving.iter().filter(|m| **m).count();
    (rows as f64 / changes.max(1) as f64).round() as usize
}

/// Why rows repeat. A coarse channel changes by its smallest step, occasionally by two, after a number of rows that
/// depends on the speed. A slow channel changes by any amount, always after the same number of rows.
enum Grain {
    /// The quantisation is coarse.
    Coarse,
    /// The quantisation is coarse, and the sensor may be slow too.
    Mixed,
    /// The sensor is slow.
    Fine,
}

fn grain(channels: &Channels, same: &[bool]) -> Grain {
    let Some(rows) = channels.alpha.as_ref().or(channels.omega.as_ref()) else {
        return Grain::Coarse;
    };
    let wheels = [0, 1].map(|i| changes(rows, i));
    let ratio = |c: &[f64], low: usize, high: usize| {
        let at = |share: usize| c.get(c.len() * share / 100).copied();
        at(low).zip(at(high)).map_or(0.0, |(low, high)| high / low)
    };
    // the smallest change, not the greatest common divisor, because loggers round
    let steps = wheels.iter().map(|c| ratio(c, 2, 50)).fold(0.0, f64::max);
    let varies = wheels.iter().any(|c| ratio(c, 10, 90) > VARIES);
    match steps < STEPS && in_steps(rows, &wheels) {
        false => Grain::Fine,
        // single steps at regular intervals are a steady motion as well
        true if !varies => Grain::Coarse,
        true if is_regular(same) => Grain::Fine,
        true => Grain::Mixed,
    }
}

/// Rows with a new reading of a sensor that is slow and so coarse that many readings repeat the last value; `None` if
/// the changes have no [`period`]. A row with a change is a reading; of the periods without one the row in which it
/// ends.
fn readings(same: &[bool]) -> Option<Vec<bool>> {
    let changes: Vec<usize> = (1..same.len()).filter(|&k| !same[k]).collect();
    let period = period(&changes)?;
    let mut fresh: Vec<bool> = same.iter().map(|same| !same).collect();
    let ends = changes.iter().skip(1).copied().chain([same.len()]);
    for (&from, to) in changes.iter().zip(ends) {
        let readings = ((to - from) as f64 / period).round() as usize;
        (1..readings).for_each(|n| fresh[from + (n as f64 * period) as usize] = true);
    }
    Some(fresh)
}

/// The period of a slow sensor in rows: all changes are a whole number of periods apart, as those of a coarse sensor at
/// full rate are not.
///
/// ```text
/// R(P) = |Σ exp(2π i k/P)|/n over the rows k with a change;   sinc(1/P) of a sensor of this period, as rows follow it
/// ```
fn period(changes: &[usize]) -> Option<f64> {
    let changes = &changes[..changes.len().min(MOST_CHANGES)];
    let mut gaps: Vec<usize> = changes.windows(2).map(|w| w[1] - w[0]).collect();
    gaps.sort_unstable();
    let longest = gaps.get(gaps.len() * 2 / 100)? + 1;
    let finest = 1.0 / (FINE * (changes.last()? - changes.first()?) as f64);
    let waves = (1.0 / (longest as f64 * finest)) as usize..=(1.0 / (SHORTEST * finest)) as usize;
    let coherence = |frequency: f64| {
        let angles = changes.iter().map(|k| TAU * frequency * *k as f64);
        let sums = angles.fold((0.0, 0.0), |(s, c), angle| (s + angle.sin(), c + angle.cos()));
        f64::hypot(sums.0, sums.1) / changes.len() as f64
    };
    let of_rows = |period: f64| (PI / period).sin() / (PI / period);
    let all: Vec<(f64, f64)> = waves
        .map(|j| j as f64 * finest)
        .map(|frequency| (coherence(frequency), 1.0 / frequency))
        .collect();
    // the longest period, since its fractions are as regular, and the best within its width
    let first = all.iter().position(|(r, period)| *r >= REGULAR * of_rows(*period))?;
    let width = first..(first + 2 * FINE as usize).min(all.len());
    let &(coherent, period) = all[width].iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    // independent changes exceed R in one of the waves with the probability waves exp(-n R²)
    let chance = -finest.ln() - changes.len() as f64 * coherent * coherent;
    (chance < UNLIKELY).then_some(period)
}

/// Whether all changes are multiples of one step.
fn in_steps(rows: &[[f64; 2]], changes: &[Vec<f64>; 2]) -> bool {
    (0..2).filter(|i| !changes[*i].is_empty()).all(|i| {
        let values: Vec<f64> = rows.iter().map(|v| v[i]).collect();
        let (least, middle) =
            (changes[i][changes[i].len() * 2 / 100], changes[i][changes[i].len() / 2]);
        // a divisor of the magnitude of the changes, or of any magnitude if it is that of the digits of the
        // logger
        let step = quantum(&values).filter(|q| middle < STEPS * q).unwrap_or(least);
        let mut off: Vec<f64> =
            changes[i].iter().map(|c| (c / step - (c / step).round()).abs()).collect();
        off.sort_by(f64::total_cmp);
        off[off.len() * 3 / 4] < EXACT
    })
}

/// Absolute changes of a wheel, the smallest first.
fn changes(rows: &[[f64; 2]], i: usize) -> Vec<f64> {
    let changes = rows.windows(2).map(|w| (w[1][i] - w[0][i]).abs());
    let mut changes: Vec<f64> = changes.filter(|d| *d > 0.0).collect();
    changes.sort_by(f64::total_cmp);
    changes
}

/// Whether nearly all changes occur at the same interval in rows.
fn is_regular(same: &[bool]) -> bool {
    let changes: Vec<usize> = (0..same.len()).filter(|&k| !same[k]).collect();
    let mut runs: Vec<usize> = changes.windows(2).map(|w| w[1] - w[0]).collect();
    runs.sort_unstable();
    let usual = runs.get(runs.len() / 2).copied().unwrap_or(0);
    let alike = runs.iter().filter(|run| **run == usual).count();
    alike as f64 >= REGULAR * runs.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels(alpha: Option<Vec<[f64; 2]>>, omega: Option<Vec<[f64; 2]>>) -> Channels {
        let n = alpha.as_ref().or(omega.as_ref()).map_or(0, Vec::len);
        let t = (0..n).map(|k| 0.01 * k as f64).collect();
        Channels { t, torque: vec![[0.0; 2]; n], alpha, omega }
    }

    #[test]
    fn rows_that_repeat_a_slow_sensor_are_not_new() {
        for every in [4, 20] {
            let slow = |k: usize| (k / every) as f64;
            let alpha = (0..400).map(|k| [slow(k).sin(), -slow(k).cos()]).collect();
            let omega = (0..400).map(|k| [1.0 + 0.01 * slow(k), 1.0]).collect();
            let fresh = refreshed(&channels(Some(alpha), Some(omega)));
            assert_eq!(fresh.iter().filter(|f| **f).count(), 400 / every);
            assert!(fresh[0] && fresh[every] && !fresh[every + 1]);
        }
    }

    #[test]
    fn a_slow_sensor_at_nearly_constant_speed_is_no_coarse_one() {
        // increments of 0.05 to 0.1 rad, every fourth row
        let at = |k: usize| 0.1 * (k / 4) as f64 - 0.5 * (1.0 - (-((k / 4) as f64) / 10.0).exp());
        let alpha: Vec<[f64; 2]> = (0..400).map(|k| [at(k), at(k)]).collect();
        let fresh = refreshed(&channels(Some(alpha), None));
        assert_eq!(fresh.iter().filter(|f| **f).count(), 100);
    }

    #[test]
    fn a_coarse_encoder_at_full_rate_stays_as_it_is() {
        let ramp = |k: i32| (f64::from(k) / 4.0).floor();
        let alpha: Vec<[f64; 2]> = (0..400).map(|k| [0.02 * ramp(k), 0.02 * ramp(k + 1)]).collect();
        let omega = (0..400).map(|k| [1.0 + 1e-3 * f64::from(k), 1.0]).collect();
        assert!(refreshed(&channels(Some(alpha.clone()), Some(omega))).iter().all(|f| *f));
        // also where there is nothing but the coarse channel
        assert!(refreshed(&channels(Some(alpha.clone()), None)).iter().all(|f| *f));
        assert!(refreshed(&channels(None, Some(alpha))).iter().all(|f| *f));
    }

    #[test]
    fn a_sensor_that_is_slow_and_coarse_is_read_at_its_period() {
        // rows of 11 ms, readings every 90 ms in steps of 0.17 rad/s, which most readings do not leave
        let speed = |t: f64| 3.0 + 0.6 * (0.7 * t).sin() + 0.8 * (1.9 * t).sin().powi(9);
        let coarse = |v: f64| (v / 0.17).round() * 0.17;
        let read = |k: usize| 0.09 * (0.011 * k as f64 / 0.09).floor();
        let at = |k: usize| [coarse(speed(read(k))), coarse(1.3 * speed(read(k) + 1.0))];
        let fresh = refreshed(&channels(None, Some((0..4000).map(at).collect())));
        let count = fresh.iter().filter(|f| **f).count();
        assert!((484..=494).contains(&count), "{count}"); // 44 s/90 ms = 489
        let early = (1..4000).filter(|&k| fresh[k] && read(k) != read(k - 1)).count();
        assert!(early > 440, "{early}");
        // the same in every row
        let at =
            |k: usize| [coarse(speed(0.011 * k as f64)), coarse(speed(0.011 * k as f64 + 1.0))];
        let fresh = refreshed(&channels(None, Some((0..4000).map(at).collect())));
        assert!(fresh.iter().all(|f| *f));
    }

    #[test]
    fn a_period_of_whole_rows_is_not_taken_for_its_half() {
        // changes every one to three periods of five rows, all of which are whole numbers of half periods too
        let steps = (0..300).scan(0, |at, k: usize| {
            *at += 5 * (1 + k * k % 3);
            Some(*at)
        });
        let found = period(&steps.collect::<Vec<_>>()).unwrap();
        assert!((found - 5.0).abs() < 1e-3, "{found}");
    }

    #[test]
    fn rows_in_a_long_standstill_count_now_and_then() {
        let at = |k: usize| if k < 200 { (k / 4) as f64 * 0.37 } else { 18.5 };
        let alpha = (0..1000).map(|k| [at(k).sin(), 0.1 * at(k) * at(k)]).collect();
        let fresh = refreshed(&channels(Some(alpha), None));
        let standing = fresh[212..].iter().filter(|f| **f).count();
        assert!((50..80).contains(&standing), "{standing}");
    }
}
