//! Words of column names: quantities, set-points, words that exclude a wheel, units.

use super::interpreted::Quantity;

/// Words of a speed that leave its unit open; `omega` and the like are angular speeds in SI.
const OPEN_SPEEDS: [&str; 27] = [
    "speed",
    "spd",
    "vel",
    "velo",
    "velocity",
    "velocities",
    "drehzahl",
    "geschwindigkeit",
    "vitesse",
    "velocita",
    "velocidad",
    "velocidade",
    "predkosc",
    "snelheid",
    "hiz",
    "hastighet",
    "hastighed",
    "nopeus",
    "rychlost",
    "viteza",
    "obroty",
    "otacky",
    "varvtal",
    "toerental",
    "скорость",
    "速度",
    "속도",
];
/// Words of a number of turns in a time.
pub(super) const TURNS: [&str; 10] = [
    "drehzahl",
    "obroty",
    "otacky",
    "varvtal",
    "toerental",
    "rpm",
    "转速",
    "轉速",
    "回転数",
    "회전수",
];
/// Words of a distance, in any unit.
const PLACES: [&str; 15] = [
    "pos",
    "position",
    "positions",
    "distance",
    "dist",
    "travel",
    "pozycja",
    "polozenie",
    "poloha",
    "posicion",
    "posizione",
    "posicao",
    "positie",
    "lage",
    "asento",
];
/// Words of a sensor of angles that leave its unit open.
const SENSORS: [&str; 2] = ["enc", "encoder"];

/// Words of each quantity; those of speeds and angles that leave the unit open are groups of their own.
const QUANTITIES: [(Quantity, &[&[&str]]); 7] = [
    (Quantity::Nanoseconds, &[&["nanosec", "nsec", "nanosecs", "nsecs", "nanoseconds"]]),
    (
        Quantity::Time,
        &[&[
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
            "uhrzeit",
            "zeitstempel",
            "datum",
            "fecha",
            "hora",
            "heure",
            "orario",
            "cas",
            "tid",
            "aika",
            "timp",
            "godzina",
            // of a day: the milliseconds of VESC Tool
            "today",
            "temps",
            "tempo",
            "tiempo",
            "czas",
            "tijd",
            "zaman",
            "время",
            "时间",
            "時間",
            "시간",
            "uptime",
            "systick",
        ]],
    ),
    (
        Quantity::Speed,
        &[
            &[
                "dalpha",
                "omega",
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
                "winkelgeschwindigkeit",
                "ω",
                "转速",
                "轉速",
                "回転数",
                "회전수",
            ],
            &OPEN_SPEEDS,
        ],
    ),
    (
        Quantity::Angle,
        &[
            &[
                "alpha",
                "angle",
                "theta",
                "phi",
                "q",
                "rotations",
                "rotation",
                "turns",
                "ticks",
                "counts",
                "count",
                "pulses",
                "tachometer",
                "tacho",
                "rev",
                "winkel",
                "travelled",
                "odometer",
                "θ",
                "φ",
                "α",
                "cnt",
                "rot",
                "angolo",
                "angulo",
                "hoek",
                "kat",
                "uhel",
                "vinkel",
                "угол",
                "角度",
                "각도",
            ],
            &PLACES,
            &SENSORS,
        ],
    ),
    (
        Quantity::Torque,
        &[&[
            "m",
            "moment",
            "torque",
            "tau",
            "effort",
            "efforts",
            "eff",
            "trq",
            "tq",
            "drehmoment",
            "τ",
            "couple",
            "coppia",
            "koppel",
            "par",
            "tork",
            "момент",
            "扭矩",
            "转矩",
            "轉矩",
            "토크",
            "トルク",
        ]],
    ),
    (
        Quantity::Current,
        &[&[
            "current",
            "currents",
            "cur",
            "curr",
            "i",
            "amps",
            "iq",
            "ia",
            "ampere",
            "strom",
            "courant",
            "corrente",
            "corriente",
            "prad",
            "stroom",
            "proud",
            "prud",
            "akim",
            "virta",
            "intensidad",
            "intensite",
            "ток",
            "电流",
            "電流",
            "전류",
        ]],
    ),
    (
        Quantity::Voltage,
        &[&[
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
            "tension",
            "tensione",
            "tensao",
            "voltaje",
            "napiecie",
            "spanning",
            "spanding",
            "napeti",
            "gerilim",
            "jannite",
            "wypelnienie",
            "напряжение",
            "电压",
            "電圧",
            "電壓",
            "전압",
            "throttle",
            // of a motor and nothing else: its command
            "power",
            "motor",
            "mot",
        ]],
    ),
];

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
