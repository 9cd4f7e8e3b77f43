//! An input whose recorded values are means over a row, as by a logger that averages a faster signal.

use super::cubic::between_rows;
use crate::math::Real;
use crate::recording::Recording;
use crate::simulate::impulse;

/// The values at the rows of an input that varies linearly between them and whose means over the rows are those that
/// were recorded, `shift` seconds later: value k is the mean from row k to the next, at `shift` = -h the one from the
/// row before. The last row lasts for `last_s`.
///
/// ```text
/// I(t)  integral of the recorded values, cubic between the rows
/// m_k = (I(t_k + h - shift) - I(t_k - shift))/h
/// M_k = (5 (m_k-1 + m_k) - (m_k-2 + m_k+1))/8
/// (M_k + M_k+1)/2 = m_k   up to fourth differences
/// ```
/// The line through the recorded values themselves, half a row away, has a quarter of each neighbour in its mean. A held
/// mean has the right impulse, but not the right path within a row.
pub(super) fn line_with_means<T: Real>(
    t: &[f64],
    recorded: &[[T; 2]],
    shift: T,
    last_s: f64,
) -> Vec<[T; 2]> {
    let Some(last) = t.last() else { return vec![] };
    let times: Vec<f64> = t.iter().copied().chain([last + last_s]).collect();
    let sums = impulse(&times, recorded);
    let (first, last) = (recorded[0], recorded[recorded.len() - 1]);
    let mut row = 0;
    let mut integral = |at: T| {
        let [begin, end] = [times[0], times[t.len()]].map(|edge| at - edge);
        let inside = between_rows(&times, &sums, at, &mut row);
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
    let mean = |k: usize, i: usize| means[k.clamp(2, t.len() + 1) - 2][i];
    let value = |k: usize, i: usize| {
        let (near, far) = (mean(k + 1, i) + mean(k + 2, i), mean(k, i) + mean(k + 3, i));
        (near * 5.0 - far) * 0.125
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
    use super::line_with_means;

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
            for k in 5..54 {
                let error = 0.5 * (line[k][0] + line[k + 1][0]) - mean(t[k]);
                // fourth differences of sin are h⁴, the cubic adds as much between the rows
                assert!(error.abs() < 0.2 * h.powi(4), "{shift} {k}: {error}");
                assert!((line[k][1] - 1.0).abs() < 1e-12);
                let through = 0.25 * (mean(t[k] - h) + 2.0 * mean(t[k]) + mean(t[k] + h));
                (off, plain) = (off + error * error, plain + (through - mean(t[k])).powi(2));
            }
            // the line through the values lacks a quarter of the second difference, h²/4
            assert!(plain > 400.0 * off, "{shift}: {plain} {off}");
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
