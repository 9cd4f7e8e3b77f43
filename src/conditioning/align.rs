//! Channels with separate sampling times, resampled to the rows of the fastest sensor.
//!
//! A log that merges messages has a row for each, with only the columns of that message; a log at a fixed rate
//! repeats the last value of slower channels. In either case a column has values only in some rows, its
//! samples:
//!
//! ```text
//! rows           those in which the sensor with the most samples has one, or a slower one, or a measured input with
//!                fewer
//! other sensors  the line between the samples around the row, and a measured input as well
//! a command      the last sample: it holds until the next, which a controller may write shortly after the sensors of
//!                its cycle
//! ```
//! Between its samples a measured input is unknown, so rows are not added there. Interpolated values would be counted
//! as measurements: angles with fewer samples than the speeds are discarded, and vice versa; if one wheel has fewer
//! samples, its rows are those of the recording.

use super::angles;
use super::cells::{column, keep, put};
use super::counterpart;
use super::finding::{Channel, Finding, Kind};
use super::signal::{changes, is_increasing, median_high};
use super::thresholds::{ANGLES, INPUTS, TIMES};
use super::{Conditioned, Context, Settings};
use crate::math::interpolate;
use crate::recording::{Channels, REGULAR, refreshed};

/// The sensors that have fewer samples than the others of the same wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlowPair {
    /// Those of the angles.
    Angles,
    /// Those of the speeds.
    Speeds,
}

/// The sensors that some recordings of one log show to be slower, all of them the same ones.
pub fn common_slow_pair<'a>(recordings: impl Iterator<Item = &'a [Finding]>) -> Option<SlowPair> {
    let mut shown = recordings.flatten().filter_map(|f| match (f.kind, f.channel) {
        (Kind::SlowPair { .. }, Channel::Angle(_)) => Some(SlowPair::Angles),
        (Kind::SlowPair { .. }, Channel::Speed(_)) => Some(SlowPair::Speeds),
        _ => None,
    });
    let first = shown.next()?;
    shown.all(|other| other == first).then_some(first)
}

/// A channel, and in which rows it has a sample.
pub(super) type Cells = (Channel, Vec<bool>);

/// Discards the angles, or the speeds, if they have fewer samples than the other, or if they are known to have fewer
/// in other recordings of the log; returns the remaining cells.
///
/// A coarse sensor has a sample in every row, most of which repeat the last value: the other pair must have fewer samples
/// and fewer new values too.
pub(super) fn without_slow_pair(
    work: &mut Conditioned,
    cells: Vec<Cells>,
    settings: &Settings,
    context: &Context,
) -> Vec<Cells> {
    let known = context.slow_pair;
    let of = |kind: fn(usize) -> Channel| {
        let of_kind = |c: &&Cells| [kind(0), kind(1)].contains(&c.0);
        cells.iter().filter(of_kind).map(|(_, own)| own.iter().filter(|o| **o).count()).min()
    };
    let (Some(angles), Some(speeds)) = (of(Channel::Angle), of(Channel::Speed)) else {
        return cells;
    };
    let fewer = if angles < speeds { SlowPair::Angles } else { SlowPair::Speeds };
    let is_fewer = |slow: usize, other: usize| (slow as f64) < TIMES.fewer_samples * other as f64;
    let new = |kind: fn(usize) -> Channel| fewest_new_values(work, &cells, kind);
    let changes = [new(Channel::Angle), new(Channel::Speed)];
    let is_slow = match fewer {
        SlowPair::Angles => is_fewer(angles, speeds) && is_fewer(changes[0], changes[1]),
        SlowPair::Speeds => is_fewer(speeds, angles) && is_fewer(changes[1], changes[0]),
    };
    if known.is_none() && !is_slow {
        return cells;
    }
    let against = disagreement(work, &cells, settings, context);
    let (slow, kind): (_, fn(usize) -> Channel) = match known.unwrap_or(fewer) {
        SlowPair::Angles => {
            work.channels.alpha = None;
            (angles, Channel::Angle)
        }
        SlowPair::Speeds => {
            work.channels.omega = None;
            (speeds, Channel::Speed)
        }
    };
    let share = slow as f64 / work.channels.t.len() as f64;
    for channel in [kind(0), kind(1)] {
        work.findings.push(Finding::corrected(channel, Kind::SlowPair { share }, "rows", true));
    }
    work.findings.extend(against);
    cells.into_iter().filter(|c| ![kind(0), kind(1)].contains(&c.0)).collect()
}

/// The samples that differ from the one before, of the sensor of a pair that has the fewest.
fn fewest_new_values(work: &Conditioned, cells: &[Cells], kind: fn(usize) -> Channel) -> usize {
    let of_kind = cells.iter().filter(|c| [kind(0), kind(1)].contains(&c.0));
    let new = of_kind.map(|(channel, own)| {
        let values = column(&work.channels, *channel).into_iter().zip(own);
        let read: Vec<f64> = values.filter(|(_, own)| **own).map(|(value, _)| value).collect();
        changes(&read).len()
    });
    new.min().unwrap_or(0)
}

