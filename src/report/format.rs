//! Formatting of all numbers in reports: significant digits, U+2212 minus, powers of ten as superscripts,
//! "not identifiable".

/// Text for a missing value (NaN).
pub const MISSING: &str = "–";
/// Text for an estimate without finite uncertainty.
pub const NOT_IDENTIFIABLE: &str = "not identifiable";

/// A number with four significant digits.
///
/// ```
/// use amigo_ident::report::format::number;
/// assert_eq!(number(-0.123456), "−0.1235");
/// assert_eq!(number(1.23e-7), "1.23 × 10⁻⁷");
/// assert_eq!(number(f64::NAN), "–");
/// ```
pub fn number(value: f64) -> String {
    significant(value, 4)
}

/// A number with the given significant digits; trailing zeros after the decimal point are dropped, and values
/// below 10⁻³ or from 10⁵ on are written with a power of ten.
pub fn significant(value: f64, digits: usize) -> String {
    let Some(exponent) = decimal_exponent(value, digits) else {
        return special(value);
    };
    if !(-3..5).contains(&exponent) {
        return scientific(value, digits);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    // 12345 with four digits stays 12345: rounding digits before the decimal point would mislead
    minus(trim_zeros(&format!("{value:.decimals$}")))
}

/// A number with the given significant digits, keeping trailing zeros: adjacent figures show their precision.
///
/// ```
/// use amigo_ident::report::format::digits;
/// assert_eq!(digits(0.44, 3), "0.440");
/// assert_eq!(digits(196.46, 3), "196");
/// ```
pub fn digits(value: f64, digits: usize) -> String {
    match decimal_exponent(value, digits) {
        Some(exponent) if value != 0.0 && (-3..5).contains(&exponent) => {
            fixed(value, (digits as i32 - 1 - exponent).max(0) as usize)
        }
        Some(exponent) if value != 0.0 => {
            let text = format!("{value:.*e}", digits.max(1) - 1);
            let mantissa = text.split('e').next().unwrap_or_default();
            minus(format!("{mantissa} × {}", power_of_ten(exponent)))
        }
        _ => significant(value, digits),
    }
}

/// A rate in hertz, whole from ten on: 6.5 Hz is not 6 Hz in one recording and 7 Hz in the next.
///
/// ```
/// use amigo_ident::report::format::hertz;
/// assert_eq!([6.4998, 6.5002, 99.97].map(hertz), ["6.5", "6.5", "100"]);
/// ```
pub fn hertz(rate: f64) -> String {
    if rate < 10.0 { significant(rate, 2) } else { format!("{rate:.0}") }
}

/// A unit with exponents as superscripts: `kg m^2` becomes `kg m²`.
pub fn unit(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace('*', "·")
}

/// A heading within a sentence: without its capital, except for names of persons.
///
/// ```
/// use amigo_ident::report::format::in_text;
/// assert_eq!(in_text("Turning scrub"), "turning scrub");
/// assert_eq!(in_text("Coulomb friction"), "Coulomb friction");
/// ```
pub fn in_text(heading: &str) -> String {
    if ["Coulomb", "Stribeck"].iter().any(|name| heading.starts_with(name)) {
        return heading.to_owned();
    }
    let mut letters = heading.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

/// A phrase as it starts a sentence or a heading: `turning scrub` becomes `Turning scrub`.
pub fn capital(phrase: &str) -> String {
    let mut letters = phrase.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// A sentence with typographic units and powers of ten: `5.2e-4 rad^2/s` becomes `5.2 × 10⁻⁴ rad²/s`.
pub fn sentence(text: &str) -> String {
    let word = |word: &str| {
        let bare = word.trim_end_matches([',', ';', '.', ')']);
        match bare.split_once('e').map(|(m, power)| (m, power.parse::<i32>())) {
            Some((mantissa, Ok(_))) if mantissa.parse::<f64>().is_ok() => {
                let shown = mantissa.bytes().filter(u8::is_ascii_digit).count();
                let value = bare.parse().unwrap_or(f64::NAN);
                digits(value, shown) + &word[bare.len()..]
            }
            _ => word.replace("^2", "²").replace("^3", "³"),
        }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A number as mantissa times a power of ten, "1.23 × 10⁻⁴".
pub fn scientific(value: f64, digits: usize) -> String {
    let Some(exponent) = decimal_exponent(value, digits) else {
        return special(value);
    };
    let text = format!("{value:.*e}", digits.max(1) - 1);
    let mantissa = text.split('e').next().unwrap_or_default();
    minus(format!("{} × {}", trim_zeros(mantissa), power_of_ten(exponent)))
}

/// A number with a fixed count of decimals, no power of ten; "−0.00" is written "0.00".
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return special(value);
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    minus(if is_zero { text.trim_start_matches('-').to_owned() } else { text })
}

/// `10ⁿ`.
pub fn power_of_ten(exponent: i32) -> String {
    format!("10{}", superscript(exponent))
}

/// An integer in superscript characters.
pub fn superscript(value: i32) -> String {
    let sign = if value < 0 { "⁻" } else { "" };
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = value.unsigned_abs().to_string();
    sign.chars().chain(digits.bytes().map(|b| DIGITS[usize::from(b - b'0')])).collect()
}

/// A value with its standard error, "0.1230 ± 0.0045": the error to two significant digits, the
/// value to the same decimal place. A common power of ten stands outside the brackets.
///
/// Not a number: [`MISSING`]. Infinite error: [`NOT_IDENTIFIABLE`]. Without an error: two digits of the value.
///
/// ```
/// use amigo_ident::report::format::estimate;
/// assert_eq!(estimate(0.12304, 0.00451), "0.1230 ± 0.0045");
/// assert_eq!(estimate(1.234e-5, 2.0e-7), "(1.234 ± 0.020) × 10⁻⁵");
/// assert_eq!(estimate(1.0, f64::INFINITY), "not identifiable");
/// ```
pub fn estimate(value: f64, std_error: f64) -> String {
    if value.is_nan() {
        return MISSING.to_owned();
    }
    if value.is_infinite() || std_error.is_infinite() {
        return NOT_IDENTIFIABLE.to_owned();
    }
    if std_error.is_nan() || std_error < 0.0 {
        return significant(value, 2);
    }
    if std_error == 0.0 {
        return number(value);
    }
    let error_exponent = decimal_exponent(std_error, 2).unwrap_or(0);
    if let Some(exponent) = power_of(value, std_error) {
        let scale = |v: f64| scale_by_power_of_ten(v, -exponent);
        // beyond 12 decimals binary rounding would be printed
        let decimals = (exponent - error_exponent + 1).clamp(0, 12) as usize;
        let (value, error) = (fixed(scale(value), decimals), fixed(scale(std_error), decimals));
        if exponent == 0 {
            return format!("{value} ± {error}");
        }
        return format!("({value} ± {error}) × {}", power_of_ten(exponent));
    }
    let decimals = (1 - error_exponent).max(0) as usize;
    format!("{} ± {}", fixed(value, decimals), fixed(std_error, decimals))
}

/// The power of ten in which an [`estimate`] is written, if it is not written in full.
fn power_of(value: f64, std_error: f64) -> Option<i32> {
    let error = decimal_exponent(std_error, 2)?;
    let exponent = decimal_exponent(value, 4).unwrap_or(error).max(error);
    (error < -6 || !(-3..5).contains(&exponent)).then_some(exponent)
}

/// The interval of an [`estimate`], "[0.119, 0.127]": in the same power of ten, to the digits in which its ends differ.
///
/// ```
/// use amigo_ident::report::format::interval;
/// assert_eq!(interval((0.119, 0.127), 0.123, 0.002), "[0.1190, 0.1270]");
/// assert_eq!(interval((2.77e-4, 3.12e-4), 2.9e-4, 1e-5), "[2.77, 3.12] × 10⁻⁴");
/// ```
pub fn interval((low, high): (f64, f64), value: f64, std_error: f64) -> String {
    let width = high - low;
    if width == 0.0 {
        return format!("[{0}, {0}]", number(low));
    }
    let size = low.abs().max(high.abs());
    let digits = (size / width).log10().ceil().clamp(0.0, 9.0) as i32 + 2;
    let power = power_of(value, std_error);
    let exponent = size.log10().floor() as i32 - power.unwrap_or(0);
    // both ends to the same decimal place
    let decimals = (digits - 1 - exponent).max(0) as usize;
    let end = |v: f64| fixed(scale_by_power_of_ten(v, -power.unwrap_or(0)), decimals);
    let times = power.map_or_else(String::new, |power| format!(" × {}", power_of_ten(power)));
    format!("[{}, {}]{times}", end(low), end(high))
}

/// A p-value as a sentence part: "p = 0.012", "p = 3.2 × 10⁻⁵", "p < 10⁻⁹".
///
/// ```
/// use amigo_ident::report::format::p_value;
/// assert_eq!(p_value(0.01234), "p = 0.012");
/// assert_eq!(p_value(1e-30), "p < 10⁻⁹");
/// ```
pub fn p_value(p: f64) -> String {
    match p {
        p if !(0.0..=1.0).contains(&p) => format!("p = {MISSING}"),
        p if p < 1e-9 => format!("p < {}", power_of_ten(-9)),
        p if p < 1e-3 => format!("p = {}", scientific(p, 2)),
        p if p < 0.0995 => format!("p = {}", significant(p, 2)),
        p => format!("p = {}", fixed(p, 2)),
    }
}

/// Two values in one unit to the same decimal place, two significant digits of the larger.
///
/// ```
/// use amigo_ident::report::format::pair;
/// assert_eq!(pair([0.05, 0.0487]), "0.050 / 0.049");
/// assert_eq!(pair([0.00097, 0.00103]), "0.0010 / 0.0010");
/// ```
pub fn pair(values: [f64; 2]) -> String {
    let larger = values.into_iter().map(f64::abs).fold(0.0, f64::max);
    match decimal_exponent(larger, 2) {
        Some(exponent) if (-4..5).contains(&exponent) && larger > 0.0 => {
            values.map(|v| fixed(v, (1 - exponent).max(0) as usize)).join(" / ")
        }
        _ => values.map(|v| digits(v, 2)).join(" / "),
    }
}

/// A share in per cent with two significant digits: 0.0123 is "1.2 %"; values below a hundredth of a per cent are
/// "< 0.01 %".
pub fn percent(share: f64) -> String {
    if !share.is_finite() {
        return special(share);
    }
    let percent = 100.0 * share;
    if percent != 0.0 && percent.abs() < 0.01 {
        return "< 0.01 %".to_owned();
    }
    let text = if percent.abs() >= 99.5 { fixed(percent, 0) } else { significant(percent, 2) };
    format!("{text} %")
}

/// A number and its unit, "0.1235 kg m²"; the unit is left out where the value is missing.
pub fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() || value.is_nan() {
        return number(value);
    }
    format!("{} {unit}", number(value))
}

/// A probability in per cent, never "100 %" or "0 %".
///
/// ```
/// use amigo_ident::report::format::probability;
/// assert_eq!(probability(1.0), "> 99.9 %");
/// assert_eq!(probability(0.0), "< 0.1 %");
/// assert_eq!(probability(0.5), "50 %");
/// ```
pub fn probability(p: f64) -> String {
    match p {
        p if p > 0.999 => "> 99.9 %".to_owned(),
        p if (0.0..0.001).contains(&p) => "< 0.1 %".to_owned(),
        p => percent(p),
    }
}

/// A count with thin spaces between thousands: "12 345".
pub fn count(value: usize) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// Exponent of the leading digit after rounding; zero for zero, `None` for NaN and infinities.
fn decimal_exponent(value: f64, digits: usize) -> Option<i32> {
    if !value.is_finite() {
        return None;
    }
    format!("{value:.*e}", digits.max(1) - 1).split('e').nth(1)?.parse().ok()
}

/// `value · 10^power`, exact to rounding also where 10^power itself would overflow.
fn scale_by_power_of_ten(value: f64, power: i32) -> f64 {
    let half = power / 2;
    value * 10f64.powi(half) * 10f64.powi(power - half)
}

fn special(value: f64) -> String {
    match value {
        v if v == f64::INFINITY => "∞".to_owned(),
        v if v == f64::NEG_INFINITY => "−∞".to_owned(),
        _ => MISSING.to_owned(),
    }
}

fn trim_zeros(text: &str) -> String {
    if !text.contains('.') {
        return text.to_owned();
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn minus(text: impl AsRef<str>) -> String {
    let text = text.as_ref();
    let text = if text == "-0" { "0" } else { text };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests;
