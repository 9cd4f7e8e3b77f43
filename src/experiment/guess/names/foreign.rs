//! Names of quantities that are not those of a wheel.

use crate::io::side;

/// Words of quantities that are not those of a wheel: of the body, of the battery, and of sensors that measure the
/// distance to an obstacle.
const OTHERS: [&str; 50] = [
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
    "batterie",
    "akku",
    "range",
    "ranges",
    "rangefinder",
    "lidar",
    "laser",
    "scan",
    "scanner",
    "sonar",
    "ultrasonic",
    "ultrasound",
    "ultraschall",
    "hcsr",
    "infrared",
    "tof",
    "proximity",
    "prox",
    "obstacle",
    "cliff",
    "bumper",
    "clearance",
    "entfernung",
    "abstand",
    "odleglosc",
];

/// Whether words are those of such a quantity. `ir` with a side of its own is an infrared sensor; alone it is the
/// current of the right motor. A power in watts is that of a motor, but no command of it.
pub(super) fn is_foreign(words: &[String]) -> bool {
    let has_side = || words.iter().any(|w| side(w).is_some());
    let is_watts = |w: &[String]| w[0] == "power" && ["w", "mw", "kw"].contains(&w[1].as_str());
    words.windows(2).any(is_watts)
        || words.iter().any(|w| OTHERS.contains(&w.as_str()) || w == "ir" && has_side())
}