/// What the angles and the speeds show against each other, both read in the same rows: the last time that both of them
/// are there.
fn disagreement(
    work: &Conditioned,
    cells: &[Cells],
    settings: &Settings,
    context: &Context,
) -> Vec<Finding> {
    let is_sensor = |c: &&Cells| matches!(c.0, Channel::Angle(_) | Channel::Speed(_));
    let sensors: Vec<Cells> = cells.iter().filter(is_sensor).cloned().collect();
    let mut both = Conditioned { channels: work.channels.clone(), findings: vec![] };
    align(&mut both, &sensors, |_| true, true);
    if both.channels.t.len() < TIMES.fewest_rows || !is_increasing(&both.channels.t) {
        return vec![];
    }
    // rows of other messages have no input
    both.channels.torque.iter_mut().flatten().filter(|m| m.is_nan()).for_each(|m| *m = 0.0);
    angles::unwrap(&mut both, settings);
    both.findings.clear();
    let as_recorded = Settings { units: false, signs: false, ..*settings };
    counterpart::units_and_signs(&mut both, &as_recorded, context);
    both.findings
}

/// Keeps the rows in which the sensor with the most samples has one, or the measured input with fewer, and reads
/// the channels of which `is_slow` there.
pub(super) fn align(
    work: &mut Conditioned,
    cells: &[Cells],
    is_slow: impl Fn(&Cells) -> bool,
    commanded: bool,
) {
    let count = |cells: &[bool]| cells.iter().filter(|c| **c).count();
    let is_sensor = |channel: Channel| matches!(channel, Channel::Angle(_) | Channel::Speed(_));
    let sensors = || cells.iter().filter(|(channel, _)| is_sensor(*channel));
    // of equals the first
    let Some(fastest) = sensors().rev().max_by_key(|(_, cells)| count(cells)) else { return };
    let few =
        |(_, own): &&Cells| (count(own) as f64) < TIMES.fewer_samples * count(&fastest.1) as f64;
    let fastest = sensors().filter(few).min_by_key(|(_, cells)| count(cells)).unwrap_or(fastest);
    let inputs = cells.iter().filter(|c| !commanded && !is_sensor(c.0) && is_slow(c));
    let slowest = inputs.min_by_key(|(_, cells)| count(cells));
    let (base, kept) = slowest.filter(|(_, c)| count(c) < count(&fastest.1)).unwrap_or(fastest);
    let rows = work.channels.t.len();
    let share = |cells: &[bool]| count(cells) as f64 / rows as f64;
    let mut flags = kept.clone();
    for (channel, own) in cells.iter().filter(|c| is_slow(c)) {
        if own == kept {
            continue;
        }
        let is_held = !is_sensor(*channel) && commanded;
        let read = if is_held {
            held
        } else if matches!(channel, Channel::Angle(_)) {
            along_angle
        } else {
            along
        };
        let values = column(&work.channels, *channel);
        let read = read(&work.channels.t, &values, own);
        put(&mut work.channels, *channel, &read);
        // before its first and after its last sample the channel is unknown
        flags.iter_mut().zip(&read).for_each(|(flag, x)| *flag &= x.is_finite());
        let share = share(own);
        let kind = if is_held { Kind::HeldColumn { share } } else { Kind::SparseColumn { share } };
        work.findings.push(Finding::corrected(*channel, kind, "rows", true));
    }
    if count(kept) < rows {
        let kind = Kind::OwnRows { share: share(kept) };
        work.findings.push(Finding::corrected(*base, kind, "rows", true));
    }
    if count(&flags) < rows {
        keep(&mut work.channels, &flags);
    }
}

/// Reads all sensors in the rows in which that with the fewest samples has one, and holds these values until the next
/// of them. All rows stay, since the input may change in any, but for those before the first and after the last sample
/// of a sensor.
pub(super) fn read_together(work: &mut Conditioned, cells: &[Cells]) {
    let count = |cells: &[bool]| cells.iter().filter(|c| **c).count();
    let Some((_, together)) = cells.iter().min_by_key(|(_, own)| count(own)) else { return };
    let rows = work.channels.t.len();
    let mut known = vec![true; rows];
    for (channel, own) in cells.iter().filter(|(_, own)| own != together) {
        let read = if matches!(channel, Channel::Angle(_)) { along_angle } else { along };
        let t = &work.channels.t;
        let there = read(t, &column(&work.channels, *channel), own);
        let values = last_of(&there, together);
        known.iter_mut().zip(&values).for_each(|(known, x)| *known &= x.is_finite());
        put(&mut work.channels, *channel, &values);
        let kind = Kind::ReadTogether { share: count(own) as f64 / rows as f64 };
        work.findings.push(Finding::corrected(*channel, kind, "rows", true));
    }
    keep(&mut work.channels, &known);
}

