//! Rounding to significant digits.

/// The value rounded to the given significant digits.
#[must_use]
pub fn round_significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.max(1) - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::round_significant;

    #[test]
    fn rounding_keeps_the_digits_that_are_asked_for() {
        assert_eq!(round_significant(1.234_567_89, 6), 1.234_57);
        assert_eq!(round_significant(-98_765.0, 2), -99_000.0);
        assert!(round_significant(f64::NAN, 6).is_nan());
    }
}
