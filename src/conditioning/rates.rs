//! Sensors of the same log that refresh at different rates, where a logger repeats their last values.
//!
//! If only one of them has a new value in a row, the repeated value of the other would be counted as a measurement.
//! Angles that refresh less often than the speeds are left out, and vice versa. The other sensors are read in the rows
//! of the slowest one. If they differ in their rates, and the input is measured, the other rows are removed; a command
//! may change in any row.

use super::align::{Cells, align, new_in, read_together, refreshed_alone, without_slow_pair};
use super::cells::columns;
use super::finding::Channel;
use super::signal::{changes, median_high};
use super::thresholds::TIMES;
use super::{Conditioned, Context, Settings};

/// Leaves out slower sensors, and reads the others in the rows of the slowest.
pub(super) fn alike(work: &mut Conditioned, settings: &Settings, context: &Context) {
    let is_sensor = |c: Channel| matches!(c, Channel::Angle(_) | Channel::Speed(_));
    let sensors = columns(&work.channels).into_iter().filter(|(channel, _)| is_sensor(*channel));
    let cells: Vec<Cells> = sensors.map(|(c, v)| (c, samples(&work.channels.t, &v))).collect();
    if !settings.rows {
        return;
    }
    let cells = without_slow_pair(work, cells, settings, context);
    let alike = are_alike(&cells);
    if !alike && !context.commanded {
        align(work, &cells, |_| true, context.commanded);
    } else if !alike || are_read_in_turn(&cells) {
        read_together(work, &cells);
    }
}

/// Whether sensors of about the same rate are read in different rows: in most rows with a new value of one of them
/// another one repeats its last.
fn are_read_in_turn(cells: &[Cells]) -> bool {
    let count =
        |of: &dyn Fn(usize) -> bool| (0..cells[0].1.len()).filter(|&k| of(k)).count() as f64;
    let in_turn = |(first, second): (&[bool], &[bool])| {
        let rates = count(&|k| first[k]) / count(&|k| second[k]);
        let apart = count(&|k| first[k] != second[k]);
        apart > count(&|k| first[k] && second[k])
            && (TIMES.same_rate..=1.0 / TIMES.same_rate).contains(&rates)
    };
    cells.iter().skip(1).any(|(_, other)| in_turn((&cells[0].1, other)))
}

/// The rows in which a sensor has measured: those in which it changes, and where it does not for longer than usual, at
/// rest, as many rows after one another.
fn samples(t: &[f64], values: &[f64]) -> Vec<bool> {
    let new = new_in(t, values);
    if new.iter().all(|new| *new) {
        // changes of a slow sensor are irregular if its filter repeats some values
        return refreshed_alone(t, values);
    }
    let changes = changes(values);
    let every = usual(&changes).max(1);
    let mut out = vec![false; values.len()];
    let ends = changes.iter().skip(1).copied().chain([values.len()]);
    for (&from, to) in changes.iter().zip(ends) {
        // the last of them may come a row early
        (from..to).step_by(every).filter(|k| *k == from || k + 1 < to).for_each(|k| out[k] = true);
    }
    out
}

/// Median number of rows between new values.
fn usual(rows: &[usize]) -> usize {
    median_high(rows.windows(2).map(|w| (w[1] - w[0]) as f64)) as usize
}

/// Whether sensors have the same median number of rows between new values.
fn are_alike(cells: &[Cells]) -> bool {
    let every = |(_, own): &Cells| {
        let rows: Vec<usize> = (0..own.len()).filter(|&k| own[k]).collect();
        usual(&rows)
    };
    cells.windows(2).all(|pair| every(&pair[0]) == every(&pair[1]))
}

#[cfg(test)]
mod tests {
    use super::super::finding::Kind;
    use super::super::{SlowPair, condition};
    use super::*;
    use crate::recording::Channels;

    /// Rows of 5 ms with sensors that refresh after so many of them.
    fn log(every: [usize; 4]) -> Channels {
        let t: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let read = |k: usize, n: usize| t[k - k % every[n]];
        let angle = |t: f64| [4.0 * (1.0 - t.cos()), 3.0 * (0.7 * t).sin() / 0.7];
        let speed = |t: f64| [4.0 * t.sin(), 3.0 * (0.7 * t).cos()];
        let rows = 0..t.len();
        let alpha = rows.clone().map(|k| [angle(read(k, 0))[0], angle(read(k, 1))[1]]).collect();
        let omega = rows.map(|k| [speed(read(k, 2))[0], speed(read(k, 3))[1]]).collect();
        let torque = t.iter().map(|t| [t.cos(), t.sin()]).collect();
        Channels { alpha: Some(alpha), omega: Some(omega), torque, t }
    }

