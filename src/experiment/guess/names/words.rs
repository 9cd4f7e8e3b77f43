//! Words of column names: quantities, what was commanded, what is no wheel, units.

use super::said::Quantity;

/// Words of each quantity, the ones that say most first.
pub(super) const QUANTITIES: [(Quantity, &[&str]); 7] = [
    (Quantity::Nanoseconds, &["nanosec", "nsec", "nanosecs", "nsecs", "nanoseconds"]),
    (
        Quantity::Time,
        &[
            "t",
            "time",
            "timestamp",
            "stamp",
            "ts",
            "sec",
            "secs",
            "second",
            "seconds",
            "clock",
            "datetime",
            "date",
            "elapsed",
            "millis",
            "micros",
            "zeit",
            // of a day: the milliseconds of VESC Tool
            "today",
        ],
    ),
    (
        Quantity::Speed,
        &[
            "dalpha",
            "omega",
            "velocity",
            "velocities",
            "speed",
            "vel",
            "velo",
            "rpm",
            "erpm",
            "w",
            "dq",
            "qd",
            "dphi",
            "dtheta",
            "angvel",
            "alphadot",
            "thetadot",
            "phidot",
            "rate",
            "drehzahl",
            "geschwindigkeit",
            "ω",
        ],
    ),
    (
        Quantity::Angle,
        &[
            "alpha",
            "angle",
            "position",
            "positions",
            "pos",
            "theta",
            "enc",
            "encoder",
            "phi",
            "q",
            "rotations",
            "rotation",
            "turns",
            "ticks",
            "counts",
            "count",
            "tachometer",
            "tacho",
            "distance",
            "dist",
            "rev",
            "winkel",
            "travel",
            "travelled",
            "odometer",
            "θ",
            "φ",
            "α",
        ],
    ),
    (
        Quantity::Torque,
        &["m", "moment", "torque", "tau", "effort", "efforts", "trq", "tq", "drehmoment", "τ"],
    ),
    (
        Quantity::Current,
        &["current", "currents", "cur", "curr", "i", "amps", "iq", "ia", "ampere", "strom"],
    ),
    (
        Quantity::Voltage,
        &[
            "voltage",
            "voltages",
            "volt",
            "volts",
            "vol",
            "v",
            "u",
            "duty",
            "dutycycle",
            "pwm",
            "spannung",
            "throttle",
            // of a motor and nothing else: its command
            "power",
            "motor",
            "mot",
        ],
    ),
];

/// Words of an input that name its motor as well: beside a unit of something else they say nothing.
pub(super) const WEAK: [&str; 4] = ["power", "motor", "mot", "throttle"];

/// Words of the step between two rows.
pub(super) const STEPS: [&str; 4] = ["dt", "deltat", "interval", "period"];

/// Words of a name that is a command and not a measurement.
pub(in crate::experiment::guess) const WISHED: [&str; 13] = [
    "command",
    "commands",
    "commanded",
    "cmd",
    "target",
    "setpoint",
    "sp",
    "reference",
    "ref",
    "desired",
    "des",
    "goal",
    "soll",
];
/// Words of quantities that are not those of a wheel.
pub(super) const OTHERS: [&str; 25] = [
    "gyro",
    "imu",
    "heading",
    "yaw",
    "pitch",
    "roll",
    "battery",
    "bat",
    "vbat",
    "bus",
    "supply",
    "vin",
    "temp",
    "temperature",
    "accel",
    "acc",
    "gps",
    "tilt",
    "arm",
    "error",
    "fault",
    "watt",
    "watts",
    "steer",
    "steering",
];

/// Words of a way in units of length.
pub(super) const LENGTHS: [&str; 7] =
    ["pos", "position", "distance", "dist", "travel", "travelled", "odometer"];

/// Words of the voltage that all motors share.
pub(super) const BATTERY: [&str; 8] =
    ["battery", "bat", "batt", "vbat", "vbatt", "bus", "supply", "vin"];

