//! Cubic interpolation between the rows of a signal.

use crate::math::Real;

/// A signal with these rows at another instant, by cubic interpolation between them; beyond the ends that value is
/// held. `row` is where the last instant was found, and is moved.
#[inline(always)]
pub(super) fn between_rows<T: Real>(t: &[f64], m: &[[T; 2]], at: T, row: &mut usize) -> [T; 2] {
    let last = t.len() - 1;
    if last == 0 {
        return m[0];
    }
    let mut k = *row;
    while k > 0 && t[k] > at.value() {
        k -= 1;
    }
    while k + 1 < last && t[k + 1] <= at.value() {
        k += 1;
    }
    *row = k;
    if at.value() <= t[0] {
        return m[0];
    }
    if at.value() >= t[last] {
        return m[last];
    }
    let h = t[k + 1] - t[k];
    let (before, behind) = (k.saturating_sub(1), (k + 2).min(last));
    let slopes = [h / (t[k + 1] - t[before]), h / (t[behind] - t[k])];
    let weights = weights_of_cubic((at - t[k]) / h, slopes);
    cubic(&weights, [m[before], m[k], m[k + 1], m[behind]])
}

/// Weights of the differences of four rows in a cubic between the middle ones, at the share `s` of their distance. The
/// slope at a row is that through its neighbours; `slopes`: the distance over that of the neighbours.
#[inline(always)]
pub(super) fn weights_of_cubic<T: Real>(s: T, slopes: [f64; 2]) -> [T; 3] {
    let (s2, s3) = (s * s, s * s * s);
    [s2 * 3.0 - s3 * 2.0, (s3 - s2 * 2.0 + s) * slopes[0], (s3 - s2) * slopes[1]]
}

/// The cubic between the second and the third of four rows.
#[inline(always)]
pub(super) fn cubic<T: Real>(
    [rise, first, second]: &[T; 3],
    [m0, m1, m2, m3]: [[T; 2]; 4],
) -> [T; 2] {
    let mut out = m1;
    for i in 0..2 {
        out[i] =
            m1[i] + *rise * (m2[i] - m1[i]) + *first * (m2[i] - m0[i]) + *second * (m3[i] - m1[i]);
    }
    out
}
