//! How units are written.

/// A unit without the signs of its product, in small letters.
pub(super) fn plain(unit: &str) -> String {
    unit.replace(['·', '*', '.', ' '], "").to_lowercase()
}

/// Other ways to write a unit.
pub(super) const SPELLINGS: [(&str, &[&str]); 34] = [
    ("s", &["sec", "secs", "second", "seconds", "sek", "seg", "с", "сек", "秒", "초"]),
    ("ms", &["msec", "millis", "milliseconds", "мс", "毫秒", "ミリ秒", "밀리초"]),
    ("rad", &["radians", "рад", "弧度"]),
    ("us", &["usec", "micros", "microseconds", "µs", "μs"]),
    ("ns", &["nanoseconds"]),
    ("min", &["minute", "minutes"]),
    ("h", &["hr", "hrs", "hour", "hours"]),
    ("d", &["day", "days"]),
    (
        "deg",
        &[
            "degree", "degrees", "°", "graden", "grados", "gradi", "graus", "degrés", "degres",
            "stopnie", "grader", "град", "度",
        ],
    ),
    ("rad/s", &["rad/sec", "rads/s", "рад/с", "弧度/秒"]),
    ("deg/s", &["°/s", "deg/sec", "dps"]),
    ("rev", &["turn", "turns", "revs", "rot", "rotation", "rotations", "revolutions"]),
    ("rev/s", &["turn/s", "turns/s", "rot/s", "rev/sec", "rps"]),
    (
        "rpm",
        &[
            "1/min",
            "r/min",
            "rev/min",
            "u/min",
            "tr/min",
            "giri/min",
            "obr/min",
            "varv/min",
            "omw/min",
            "toeren/min",
            "omdr/min",
            "ot/min",
            "об/мин",
            "об/хв",
            "о/мин",
            "d/dk",
            "dev/dk",
            "devir/dk",
            "devir/dakika",
            "vòng/phút",
            "vong/phut",
            "v/ph",
            "putaran/menit",
            "ford/min",
            "rot/min",
            "o/min",
            "στρ/λεπτό",
            "转/分",
            "回転/分",
        ],
    ),
    ("ticks", &["tick", "count", "counts", "pulses"]),
    ("ticks/s", &["ticks/sec", "counts/s", "counts/sec", "tps"]),
    ("m", &["meters", "metres"]),
    ("cm", &["centimeters", "centimetres"]),
    ("mm", &["millimeters", "millimetres"]),
    ("m/s", &["m/sec"]),
    ("km/h", &["kmh", "kph"]),
    ("ft", &["feet", "foot"]),
    ("in", &["inch", "inches"]),
    ("ft/s", &["ft/sec", "fps"]),
    ("in/s", &["in/sec", "ips"]),
    ("N m", &["n-m", "newtonmeters", "newtonmetres", "нм", "н-м", "牛米"]),
    ("kgf cm", &["kgf-cm", "kgcm", "kg-cm"]),
    ("oz in", &["oz-in", "ozfin", "ozf-in", "in-oz", "inoz"]),
    ("lb in", &["lb-in", "lbin", "lbfin", "lbf-in", "in-lb", "inlb"]),
    ("lb ft", &["lb-ft", "lbft", "lbfft", "lbf-ft", "ft-lb", "ftlb"]),
    ("A", &["amp", "amps", "ampere", "amperes", "а", "安", "安培", "アンペア", "암페어"]),
    ("V", &["volt", "volts", "в", "伏", "伏特", "ボルト", "볼트"]),
    ("mA", &["milliamps", "ма", "毫安"]),
    ("mV", &["millivolts", "мв", "毫伏"]),
];

/// Other ways to write a unit of the program, in small letters.
#[must_use]
pub fn spellings(unit: &str) -> &'static [&'static str] {
    SPELLINGS.iter().find(|(name, _)| *name == unit).map_or(&[], |(_, others)| others)
}

/// Ways to write that an angle is meant by the second.
const A_SECOND: [&str; 6] = ["persecond", "persec", "pers", "/second", "/sec", "/s"];
/// Units of angles, and of them by the second.
const BY_SECOND: [(&str, &str); 10] = [
    ("rad", "rad/s"),
    ("mrad", "mrad/s"),
    ("deg", "deg/s"),
    ("rev", "rev/s"),
    ("ticks", "ticks/s"),
    ("m", "m/s"),
    ("cm", "cm/s"),
    ("mm", "mm/s"),
    ("ft", "ft/s"),
    ("in", "in/s"),
];

/// The name of a unit in the program, where it is written in another way: `rotations`, `rotations per second`.
pub(super) fn synonym(unit: &str) -> &str {
    let written = plain(unit);
    let by_second = || {
        let angle = A_SECOND.iter().find_map(|end| written.strip_suffix(end))?;
        let angle = listed(angle).unwrap_or(angle);
        BY_SECOND.iter().find(|(of, _)| *of == angle).map(|(_, speed)| *speed)
    };
    listed(&written).or_else(by_second).unwrap_or(unit)
}

/// The unit that is written in this way.
fn listed(written: &str) -> Option<&'static str> {
    SPELLINGS.iter().find(|(_, others)| others.contains(&written)).map(|(name, _)| *name)
}
