//! Columns in which a logger writes a cell only when the value changes (Shuffleboard, NetworkTables): an empty cell then
//! means the value before it, and no lost sample.
//!
//! ```text
//! values          successive ones differ, since equal ones are not written
//! motion          most values are in successive rows: the column has no slower rate of its own
//! rest            most of the time without a value is in long stretches; behind one the value goes on from that before it,
//!                 as after lost samples of a moving wheel it does not
//! ```
//! Coarse values stay in motion too. They are recognised by the steps between successive values of all columns with
//! empty cells: a value that is read at times which do not depend on it stays about as often as it moves by the smallest
//! step up, or down.
//!
//! ```text
//! n_0, n_1        successive values that are equal; that differ by the smallest step of their column
//! steps           n_1 >= 20,   n_0 <= n_1/10
//! time            each sensor has no value, in rows of other columns, over more than 5 % of the time in steps of more than
//!                 1.5 times the usual one: it has no slower rate of its own
//! ```

use super::cells::{columns, put};
use super::finding::{Channel, Finding, Kind};
use super::signal::{is_increasing, median_high};
use super::thresholds::{IMPORT, TIMES};
use super::{Conditioned, Settings};

/// Holds the last value in the empty cells, if the sensors with empty cells are written on change; of an input as well,
/// if its successive values differ.
pub(super) fn hold(work: &mut Conditioned, settings: &Settings) {
    let t = &work.channels.t;
    if !settings.rows || !is_increasing(t) {
        return;
    }
    let share = |v: &[f64]| v.iter().filter(|x| x.is_nan()).count() as f64 / v.len() as f64;
    let is_sensor = |c: Channel| matches!(c, Channel::Angle(_) | Channel::Speed(_));
    let all = columns(&work.channels);
    let sparse: Vec<_> = all.iter().filter(|(_, v)| share(v) > TIMES.lost_cells).collect();
    let sensors: Vec<_> = sparse.iter().filter(|(c, _)| is_sensor(*c)).collect();
    let rest = || sensors.iter().all(|(c, v)| is_written_on_change(*c, t, v));
    let stay = || never_stay(&sparse) && sensors.iter().all(|(_, v)| is_irregular(t, v));
    if sensors.is_empty() || !rest() && !stay() {
        return;
    }
    let is_held = |(c, v): &&(Channel, Vec<f64>)| share(v) > 0.0 && (is_sensor(*c) || differ(v));
    for (channel, values) in all.iter().filter(is_held) {
        put(&mut work.channels, *channel, &held(values));
        let kind = Kind::OnChange { share: share(values) };
        work.findings.push(Finding::corrected(*channel, kind, "rows", true));
    }
}

/// Whether successive values of these columns are never equal although many differ by one step only.
fn never_stay(columns: &[&(Channel, Vec<f64>)]) -> bool {
    let (mut equal, mut one_step) = (0, 0);
    for (_, values) in columns {
        let change = |[a, b]: &[usize; 2]| (values[*b] - values[*a]).abs();
        let changes: Vec<f64> = steps(values).iter().map(change).collect();
        let moved = changes.iter().copied().filter(|c| *c > 0.0);
        // half way to two steps
        let most = 1.5 * moved.fold(f64::INFINITY, f64::min);
        equal += changes.iter().filter(|c| **c == 0.0).count();
        one_step += changes.iter().filter(|c| **c > 0.0 && **c < most).count();
    }
    one_step >= TIMES.fewest_one_step && equal as f64 <= TIMES.stays * one_step as f64
}

/// Whether the times between the values of a sensor, in whose empty cells other columns have rows, are irregular.
fn is_irregular(t: &[f64], values: &[f64]) -> bool {
    let steps = steps(values);
    let length = |[a, b]: &[usize; 2]| t[*b] - t[*a];
    let usual = median_high(steps.iter().map(length));
    let is_long =
        |step: &&[usize; 2]| step[1] - step[0] > 1 && length(step) > TIMES.next_tick * usual;
    let long: f64 = steps.iter().filter(is_long).map(length).sum();
    long > TIMES.lost_cells * (t[t.len() - 1] - t[0])
}

/// The rows of each value and of the next one.
fn steps(values: &[f64]) -> Vec<[usize; 2]> {
    let written: Vec<usize> = (0..values.len()).filter(|&k| !values[k].is_nan()).collect();
    written.windows(2).map(|w| [w[0], w[1]]).collect()
}

/// Whether nearly all successive values differ.
fn differ(values: &[f64]) -> bool {
    let steps = steps(values);
    let equal = steps.iter().filter(|[a, b]| values[*a] == values[*b]).count();
    equal as f64 <= IMPORT.unchanged_written * steps.len() as f64
}

