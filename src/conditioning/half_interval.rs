//! Rows in which both speeds are half of those around them: a logger whose interval for counting pulses began half a
//! row late.
//!
//! ```text
//! dip    w_k < 3/4 (w_(k-1) + w_(k+1))/2 of both wheels, which turn fast and alike in the rows around
//! half   w_k / ((w_(k-1) + w_(k+1))/2) of both wheels in (5/12, 7/12): nearer to 1/2 than to 1/3 or 2/3
//! ```
//! Wheels that slow down for a single row do so by any ratio, and not both by the same. The row contains no speed of its
//! time, and is left out.

use super::cells::keep;
use super::finding::{Channel, Finding, Kind};
use super::signal::{column, pieces, quantile};
use super::thresholds::SAMPLES;
use super::{Conditioned, Settings};
use crate::math::noise::grid;

/// Leaves out the rows with half the speed.
pub(super) fn rows(work: &mut Conditioned, settings: &Settings) {
    let found = halved(work);
    let Some(first) = found.first() else { return };
    let kind = Kind::HalfInterval { rows: found.len(), first: first + 1 };
    work.findings.push(Finding::corrected(Channel::Sensors, kind, "rows", settings.rows));
    if settings.rows {
        let kept: Vec<bool> =
            (0..work.channels.t.len()).map(|k| found.binary_search(&k).is_err()).collect();
        keep(&mut work.channels, &kept);
    }
}

/// The rows with half the speed of those around them; none if as many dip otherwise.
fn halved(work: &Conditioned) -> Vec<usize> {
    let Some(omega) = &work.channels.omega else { return vec![] };
    // a slow wheel may turn by one count in a row and by two in the next
    let least = [0, 1].map(|i| {
        let speed = column(omega, i);
        let top = quantile(speed.iter().map(|w| w.abs()), 0.99);
        (SAMPLES.dead_slow * top).max(2.0 * SAMPLES.dead_steps * grid(&speed).unwrap_or(0.0))
    });
    let ratio = |k: usize, i: usize| {
        let [before, after] = [omega[k - 1][i], omega[k + 1][i]];
        let fast = before.abs().min(after.abs()) > least[i] && before * after > 0.0;
        let alike = (before / after - 1.0).abs() < SAMPLES.around_alike;
        (fast && alike).then(|| 2.0 * omega[k][i] / (before + after))
    };
    let both = |k: usize, [low, high]: [f64; 2]| {
        (0..2).all(|i| ratio(k, i).is_some_and(|ratio| low < ratio && ratio < high))
    };
    let inner = pieces(&work.channels.t);
    let inner = inner.iter().flat_map(|p| p.start + 1..p.end.saturating_sub(1).max(p.start + 1));
    let dips: Vec<usize> = inner.filter(|&k| both(k, [f64::NEG_INFINITY, SAMPLES.dip])).collect();
    let half: Vec<usize> = dips.iter().copied().filter(|&k| both(k, SAMPLES.half)).collect();
    let is_rule = half.len() >= SAMPLES.fewest_half
        && half.len() as f64 >= SAMPLES.half_of_dips * dips.len() as f64;
    if is_rule { half } else { vec![] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channels;

    /// Speeds of about 3 rad/s, in every fourth row times `factor(row)` of each wheel.
    fn work(factor: impl Fn(usize) -> [f64; 2]) -> Conditioned {
        let t: Vec<f64> = (0..80).map(|k| f64::from(k) / 15.0).collect();
        let speed = |k: usize| {
            let by = if k % 4 == 3 { factor(k) } else { [1.0; 2] };
            let noise = 0.1 * (37.0 * (k * k) as f64).sin();
            [0, 1].map(|i| by[i] * (3.0 + noise))
        };
        let omega = Some((0..80).map(speed).collect());
        let channels = Channels { torque: vec![[2.5; 2]; 80], t, alpha: None, omega };
        Conditioned { channels, findings: vec![] }
    }

    #[test]
    fn rows_of_half_an_interval_are_left_out() {
        let mut done = work(|_| [0.5; 2]);
        rows(&mut done, &Settings::default());
        // the last row has only one neighbour
        let kind = Kind::HalfInterval { rows: 19, first: 4 };
        assert!(done.findings.iter().any(|f| f.kind == kind), "{:?}", done.findings);
        assert_eq!(done.channels.t.len(), 61);
        let mut left = work(|_| [0.5; 2]);
        rows(&mut left, &Settings { rows: false, ..Settings::default() });
        assert_eq!((left.findings.len(), left.channels.t.len()), (1, 80));
    }

    #[test]
    fn one_wheel_other_ratios_and_many_ratios_are_no_half_interval() {
        let many = |k: usize| [0.1 * (k % 7) as f64; 2];
        let factors: [&dyn Fn(usize) -> [f64; 2]; 4] =
            [&|_| [0.5, 1.0], &|_| [1.0 / 3.0; 2], &|_| [2.0 / 3.0; 2], &many];
        for factor in factors {
            let mut done = work(factor);
            rows(&mut done, &Settings::default());
            assert!(done.findings.is_empty(), "{:?}", done.findings);
        }
    }

    #[test]
    fn counts_of_a_slow_wheel_that_alternate_are_no_half_interval() {
        let mut slow = work(|_| [0.5; 2]);
        let counts = |k: usize| [if k % 4 == 3 { 1.0 } else { 2.0 }; 2];
        slow.channels.omega = Some((0..80).map(counts).collect());
        rows(&mut slow, &Settings::default());
        assert!(slow.findings.is_empty(), "{:?}", slow.findings);
    }
}
