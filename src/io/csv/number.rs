//! A cell of text as a number: decimal commas, dates and times of day.

use super::bare::bare;
use super::style::Style;

/// Words for a value that is not there.
pub(in crate::io) const ABSENT: [&str; 6] = ["", "na", "n/a", "null", "none", "-"];

/// A cell of data as a number; NaN for a missing value.
pub(in crate::io) fn value(cell: &str, style: Style) -> Option<f64> {
    number(cell, style).or_else(|| {
        let bare = bare(cell).to_lowercase();
        if ABSENT.contains(&bare.as_str()) {
            return Some(f64::NAN);
        }
        hexadecimal(&bare).or_else(|| date_time(&bare))
    })
}

/// The counts of a cell as registers show them: `0x1a3f`.
fn hexadecimal(bare: &str) -> Option<f64> {
    let digits = bare.strip_prefix("0x").filter(|digits| digits.len() <= 8)?;
    u32::from_str_radix(digits, 16).ok().map(f64::from)
}

/// A cell as a number that is written in that style.
pub(in crate::io) fn number(cell: &str, style: Style) -> Option<f64> {
    style.number(bare(cell))
}

/// A number and the unit after it, with or without a space: `44.1rpm`, `0.01 sec`, `12%`. The unit of a bare
/// number is empty.
pub(in crate::io) fn quantity(text: &str) -> Option<(f64, &str)> {
    let text = text.trim().trim_matches('"').trim();
    if let Ok(number) = text.parse() {
        return Some((number, ""));
    }
    // an `e` may be the exponent or the beginning of a unit
    let digits = text.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
    let digits = digits.unwrap_or(text.len());
    let (number, unit) = (0..=digits).rev().find_map(|end| {
        let number: f64 = text.get(..end)?.parse().ok()?;
        Some((number, text[end..].trim_start()))
    })?;
    let is_part = |c: char| c.is_alphabetic() || "%°/·^²³".contains(c);
    let letters = unit.trim_end_matches(|c: char| unit.contains('/') && c.is_ascii_digit());
    (letters.starts_with(|c: char| c.is_alphabetic() || "%°".contains(c))
        && letters.chars().all(is_part))
    .then_some((number, unit))
}

/// Seconds of a number with a unit of time.
pub(in crate::io) fn duration(text: &str) -> Option<f64> {
    let (number, unit) = quantity(text)?;
    let units = [("s", 1.0), ("sec", 1.0), ("ms", 1e-3), ("us", 1e-6), ("µs", 1e-6), ("min", 60.0)];
    units.iter().find(|(name, _)| *name == unit).map(|(_, factor)| factor * number)
}

/// Seconds of a day.
const DAY: f64 = 86400.0;

/// A date with time, or a time of day, in seconds: `2026-03-03T12:00:00.250Z`, `3/3/2026 1:00:00 PM`, `12:00:00.25`.
/// With an offset from UTC it is the time in UTC, since the offset of a log changes when summer time begins or ends; a
/// zone without an offset shifts all rows alike.
fn date_time(text: &str) -> Option<f64> {
    let text = text.trim_matches(['[', ']']).trim();
    let is_half = |word: &str| text.strip_suffix(word).map(str::trim_end);
    let (text, half) = match (is_half("am"), is_half("pm")) {
        (Some(text), _) => (text, Some(0.0)),
        (_, Some(text)) => (text, Some(DAY / 2.0)),
        _ => (text, None),
    };
    // a span of time, as pandas writes it
    if let Some((days, time)) = text.split_once(" days ") {
        return Some(DAY * days.parse::<f64>().ok()? + clock(time, half)?);
    }
    if let Some((days, time)) = named_date(text) {
        return Some(DAY * days + time.map_or(Some(0.0), |time| clock(time, half))?);
    }
    // the last slash of `2026/03/03/12:00:00`
    let parted = text
        .split_once(['t', ' '])
        .or_else(|| text.rsplit_once('/').filter(|(date, _)| date.contains('/')));
    match parted {
        // `20260303T120000.250`
        Some((date, time)) if date.len() == 8 && date.bytes().all(|b| b.is_ascii_digit()) => {
            let parts = [date.get(..4)?, date.get(4..6)?, date.get(6..)?];
            let clock_of = |time: &str| {
                let parts = [time.get(..2)?, time.get(2..4)?, time.get(4..)?];
                clock(&parts.join(":"), half)
            };
            let time = if time.contains(':') { clock(time, half)? } else { clock_of(time)? };
            Some(DAY * days_of(&parts.join("-"), false)? + time)
        }
        Some((date, time)) => Some(DAY * days_of(date, half.is_some())? + clock(time, half)?),
        None => clock(text, half),
    }
}

