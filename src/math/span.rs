//! The range of a number over several statements with the same wording.

use std::fmt::{self, Display};

/// The smallest and the largest of several numbers; both equal for a single number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span<T> {
    low: T,
    high: T,
}

impl<T: Copy + PartialOrd> Span<T> {
    /// The range of a single number.
    pub fn of(value: T) -> Self {
        Self { low: value, high: value }
    }

    /// The smallest.
    pub fn low(self) -> T {
        self.low
    }

    /// The largest.
    pub fn high(self) -> T {
        self.high
    }

    /// The range that contains both.
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        let low = if other.low < self.low { other.low } else { self.low };
        let high = if other.high > self.high { other.high } else { self.high };
        Self { low, high }
    }

    /// The range of a monotonic function of the numbers.
    pub fn map<U: Copy + PartialOrd>(self, f: impl Fn(T) -> U) -> Span<U> {
        Span::of(f(self.low)).join(Span::of(f(self.high)))
    }

    /// Both ends formatted by `text`, or one if their texts are equal: "49.5", "49.5 to 50.2".
    pub fn written(self, text: impl Fn(T) -> String) -> String {
        let (low, high) = (text(self.low), text(self.high));
        if low == high { low } else { format!("{low} to {high}") }
    }
}

/// A statement with counts of type `C` and other numbers of type `R`.
pub(crate) trait Statement<C, R>: Copy {
    /// The same statement with numbers of other types.
    type With<D: Copy, S: Copy>: Copy;

    /// Replaces all counts by the first function and all other numbers by the second.
    fn map<D: Copy, S: Copy>(
        self,
        whole: impl FnMut(C) -> D,
        real: impl FnMut(R) -> S,
    ) -> Self::With<D, S>;
}

/// Two statements that differ only in numbers, combined with the ranges of these.
pub(crate) fn joined<T>(one: T, other: T) -> T
where
    T: Statement<Span<usize>, Span<f64>, With<Span<usize>, Span<f64>> = T>,
{
    let (mut counts, mut reals) = (vec![], vec![]);
    other.map(|count| counts.push(count), |real| reals.push(real));
    let (mut counts, mut reals) = (counts.into_iter(), reals.into_iter());
    one.map(
        |count| counts.next().map_or(count, |other| count.join(other)),
        |real| reals.next().map_or(real, |other| real.join(other)),
    )
}

/// Formats both ends with the given digits and sign.
impl<T: Copy + PartialOrd + Display> Display for Span<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = |value: T| match (f.precision(), f.sign_plus()) {
            (Some(digits), true) => format!("{value:+.digits$}"),
            (Some(digits), false) => format!("{value:.digits$}"),
            (None, true) => format!("{value:+}"),
            (None, false) => format!("{value}"),
        };
        f.write_str(&self.written(text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_written_once_where_both_ends_read_the_same() {
        let lag = Span::of(49.5).join(Span::of(50.24)).join(Span::of(50.0));
        assert_eq!(format!("{lag:.1} ms"), "49.5 to 50.2 ms");
        assert_eq!(format!("{lag:+.0} ms"), "+50 ms");
        assert_eq!(Span::of(3).join(Span::of(17)).to_string(), "3 to 17");
        assert_eq!(Span::of(3_usize).to_string(), "3");
    }

    #[test]
    fn the_ends_keep_their_order_under_a_falling_function() {
        let ratio = Span::of(2.0).join(Span::of(4.0)).map(|r: f64| 1.0 / r);
        assert_eq!((ratio.low(), ratio.high()), (0.25, 0.5));
    }
}
