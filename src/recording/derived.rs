//! Angles from speeds and speeds from angles, if one of them was not recorded.

use std::ops::Range;

use crate::math::{cumulative_trapezoid, noise, quantile};

/// Error of a speed computed from counts of an encoder, as a share of the top speed, above which it is computed over
/// more rows (judgement: a percent is hardly visible in a figure).
pub(crate) const RESOLVED: f64 = 0.01;
/// Longest time to either side of a row over which a speed is computed \[s\], as in the local motion.
const LONGEST: f64 = 0.03;

/// Number of rows to either side over which speeds are computed from angles: one, and more if the rows follow each
/// other so fast that the counts of the encoder would hide the speed.
///
/// ```text
/// √2 (q/√12)/(2 n h) <= 0.01 top speed,   n h <= 0.03 s
/// ```
pub(super) fn reach(alpha: &[[f64; 2]], fresh: &[bool], step: f64) -> usize {
    let most = (LONGEST / step).round() as usize;
    if most <= 1 || alpha.len() <= most || !fresh.iter().all(|f| *f) {
        return 1;
    }
    let of_wheel = |i: usize| {
        let angles: Vec<f64> = alpha.iter().map(|a| a[i]).collect();
        let Some(step_of_angle) = noise::quantum(&angles) else { return 1.0 };
        let speeds = angles.windows(most + 1).map(|w| (w[most] - w[0]).abs());
        let top = quantile(speeds, 0.99) / (most as f64 * step);
        if top > 0.0 { step_of_angle / (24.0_f64.sqrt() * step * RESOLVED * top) } else { 1.0 }
    };
    (of_wheel(0).max(of_wheel(1)).ceil() as usize).clamp(1, most)
}

/// Angles from speeds, by the trapezoid rule from zero \[rad\].
pub(super) fn integrate(t: &[f64], omega: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [right, left] = [0, 1].map(|i| cumulative_trapezoid(t, |k| omega[k][i]));
    right.into_iter().zip(left).map(|(right, left)| [right, left]).collect()
}

/// Speeds from angles, over `reach` rows to either side; of a sensor that is slower than the rows computed from the
/// rows with new values, and held in between like the angles.
pub(crate) fn slopes(
    t: &[f64],
    alpha: &[[f64; 2]],
    pieces: &[Range<usize>],
    fresh: &[bool],
    reach: usize,
) -> Vec<[f64; 2]> {
    if fresh.iter().all(|f| *f) {
        return differentiate(t, alpha, pieces, reach);
    }
    let mut omega = vec![[0.0; 2]; t.len()];
    for piece in pieces {
        let of = |is_new: &dyn Fn(&usize) -> bool| piece.clone().filter(is_new).collect::<Vec<_>>();
        let mut rows = of(&|k| fresh[*k]);
        if rows.len() < 2 {
            rows = of(&|k| fresh[*k] || *k == piece.start);
        }
        let times: Vec<f64> = rows.iter().map(|&k| t[k]).collect();
        let angles: Vec<[f64; 2]> = rows.iter().map(|&k| alpha[k]).collect();
        let slopes = differentiate(&times, &angles, std::slice::from_ref(&(0..rows.len())), 1);
        // rows before the first new value repeat an older one
        omega[piece.start..rows[0]].fill(slopes[0]);
        for (place, &row) in rows.iter().enumerate() {
            let end = rows.get(place + 1).copied().unwrap_or(piece.end);
            omega[row..end].fill(slopes[place]);
        }
    }
    omega
}

/// Speeds from angles, in pieces without a gap: the slope of the parabola through a row and those `reach` rows before
/// and after it; nearer to the ends of a piece the mean speed over the rows that there are.
pub(crate) fn differentiate(
    t: &[f64],
    alpha: &[[f64; 2]],
    pieces: &[Range<usize>],
    reach: usize,
) -> Vec<[f64; 2]> {
    let mut omega = vec![[0.0; 2]; t.len()];
    for piece in pieces.iter().filter(|piece| piece.len() >= 2) {
        for k in piece.clone() {
            let before = k.max(piece.start + reach) - reach;
            let after = (k + reach).min(piece.end - 1);
            for i in 0..2 {
                let slope = |a: usize, b: usize| (alpha[b][i] - alpha[a][i]) / (t[b] - t[a]);
                omega[k][i] = if before + reach == k && after == k + reach {
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

#[cfg(test)]
mod tests {
    use crate::recording::{Channels, DriveUnit, Recording};

    /// A wheel at 5 + 4 sin 2t rad/s, counted 2048 times a turn, at an interval of `step` \[s\]; its true speeds.
    fn counted(step: f64, ticks: f64) -> (Recording, Vec<f64>) {
        let t: Vec<f64> = (0..(8.0 / step) as usize).map(|k| step * k as f64).collect();
        let tick = std::f64::consts::TAU / ticks;
        let angle = |t: f64| 5.0 * t - 2.0 * (2.0 * t).cos();
        let alpha = t.iter().map(|t| [(angle(*t) / tick).floor() * tick; 2]).collect();
        let speeds = t.iter().map(|t| 5.0 + 4.0 * (2.0 * t).sin()).collect();
        let torque = vec![[0.1; 2]; t.len()];
        let channels = Channels { t, alpha: Some(alpha), omega: None, torque };
        (Recording::new("counts", channels, DriveUnit::NewtonMetre).unwrap(), speeds)
    }

    #[test]
    fn speeds_from_counts_in_fast_rows_are_known_to_a_hundredth_of_the_top_speed() {
        for (step, ticks) in [(1e-3, 2048.0), (2e-3, 512.0)] {
            let (r, speeds) = counted(step, ticks);
            assert!(r.reach() > 1);
            let errors = r.omega().iter().zip(&speeds).map(|(w, speed)| (w[0] - speed).powi(2));
            let error = (errors.sum::<f64>() / speeds.len() as f64).sqrt();
            // the ends of the recording have fewer rows
            assert!(error < 1.1 * 0.01 * 9.0, "{step}: {error}");
            let noise = r.motion_noise().omega[0];
            assert!((noise / error - 1.0).abs() < 0.25, "{noise} {error}");
        }
        // one count in five rows: they determine the speed
        assert_eq!(counted(0.01, 9550.0).0.reach(), 1);
        // fewer counts than the longest time needs
        assert_eq!(counted(1e-3, 100.0).0.reach(), 30);
    }
}