/// Endings of a name that are a unit: as written, unit of the program, and whether it says the quantity
/// by itself.
pub(super) const UNITS: [(&[&str], &str, Option<Quantity>); 32] = [
    (&["mm/s", "mmps", "mmpersec", "mmpersecond"], "mm/s", Some(Quantity::Speed)),
    (&["cm/s", "cmps", "cmpersec", "cmpersecond"], "cm/s", Some(Quantity::Speed)),
    (
        &[
            "meterspersecond",
            "meterspersec",
            "metrespersecond",
            "mpersecond",
            "mpersec",
            "mpers",
            "mps",
            "m/sec",
            "m/s",
        ],
        "m/s",
        Some(Quantity::Speed),
    ),
    (
        &[
            "radianspersecond",
            "radianspersec",
            "radpersec",
            "radpers",
            "radps",
            "rads",
            "rad/sec",
            "rads/s",
            "rad/s",
        ],
        "rad/s",
        Some(Quantity::Speed),
    ),
    (
        &[
            "degreespersecond",
            "degreespersec",
            "degpersec",
            "degpers",
            "degps",
            "dps",
            "deg/sec",
            "°/s",
            "deg/s",
        ],
        "deg/s",
        Some(Quantity::Speed),
    ),
    (
        &[
            "rotationspersecond",
            "rotationspersec",
            "revolutionspersecond",
            "revpersec",
            "revpers",
            "rev/s",
            "rev/sec",
            "rot/s",
            "rps",
            "turnspersecond",
            "turn/s",
            "turns/s",
        ],
        "rev/s",
        Some(Quantity::Speed),
    ),
    (
        &["rotationsperminute", "rpm", "1/min", "r/min", "u/min", "rev/min"],
        "rpm",
        Some(Quantity::Speed),
    ),
    (
        &[
            "ticks/s",
            "ticks/sec",
            "counts/s",
            "counts/sec",
            "tickspersecond",
            "tickspersec",
            "countspersecond",
            "cps",
            "qpps",
            "pps",
        ],
        "ticks/s",
        Some(Quantity::Speed),
    ),
    (&["mrad/s", "mrad/sec", "mradps", "mradpers", "mradpersec"], "mrad/s", Some(Quantity::Speed)),
    (&["mrad"], "mrad", Some(Quantity::Angle)),
    (&["radians", "rad"], "rad", Some(Quantity::Angle)),
    (&["degrees", "degree", "deg", "grad"], "deg", Some(Quantity::Angle)),
    (
        &["rotations", "rotation", "revolutions", "turns", "turn", "revs", "rev"],
        "rev",
        Some(Quantity::Angle),
    ),
    (&["ticks", "tick", "counts"], "ticks", Some(Quantity::Angle)),
    (&["meters", "metres"], "m", None),
    (&["centimeters", "centimetres", "cm"], "cm", Some(Quantity::Angle)),
    (&["millimeters", "millimetres", "mm"], "mm", Some(Quantity::Angle)),
    (&["milliseconds", "millis", "msec", "ms"], "ms", Some(Quantity::Time)),
    (&["microseconds", "micros", "usec", "us"], "us", Some(Quantity::Time)),
    (&["nanoseconds", "ns"], "ns", Some(Quantity::Time)),
    (&["milliamps", "ma"], "mA", Some(Quantity::Current)),
    (&["amperes", "ampere", "amps", "amp", "a"], "A", Some(Quantity::Current)),
    (&["millivolts", "mv"], "mV", Some(Quantity::Voltage)),
    (&["volts", "volt", "v"], "V", Some(Quantity::Voltage)),
    (&["mnm"], "mN m", Some(Quantity::Torque)),
    (&["ncm"], "N cm", Some(Quantity::Torque)),
    (&["kgfcm", "kgcm"], "kgf cm", Some(Quantity::Torque)),
    (&["ozin", "ozfin", "inoz"], "oz in", Some(Quantity::Torque)),
    (&["lbin", "lbfin", "inlb"], "lb in", Some(Quantity::Torque)),
    (&["lbft", "lbfft", "ftlb"], "lb ft", Some(Quantity::Torque)),
    (&["newtonmeters", "newtonmetres", "nm"], "N m", Some(Quantity::Torque)),
    (&["seconds", "second", "secs", "sec", "s"], "s", None),
];

/// The quantity and the word that says it.
pub(super) fn take_quantity(words: &mut Vec<String>) -> Option<(Quantity, String)> {
    // a derivative: d alpha, wheel speed, alpha dot
    let dot = words.iter().any(|w| matches!(w.as_str(), "dot" | "d"));
    let is_alone = words.iter().filter(|w| !w.chars().all(|c| c.is_ascii_digit())).count() == 1;
    for (quantity, known) in QUANTITIES {
        if let Some(k) = words.iter().position(|w| known.contains(&w.as_str())) {
            // one letter says little among other words
            if words[k].len() == 1 && !is_alone && !dot {
                continue;
            }
            let word = words.remove(k);
            let speed = dot && quantity == Quantity::Angle;
            return Some((if speed { Quantity::Speed } else { quantity }, word));
        }
    }
    None
}
