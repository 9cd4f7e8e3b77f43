//! Words of column names: set-points, words that exclude a wheel, and the quantity of a name.

use super::interpreted::Quantity;
use super::quantities::{OPEN_SPEEDS, PLACES, QUANTITIES, SENSORS};

/// Words of an input that may also denote its motor; with a unit of another quantity they are
/// ignored.
pub(super) const WEAK: [&str; 4] = ["power", "motor", "mot", "throttle"];

/// Words of the step between two rows.
pub(super) const STEPS: [&str; 4] = ["dt", "deltat", "interval", "period"];

/// Words of a name that is a command and not a measurement.
pub(in crate::experiment::guess) const WISHED: [&str; 21] = [
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
    "sollwert",
    "consigne",
    "consigna",
    "obiettivo",
    "目标",
    "目標",
    "指令",
    "목표",
];

/// Words for measured values, which carry no other information.
pub(in crate::experiment::guess) const MEASURED: [&str; 15] = [
    "meas", "measured", "measure", "act", "actual", "ist", "istwert", "pv", "fb", "feedback",
    "real", "mes", "实际", "実", "測定",
];

/// Words of the structures in which Simulink and scripts store signals of any kind.
const CONTAINERS: [&str; 8] =
    ["data", "values", "value", "signals", "out", "logsout", "simout", "log"];

/// Words of the system whose ticks are those of a clock.
pub(super) const SYSTEM: [&str; 7] = ["hal", "sys", "system", "os", "rtos", "kernel", "mcu"];
/// Words of a way in units of length.
pub(super) const LENGTHS: [&str; 7] =
    ["pos", "position", "distance", "dist", "travel", "travelled", "odometer"];

/// Words of a distance, driven or to an obstacle.
const DISTANCES: [&str; 2] = ["distance", "dist"];

/// Whether a word denotes a distance, driven or to an obstacle.
pub(in crate::experiment::guess) fn is_distance(word: &str) -> bool {
    DISTANCES.contains(&word)
}

/// Words of the voltage that all motors share.
pub(super) const BATTERY: [&str; 10] =
    ["battery", "bat", "batt", "vbat", "vbatt", "bus", "supply", "vin", "batterie", "akku"];

/// The quantity and the word that denotes it.
pub(super) fn take_quantity(words: &mut Vec<String>) -> Option<(Quantity, String)> {
    // a derivative: d alpha, wheel speed, alpha dot
    let dot = words.iter().any(|w| matches!(w.as_str(), "dot" | "d"));
    let says = |w: &&String| {
        let word = w.as_str();
        let is_empty = MEASURED.contains(&word) || CONTAINERS.contains(&word);
        !is_empty && !w.chars().all(|c| c.is_ascii_digit())
    };
    let is_alone = words.iter().filter(says).count() == 1;
    for (quantity, known) in QUANTITIES {
        if let Some(k) = words.iter().position(|w| is_among(known, w)) {
            // a single letter is ambiguous among other words
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

/// Whether a word denotes a quantity of a wheel, not a time.
pub(super) fn is_of_wheel(word: &str) -> bool {
    let is_time = |q: Quantity| matches!(q, Quantity::Time | Quantity::Nanoseconds);
    QUANTITIES.iter().any(|(quantity, groups)| !is_time(*quantity) && is_among(groups, word))
}

/// Whether a word denotes a quantity.
pub(super) fn is_quantity(word: &str) -> bool {
    QUANTITIES.iter().any(|(_, groups)| is_among(groups, word))
}

fn is_among(groups: &[&[&str]], word: &str) -> bool {
    groups.iter().any(|words| words.contains(&word))
}

/// Whether the word that denotes a speed, if any, leaves its unit open.
pub(in crate::experiment::guess) fn leaves_speed_open(word: &str) -> bool {
    matches!(word, "" | "v") || OPEN_SPEEDS.contains(&word)
}

/// Whether the word that denotes an angle, if any, leaves its unit open.
pub(in crate::experiment::guess) fn leaves_angle_open(word: &str) -> bool {
    word.is_empty() || SENSORS.contains(&word) || is_place(word)
}

/// Whether a word denotes a distance, in any unit.
pub(in crate::experiment::guess) fn is_place(word: &str) -> bool {
    PLACES.contains(&word)
}
