//! Numbers of digits with a decimal point, as almost all cells of a log are.

/// Powers of ten that are exact.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// Largest whole number below which all are exact.
const EXACT: u64 = 1 << 53;
/// Bytes of which a number with at most nineteen digits, which fit in 64 bits, consists.
const LONGEST: usize = 19;

/// The number that [`str::parse`] gives for the digits at the front of `text`, with at most one point and a minus sign,
/// and what follows them. `None` for any other notation, and for more digits than are exact.
///
/// ```text
/// digits / 10^decimals,   both exact, so that the quotient is rounded once
/// ```
/// Source: W. D. Clinger, How to read floating point numbers accurately (1990).
#[inline]
pub(super) fn front(text: &[u8]) -> Option<(f64, &[u8])> {
    let (is_negative, number) = match text {
        [b'-', number @ ..] => (true, number),
        number => (false, number),
    };
    let (whole, rest) = digits(number, 0);
    let (whole, decimals, point, rest) = match rest {
        [b'.', fraction @ ..] => {
            let (whole, rest) = digits(fraction, whole);
            (whole, fraction.len() - rest.len(), 1, rest)
        }
        rest => (whole, 0, 0, rest),
    };
    let length = number.len() - rest.len();
    if length == point || length > LONGEST || whole > EXACT {
        return None;
    }
    let value = whole as f64 / TENS[decimals];
    Some((if is_negative { -value } else { value }, rest))
}

/// The whole number `whole` continued by the digits at the front of `text`, and what follows them; wrong for more than
/// [`LONGEST`] of them.
#[inline]
fn digits(mut text: &[u8], mut whole: u64) -> (u64, &[u8]) {
    while let [byte @ b'0'..=b'9', rest @ ..] = text {
        whole = whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
        text = rest;
    }
    (whole, text)
}

#[cfg(test)]
mod tests {
    use super::front;

    /// The number of a text that consists of nothing else.
    fn plain(text: &[u8]) -> Option<f64> {
        front(text).filter(|(_, rest)| rest.is_empty()).map(|(value, _)| value)
    }

    #[test]
    fn plain_numbers_are_those_of_the_standard_library() {
        let numbers = [
            "0",
            "-0",
            "7",
            "-7.",
            ".5",
            "-.25",
            "0.1",
            "0.000",
            "12.5",
            "-0.00031",
            "1000.000",
            "9007199254740992",
            "9007199254740.99",
            "0.1234567890123456",
            "3.14159265358979",
            "00000000000000.0001",
        ];
        for text in numbers {
            let expected: f64 = text.parse().unwrap();
            let found = plain(text.as_bytes()).unwrap();
            assert_eq!(found.to_bits(), expected.to_bits(), "{text}");
        }
        let mut state = 1_u64;
        for k in 0..100_000_usize {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let text = format!("{:.*}", k % 12, (state >> 30) as f64 * 1e-6 - 5e3);
            let expected: f64 = text.parse().unwrap();
            let found = plain(text.as_bytes()).map(f64::to_bits);
            assert!(found.is_none_or(|found| found == expected.to_bits()), "{text}");
        }
    }

    #[test]
    fn other_notations_are_left_to_others() {
        for text in ["", "-", ".", "-.", "+1", "1e5", "1,5", "1.2.3", " 1", "nan", "1'000", "--1"] {
            assert_eq!(plain(text.as_bytes()), None, "{text}");
        }
        // more digits than are exact
        assert_eq!(plain(b"9007199254740993"), None);
        assert_eq!(plain(b"12345678901234567890"), None);
    }
}