/// Seconds of a time of day: hours and minutes, with seconds if need be; minutes and seconds where the last
/// of two parts has a fraction, or the last of three the three digits of milliseconds. `half` is what the half
/// of the day adds, where one is written.
fn clock(time: &str, half: Option<f64>) -> Option<f64> {
    let (time, east) = match time.rfind(['+', '-']).map(|at| time.split_at(at)) {
        Some((time, offset)) if time.contains(':') => (time.trim_end(), offset_of(offset)),
        _ => (time.trim_end_matches('z'), 0.0),
    };
    let part = |text: &str| text.replacen(',', ".", 1).parse::<f64>().ok();
    let of_milliseconds = |text: &str| text.len() == 3 && text.parse::<u16>().is_ok();
    let parts: Vec<&str> = time.split(':').collect();
    let (hours, minutes, seconds) = match parts[..] {
        [minutes, seconds] if seconds.contains(['.', ',']) => (0.0, part(minutes)?, part(seconds)?),
        [hours, minutes] => (part(hours)?, part(minutes)?, 0.0),
        [minutes, seconds, rest] if of_milliseconds(rest) => {
            (0.0, part(minutes)?, part(seconds)? + 1e-3 * part(rest)?)
        }
        [hours, minutes, seconds] => (part(hours)?, part(minutes)?, part(seconds)?),
        [hours, minutes, seconds, rest] => {
            let fraction = part(&format!("0.{rest}"))?;
            (part(hours)?, part(minutes)?, part(seconds)? + fraction)
        }
        _ => return None,
    };
    let hours = half.map_or(hours, |half| hours % 12.0 + half / 3600.0);
    Some(3600.0 * hours + 60.0 * minutes + seconds - east)
}

/// Seconds by which a local time is ahead of UTC: `+01:00`, `-0530`, `+02`, also with the name of the zone behind it
/// (`+01:00[europe/berlin]`); zero for other text.
fn offset_of(text: &str) -> f64 {
    let digits: Vec<f64> = text
        .bytes()
        .skip(1)
        .filter(|b| *b != b':')
        .map_while(|b| b.is_ascii_digit().then(|| f64::from(b - b'0')))
        .collect();
    let size = match digits[..] {
        [a, b] => 3600.0 * (10.0 * a + b),
        [a, b, c, d] => 3600.0 * (10.0 * a + b) + 60.0 * (10.0 * c + d),
        _ => 0.0,
    };
    if text.starts_with('-') { -size } else { size }
}

/// Days of a date since 1970; the year stands first, as ISO 8601 has it, or last, but first between colons
/// (`2022:06:01`, as cameras write it), which otherwise separate a time of day. The month stands before the day
/// in the notation of the United States: beside halves of the day, and where only that can be meant.
fn days_of(date: &str, is_american: bool) -> Option<f64> {
    let mut parts = date.split(['-', '/', '.', ':']).map(|p| p.parse::<i64>().ok());
    let (a, b, c) = (parts.next()??, parts.next()??, parts.next()??);
    if date.contains(':') && a <= 31 {
        return None;
    }
    let (year, month, day) = if a > 31 {
        (a, b, c)
    } else if is_american || b > 12 {
        (c, a, b)
    } else {
        (c, b, a)
    };
    days_since_1970(year, month, day).map(|days| days as f64)
}

