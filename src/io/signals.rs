//! Signals with separate time stamps, and their combination into rows.

mod one_loop;

use std::collections::HashMap;
use std::path::Path;

use polars::prelude::{DataFrame, NamedFrom, Series};

use self::one_loop::at_rows;
use super::IoError;
use super::error::{format_error, shown};

/// Share of the values of another signal from which on a sensor has as many: a log begins and ends within a cycle, and a
/// few messages are lost (judgement).
const AS_MANY: f64 = 0.99;

/// A signal with its own time stamps.
#[derive(Clone, Debug, Default, PartialEq)]
struct Signal {
    name: String,
    samples: Vec<(i64, f64)>,
}

/// The signals of a log.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Signals {
    /// Name of the column that holds the time of the rows.
    time: String,
    /// Ticks of the stamps in a second.
    per_second: f64,
    list: Vec<Signal>,
}

/// Signals that are being collected, in the order in which their names come up.
#[derive(Debug, Default)]
pub(super) struct Collector {
    list: Vec<Signal>,
    places: HashMap<String, usize>,
}

impl Collector {
    /// The place of the signal of that name.
    pub(super) fn place(&mut self, name: &str) -> usize {
        if let Some(place) = self.places.get(name) {
            return *place;
        }
        self.list.push(Signal { name: name.into(), samples: vec![] });
        self.places.insert(name.into(), self.list.len() - 1);
        self.list.len() - 1
    }

    pub(super) fn push(&mut self, place: usize, stamp: i64, value: f64) {
        self.list[place].samples.push((stamp, value));
    }

    /// Takes over the signals of another, with a prefix to their names and new stamps.
    pub(super) fn absorb(&mut self, other: Self, prefix: &str, stamp: impl Fn(i64) -> i64) {
        for signal in other.list {
            let place = self.place(&format!("{prefix}{}", signal.name));
            let samples = signal.samples.into_iter().map(|(at, value)| (stamp(at), value));
            self.list[place].samples.extend(samples);
        }
    }

    /// The collected signals in order of time, without those that contain no number.
    pub(super) fn finish(self, per_second: f64) -> Signals {
        let mut list = self.list;
        list.retain(|s| s.samples.iter().any(|(_, x)| !x.is_nan()));
        for signal in &mut list {
            signal.samples.sort_by_key(|(stamp, _)| *stamp);
            // of several values at one time the last counts
            signal.samples.reverse();
            signal.samples.dedup_by_key(|(stamp, _)| *stamp);
            signal.samples.reverse();
        }
        // an entry of the log may have taken the name
        let taken = |name: &str| list.iter().any(|s| s.name == name);
        let time = if taken("t") { "timestamp" } else { "t" };
        Signals { time: time.into(), per_second, list }
    }
}

impl Signals {
    pub(super) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Names of the columns: the time first.
    pub(super) fn names(&self) -> Vec<String> {
        let names = self.list.iter().map(|s| s.name.clone());
        std::iter::once(self.time.clone()).chain(names).collect()
    }

    /// Every signal with its own values; the time is that of the signal with the most values.
    pub(super) fn all(self) -> Vec<(String, Vec<f64>)> {
        let busiest = self.list.iter().max_by_key(|s| s.samples.len());
        let stamps = busiest.map_or(vec![], |s| s.samples.iter().map(|(at, _)| *at).collect());
        let start = stamps.first().copied().unwrap_or(0_i64);
        let second = |at: &i64| (i128::from(*at) - i128::from(start)) as f64 / self.per_second;
        let time = (self.time.clone(), stamps.iter().map(second).collect());
        let values = |s: Signal| (s.name, s.samples.into_iter().map(|(_, x)| x).collect());
        std::iter::once(time).chain(self.list.into_iter().map(values)).collect()
    }

    /// The columns of those names in rows: one at each stamp of the signal among them that has the most ([`of_rows`]),
    /// from the first at which all have a value. Values that one loop writes shortly after one another are of one row; other signals
    /// hold their last value ([`one_loop`]).
    ///
    /// ```text
    /// t = (stamp - first stamp) / ticks per second        [s]
    /// ```
    pub(super) fn frame(
        &self,
        path: &Path,
        names: &[String],
        is_sensor: impl Fn(&str) -> bool,
    ) -> Result<DataFrame, IoError> {
        let wanted: Vec<&Signal> = self.list.iter().filter(|s| names.contains(&s.name)).collect();
        let most = of_rows(&wanted, &is_sensor);
        let rows: Vec<i64> = most.map_or(vec![], |s| s.samples.iter().map(|(at, _)| *at).collect());
        let values = wanted.iter().map(|s| at_rows(&s.samples, &rows, is_sensor(&s.name)));
        let values: Vec<Vec<Option<f64>>> = values.collect();
        let begun = values.iter().map(|v| v.iter().take_while(|x| x.is_none()).count());
        let first = begun.max().unwrap_or(0);
        if let Some(most) = most.filter(|_| first == rows.len()) {
            return Err(apart(path, most, &wanted));
        }
        let second = |at: &i64| (i128::from(*at) - i128::from(rows[first])) as f64;
        let t = rows[first..].iter().map(|at| second(at) / self.per_second).collect();
        let columns = wanted.iter().zip(&values);
        let columns =
            columns.map(|(s, v)| (s.name.as_str(), v[first..].iter().copied().flatten().collect()));
        let time = std::iter::once((self.time.as_str(), t));
        frame(path, time.chain(columns).filter(|(name, _)| names.iter().any(|n| n == name)))
    }
}

