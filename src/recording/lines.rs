//! Linear interpolation of sensors that are slower than the rows, for filters.

use std::borrow::Cow;

use super::Recording;
use crate::math::{interpolate_wheels, median_high};

impl Recording {
    /// Number of rows per new value of the sensors.
    #[must_use]
    pub fn rows_per_refresh(&self) -> usize {
        let fresh = self.fresh().iter().filter(|fresh| **fresh).count().max(1);
        ((self.fresh().len() as f64 / fresh as f64).round() as usize).max(1)
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
    let fresh = r.fresh();
    if fresh.iter().all(|fresh| *fresh) {
        return Cow::Borrowed(signal);
    }
    let mut out = signal.to_vec();
    let rows: Vec<usize> = (0..fresh.len()).filter(|&k| fresh[k]).collect();
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