/// The last value at each row; none before the first.
fn held(values: &[f64]) -> Vec<f64> {
    let mut last = f64::NAN;
    let mut read = |x: &f64| {
        last = if x.is_nan() { last } else { *x };
        last
    };
    values.iter().map(&mut read).collect()
}

/// Whether the cells of a sensor are those of a value that is written when it changes.
fn is_written_on_change(channel: Channel, t: &[f64], values: &[f64]) -> bool {
    let steps = steps(values);
    let near: Vec<[usize; 2]> = steps.iter().copied().filter(|[a, b]| b - a == 1).collect();
    if steps.len() < TIMES.fewest_changes || 2 * near.len() < steps.len() || !differ(values) {
        return false;
    }
    let usual = median_high(near.iter().map(|[a, b]| t[*b] - t[*a]));
    let is_long = |[a, b]: &&[usize; 2]| b - a > 1 && t[*b] - t[*a] > IMPORT.unchanged_rows * usual;
    let long: Vec<&[usize; 2]> = steps.iter().filter(is_long).collect();
    // of a robot at rest the logger writes few rows
    let without = |[a, b]: &[usize; 2]| if b - a > 1 { t[*b] - t[*a] - usual } else { 0.0 };
    let empty: f64 = steps.iter().map(without).sum();
    let rest: f64 = long.iter().map(|step| without(step)).sum();
    let most = near.iter().map(|[a, b]| (values[*b] - values[*a]).abs()).fold(0.0, f64::max);
    let top = values.iter().filter(|v| !v.is_nan()).fold(0.0, |top: f64, v| top.max(v.abs()));
    // a counter that is set to zero does not go on
    let goes_on =
        |[a, b]: &[usize; 2]| (values[*b] - values[*a]).abs() <= most || values[*b] == 0.0;
    let rests = |step: &[usize; 2]| match channel {
        Channel::Angle(_) => goes_on(step),
        Channel::Speed(_) => goes_on(step) && values[step[0]].abs() <= TIMES.rests_below * top,
        _ => false,
    };
    // rows of other messages leave cells without a value, and no time
    !long.is_empty() && 2.0 * rest > empty && long.iter().all(|step| rests(step))
}

#[cfg(test)]
mod tests {
    use super::super::{Context, condition};
    use super::*;
    use crate::recording::Channels;

    /// A run of two seconds between two rests, of which a logger at 50 Hz writes the cells that `is_written`.
    fn log(is_written: impl Fn(usize) -> bool) -> (Channels, Channels) {
        let t: Vec<f64> = (0..250).map(|k| 0.02 * f64::from(k)).collect();
        let moving = |t: f64| if (1.5..3.5).contains(&t) { t - 1.5 } else { 0.0 };
        let phase = |t: f64| std::f64::consts::PI * moving(t);
        let angle =
            |t: f64| if t < 3.5 { phase(t) - phase(t).sin() } else { std::f64::consts::TAU };
        let of = |t: f64| [angle(t), 3.0 * (1.0 - phase(t).cos()), 2.0 * phase(t).sin()];
        let rows: Vec<[f64; 3]> = t.iter().map(|t| of(*t)).collect();
        let empty: Vec<[f64; 3]> = (0..rows.len())
            .map(|k| {
                let all = k == 0 || is_written(k);
                std::array::from_fn(|i| {
                    if k == 0 || all && rows[k][i] != rows[k - 1][i] {
                        rows[k][i]
                    } else {
                        f64::NAN
                    }
                })
            })
            .collect();
        let channels = |rows: &[[f64; 3]]| Channels {
            t: t.clone(),
            alpha: Some(rows.iter().map(|r| [r[0]; 2]).collect()),
            omega: Some(rows.iter().map(|r| [r[1]; 2]).collect()),
            torque: rows.iter().map(|r| [r[2]; 2]).collect(),
        };
        (channels(&rows), channels(&empty))
    }

    fn done(channels: Channels) -> Conditioned {
        let context = Context { commanded: true, ..Context::default() };
        condition(channels, &Settings::default(), &context).unwrap()
    }

    fn is_held(done: &Conditioned) -> bool {
        done.findings.iter().any(|f| matches!(f.kind, Kind::OnChange { .. }))
    }

