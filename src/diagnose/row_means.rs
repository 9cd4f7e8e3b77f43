//! Inputs of which the means over the rows are known: an input whose recorded values are such means, as by a logger that
//! averages a faster signal, and one that varies smoothly through its recorded values.

use super::spline::Spline;
use crate::math::Real;
use crate::recording::Recording;
use crate::simulate::impulse;

/// The values at the rows of an input that varies linearly between them and whose means over the rows are those that
/// were recorded, `shift` seconds later: value k is the mean from row k to the next, at `shift` = -h the one from the
/// row before. The last row lasts for `last_s`.
///
/// ```text
/// I(t)  integral of the recorded values, a cubic spline between the rows
/// m_k = (I(t_k + h - shift) - I(t_k - shift))/h
/// M_k = (22 (m_k-1 + m_k) - 7 (m_k-2 + m_k+1) + (m_k-3 + m_k+2))/32
/// (M_k + M_k+1)/2 = m_k   up to sixth differences
/// ```
/// The line through the recorded values themselves, half a row away, has a quarter of each neighbour in its mean. A held
/// mean has the right impulse, but not the right path within a row.
pub(super) fn line_with_means<T: Real>(
    t: &[f64],
    recorded: &[[T; 2]],
    shift: T,
    last_s: f64,
) -> Vec<[T; 2]> {
    let Some(times) = with_end(t, last_s) else { return vec![] };
    line_of(&times, &impulse(&times, recorded), recorded, shift)
}

/// The values at the rows of an input that varies linearly between them and whose means over the rows are those of the
/// cubic spline through the recorded values, `shift` seconds later. Of a smooth input the line through its values has a
/// twelfth of its second difference too much in the mean over a row.
pub(super) fn line_with_means_of_spline<T: Real>(
    t: &[f64],
    recorded: &[[T; 2]],
    shift: T,
    last_s: f64,
) -> Vec<[T; 2]> {
    let Some(times) = with_end(t, last_s) else { return vec![] };
    let spline = Spline::new(t, recorded);
    let means: Vec<[T; 2]> =
        (0..t.len() - 1).map(|k| spline.mean(k)).chain(recorded.last().copied()).collect();
    line_of(&times, &impulse(&times, &means), recorded, shift)
}

/// The times of the rows and of the end of the last one, which lasts for `last_s`; `None` without rows.
fn with_end(t: &[f64], last_s: f64) -> Option<Vec<f64>> {
    let last = t.last()?;
    Some(t.iter().copied().chain([last + last_s]).collect())
}

/// The line with the means of an input whose integrals from the first of `times` to each are `sums`, `shift` seconds later;
/// before the first and behind the last row the `recorded` values there hold.
fn line_of<T: Real>(times: &[f64], sums: &[[T; 2]], recorded: &[[T; 2]], shift: T) -> Vec<[T; 2]> {
    let t = &times[..times.len() - 1];
    let (first, last) = (recorded[0], recorded[recorded.len() - 1]);
    let (spline, mut row) = (Spline::new(times, sums), 0);
    let mut integral = |at: T| {
        let [begin, end] = [times[0], times[t.len()]].map(|edge| at - edge);
        let inside = spline.at(at, &mut row);
        let beyond = |of: [T; 2], by: T| [0, 1].map(|i| inside[i] + of[i] * by);
        match (begin.value() < 0.0, end.value() > 0.0) {
            (true, _) => beyond(first, begin),
            (_, true) => beyond(last, end),
            _ => inside,
        }
    };
    let at_rows: Vec<[T; 2]> = times.iter().map(|&row| integral(-shift + row)).collect();
    let means: Vec<[T; 2]> = (0..t.len())
        .map(|k| [0, 1].map(|i| (at_rows[k + 1][i] - at_rows[k][i]) / (times[k + 1] - times[k])))
        .collect();
    // the mean of the row `before` the one before row k, and its counterpart behind
    let around = |k: usize, before: usize, i: usize| {
        let last = t.len() - 1;
        means[k.saturating_sub(before + 1)][i] + means[(k + before).min(last)][i]
    };
    let value = |k: usize, i: usize| {
        (around(k, 0, i) * 22.0 - around(k, 1, i) * 7.0 + around(k, 2, i)) / 32.0
    };
    (0..t.len()).map(|k| [0, 1].map(|i| value(k, i))).collect()
}

/// A recording whose input has the recorded means over its rows, `shift` seconds later: value k is the mean from row k to
/// the next, at `shift` = -h the one from the row before.
#[must_use]
pub fn with_line_of_means(recording: &Recording, shift: f64) -> Recording {
    recording.with_interpolated_torque(|recorded| {
        let of = |piece: &std::ops::Range<usize>| {
            let (t, m) = (&recording.t()[piece.clone()], &recorded[piece.clone()]);
            line_with_means(t, m, shift, recording.step())
        };
        recording.pieces().iter().flat_map(of).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::{line_with_means, line_with_means_of_spline};

    #[test]
    fn the_line_has_the_recorded_means() {
        // of sin(t) the mean from a to b is (cos a - cos b)/(b - a)
        let h = 0.2;
        let t: Vec<f64> = (0..60).map(|k| h * f64::from(k)).collect();
        let mean = |a: f64| (a.cos() - (a + h).cos()) / h;
        for shift in [-h, -0.5 * h, 0.0, 0.3 * h] {
            let recorded: Vec<[f64; 2]> = t.iter().map(|&t| [mean(t + shift), 1.0]).collect();
            let line = line_with_means(&t, &recorded, shift, h);
            let (mut off, mut plain) = (0.0, 0.0);
            for k in 8..50 {
                let error = 0.5 * (line[k][0] + line[k + 1][0]) - mean(t[k]);
                // error of the spline between the rows: h⁴/384; of the line: sixth differences
                assert!(error.abs() < 0.02 * h.powi(4), "{shift} {k}: {error}");
                assert!((line[k][1] - 1.0).abs() < 1e-12);
                let through = 0.25 * (mean(t[k] - h) + 2.0 * mean(t[k]) + mean(t[k] + h));
                (off, plain) = (off + error * error, plain + (through - mean(t[k])).powi(2));
            }
            // the line through the values lacks a quarter of the second difference, h²/4
            assert!(plain > 1e4 * off, "{shift}: {plain} {off}");
        }
    }

    #[test]
    fn the_line_has_the_means_of_a_smooth_input() {
        let h = 0.2;
        let t: Vec<f64> = (0..60).map(|k| h * f64::from(k)).collect();
        let recorded: Vec<[f64; 2]> = t.iter().map(|t| [t.sin(), 1.0]).collect();
        let mean = |a: f64| (a.cos() - (a + h).cos()) / h;
        for shift in [0.0, 0.4 * h, 0.85 * h, 2.3 * h] {
            let line = line_with_means_of_spline(&t, &recorded, shift, h);
            for k in 9..50 {
                let error = 0.5 * (line[k][0] + line[k + 1][0]) - mean(t[k] - shift);
                // error of the splines through the values and through their integral: h⁴/384 each
                assert!(error.abs() < 0.02 * h.powi(4), "{shift} {k}: {error}");
                assert!((line[k][1] - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn beyond_the_ends_the_end_values_hold() {
        let t: Vec<f64> = (0..9).map(f64::from).collect();
        for shift in [-1.5, 0.25, 3.0] {
            let line = line_with_means(&t, &[[2.0, -1.0]; 9], shift, 1.0);
            assert!(line.iter().all(|m| (m[0] - 2.0).abs() + (m[1] + 1.0).abs() < 1e-12));
        }
    }
}
