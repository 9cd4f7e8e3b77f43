//! How units are written.

/// A unit without the signs of its product, in small letters.
pub(super) fn plain(unit: &str) -> String {
    unit.replace(['·', '*', '.', ' '], "").to_lowercase()
}

/// Other ways to write a unit.
pub(super) const SPELLINGS: [(&str, &[&str]); 30] = [
    ("s", &["sec", "secs", "second", "seconds", "sek", "seg", "с", "сек", "秒", "초"]),
    ("ms", &["мс", "毫秒", "ミリ秒", "밀리초"]),
    ("rad", &["рад", "弧度"]),
    ("us", &["µs", "μs"]),
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
    ("rev", &["turn", "turns", "revs", "rot"]),
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
    ("ticks", &["tick", "count", "counts"]),
    ("ticks/s", &["ticks/sec", "counts/s", "counts/sec", "tps"]),
    ("m/s", &["m/sec"]),
    ("km/h", &["kmh", "kph"]),
    ("ft", &["feet", "foot"]),
    ("in", &["inch", "inches"]),
    ("ft/s", &["ft/sec", "fps"]),
    ("in/s", &["in/sec", "ips"]),
    ("N m", &["n-m", "нм", "н-м", "牛米"]),
    ("kgf cm", &["kgf-cm", "kgcm", "kg-cm"]),
    ("oz in", &["oz-in", "ozfin", "ozf-in", "in-oz", "inoz"]),
    ("lb in", &["lb-in", "lbin", "lbfin", "lbf-in", "in-lb", "inlb"]),
    ("lb ft", &["lb-ft", "lbft", "lbfft", "lbf-ft", "ft-lb", "ftlb"]),
    ("A", &["amp", "amps", "ampere", "amperes", "а", "安", "安培", "アンペア", "암페어"]),
    ("V", &["volt", "volts", "в", "伏", "伏特", "ボルト", "볼트"]),
    ("mA", &["ма", "毫安"]),
    ("mV", &["мв", "毫伏"]),
];

/// Other ways to write a unit of the program, in small letters.
#[must_use]
pub fn spellings(unit: &str) -> &'static [&'static str] {
    SPELLINGS.iter().find(|(name, _)| *name == unit).map_or(&[], |(_, others)| others)
}

/// The name of a unit in the program, where it is written in another way.
pub(super) fn synonym(unit: &str) -> &str {
    let written = plain(unit);
    let meant = SPELLINGS.iter().find(|(_, others)| others.contains(&written.as_str()));
    meant.map_or(unit, |(name, _)| name)
}