/// The rows in which a channel has a new value: all, unless it changes after every so many rows.
pub(super) fn new_in(t: &[f64], values: &[f64]) -> Vec<bool> {
    let changes = changes(values);
    let runs: Vec<usize> = changes.windows(2).map(|w| w[1] - w[0]).collect();
    let usual = median_high(runs.iter().map(|r| *r as f64)) as usize;
    let alike = runs.iter().filter(|run| run.abs_diff(usual) <= 1).count();
    if usual < 2 || (alike as f64) < REGULAR * runs.len() as f64 {
        return vec![true; values.len()];
    }
    refreshed_alone(t, values)
}

/// The rows in which a sensor, a single channel, has a new value.
pub(super) fn refreshed_alone(t: &[f64], values: &[f64]) -> Vec<bool> {
    let alpha = Some(values.iter().map(|v| [*v; 2]).collect());
    refreshed(&Channels { t: t.to_vec(), alpha, omega: None, torque: vec![] })
}

/// A command: the last sample at each row, or the next one of the same cycle; none before the first.
fn held(t: &[f64], values: &[f64], own: &[bool]) -> Vec<f64> {
    let samples: Vec<usize> = (0..t.len()).filter(|&k| own[k]).collect();
    let near = INPUTS.same_cycle * median_high(samples.windows(2).map(|w| t[w[1]] - t[w[0]]));
    let last = last_of(values, own);
    let read = |k: usize| {
        let mut cycle = (k..t.len()).take_while(|&j| t[j] - t[k] < near || j == k);
        cycle.find(|&j| own[j]).map_or(last[k], |j| values[j])
    };
    (0..t.len()).map(read).collect()
}

/// The last sample at each row; none before the first.
fn last_of(values: &[f64], own: &[bool]) -> Vec<f64> {
    let mut last = f64::NAN;
    let mut read = |(value, own): (&f64, &bool)| {
        last = if *own { *value } else { last };
        last
    };
    values.iter().zip(own).map(&mut read).collect()
}

/// The line between the samples around each row; none before the first and after the last.
fn along(t: &[f64], values: &[f64], own: &[bool]) -> Vec<f64> {
    between(t, values, own, f64::INFINITY)
}

/// The same, but the sample before where an angle wraps between two samples.
fn along_angle(t: &[f64], values: &[f64], own: &[bool]) -> Vec<f64> {
    let held = || values.iter().zip(own).filter(|(_, own)| **own).map(|(v, _)| *v);
    let range = held().fold(f64::NEG_INFINITY, f64::max) - held().fold(f64::INFINITY, f64::min);
    between(t, values, own, ANGLES.wraps * range)
}