    #[test]
    fn empty_cells_of_values_that_rest_mean_the_last_value() {
        let (whole, empty) = log(|_| true);
        let done = done(empty);
        assert!(is_held(&done), "{:?}", done.findings);
        assert_eq!(done.channels.t.len(), 250, "{:?}", done.findings);
        let pairs = done.channels.alpha.iter().flatten().zip(whole.alpha.iter().flatten());
        assert!(pairs.flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).all(|d| d.abs() < 1e-12));
    }

    #[test]
    fn few_rows_at_rest_and_speeds_that_repeat_at_stamps_that_scatter_are_written_on_change() {
        // ten rows per second to a millisecond, and none while nothing changes; a speed that stays for three rows
        let t: Vec<f64> = [0.0, 5.663, 6.365]
            .into_iter()
            .chain((0..18).map(|k| 6.465 + 0.1 * f64::from(k) + if k == 10 { 1e-3 } else { 0.0 }))
            .collect();
        let moving = |k: usize| if k < 3 { 0.0 } else { t[k] - 6.4 };
        let written = |k: usize| k == 0 || k > 2 && ![11, 12, 14, 15, 17].contains(&k);
        let speed = |k: usize| (40.0 * (1.0 - (-moving(k) / 0.4).exp())).round() / 2.0;
        let cell = |value: f64, is: bool| if is { value } else { f64::NAN };
        let rows = 0..t.len();
        let alpha = rows.clone().map(|k| [cell(8.0 * moving(k).powi(2), k == 0 || k > 2); 2]);
        let omega = rows.clone().map(|k| [cell(speed(k), written(k)); 2]);
        let torque = rows.map(|k| [if k < 2 { 0.0 } else { 3.0 + 0.01 * k as f64 }; 2]);
        let channels = Channels {
            alpha: Some(alpha.collect()),
            omega: Some(omega.collect()),
            torque: torque.collect(),
            t: t.clone(),
        };
        let done = done(channels);
        assert!(is_held(&done), "{:?}", done.findings);
        assert_eq!(done.channels.t.len(), t.len());
        // three rows later by 301 ms
        assert!(t[13] - t[10] > 0.3);
    }

    /// A run at 50 Hz with sensors and inputs of this step, and the same with empty cells where `is_empty`, of the row
    /// and whether the value repeats that of the row before.
    fn coarse(step: f64, is_empty: impl Fn(usize, bool) -> bool) -> (Channels, Channels) {
        let t: Vec<f64> = (0..1500).map(|k| 0.02 * f64::from(k)).collect();
        let moving = |t: f64| (t - 2.0).clamp(0.0, 20.0);
        let speed = |t: f64, i: usize| 5.0 * (0.3 * moving(t) * (1.0 + 0.2 * i as f64)).sin();
        let rounded = |x: f64| (x / step).round() * step;
        let rows = |of: &dyn Fn(f64, usize) -> f64| -> Vec<[f64; 2]> {
            t.iter().map(|t| [0, 1].map(|i| rounded(of(*t, i)))).collect()
        };
        let omega = rows(&speed);
        let torque = rows(&|t, i| 0.8 * speed(t + 0.1, i));
        let written = |v: &[[f64; 2]]| -> Vec<[f64; 2]> {
            let cell = |k: usize, i: usize| {
                let empty = k > 0 && is_empty(k + i, v[k][i] == v[k - 1][i]);
                if empty { f64::NAN } else { v[k][i] }
            };
            (0..v.len()).map(|k| [0, 1].map(|i| cell(k, i))).collect()
        };
        let of = |omega: Vec<[f64; 2]>, torque| Channels {
            t: t.clone(),
            alpha: None,
            omega: Some(omega),
            torque,
        };
        let empty = of(written(&omega), written(&torque));
        (of(omega, torque), empty)
    }

    #[test]
    fn coarse_values_that_stay_in_motion_are_not_written() {
        // a new value in one of six rows, and in nearly all
        for step in [0.2, 0.001] {
            let (whole, empty) = coarse(step, |_, repeats| repeats);
            let (full, held) = (done(whole), done(empty));
            assert!(is_held(&held), "{:?}", held.findings);
            assert_eq!(held.channels.t, full.channels.t);
            assert_eq!(held.channels.omega, full.channels.omega);
            assert_eq!(held.channels.torque, full.channels.torque);
        }
    }

    #[test]
    fn coarse_values_of_lost_or_seldom_rows_are_not_written_on_change() {
        for is_lost in [|k: usize| k * 7919 % 100 < 30, |k: usize| !k.is_multiple_of(3)] {
            let (_, empty) = coarse(0.2, |k, _| is_lost(k));
            assert!(!is_held(&done(empty)));
        }
    }

    #[test]
    fn samples_that_are_lost_in_motion_are_no_rest() {
        let (_, lost) = log(|k| !(110..125).contains(&k));
        assert!(!is_held(&done(lost)));
        // a sensor with a rate of its own
        let (_, slow) = log(|k| k.is_multiple_of(3));
        assert!(!is_held(&done(slow)));
    }
}