    #[test]
    fn sensors_of_four_rates_stand_at_the_times_of_the_slowest() {
        let done =
            |every| condition(log(every), &Settings::default(), &Context::default()).unwrap();
        let found = done([4, 6, 6, 6]);
        let (t, omega) = (&found.channels.t, found.channels.omega.as_ref().unwrap());
        assert!(t.windows(2).all(|w| (w[1] - w[0] - 0.03).abs() < 1e-9), "{:?}", found.findings);
        let alpha = found.channels.alpha.as_ref().unwrap();
        for k in 0..t.len() - 2 {
            // chords of 20 ms: 4 h^2/8
            assert!((omega[k][0] - 4.0 * t[k].sin()).abs() < 4e-4);
            assert!((alpha[k][0] - 4.0 * (1.0 - t[k].cos())).abs() < 4e-4);
        }
        // speeds that come seldom add nothing to the angles
        assert!(done([1, 1, 4, 4]).channels.omega.is_none());
        assert!(done([4, 4, 1, 1]).channels.alpha.is_none());
        // all at one rate: as they are
        for every in [1, 4] {
            assert_eq!(done([every; 4]).channels.alpha, log([every; 4]).alpha);
        }
    }
    #[test]
    fn sensors_that_are_read_in_turn_stand_at_the_same_times_under_a_command() {
        // encoders of 20 ms, one a row after the other, and speeds whose filter repeats values
        let mut made = log([4, 4, 4, 4]);
        let rows = 0..made.t.len();
        let angle = |t: f64| 3.0 * (0.7 * t).sin() / 0.7;
        let later = |k: usize| if k == 0 { 0 } else { k - (k - 1) % 4 };
        let alpha = made.alpha.as_mut().unwrap();
        rows.clone().for_each(|k| alpha[k][1] = angle(0.005 * later(k) as f64));
        let omega = made.omega.as_mut().unwrap();
        let filtered = |k: usize| {
            let n = k / 4;
            4 * [n, n - n % 2, n - n % 3][(n / 6) % 3]
        };
        let read: Vec<[f64; 2]> = rows.clone().map(|k| omega[filtered(k)]).collect();
        omega.copy_from_slice(&read);
        let commanded = Context { commanded: true, ..Context::default() };
        let done = condition(made.clone(), &Settings::default(), &commanded).unwrap();
        let c = &done.channels;
        assert!(c.omega.is_none(), "{:?}", done.findings);
        assert!(c.t.len() > 3990, "{}", c.t.len());
        let alpha = c.alpha.as_ref().unwrap();
        let fresh = crate::recording::refreshed(c);
        let read: Vec<usize> = (8..c.t.len()).filter(|&k| fresh[k]).collect();
        assert!((980..=1000).contains(&read.len()), "{}", read.len());
        for k in read {
            // a chord of 20 ms: 4 h^2/8
            assert!((alpha[k][0] - 4.0 * (1.0 - c.t[k].cos())).abs() < 2.1e-4);
            assert!((alpha[k][1] - angle(c.t[k])).abs() < 2.1e-4, "{k}");
        }
        // what another recording of the log shows holds for one whose speeds look as new as the angles
        let known = Context { slow_pair: Some(SlowPair::Speeds), ..commanded };
        let alike = condition(log([4; 4]), &Settings::default(), &known).unwrap();
        assert!(alike.channels.omega.is_none());
    }

    #[test]
    fn speeds_that_change_as_often_as_the_steps_of_an_encoder_stay() {
        // 16 counts per turn, and speeds from the time between two of them
        let step = std::f64::consts::TAU / 16.0;
        let t: Vec<f64> = (0..400).map(|k| 0.015 * f64::from(k)).collect();
        let angle = |t: f64, i: usize| (12.0 + i as f64) * (t - 0.4 * (1.5 * t).sin() / 1.5);
        let rows = 0..t.len();
        let counted = |k: usize, i: usize| step * (angle(t[k], i) / step).floor();
        let alpha: Vec<[f64; 2]> = rows.map(|k| [0, 1].map(|i| counted(k, i))).collect();
        let mut omega = vec![[0.0; 2]; t.len()];
        let speed = |k: usize, i: usize| (12.0 + i as f64) * (1.0 - 0.4 * (1.5 * t[k]).cos());
        let is_new = |k: usize, i: usize| alpha[k][i] != alpha[k - 1][i];
        for k in 1..t.len() {
            let last = omega[k - 1];
            omega[k] = [0, 1].map(|i| if is_new(k, i) { 1.2 * speed(k, i) } else { last[i] });
        }
        let torque = t.iter().map(|t| [10.0 + (1.5 * t).sin(); 2]).collect();
        let made = Channels { t, alpha: Some(alpha), omega: Some(omega), torque };
        let commanded = Context { commanded: true, ..Context::default() };
        let done = condition(made.clone(), &Settings::default(), &commanded).unwrap();
        assert!(done.channels.omega.is_some() && done.channels.alpha.is_some());
        let gains = |found: &Conditioned| {
            let gains = found.findings.iter().filter_map(|f| match f.kind {
                Kind::Gain { ratio, .. } => Some(ratio),
                _ => None,
            });
            gains.collect::<Vec<_>>()
        };
        assert_eq!(gains(&done).len(), 2, "{:?}", done.findings);
        // what the two show against each other is stated where one of them is left out too
        let known = Context { slow_pair: Some(SlowPair::Speeds), ..commanded };
        let done = condition(made, &Settings::default(), &known).unwrap();
        assert!(done.channels.omega.is_none());
        let found = gains(&done);
        assert!(found.len() == 2 && found.iter().all(|r| (r - 1.2).abs() < 0.03), "{found:?}");
    }
}
