//! Signals with separate time stamps, and their combination into rows.

use std::collections::HashMap;
use std::path::Path;

use polars::prelude::{DataFrame, NamedFrom, Series};

use super::IoError;
use super::error::{format_error, shown};

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

    /// The columns of those names in rows: one at each stamp of the signal among them that has the
    /// most, from the moment when all have a value. The others hold their last value.
    ///
    /// ```text
    /// t = (stamp - first stamp) / ticks per second        [s]
    /// ```
    pub(super) fn frame(&self, path: &Path, names: &[String]) -> Result<DataFrame, IoError> {
        let wanted: Vec<&Signal> = self.list.iter().filter(|s| names.contains(&s.name)).collect();
        let stamps = self.stamps(path, &wanted)?;
        let start = stamps.first().copied().unwrap_or_default();
        let second = |stamp: &i64| (i128::from(*stamp) - i128::from(start)) as f64;
        let t: Vec<f64> = stamps.iter().map(|s| second(s) / self.per_second).collect();
        let held = wanted.iter().map(|s| (s.name.as_str(), s.held(&stamps)));
        let time = std::iter::once((self.time.as_str(), t));
        frame(path, time.chain(held).filter(|(name, _)| names.iter().any(|n| n == name)))
    }

    /// The stamps of the rows.
    fn stamps(&self, path: &Path, wanted: &[&Signal]) -> Result<Vec<i64>, IoError> {
        let first = |s: &&&Signal| s.samples.first().map(|(stamp, _)| *stamp);
        let Some(late) = wanted.iter().max_by_key(first) else { return Ok(vec![]) };
        let start = first(&late).unwrap_or(i64::MAX);
        // the first of several with as many
        let most = wanted.iter().rev().max_by_key(|s| s.samples.len()).unwrap_or(late);
        let stamps = most.samples.iter().map(|(stamp, _)| *stamp).filter(|stamp| *stamp >= start);
        let stamps: Vec<i64> = stamps.collect();
        if stamps.is_empty() {
            return Err(IoError::Apart {
                file: shown(path),
                late: late.name.clone(),
                early: most.name.clone(),
            });
        }
        Ok(stamps)
    }
}

impl Signal {
    /// The last value at or before each stamp; there must be one before the first.
    fn held(&self, stamps: &[i64]) -> Vec<f64> {
        let mut k = 0;
        let last = |stamp: &i64| {
            while self.samples.get(k + 1).is_some_and(|(next, _)| next <= stamp) {
                k += 1;
            }
            self.samples[k].1
        };
        stamps.iter().map(last).collect()
    }
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
        let frame = signals.frame(Path::new("x.wpilog"), &names).map_err(|e| e.to_string())?;
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
