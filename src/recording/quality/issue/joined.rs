//! Combination of issues that differ only in their numbers.

use super::unit::UnitError;
use super::{Issue, StatedIssue, is_full_turn};
use crate::math::{Span, Statement, joined};
use crate::recording::Gaps;

impl<C: Copy, R: Copy> Statement<C, R> for Issue<C, R> {
    type With<D: Copy, S: Copy> = Issue<D, S>;

    fn map<D: Copy, S: Copy>(
        self,
        mut whole: impl FnMut(C) -> D,
        mut real: impl FnMut(R) -> S,
    ) -> Issue<D, S> {
        match self {
            Self::Windows { rows, windows, length_s, share } => Issue::Windows {
                rows: whole(rows),
                windows: whole(windows),
                length_s: real(length_s),
                share: real(share),
            },
            Self::Short(length) => Issue::Short(real(length)),
            Self::Slow(rate) => Issue::Slow(real(rate)),
            Self::Settles { step_s, constant_s } => {
                Issue::Settles { step_s: real(step_s), constant_s: real(constant_s) }
            }
            Self::Uneven(jitter) => Issue::Uneven(real(jitter)),
            Self::Gaps(gaps, short) => Issue::Gaps(
                Gaps { count: whole(gaps.count), longest: real(gaps.longest) },
                whole(short),
            ),
            Self::Repeats(share) => Issue::Repeats(real(share)),
            Self::Still(wheel) => Issue::Still(wheel),
            Self::ConstantInput { wheel, value, unit } => {
                Issue::ConstantInput { wheel, value: real(value), unit }
            }
            Self::AtLimit { wheel, value, unit, share, is_command } => {
                Issue::AtLimit { wheel, value: real(value), unit, share: real(share), is_command }
            }
            Self::Spikes { channel, wheel, count, t, around } => Issue::Spikes {
                channel,
                wheel,
                count: whole(count),
                t: real(t),
                around: around.map(&mut real),
            },
            Self::Jumps { wheel, count, t, size } => {
                Issue::Jumps { wheel, count: whole(count), t: real(t), size: real(size) }
            }
            Self::CoarseSpeed(wheel, step) => Issue::CoarseSpeed(wheel, real(step)),
            Self::Standstill(share) => Issue::Standstill(real(share)),
            Self::OneAxis => Issue::OneAxis,
            Self::StraightOnly => Issue::StraightOnly,
            Self::SpotOnly => Issue::SpotOnly,
            Self::OneWay(wheel, forward) => Issue::OneWay(wheel, forward),
            Self::TooLarge { wheel, top, unit } => Issue::TooLarge { wheel, top: real(top), unit },
            Self::TooFast { top, radius } => {
                Issue::TooFast { top: real(top), radius: real(radius) }
            }
            Self::ExchangedSpeeds => Issue::ExchangedSpeeds,
            Self::Ratio { wheel, ratio, radius } => {
                Issue::Ratio { wheel, ratio: real(ratio), radius: real(radius) }
            }
            Self::ExchangedInput => Issue::ExchangedInput,
            Self::OpposingInput(wheel) => Issue::OpposingInput(wheel),
            Self::SignUntested(wheel) => Issue::SignUntested(wheel),
        }
    }
}

impl Issue {
    /// The issue as it is printed.
    #[must_use]
    pub fn stated(self) -> StatedIssue {
        self.map(Span::of, Span::of)
    }
}

/// Categories of a number that determine the wording.
#[derive(PartialEq)]
enum Meaning {
    Size,
    Zero,
    FullTurn,
    Ratio(UnitError),
}

impl StatedIssue {
    /// Widens the ranges of its numbers by those of another issue if they differ only in numbers; otherwise
    /// returns `false`.
    pub fn join(&mut self, other: &Self) -> bool {
        let rest = |issue: Self| (issue.map(|_| (), |_| ()), issue.meaning());
        let is_like = rest(*self) == rest(*other);
        if is_like {
            *self = joined(*self, *other);
        }
        is_like
    }

    /// Numbers of different categories have different wordings.
    fn meaning(self) -> Meaning {
        match self {
            Self::ConstantInput { value, .. } if value.low() == 0.0 => Meaning::Zero,
            Self::Jumps { size, .. } if is_full_turn(size) => Meaning::FullTurn,
            Self::Ratio { ratio, radius, .. } => {
                Meaning::Ratio(UnitError::of(ratio.low(), radius.low()))
            }
            _ => Meaning::Size,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::recording::DriveUnit;

    /// Combination of two issues; `None` if they differ in more than numbers.
    fn joined(one: Issue, other: Issue) -> Option<String> {
        let mut all = one.stated();
        all.join(&other.stated()).then(|| all.what())
    }

    #[test]
    fn issues_that_differ_in_their_numbers_become_one() {
        assert_eq!(
            joined(Issue::Short(2.5), Issue::Short(1.25)).unwrap(),
            "the recording lasts 1.25 to 2.50 s"
        );
        let gaps = |count, longest| Issue::Gaps(Gaps { count, longest }, 0);
        assert_eq!(
            joined(gaps(1, 0.5), gaps(3, 0.25)).unwrap(),
            "1 to 3 gaps in time, the longest 0.250 to 0.500 s"
        );
    }

    #[test]
    fn constants_of_several_recordings_are_no_range_of_one() {
        let constant = |value| Issue::ConstantInput { wheel: 0, value, unit: DriveUnit::Volt };
        let words = "M1 is constant in each of them, at values of -7 to 7";
        assert_eq!(joined(constant(-7.0), constant(7.0)).unwrap(), words);
        assert_eq!(joined(constant(7.0), constant(7.0)).unwrap(), "M1 is 7 throughout");
    }

    #[test]
    fn other_wheels_and_numbers_of_another_meaning_stay_apart() {
        assert!(joined(Issue::Still(0), Issue::Still(1)).is_none());
        let jump = |size| Issue::Jumps { wheel: 0, count: 1, t: 0.0, size };
        assert!(joined(jump(TAU), jump(2.0)).is_none());
        assert!(joined(jump(TAU), jump(-6.3)).is_some());
        let ratio = |ratio| Issue::Ratio { wheel: 0, ratio, radius: 0.05 };
        assert!(joined(ratio(57.3), ratio(9.55)).is_none());
        assert!(joined(ratio(57.3), ratio(-57.3)).is_none());
        assert!(joined(ratio(57.3), ratio(57.2)).is_some());
    }
}
