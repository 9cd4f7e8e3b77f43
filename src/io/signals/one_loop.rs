//! The values of a signal with its own time stamps, at the stamps of the rows.
//!
//! A loop that writes several signals stamps them shortly after one another, each at a nearly constant distance from
//! the others. Values of one loop belong to one row, whichever of them is written first:
//!
//! ```text
//! d_j = s_j - (nearest r)    s_j: stamp of a value,  r_k: stamp of a row,  T: median of r_(k+1) - r_k
//! d   = median of d_j        of a signal of the loop of the rows: |d_j - d| <= T/4 for nine in ten values, |d| <= T/2
//! row k                      the last value with s_j - d < r_k + min(r_(k+1) - r_k, T)/2
//!                            otherwise, of a signal with a period of its own, the last one with s_j <= r_k
//! sensor, |d| > T/10         on the line between its values around r_k
//! ```

use crate::math::{interpolate, median_high};

/// Distance of a value from the usual one, in periods of the rows: half of that at which it would be as near to another
/// row. The distances of a signal with a period of its own are even over a period, and half of them are within.
const SCATTER: f64 = 0.25;
/// Share of the values that must be so near: a few may be delayed.
const OF_LOOP: f64 = 0.9;
/// Distance, in periods of the rows, up to which values count as those of the row (judgement, as for a command that is
/// written shortly after the sensors): a loop reads its sensors together and writes them one after the other.
const TOGETHER: f64 = 0.1;
/// Number of periods between two values up to which a sensor is on the line between them: beyond, values are missing,
/// or were not written because they did not change.
const ADJACENT: f64 = 1.5;
/// Share of its range beyond which an angle does not move between two values, but wraps.
const WRAPS: f64 = 0.5;

/// A value with its stamp.
type Sample = (i64, f64);

/// The value of each row; `None` before the first one.
pub(super) fn at_rows(samples: &[Sample], rows: &[i64], is_sensor: bool) -> Vec<Option<f64>> {
    let period = median_high(rows.windows(2).map(|w| since(w[1], w[0])));
    let distance = distance(samples, rows, period);
    let places = places(samples, rows, period, distance);
    let is_apart = distance.is_some_and(|d| d.abs() > TOGETHER * period);
    let line = Line { samples, most: WRAPS * range(samples), longest: ADJACENT * period };
    let value = |(place, row): (Option<usize>, &i64)| {
        let own = samples[place?].1;
        Some(if is_sensor && is_apart { line.at(place?, *row).unwrap_or(own) } else { own })
    };
    places.into_iter().zip(rows).map(value).collect()
}

/// Ticks from one stamp to another.
fn since(stamp: i64, other: i64) -> f64 {
    (i128::from(stamp) - i128::from(other)) as f64
}

/// Usual distance of the values from the nearest row in ticks; `None` for a signal of another period.
fn distance(samples: &[Sample], rows: &[i64], period: f64) -> Option<f64> {
    let mut k = 0;
    let mut from_row = |(stamp, _): &Sample| {
        let off = |k: usize| since(*stamp, rows[k]);
        // midway between two rows, a value is of the later one
        while k + 1 < rows.len() && off(k + 1).abs() <= off(k).abs() {
            k += 1;
        }
        off(k)
    };
    let all: Vec<f64> = samples.iter().map(&mut from_row).collect();
    let usual = median_high(all.iter().copied());
    let near = all.iter().filter(|d| (*d - usual).abs() <= SCATTER * period).count();
    let is_of_loop = near as f64 >= OF_LOOP * all.len() as f64 && usual.abs() <= 0.5 * period;
    is_of_loop.then_some(usual)
}

/// The place of the value of each row among the samples.
fn places(
    samples: &[Sample],
    rows: &[i64],
    period: f64,
    distance: Option<f64>,
) -> Vec<Option<usize>> {
    let mut passed = 0;
    let mut place = |k: usize| {
        let next = rows.get(k + 1).map_or(period, |next| since(*next, rows[k]));
        let belongs = |(stamp, _): &Sample| match distance {
            Some(d) => {
                let off = since(*stamp, rows[k]) - d;
                off <= 0.0 || off < 0.5 * next.min(period)
            }
            None => *stamp <= rows[k],
        };
        while samples.get(passed).is_some_and(belongs) {
            passed += 1;
        }
        passed.checked_sub(1)
    };
    (0..rows.len()).map(&mut place).collect()
}

