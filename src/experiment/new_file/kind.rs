//! Kinds of movement, and the recordings that are kept for validation.

use crate::recording::Recording;

/// Ratio of the two mean speeds below which the smaller one counts as zero: straight, or turning on the spot.
const ONE_WAY: f64 = 0.15;
/// Time interval over which angles are compared \[s\].
const PASSED: f64 = 0.25;

/// A kind of movement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Straight,
    Turning,
    Mixed,
    /// The wheels do not move.
    Still,
}

impl Kind {
    /// Classified by the angles of the wheels over a quarter of a second, in which the steps of an encoder
    /// are small: equal angles are straight driving, opposite ones turning on the spot.
    pub(super) fn of(r: &Recording) -> Self {
        if super::super::remarks::without_motion(std::iter::once(r)) {
            return Self::Still;
        }
        let rows = ((PASSED / r.step()).round() as usize).clamp(1, r.len() - 1);
        let size = |sign: f64| -> f64 {
            let passed = |k: usize, i: usize| r.alpha()[k + rows][i] - r.alpha()[k][i];
            (0..r.len() - rows).map(|k| (passed(k, 0) + sign * passed(k, 1)).powi(2)).sum()
        };
        let (sum, difference) = (size(1.0).sqrt(), size(-1.0).sqrt());
        if difference < ONE_WAY * sum {
            Self::Straight
        } else if sum < ONE_WAY * difference {
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
            Self::Still => "at rest throughout",
        }
    }
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
