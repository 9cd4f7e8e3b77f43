//! Kinds of movement, and the recordings that are kept for validation.

use super::super::no_motion::NoMotion;
use crate::recording::Recording;

/// Ratio of the two mean speeds below which the smaller one counts as zero: straight, or turning on the spot.
const ONE_WAY: f64 = 0.15;
/// Turn over travel of a curve in which one wheel goes twice as fast as the other: (2 - 1)/(2 + 1).
const CURVE: f64 = 1.0 / 3.0;
/// Largest share of the time in motion that is in such curves if the motion counts as straight (judgement): corrections of the
/// course take less.
const CURVES: f64 = 0.05;
/// Time interval over which angles are compared \[s\].
const PASSED: f64 = 0.25;

/// A kind of movement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Straight,
    Turning,
    Mixed,
    /// No motion that changes.
    Without(NoMotion),
}

impl Kind {
    /// Classified by the angles of the wheels over a quarter of a second, in which the steps of an encoder
    /// are small: equal angles are straight driving, opposite ones turning on the spot.
    pub(super) fn of(r: &Recording) -> Self {
        if let Some(none) = NoMotion::of(std::iter::once(r)) {
            return Self::Without(none);
        }
        let rows = ((PASSED / r.step()).round() as usize).clamp(1, r.len() - 1);
        let passed = |k: usize, i: usize| r.alpha()[k + rows][i] - r.alpha()[k][i];
        // travel and turn within each interval
        let both: Vec<[f64; 2]> = (0..r.len() - rows)
            .map(|k| [passed(k, 0) + passed(k, 1), passed(k, 0) - passed(k, 1)])
            .collect();
        if is_only(&both, 0) {
            Self::Straight
        } else if is_only(&both, 1) {
            Self::Turning
        } else {
            Self::Mixed
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Straight => "straight ahead",
            Self::Turning => "turning on the spot",
            Self::Mixed => "straight and turning",
            Self::Without(NoMotion::Rest) => "at rest throughout",
            Self::Without(NoMotion::Steady) => "at a steady speed throughout",
        }
    }
}

/// Whether travel (0) or turning (1) is the only movement: the root mean square of the other is small, and a curve, in
/// which one wheel goes twice as fast as the other, is no considerable part of the time.
fn is_only(both: &[[f64; 2]], kind: usize) -> bool {
    let square = |i: usize| both.iter().map(|v| v[i].powi(2)).sum::<f64>();
    let size = |v: &[f64; 2]| v[0].abs().max(v[1].abs());
    let top = both.iter().map(size).fold(0.0, f64::max);
    let moving = || both.iter().filter(|v| size(v) > ONE_WAY * top);
    let curves = moving().filter(|v| v[1 - kind].abs() > CURVE * v[kind].abs()).count();
    square(1 - kind).sqrt() < ONE_WAY * square(kind).sqrt()
        && curves as f64 <= CURVES * moving().count() as f64
}

/// The recordings kept for validation, with a remark if needed: of each kind of movement every third, counted
/// from the last, so that no kind of movement is used for validation without training.
pub(super) fn split(kinds: &[Option<Kind>]) -> (Vec<bool>, Vec<String>) {
    let mut validation = vec![false; kinds.len()];
    let mut remarks = Vec::new();
    let many = kinds.len() > 1;
    for kind in [Some(Kind::Straight), Some(Kind::Turning), Some(Kind::Mixed), None] {
        let of: Vec<usize> = (0..kinds.len()).filter(|&k| kinds[k] == kind).collect();
        if of.len() >= 2 {
            of.iter().rev().step_by(3).for_each(|&k| validation[k] = true);
        } else if let ([_], Some(kind), true) = (&of[..], kind, many) {
            let words = kind.words();
            remarks.push(format!(
                "only one recording is {words}: it is used for training, so this kind of movement is not \
                 validated"
            ));
        }
    }
    if many && !validation.contains(&true) {
        remarks.push(
            "no kind of movement was recorded twice, so that no recording is left for validation"
                .into(),
        );
    }
    (validation, remarks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_of_a_tenth_of_the_time_is_no_travel_straight_ahead() {
        let driven = |seconds: usize| -> Vec<[f64; 2]> {
            let slow = |k: usize| if k < 10 * seconds { [0.4, 0.2] } else { [2.0, 0.02] };
            (0..400).map(slow).collect()
        };
        assert!(is_only(&driven(0), 0) && is_only(&driven(1), 0) && !is_only(&driven(4), 0));
        let mirrored: Vec<[f64; 2]> = driven(1).iter().map(|v| [v[1], v[0]]).collect();
        assert!(is_only(&mirrored, 1) && !is_only(&mirrored, 0));
    }

    #[test]
    fn validation_is_of_every_kind_that_was_recorded_twice_and_of_no_other() {
        let (s, t) = (Some(Kind::Straight), Some(Kind::Turning));
        assert_eq!(split(&[s, s, s, s, t, t]).0, [true, false, false, true, false, true]);
        let (validation, said) = split(&[s, s, t]);
        assert_eq!(validation, [false, true, false]);
        assert!(said[0].contains("turning on the spot: it is used for training"), "{said:?}");
        assert_eq!(split(&[s]), (vec![false], vec![]));
        assert!(split(&[s, t]).1[2].contains("no recording is left"));
    }
}
