//! Sensors that refresh more slowly than the logger writes.

use super::Measured;

/// Share of repeated rows, while moving, from which on the logger repeats its sensors.
const REPEATED: f64 = 0.4;

/// Which rows hold new values. All do, unless the rows repeat the motion in more than 40 % of the
/// samples in which a wheel moves: then only rows that differ from the one before, and rows in the
/// middle of a long standstill, are new.
pub(super) fn fresh(alpha: &[[f64; 2]], omega: &[[f64; 2]], measured: Measured) -> Vec<bool> {
    let same = |k: usize| {
        k > 0
            && (!measured.alpha || alpha[k] == alpha[k - 1])
            && (!measured.omega || omega[k] == omega[k - 1])
    };
    let fastest = omega.iter().flatten().fold(0.0_f64, |a, w| a.max(w.abs()));
    let moving = |k: usize| omega[k][0].abs().max(omega[k][1].abs()) > 0.2 * fastest;
    let count = (0..omega.len()).filter(|&k| moving(k)).count();
    let repeated = (0..omega.len()).filter(|&k| moving(k) && same(k)).count();
    if (repeated as f64) < REPEATED * count as f64 {
        return vec![true; omega.len()];
    }
    let mut since = 0;
    (0..omega.len())
        .map(|k| {
            since = if same(k) { since + 1 } else { 0 };
            // a refresh is never slower than this many rows; beyond, it really stands still
            since == 0 || since % LONGEST == 0
        })
        .collect()
}

/// Most rows that one refresh can last.
const LONGEST: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: Measured = Measured { alpha: true, omega: true };

    #[test]
    fn rows_that_repeat_a_slow_sensor_are_not_new() {
        let slow = |k: usize| (k / 4) as f64;
        let alpha: Vec<[f64; 2]> = (0..100).map(|k| [slow(k), -slow(k)]).collect();
        let omega: Vec<[f64; 2]> = (0..100).map(|k| [1.0 + 0.01 * slow(k), 1.0]).collect();
        let fresh = fresh(&alpha, &omega, BOTH);
        assert_eq!(fresh.iter().filter(|f| **f).count(), 25);
        assert!(fresh[0] && fresh[4] && !fresh[5]);
    }

    #[test]
    fn a_coarse_encoder_at_full_rate_stays_as_it_is() {
        let alpha: Vec<[f64; 2]> = (0..100).map(|k| [(f64::from(k) / 4.0).floor(), 0.0]).collect();
        let omega: Vec<[f64; 2]> = (0..100).map(|k| [1.0 + 1e-3 * f64::from(k), 1.0]).collect();
        assert!(fresh(&alpha, &omega, BOTH).iter().all(|f| *f));
    }
}
