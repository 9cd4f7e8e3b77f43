//! Columns in which a logger writes a cell only when the value changes (Shuffleboard, NetworkTables): an empty cell then
//! means the value before it, and no lost sample.
//!
//! ```text
//! values          successive ones differ, since equal ones are not written
//! motion          most values are in successive rows: the column has no slower rate of its own
//! rest            most of the time without a value is in long stretches; behind one the value goes on from that before it,
//!                 as after lost samples of a moving wheel it does not
//! ```

use super::cells::{columns, put};
use super::finding::{Channel, Finding, Kind};
use super::signal::{is_increasing, median_high};
use super::thresholds::{IMPORT, TIMES};
use super::{Conditioned, Settings};

/// Holds the last value in the empty cells, if each sensor with empty cells is written on change; of an input as well,
/// if its successive values differ.
pub(super) fn hold(work: &mut Conditioned, settings: &Settings) {
    let t = &work.channels.t;
    if !settings.rows || !is_increasing(t) {
        return;
    }
    let share = |v: &[f64]| v.iter().filter(|x| x.is_nan()).count() as f64 / v.len() as f64;
    let is_sensor = |c: Channel| matches!(c, Channel::Angle(_) | Channel::Speed(_));
    let all = columns(&work.channels);
    let mut sensors =
        all.iter().filter(|(c, v)| is_sensor(*c) && share(v) > TIMES.lost_cells).peekable();
    if sensors.peek().is_none() || !sensors.all(|(c, v)| is_written_on_change(*c, t, v)) {
        return;
    }
    let is_held = |(c, v): &&(Channel, Vec<f64>)| share(v) > 0.0 && (is_sensor(*c) || differ(v));
    for (channel, values) in all.iter().filter(is_held) {
        put(&mut work.channels, *channel, &held(values));
        let kind = Kind::OnChange { share: share(values) };
        work.findings.push(Finding::corrected(*channel, kind, "rows", true));
    }
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

    #[test]
    fn samples_that_are_lost_in_motion_are_no_rest() {
        let (_, lost) = log(|k| !(110..125).contains(&k));
        assert!(!is_held(&done(lost)));
        // a sensor with a rate of its own
        let (_, slow) = log(|k| k.is_multiple_of(3));
        assert!(!is_held(&done(slow)));
    }
}