/// The signal at whose stamps the rows are: the one with the most values, or a sensor with as many, of which no value
/// between its stamps is needed then; of several the first.
fn of_rows<'a>(wanted: &[&'a Signal], is_sensor: impl Fn(&str) -> bool) -> Option<&'a Signal> {
    let most = wanted.iter().map(|s| s.samples.len()).max()?;
    let as_many = |s: &&&'a Signal| s.samples.len() as f64 >= AS_MANY * most as f64;
    let sensor = wanted.iter().filter(as_many).find(|s| is_sensor(&s.name));
    sensor.or_else(|| wanted.iter().find(|s| s.samples.len() == most)).copied()
}

/// That one of the signals begins after the last row.
fn apart(path: &Path, rows: &Signal, wanted: &[&Signal]) -> IoError {
    let first = |s: &&&Signal| s.samples.first().map(|(stamp, _)| *stamp);
    let late = wanted.iter().max_by_key(first).map_or(&rows.name, |s| &s.name);
    IoError::Apart { file: shown(path), late: late.clone(), early: rows.name.clone() }
}

/// Columns of one length as a frame.
pub(super) fn frame<'a>(
    path: &Path,
    columns: impl Iterator<Item = (&'a str, Vec<f64>)>,
) -> Result<DataFrame, IoError> {
    let series: Vec<_> =
        columns.map(|(name, values)| Series::new(name.into(), values).into()).collect();
    let height = series.first().map_or(0, polars::prelude::Column::len);
    DataFrame::new(height, series).map_err(|e| format_error(path, "table", &e))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(signals: &Signals, names: &[&str]) -> Result<Vec<Vec<f64>>, String> {
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        let frame =
            signals.frame(Path::new("x.wpilog"), &names, |_| true).map_err(|e| e.to_string())?;
        let values =
            |n: &String| frame.column(n).unwrap().f64().unwrap().iter().flatten().collect();
        Ok(names.iter().map(values).collect())
    }

    fn collected(samples: &[(&str, i64, f64)]) -> Signals {
        let mut all = Collector::default();
        for (name, stamp, value) in samples {
            let place = all.place(name);
            all.push(place, *stamp, *value);
        }
        all.finish(10.0)
    }

    #[test]
    fn rows_follow_the_busiest_of_the_named_signals_and_the_others_are_held() {
        let signals = collected(&[
            ("busy", 0, 9.0),
            ("b", 1, 1.0),
            ("a", 2, 7.0),
            ("b", 5, 3.0),
            ("b", 3, 2.0),
            ("a", 4, 8.0),
            ("b", 5, 4.0),
            ("busy", 1, 9.0),
            ("busy", 2, 9.0),
            ("busy", 3, 9.0),
        ]);
        // b has stamps 1, 3, 5; a begins at 2; of the two values at 5 the later counts
        let rows = columns(&signals, &["t", "a", "b"]).unwrap();
        assert_eq!(rows, [vec![0.0, 0.2], vec![7.0, 8.0], vec![2.0, 4.0]]);
        assert_eq!(signals.names(), ["t", "busy", "b", "a"]);
    }

    #[test]
    fn what_one_loop_writes_after_one_another_is_of_one_row() {
        let mut all = Collector::default();
        for k in 0..100 {
            for (i, name) in ["input", "speed"].iter().enumerate() {
                let place = all.place(name);
                all.push(place, 1000 * k + 20 * i as i64, k as f64);
            }
        }
        let rows = columns(&all.finish(1e6), &["t", "input", "speed"]).unwrap();
        assert_eq!(rows[1], rows[2]);
        assert!(rows[1].len() == 100 && rows[0][99] == 0.099);
    }

    #[test]
    fn signals_that_never_meet_are_named() {
        let signals = collected(&[("a", 0, 1.0), ("a", 1, 1.0), ("b", 9, 1.0)]);
        let e = columns(&signals, &["a", "b"]).unwrap_err();
        assert!(e.contains("`b` begins after the last value of `a`"), "{e}");
    }

    #[test]
    fn an_entry_called_t_keeps_its_name_and_signals_without_a_number_are_left_out() {
        let signals = collected(&[("t", 0, 5.0), ("effort", 0, f64::NAN), ("x", -4, 1.0)]);
        assert_eq!(signals.names(), ["timestamp", "t", "x"]);
        assert_eq!(columns(&signals, &["timestamp", "t"]).unwrap(), [[0.0], [5.0]]);
    }

    #[test]
    fn stamps_at_both_ends_of_their_range_make_no_overflow() {
        let signals = collected(&[("a", i64::MIN, 1.0), ("a", i64::MAX, 2.0)]);
        let rows = columns(&signals, &["t", "a"]).unwrap();
        // 2^64 ticks, ten in a second
        assert_eq!(rows[0], [0.0, 18_446_744_073_709_551_615.0 / 10.0]);
    }
}