/// Largest difference between two values.
fn range(samples: &[Sample]) -> f64 {
    let values = || samples.iter().map(|(_, x)| *x);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

/// The lines between the values of a sensor.
struct Line<'a> {
    samples: &'a [Sample],
    /// Largest difference between two values.
    most: f64,
    /// Largest time between them in ticks.
    longest: f64,
}

impl Line<'_> {
    /// The value at the stamp of a row whose own value is at this place; `None` without a line around it.
    fn at(&self, place: usize, row: i64) -> Option<f64> {
        let later = usize::from(self.samples[place].0 < row);
        let (to, from) = (place + later, (place + later).checked_sub(1)?);
        let ((start, a), (end, b)) = (self.samples[from], *self.samples.get(to)?);
        let length = since(end, start);
        let is_line = length <= self.longest && (b - a).abs() <= self.most;
        is_line.then(|| interpolate([0.0, length], [a, b], since(row, start)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows every 100 ticks.
    fn rows() -> Vec<i64> {
        (0..200).map(|k| 100 * k).collect()
    }

    /// The number of each loop, written so long after its row.
    fn written(after: impl Fn(i64) -> i64) -> Vec<Sample> {
        (0..200).map(|k| (100 * k + after(k), k as f64)).collect()
    }

    #[test]
    fn values_that_one_loop_writes_are_of_one_row() {
        // shortly before or after the row, at distances that scatter, and one delayed by another thirty ticks
        let late = |k| if k == 70 { 33 } else { 3 };
        let after: [&dyn Fn(i64) -> i64; 5] =
            [&|_| 0, &|_| -3, &|k| k * 7 % 9, &|k| 30 + k * 7 % 20, &late];
        for after in after {
            let found = at_rows(&written(after), &rows(), false);
            assert!((0..200).all(|k| found[k] == Some(k as f64)), "{found:?}");
        }
    }

    #[test]
    fn a_slower_signal_of_the_loop_changes_in_its_row() {
        let slow: Vec<Sample> = (0..40).map(|k| (500 * k + 2, k as f64)).collect();
        let found = at_rows(&slow, &rows(), false);
        assert!((0..200).all(|k| found[k] == Some((k / 5) as f64)));
    }

    #[test]
    fn a_signal_with_a_period_of_its_own_holds_its_last_value() {
        let own: Vec<Sample> = (0..190).map(|k| (104 * k + 5, k as f64)).collect();
        let found = at_rows(&own, &rows(), true);
        let last = |row: i64| own.iter().rev().find(|(at, _)| *at <= row).map(|(_, x)| *x);
        assert!(rows().iter().zip(&found).all(|(row, x)| *x == last(*row)));
        assert_eq!(found[0], None);
    }

    #[test]
    fn sensors_a_part_of_a_period_apart_are_on_the_line_between_their_values() {
        let before = at_rows(&written(|_| -30), &rows(), true);
        assert!((1..199).all(|k| (before[k].unwrap() - k as f64 - 0.3).abs() < 1e-12));
        let after = at_rows(&written(|_| 30), &rows(), true);
        assert!((1..200).all(|k| (after[k].unwrap() - k as f64 + 0.3).abs() < 1e-12));
        // there is no line to the value before the first, over a wrap, or over values that are missing
        assert_eq!(after[0], Some(0.0));
        let wrapped: Vec<Sample> = written(|_| 30).iter().map(|(t, x)| (*t, x % 50.0)).collect();
        assert_eq!(at_rows(&wrapped, &rows(), true)[50], Some(0.0));
        let mut missing = written(|_| 30);
        missing.retain(|(at, _)| !(9000..9400).contains(at));
        assert_eq!(at_rows(&missing, &rows(), true)[94], Some(94.0));
    }

    #[test]
    fn values_in_a_pause_of_the_rows_are_not_of_the_row_before() {
        let mut paused = rows();
        paused.iter_mut().skip(100).for_each(|row| *row += 5000);
        let mut values: Vec<Sample> = paused.iter().map(|row| (row + 2, 0.0)).collect();
        values.insert(100, (paused[99] + 2500, 1.0));
        assert_eq!(at_rows(&values, &paused, false)[99], Some(0.0));
    }
}
