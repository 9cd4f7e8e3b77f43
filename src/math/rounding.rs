//! Rounding to significant digits.

/// Powers of ten that are exact as numbers.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// Largest scaled value of the short way: its error by rounding stays far below [`TIE`].
const LARGEST: f64 = 1e9;
/// Distance from the middle of two neighbours within which the decimals of the value decide.
const TIE: f64 = 1e-6;

/// The value rounded to the given significant digits.
#[must_use]
pub fn round_significant(value: f64, digits: usize) -> f64 {
    let digits = digits.max(1);
    quickly_significant(value, digits)
        .unwrap_or_else(|| format!("{value:.*e}", digits - 1).parse().unwrap_or(value))
}

/// The value rounded to this number of decimals.
#[must_use]
pub fn round_decimals(value: f64, decimals: usize) -> f64 {
    quickly(value, decimals as i32)
        .unwrap_or_else(|| format!("{value:.decimals$}").parse().unwrap_or(value))
}

/// [`round_significant`] without text; `None` where the exponent or the neighbour is not certain.
fn quickly_significant(value: f64, digits: usize) -> Option<f64> {
    let exponent = value.abs().log10().floor();
    if !(exponent.abs() <= 22.0) {
        return None;
    }
    let decimals = digits as i32 - 1 - exponent as i32;
    let rounded = quickly(value, decimals)?;
    // a logarithm next to a whole number may be that of the wrong decade
    let lowest = POWERS[exponent.abs() as usize];
    let lowest = if exponent < 0.0 { 1.0 / lowest } else { lowest };
    let inside = value.abs() > lowest * (1.0 + TIE) && value.abs() < 10.0 * lowest * (1.0 - TIE);
    inside.then_some(rounded)
}

/// The value rounded to decimals (to tens, hundreds, … for negative ones) as the quotient or product of two exact
/// numbers, which is the number that the rounded decimal stands for; `None` near the middle of two neighbours.
fn quickly(value: f64, decimals: i32) -> Option<f64> {
    let power = *POWERS.get(decimals.unsigned_abs() as usize)?;
    let scaled = if decimals >= 0 { value * power } else { value / power };
    let is_short = scaled.abs() < LARGEST && (scaled.fract().abs() - 0.5).abs() > TIE;
    let whole = scaled.round();
    let rounded = if decimals >= 0 { whole / power } else { whole * power };
    is_short.then_some(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_the_digits_that_are_asked_for() {
        assert_eq!(round_significant(1.234_567_89, 6), 1.234_57);
        assert_eq!(round_significant(-98_765.0, 2), -99_000.0);
        assert!(round_significant(f64::NAN, 6).is_nan());
    }

    #[test]
    fn rounded_numbers_are_those_of_the_rounded_decimals() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut values =
            vec![0.0, -0.0, 1.0, 0.5, 2.5, -0.125, 1e-7, 1e22, 9.9995, 0.99999, 1000.0];
        values.extend([f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, f64::MAX, 5e-324]);
        for k in 0..20_000 {
            let size = 10.0_f64.powf(40.0 * next() - 20.0);
            values.push(if k % 2 == 0 { size } else { -size * next() });
            // decimals next to the middle of two neighbours
            values.push(((1e4 * next()).floor() + 0.5) * 1e-3);
        }
        for value in values {
            for digits in 1..8 {
                let text: f64 = format!("{value:.*e}", digits - 1).parse().unwrap();
                assert_eq!(round_significant(value, digits).to_bits(), text.to_bits(), "{value}");
                let text: f64 = format!("{value:.digits$}").parse().unwrap();
                assert_eq!(round_decimals(value, digits).to_bits(), text.to_bits(), "{value}");
            }
        }
    }
}