fn between(t: &[f64], values: &[f64], own: &[bool], most: f64) -> Vec<f64> {
    let mut out = vec![f64::NAN; t.len()];
    let samples: Vec<usize> = (0..t.len()).filter(|&k| own[k]).collect();
    for w in samples.windows(2) {
        let (from, to) = (w[0], w[1]);
        let (ends, rise) = ([t[from], t[to]], (values[to] - values[from]).abs());
        let is_line = t[to] > t[from] && rise <= most;
        for k in from..to {
            out[k] = if is_line {
                interpolate(ends, [values[from], values[to]], t[k])
            } else {
                values[from]
            };
        }
    }
    if let Some(&last) = samples.last() {
        out[last] = values[last];
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::condition;
    use super::*;

    /// Messages in rows of their own: sensors every 20 ms, currents every 50 ms between them.
    fn merged() -> Channels {
        let mut rows: Vec<(f64, bool)> = (0..500).map(|k| (0.02 * f64::from(k), true)).collect();
        rows.extend((0..200).map(|k| (0.05 * f64::from(k) + 0.007, false)));
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let none = [f64::NAN; 2];
        let of = |sensor: bool, value: fn(f64) -> f64| {
            let cell =
                |(t, s): &(f64, bool)| if *s == sensor { [value(*t), -value(*t)] } else { none };
            rows.iter().map(cell).collect::<Vec<_>>()
        };
        Channels {
            t: rows.iter().map(|(t, _)| *t).collect(),
            alpha: Some(of(true, |t| 4.0 * (1.0 - t.cos()))),
            omega: Some(of(true, |t| 4.0 * t.sin())),
            torque: of(false, |t| 0.1 * t.cos()),
        }
    }

    #[test]
    fn rows_of_other_messages_do_not_repeat_the_sensors() {
        let done = condition(merged(), &Settings::default(), &Context::default()).unwrap();
        let c = &done.channels;
        assert!(c.t.windows(2).all(|w| (w[1] - w[0] - 0.05).abs() < 1e-9), "{:?}", done.findings);
        for (k, t) in c.t.iter().enumerate() {
            assert!((c.torque[k][1] + 0.1 * t.cos()).abs() < 1e-12);
            // a chord of 20 ms: 4 h^2/8
            assert!((c.omega.as_ref().unwrap()[k][0] - 4.0 * t.sin()).abs() < 2.1e-4);
        }
        // a command holds until the next, and is known in every row
        let commanded = Context { commanded: true, ..Context::default() };
        let c = condition(merged(), &Settings::default(), &commanded).unwrap().channels;
        assert!(c.t.windows(2).all(|w| (w[1] - w[0] - 0.02).abs() < 1e-9));
        let off = |k: usize| (c.omega.as_ref().unwrap()[k][0] - 4.0 * c.t[k].sin()).abs();
        assert!((0..c.t.len()).all(|k| off(k) < 1e-12));
        let last = |t: f64| 0.05 * ((t - 0.007) / 0.05).floor() + 0.007;
        let off = |k: usize| (c.torque[k][0] - 0.1 * last(c.t[k] + 1e-9).cos()).abs();
        assert!((0..c.t.len()).all(|k| off(k) < 1e-12));
    }

    #[test]
    fn a_command_that_is_written_after_the_sensors_is_of_their_cycle() {
        let value = |cycle: usize| (0.3 * cycle as f64).sin();
        let cycles =
            (0..500).flat_map(|k| [(0.02 * k as f64, None), (0.02 * k as f64 + 2e-4, Some(k))]);
        let rows: Vec<(f64, Option<usize>)> = cycles.collect();
        let channels = Channels {
            t: rows.iter().map(|row| row.0).collect(),
            alpha: None,
            omega: Some(rows.iter().map(|(t, k)| [k.map_or(t.sin(), |_| f64::NAN); 2]).collect()),
            torque: rows.iter().map(|(_, k)| [k.map_or(f64::NAN, value); 2]).collect(),
        };
        let commanded = Context { commanded: true, ..Context::default() };
        let c = condition(channels, &Settings::default(), &commanded).unwrap().channels;
        assert_eq!(c.t.len(), 500);
        assert!((0..500).all(|k| c.torque[k] == [value(k); 2]));
    }

    #[test]
    fn wheels_that_are_read_in_turn_stand_at_the_same_times() {
        let t: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let speed = |t: f64| [4.0 * t.sin(), 3.0 * (0.7 * t).cos()];
        let mut omega: Vec<[f64; 2]> = t.iter().map(|t| speed(*t)).collect();
        for k in 1..t.len() {
            omega[k][k % 2] = omega[k - 1][k % 2];
        }
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [t.cos(), t.sin()]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
        let (t, omega) = (&done.channels.t, done.channels.omega.as_ref().unwrap());
        assert!((3995..=4000).contains(&omega.len()), "{:?}", done.findings);
        let fresh = refreshed(&done.channels);
        let read: Vec<usize> = (2..t.len()).filter(|&k| fresh[k]).collect();
        assert!((1990..=2001).contains(&read.len()), "{}", read.len());
        for k in read {
            // a chord of 10 ms: 4 h^2/8
            assert!((0..2).all(|i| (omega[k][i] - speed(t[k])[i]).abs() < 6e-5), "{k}");
        }
        // sensors of 20 ms in different rows of 1 ms change in the same rows
        let t: Vec<f64> = (0..12_000).map(|k| 0.001 * k as f64).collect();
        let read = |k: usize, row: usize| 0.001 * ((k + 20 - row) / 20 * 20 + row) as f64 - 0.02;
        let omega = (0..t.len()).map(|k| [speed(read(k, 3))[0], speed(read(k, 17))[1]]).collect();
        let torque = t.iter().map(|t| [t.cos(), t.sin()]).collect();
        let channels = Channels { t, alpha: None, omega: Some(omega), torque };
        let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
        let omega = done.channels.omega.as_ref().unwrap();
        let changes = |i: usize| (1..omega.len()).filter(move |&k| omega[k][i] != omega[k - 1][i]);
        assert!(changes(0).eq(changes(1)), "{:?}", done.findings);
        assert!((595..=601).contains(&changes(0).count()));
        // both wheels in the same rows: that is the refresh of the rows
        let t: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let slow: Vec<[f64; 2]> = (0..4000).map(|k| speed(0.005 * f64::from(k - k % 2))).collect();
        let torque: Vec<[f64; 2]> = t.iter().map(|t| [t.cos(), t.sin()]).collect();
        let channels = Channels { t, alpha: None, omega: Some(slow), torque };
        let done = condition(channels, &Settings::default(), &Context::default()).unwrap();
        assert_eq!(done.channels.t.len(), 4000);
    }
}
