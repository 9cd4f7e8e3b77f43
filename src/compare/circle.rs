//! Angles modulo a turn as numbers on a line.

use std::f64::consts::TAU;

/// Smallest arc that distinguishes a torque periodic in an angle from a constant \[rad\], and longest arc without values
/// that leaves the circle whole (judgement: over half a radian a sine changes by half of its amplitude at most).
const LEAST_ARC: f64 = 0.5;

/// The angle at which a circle of `angles`, each from 0 to 2 pi, is cut: zero if they cover it, else the end of the
/// longest arc without any, so that neighbours stay together; `None` if they cover less than half a radian.
pub(super) fn cut(angles: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = angles.filter(|angle| angle.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = (*sorted.first()?, *sorted.last()?);
    let across = (first + TAU - last, first);
    let gaps = sorted.windows(2).map(|pair| (pair[1] - pair[0], pair[1]));
    let (longest, end) = gaps.fold(across, |a, b| if b.0 > a.0 { b } else { a });
    if TAU - longest < LEAST_ARC {
        return None;
    }
    Some(if longest < LEAST_ARC { 0.0 } else { end })
}

/// The angle from `cut` to a turn later.
pub(super) fn opened(angle: f64, cut: f64) -> f64 {
    // the remainder of a tiny negative number is rounded to a turn
    cut + (angle - cut).rem_euclid(TAU).min(TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_about_zero_is_one_arc_and_a_full_circle_starts_at_zero() {
        let about_zero = [6.0, 6.1, 0.1, 0.5, 6.27];
        let at = cut(about_zero.into_iter()).unwrap();
        assert_eq!(at, 6.0);
        let mut opened: Vec<f64> = about_zero.iter().map(|a| opened(*a, at)).collect();
        opened.sort_by(f64::total_cmp);
        assert!(opened[4] - opened[0] < 0.8);
        assert_eq!(cut((0..100).map(|k| 0.062 * f64::from(k))), Some(0.0));
        // the ticks of a robot that drives straight ahead, on both sides of zero
        assert_eq!(cut([0.0, 0.02, 6.27, 0.0].into_iter()), None);
        assert_eq!(cut(std::iter::empty()), None);
    }
}