/// First letters of the names of months in English, and where they differ in German and French.
const MONTHS: [&[&str]; 12] = [
    &["jan"],
    &["feb", "fév", "fev"],
    &["mar", "mär", "mrz"],
    &["apr", "avr"],
    &["may", "mai"],
    &["jun", "juin"],
    &["jul", "juil"],
    &["aug", "aoû", "aou"],
    &["sep"],
    &["oct", "okt"],
    &["nov"],
    &["dec", "dez", "déc"],
];

/// Month of a name or its beginning, from 1.
fn month(word: &str) -> Option<i64> {
    let is_name = word.chars().count() >= 3 && word.chars().all(char::is_alphabetic);
    let begins = |names: &&[&str]| names.iter().any(|name| word.starts_with(name));
    let place = MONTHS.iter().position(begins)?;
    is_name.then_some(place as i64 + 1)
}

/// Days since 1970 of a date whose month is a name, and the time of day where one stands beside it: `01-may-2024
/// 10:00:00.010`, `mon jun 10 13:03:00 2024`, `june 10, 2024`. The day is the first number that may be one.
fn named_date(text: &str) -> Option<(f64, Option<&str>)> {
    if !text.contains(char::is_alphabetic) {
        return None;
    }
    let (times, words): (Vec<&str>, Vec<&str>) = text.split(' ').partition(|w| w.contains(':'));
    let parts = words.iter().flat_map(|word| word.split(['-', '/', '.', ',']));
    let (mut named, mut numbers) = (None, vec![]);
    for part in parts.filter(|part| !part.is_empty()) {
        match (part.parse::<i64>(), month(part)) {
            (Ok(number), _) => numbers.push(number),
            (_, Some(found)) if named.is_none() => named = Some(found),
            (..) if WEEKDAYS.iter().any(|day| part.starts_with(day)) => {}
            _ => return None,
        }
    }
    let (&[a, b], month, true) = (&numbers[..], named?, times.len() < 2) else { return None };
    let (day, year) = if a > 31 { (b, a) } else { (a, b) };
    // two digits of a year
    let year = if year < 100 { year + 2000 } else { year };
    Some((days_since_1970(year, month, day)? as f64, times.first().copied()))
}

/// First letters of the days of a week, which a date may begin with, and words of a time zone behind it.
const WEEKDAYS: [&str; 9] = ["mon", "tue", "wed", "thu", "fri", "sat", "sun", "utc", "gmt"];

