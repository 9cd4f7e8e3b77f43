//! Angles from speeds and speeds from angles, if one of them was not recorded.

use std::ops::Range;

use crate::math::cumulative_trapezoid;

/// Angles from speeds, by the trapezoid rule from zero \[rad\].
pub(super) fn integrate(t: &[f64], omega: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [right, left] = [0, 1].map(|i| cumulative_trapezoid(t, |k| omega[k][i]));
    right.into_iter().zip(left).map(|(right, left)| [right, left]).collect()
}

/// Speeds from angles of a sensor that is slower than the rows: computed from the rows with new values, and
/// held in between like the angles.
pub(crate) fn slopes(
    t: &[f64],
    alpha: &[[f64; 2]],
    pieces: &[Range<usize>],
    fresh: &[bool],
) -> Vec<[f64; 2]> {
    if fresh.iter().all(|f| *f) {
        return differentiate(t, alpha, pieces);
    }
    let mut omega = vec![[0.0; 2]; t.len()];
    for piece in pieces {
        let is_new = |k: &usize| fresh[*k] || *k == piece.start;
        let rows: Vec<usize> = piece.clone().filter(is_new).collect();
        let times: Vec<f64> = rows.iter().map(|&k| t[k]).collect();
        let angles: Vec<[f64; 2]> = rows.iter().map(|&k| alpha[k]).collect();
        let slopes = differentiate(&times, &angles, std::slice::from_ref(&(0..rows.len())));
        for (place, &row) in rows.iter().enumerate() {
            let end = rows.get(place + 1).copied().unwrap_or(piece.end);
            omega[row..end].fill(slopes[place]);
        }
    }
    omega
}

/// Speeds from angles, in pieces without a gap.
pub(crate) fn differentiate(
    t: &[f64],
    alpha: &[[f64; 2]],
    pieces: &[Range<usize>],
) -> Vec<[f64; 2]> {
    let mut omega = vec![[0.0; 2]; t.len()];
    for piece in pieces.iter().filter(|piece| piece.len() >= 2) {
        for k in piece.clone() {
            let (before, after) = (k.max(piece.start + 1) - 1, (k + 1).min(piece.end - 1));
            for i in 0..2 {
                let slope = |a: usize, b: usize| (alpha[b][i] - alpha[a][i]) / (t[b] - t[a]);
                omega[k][i] = if before < k && after > k {
                    let (h0, h1) = (t[k] - t[before], t[after] - t[k]);
                    (slope(before, k) * h1 + slope(k, after) * h0) / (h0 + h1)
                } else {
                    slope(before, after)
                };
            }
        }
    }
    omega
}
