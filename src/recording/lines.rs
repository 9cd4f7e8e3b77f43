//! Sensors that are slower than the rows: the rows with a new reading, and lines between these for filters.

use std::borrow::Cow;
use std::ops::Range;

use super::Recording;
use crate::math::{interpolate_wheels, median_high};

impl Recording {
    /// Whether the sensors gave a new value at a row; the others repeat the last one, as if measured again.
    #[must_use]
    pub fn is_reading(&self, row: usize) -> bool {
        self.fresh()[row]
    }

    /// Whether any row repeats the reading of another one.
    #[must_use]
    pub fn repeats_readings(&self) -> bool {
        self.fresh().contains(&false)
    }

    /// Number of rows with a new reading: what counts as measured. The first row is always one.
    #[must_use]
    pub fn readings(&self) -> usize {
        self.readings_in(&(0..self.len()))
    }

    /// The same of some rows, which may all repeat a reading before them.
    #[must_use]
    pub fn readings_in(&self, rows: &Range<usize>) -> usize {
        self.fresh()[rows.clone()].iter().filter(|fresh| **fresh).count()
    }

    /// Mean time from one reading to the next, with the median step of the rows \[s\].
    #[must_use]
    pub fn reading_interval(&self) -> f64 {
        self.step() * self.len() as f64 / self.readings() as f64
    }

    /// Number of rows per new value of the sensors.
    #[must_use]
    pub fn rows_per_refresh(&self) -> usize {
        ((self.len() as f64 / self.readings() as f64).round() as usize).max(1)
    }

    /// A measured signal of the wheels, interpolated linearly between new values if the sensors are slower
    /// than the rows. Filters use this signal, because repeated values would delay it by half a refresh
    /// interval.
    #[must_use]
    pub fn on_lines<'a>(&self, signal: &'a [[f64; 2]]) -> Cow<'a, [[f64; 2]]> {
        on_lines(self, signal)
    }
}

/// A signal, interpolated linearly between new values; after a standstill the line begins one refresh
/// interval before the first value in motion.
fn on_lines<'a>(r: &Recording, signal: &'a [[f64; 2]]) -> Cow<'a, [[f64; 2]]> {
    if !r.repeats_readings() {
        return Cow::Borrowed(signal);
    }
    let mut out = signal.to_vec();
    let rows: Vec<usize> = (0..r.len()).filter(|&k| r.is_reading(k)).collect();
    if rows.len() < 2 {
        return Cow::Borrowed(signal);
    }
    let period = median_high(rows.windows(2).map(|w| (w[1] - w[0]) as f64)) as usize;
    let t = r.t();
    for w in rows.windows(2) {
        if !r.piece_of(w[0]).is_some_and(|piece| piece.contains(&w[1])) {
            continue;
        }
        let from = w[0].max(w[1].saturating_sub(period));
        for k in w[0] + 1..w[1] {
            let ends = [t[from], t[w[1]]];
            out[k] = interpolate_wheels(ends, [signal[w[0]], signal[w[1]]], t[k].max(t[from]));
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit, Issue};

    #[test]
    fn rows_that_repeat_a_slow_sensor_are_no_readings() {
        // readings every 40 ms in rows of 10 ms
        let t: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let omega = |every: usize| (0..400).map(|k| [t[k - k % every].sin(), 1.0]).collect();
        let new = |every: usize| {
            let (omega, torque) = (Some(omega(every)), vec![[0.1; 2]; 400]);
            let channels = Channels { t: t.clone(), alpha: None, omega, torque };
            Recording::new("made", channels, DriveUnit::NewtonMetre).unwrap()
        };
        let slow = new(4);
        assert!(slow.repeats_readings() && slow.is_reading(0) && slow.is_reading(4));
        assert!(!slow.is_reading(3) && !slow.is_reading(5));
        assert_eq!((slow.readings(), slow.rows_per_refresh()), (100, 4));
        assert_eq!([1..4, 4..5, 3..9].map(|rows| slow.readings_in(&rows)), [0, 1, 2]);
        assert!((slow.reading_interval() - 0.04).abs() < 1e-12);
        let fast = new(1);
        assert!(!fast.repeats_readings() && fast.readings() == 400);
        assert!((fast.reading_interval() - 0.01).abs() < 1e-12);
    }

    #[test]
    fn filters_see_the_line_between_the_values_of_a_slow_sensor() {
        let t: Vec<f64> = (0..4000).map(|k| 0.005 * f64::from(k)).collect();
        let at = |t: f64| [4.0 * t + t.sin(), 3.0 * t + (0.8 * t).cos()];
        let speed = |t: f64| [4.0 + t.cos(), 3.0 - 0.8 * (0.8 * t).sin()];
        let held: Vec<usize> = (0..4000).map(|k| k - k % 10).collect();
        let channels = Channels {
            alpha: Some(held.iter().map(|&k| at(t[k])).collect()),
            omega: Some(held.iter().map(|&k| speed(t[k])).collect()),
            torque: vec![[0.1; 2]; 4000],
            t: t.clone(),
        };
        let r = Recording::new("slow", channels, DriveUnit::NewtonMetre).unwrap();
        assert_eq!(r.rows_per_refresh(), 10);
        let line = r.on_lines(r.omega());
        for k in 100..3900 {
            let is = speed(t[k]);
            // a chord over 50 ms of a unit wave: 0.05²/8
            assert!((0..2).all(|i| (line[k][i] - is[i]).abs() < 4e-4), "{k}: {:?} {is:?}", line[k]);
            let local = r.local_motion()[k].omega;
            assert!((0..2).all(|i| (local[i] - is[i]).abs() < 2e-2), "{k}: {local:?} {is:?}");
        }
        // the windows of the checks see speeds that are the slopes of their angles
        let robot = crate::robot::Robot::amigobot();
        let findings = crate::recording::quality(&r, &robot).findings;
        assert!(findings.iter().all(|f| !matches!(f.issue, Issue::Ratio { .. })), "{findings:?}");
    }
}