/// Days of the Gregorian calendar. Source: H. Hinnant, chrono-compatible low-level date algorithms.
fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1900..3000).contains(&year) {
        return None;
    }
    let year = if month <= 2 { year - 1 } else { year };
    let (era, month) = (year.div_euclid(400), (month + 9) % 12);
    let in_era = year - 400 * era;
    let in_year = (153 * month + 2) / 5 + day - 1;
    Some(146_097 * era + 365 * in_era + in_era / 4 - in_era / 100 + in_year - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_times_of_day_are_seconds() {
        // python: datetime(2026, 3, 3, 12, 0, 0, 250000, timezone.utc).timestamp()
        let expected = 1_772_539_200.25;
        for text in [
            "2026-03-03T12:00:00.250Z",
            "20260303T120000.250",
            "20260303T12:00:00.250",
            "2026-03-03 12:00:00.25",
            "03.03.2026 12:00:00,250",
            "2026-03-03T13:00:00.25+01:00",
            "2026-03-03 06:30:00.25 -0530",
            "2026-03-03T14:00:00.25+02",
            "2026-03-03T13:00:00.25+01:00[Europe/Berlin]",
            "2026/03/03/12:00:00.25",
            "2026:03:03 12:00:00.250",
            "3/3/2026 12:00:00.250 PM",
            "2026-03-03 12:00:00:250",
        ] {
            assert_eq!(value(text, Style::Either), Some(expected), "{text}");
        }
        assert!(
            value("", Style::Point).unwrap().is_nan()
                && value("null", Style::Point).unwrap().is_nan()
        );
        assert_eq!(value("0x1A3F", Style::Point), Some(6719.0));
        for text in [
            "broken",
            "0xg1",
            "20261303T000000",
            "2026-13-03 00:00",
            "03:03:2026 00:00",
            "1:x",
            "1:03:00 XM",
            "12:00:x",
        ] {
            assert_eq!(value(text, Style::Either), None, "{text}");
        }
    }

    #[test]
    fn a_log_goes_on_where_summer_time_begins_or_ends() {
        let second = |text: &str| value(text, Style::Point).unwrap();
        let begins =
            second("2024-03-31 03:00:00.000000+02:00") - second("2024-03-31 01:59:59.980000+01:00");
        let ends =
            second("2024-10-27T02:00:00.000+01:00") - second("2024-10-27T02:59:59.980+02:00");
        // to the resolution of a double of 1.7e9 s
        assert!((begins - 0.02).abs() < 1e-6 && (ends - 0.02).abs() < 1e-6, "{begins} {ends}");
    }

    #[test]
    fn numbers_with_units_are_parted() {
        for (text, expected) in [
            ("44.1rpm", Some((44.1, "rpm"))),
            ("\"0.01 sec\"", Some((0.01, "sec"))),
            ("-1e-3 m/s", Some((-1e-3, "m/s"))),
            ("9.81m/s2", Some((9.81, "m/s2"))),
            ("5e", Some((5.0, "e"))),
            ("12%", Some((12.0, "%"))),
            ("+7", Some((7.0, ""))),
            ("0x40", None),
            ("1-2", None),
            ("3 4", None),
            ("rpm", None),
            ("é", None),
        ] {
            assert_eq!(quantity(text), expected, "{text}");
        }
        assert_eq!(
            (duration("20 ms"), duration("20 mA"), duration("20")),
            (Some(0.02), None, None)
        );
    }

    #[test]
    fn clocks_of_two_parts_and_halves_of_the_day_are_read() {
        for (text, seconds) in [
            ("12:00:01.5", 43_201.5),
            ("12:34", 45_240.0),
            // Excel shows minutes and seconds
            ("12:34.5", 754.5),
            ("3:00:020", 180.02),
            ("[13:03:00.5]", 46_980.5),
            ("1:03:00.5 PM", 46_980.5),
            ("12:00:00.5 am", 0.5),
            ("0 days 00:00:02.5", 2.5),
        ] {
            assert_eq!(value(text, Style::Point), Some(seconds), "{text}");
        }
        // python: datetime(2024, 10, 1, 10, 0, 0, 10000, timezone.utc).timestamp()
        for text in [
            "01-Oct-2024 10:00:00.010",
            "1 October 2024 10:00:00,010",
            "Tue Oct 1 10:00:00.010 2024",
            "Oct 1, 2024 10:00:00.010 AM",
            "2024-Okt-01 10:00:00.01",
        ] {
            assert_eq!(value(text, Style::Point), Some(1_727_776_800.01), "{text}");
        }
        for text in ["01-Foo-2024 10:00:00", "May", "1 May", "Oct 1 2024 motor 3"] {
            assert_eq!(value(text, Style::Point), None, "{text}");
        }
        // the 14th is no month; the day after the 10th of June is the 11th in both notations
        let day = |text: &str| value(text, Style::Point).unwrap();
        assert_eq!(day("6/14/2024 00:00") - day("13.6.2024 00:00"), 86_400.0);
        assert_eq!(day("6/11/2024 0:00:00 AM") - day("6/10/2024 0:00:00 AM"), 86_400.0);
    }
}
