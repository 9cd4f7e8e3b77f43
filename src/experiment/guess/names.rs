//! Interpretation of a column name: quantity, wheel, unit.

mod compounds;
mod factor;
mod foreign;
mod interpreted;
mod measure;
mod prefixed;
mod quantities;
mod side;
mod unit;
mod words;

use self::factor::multiplied;
use self::foreign::is_foreign;
pub(super) use self::interpreted::{Named, Quantity, Side};
use self::measure::Measure;
use self::prefixed::take_prefix;
use self::quantities::TURNS;
use self::side::take_side;
use self::unit::{split_unit, unit, unit_in_front};
use self::words::{BATTERY, STEPS, SYSTEM, WEAK, take_quantity};
pub(super) use self::words::{
    MEASURED, WISHED, is_distance, is_place, leaves_angle_open, leaves_speed_open,
};
use crate::io::{without_port, words};

/// The interpretation of a name.
pub(super) fn named(name: &str) -> Named {
    named_with(name, &|word| word)
}

/// The same with some words of it exchanged for others.
pub(in crate::experiment::guess) fn named_with(
    name: &str,
    exchanged: &dyn Fn(String) -> String,
) -> Named {
    let (name, port) = without_port(name);
    let (times, name) = multiplied(name);
    let (bare, bracket) = split_unit(name);
    let (front, bare) = unit_in_front(bare);
    let mut words: Vec<String> = words(bare).into_iter().map(exchanged).collect();
    compounds::part(&mut words);
    compounds::join(&mut words);
    compounds::in_context(&mut words);
    // Simulink keeps the values of a signal in a field of it
    if words.len() > 1 && words.last().is_some_and(|w| w == "data") {
        words.pop();
    }
    words.extend(port.map(str::to_owned));
    let prefix = take_prefix(bare, &mut words);
    let Measure { unit: mut ending, scale, plain, in_brackets } =
        Measure::taken(&mut words, times, bracket, front);
    let scale = prefix.map(|factor| factor * scale.unwrap_or(1.0)).or(scale);
    let step = words.iter().any(|w| STEPS.contains(&w.as_str()))
        || words.windows(2).any(|w| w[0] == "delta" && matches!(w[1].as_str(), "t" | "time"));
    let foreign = is_foreign(&words);
    let other = step || foreign;
    let battery = !name.contains('%') && is_battery(&words, ending.map(|(unit, _)| unit));
    let wished = words.iter().any(|w| WISHED.contains(&w.as_str()));
    let side = take_side(&mut words);
    let (mut quantity, word) = match other {
        true => (None, String::new()),
        false => quantity_of(&mut words, ending, in_brackets, side.is_some()),
    };
    if ending.is_none() {
        ending = plain.and_then(|unit| of_frequency(&unit, quantity, &word)).and_then(unit);
    }
    // `sec`, `millis`: a unit of time and nothing else
    let time = matches!(ending, Some(("s" | "ms" | "us" | "ns" | "min" | "h" | "d", _)));
    if quantity.is_none() && !other && time && words.is_empty() {
        quantity = Some(Quantity::Time);
    }
    // the ticks of an operating system are those of its clock
    if matches!(ending, Some(("ticks", _))) && words.iter().any(|w| SYSTEM.contains(&w.as_str())) {
        (quantity, ending) = (Some(Quantity::Time), None);
    }
    let unit = ending.map(|(unit, _)| unit).or(match word.as_str() {
        "amps" | "ampere" => Some("A"),
        "volts" | "volt" => Some("V"),
        _ => None,
    });
    let per_row = false;
    Named {
        quantity,
        word,
        side,
        unit,
        scale,
        per_row,
        wished,
        battery,
        step,
        foreign,
        rest: words,
    }
}

/// The quantity that words and unit denote, with its word.
fn quantity_of(
    words: &mut Vec<String>,
    ending: Option<(&'static str, Option<Quantity>)>,
    in_brackets: bool,
    has_side: bool,
) -> (Option<Quantity>, String) {
    let taken = take_quantity(words);
    let (quantity, word) = taken.map_or((None, String::new()), |(stated, by)| (Some(stated), by));
    match ending {
        // a unit in brackets is one for certain: `v_l (m/s)` is no voltage; nor is `position_rpm` a position.
        // `a` alone as a unit is not sufficient
        Some((stated, Some(of))) if in_brackets || is_overruled(quantity, &word, of) => {
            let sufficient = stated != "A" || !words.is_empty() || has_side;
            (sufficient.then_some(of).or(quantity), word)
        }
        _ => (quantity, word),
    }
}

/// The unit of a frequency, without spaces, points and signs.
const PER_SECOND: [&str; 6] = ["1/s", "1/sec", "s1", "s^1", "s⁻¹", "/s"];

/// Unit of a speed in the unit of a frequency. Of `1/s`: turns per second for a word for turns, rad/s for a word for an
/// angular speed; open for any other. Turns alone have a speed in hertz.
fn of_frequency(unit: &str, quantity: Option<Quantity>, word: &str) -> Option<&'static str> {
    let is_speed = quantity == Some(Quantity::Speed);
    match unit {
        "hz" if is_speed => Some("rev/s"),
        unit if !is_speed || !PER_SECOND.contains(&unit) => None,
        _ if TURNS.contains(&word) => Some("rev/s"),
        _ if !leaves_speed_open(word) => Some("rad/s"),
        _ => None,
    }
}

/// Whether a name denotes the battery voltage: it contains volts, or only the battery. The values must then be those
/// of a battery.
fn is_battery(words: &[String], unit: Option<&str>) -> bool {
    let is_volt = |w: &String| {
        matches!(w.as_str(), "voltage" | "volt" | "volts" | "vbat" | "vbatt" | "spannung")
    };
    let is_one = |w: &String| BATTERY.contains(&w.as_str());
    words.iter().any(is_one)
        && match unit {
            Some(unit) => matches!(unit, "V" | "mV"),
            None => words.iter().any(is_volt) || words.iter().all(is_one),
        }
}

/// Whether the unit after a name takes precedence over its word: `position_rpm` is a speed, `left_motor_rpm` is no
/// input, and a single letter has no precedence over any unit.
fn is_overruled(quantity: Option<Quantity>, word: &str, of: Quantity) -> bool {
    match quantity {
        None => true,
        Some(Quantity::Angle) => of == Quantity::Speed,
        Some(_) => WEAK.contains(&word) || word.len() == 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_common_loggers_say_quantity_wheel_and_unit() {
        use Quantity::*;
        use Side::*;
        let cases = [
            ("time_ms", Some(Time), None, Some("ms")),
            ("stamp", Some(Time), None, None),
            ("timestamp_us", Some(Time), None, Some("us")),
            ("sec", Some(Time), None, Some("s")),
            ("header.stamp.nanosec", Some(Nanoseconds), None, None),
            ("wR", Some(Speed), Some(Right), None),
            ("Rspeed", Some(Speed), Some(Right), None),
            ("lvolt", Some(Voltage), Some(Left), Some("V")),
            ("rightspeed", Some(Speed), Some(Right), None),
            ("Lpwm", Some(Voltage), Some(Left), None),
            ("vel_right [rpm]", Some(Speed), Some(Right), Some("rpm")),
            ("omega 1 (rechts)", Some(Speed), Some(Right), None),
            ("left_vel", Some(Speed), Some(Left), None),
            ("curR", Some(Current), Some(Right), None),
            ("i_left_mA", Some(Current), Some(Left), Some("mA")),
            ("right_rpm", Some(Speed), Some(Right), Some("rpm")),
            ("LeftVelocityRadPerSec", Some(Speed), Some(Left), Some("rad/s")),
            ("/Drive/RightAppliedVolts", Some(Voltage), Some(Right), Some("V")),
            ("leftPositionRotations", Some(Angle), Some(Left), Some("rev")),
            ("right_rev_per_s", Some(Speed), Some(Right), Some("rev/s")),
            ("right_rev", Some(Angle), Some(Right), Some("rev")),
            ("axis0.encoder.vel_estimate", Some(Speed), Some(Numbered(0)), None),
            ("axis1.motor.current_control.Iq_measured", Some(Current), Some(Numbered(1)), None),
            ("erpm_left", Some(Speed), Some(Left), Some("rpm")),
            ("velocity(:,1)", Some(Speed), Some(Numbered(1)), None),
            ("enc_l_ticks", Some(Angle), Some(Left), Some("ticks")),
            ("tau_r", Some(Torque), Some(Right), None),
            ("TqL", Some(Torque), Some(Left), None),
            ("T_l (N.m)", Some(Torque), Some(Left), Some("N m")),
            ("v_l (m/s)", Some(Speed), Some(Left), Some("m/s")),
            ("left_motor_rpm", Some(Speed), Some(Left), Some("rpm")),
            ("motor_left_deg", Some(Angle), Some(Left), Some("deg")),
            ("left_motor_ticks", Some(Angle), Some(Left), Some("ticks")),
            ("left_mm_s", Some(Speed), Some(Left), Some("mm/s")),
            ("left_speed_m_s", Some(Speed), Some(Left), Some("m/s")),
            ("right_vel_m_per_s", Some(Speed), Some(Right), Some("m/s")),
            ("left_speed_ms", Some(Speed), Some(Left), Some("m/s")),
            ("left [U/min]", Some(Speed), Some(Left), Some("rpm")),
            ("speed left (deg/sec)", Some(Speed), Some(Left), Some("deg/s")),
            ("right (Amps)", Some(Current), Some(Right), Some("A")),
            ("stamp_ms", Some(Time), None, Some("ms")),
            ("vR_cm_s", Some(Speed), Some(Right), Some("cm/s")),
            ("speed_a", Some(Speed), None, None),
            ("rpmA", Some(Speed), None, Some("rpm")),
            ("current_mA.A", Some(Current), None, Some("mA")),
            ("current_mA.B", Some(Current), None, Some("mA")),
            ("mA_left", Some(Current), Some(Left), Some("mA")),
            ("pwm_a", Some(Voltage), None, None),
            ("left_a", Some(Current), Some(Left), Some("A")),
            ("Left Vol", Some(Voltage), Some(Left), None),
            ("dt_ms", None, None, Some("ms")),
            ("steering_deg", None, None, Some("deg")),
            ("gyro_rate", None, None, None),
            ("Vbat", None, None, None),
            ("M2", Some(Torque), Some(Numbered(2)), None),
            ("M1_speed_qpps", Some(Speed), Some(Numbered(1)), Some("ticks/s")),
            ("id2_present_velocity", Some(Speed), Some(Numbered(2)), None),
            ("B_degrees", Some(Angle), None, Some("deg")),
            ("ω right [rad/s]", Some(Speed), Some(Right), Some("rad/s")),
            ("Motor Power Ch2", Some(Voltage), Some(Numbered(2)), None),
            ("motL", Some(Voltage), Some(Left), None),
            ("taur", Some(Torque), Some(Right), None),
            ("Wheel Speed RL [rpm]", Some(Speed), Some(Left), Some("rpm")),
            ("LB velocity (rpm)", Some(Speed), Some(Left), Some("rpm")),
            ("motor_rf_mA", Some(Current), Some(Right), Some("mA")),
            ("battery_voltage_mV", None, None, Some("mV")),
            ("torque_right [oz-in]", Some(Torque), Some(Right), Some("oz in")),
            ("torque_left (kgf.cm)", Some(Torque), Some(Left), Some("kgf cm")),
            ("left_pos_m", Some(Angle), Some(Left), Some("m")),
            ("alpha1", Some(Angle), Some(Numbered(1)), None),
            ("rad_s_l", Some(Speed), Some(Left), Some("rad/s")),
            ("rad_per_s_right", Some(Speed), Some(Right), Some("rad/s")),
            ("wheel_rad_s_left", Some(Speed), Some(Left), Some("rad/s")),
            ("rads_l", Some(Speed), Some(Left), Some("rad/s")),
            ("deg/s", Some(Speed), None, Some("deg/s")),
            ("left_tps", Some(Speed), Some(Left), Some("ticks/s")),
            ("ticks_per_sec_l", Some(Speed), Some(Left), Some("ticks/s")),
            ("speed_l_kmh", Some(Speed), Some(Left), Some("km/h")),
            ("cnt_l", Some(Angle), Some(Left), None),
            ("rot_r", Some(Angle), Some(Right), None),
            ("시간(초)", Some(Time), None, Some("s")),
            ("时间(毫秒)", Some(Time), None, Some("ms")),
            ("左轮转速(转/分)", Some(Speed), Some(Left), Some("rpm")),
            ("Left Velocity (ft/s)", Some(Speed), Some(Left), Some("ft/s")),
            ("leftPositionInches", Some(Angle), Some(Left), Some("in")),
            ("tick_ms", Some(Time), None, Some("ms")),
            ("HAL_tick", Some(Time), None, None),
            ("tick_l", Some(Angle), Some(Left), Some("ticks")),
            ("left_pulses", Some(Angle), Some(Left), Some("ticks")),
            ("wl_meas", Some(Speed), Some(Left), None),
            ("ist_r", None, Some(Right), None),
            ("spd_l", Some(Speed), Some(Left), None),
            ("Vitesse roue gauche (tr/min)", Some(Speed), Some(Left), Some("rpm")),
            ("Tension moteur droit (V)", Some(Voltage), Some(Right), Some("V")),
            ("vel_sx", Some(Speed), Some(Left), None),
            ("rpm_der", Some(Speed), Some(Right), Some("rpm")),
            ("Drehzahl der linken Seite", Some(Speed), Some(Left), None),
            ("左实际速度", Some(Speed), Some(Left), None),
            ("скорость_прав", Some(Speed), Some(Right), None),
            ("ток правый [А]", Some(Current), Some(Right), Some("A")),
            ("скорость левая [рад/с]", Some(Speed), Some(Left), Some("rad/s")),
            ("wheel_rl_eff", Some(Torque), Some(Left), None),
            ("prędkość kątowa lewego koła [rad/s]", Some(Speed), Some(Left), Some("rad/s")),
            ("Motorstrom rechts", Some(Current), Some(Right), None),
            ("Raddrehzahl links [U/min]", Some(Speed), Some(Left), Some("rpm")),
            ("Batteriespannung", None, None, None),
            ("otáčky levé", Some(Speed), Some(Left), None),
            ("varvtal vänster", Some(Speed), Some(Left), None),
            ("akım sağ", Some(Current), Some(Right), None),
            ("lw_vel", Some(Speed), Some(Left), None),
            ("range_left", None, Some(Left), None),
            ("ir_right", None, Some(Right), None),
            ("tof_left_mm", None, Some(Left), Some("mm")),
            ("dalpha2", Some(Speed), Some(Numbered(2)), None),
            ("Motor right turns_per_s", Some(Speed), Some(Right), Some("rev/s")),
            ("left rotations/s", Some(Speed), Some(Left), Some("rev/s")),
            ("right_revs_per_sec", Some(Speed), Some(Right), Some("rev/s")),
            ("wheel_left_rotations_per_second", Some(Speed), Some(Left), Some("rev/s")),
            ("wheel_speed_right_left(:,2)", Some(Speed), Some(Numbered(2)), None),
            ("1.velocity [Hz]", Some(Speed), Some(Numbered(1)), Some("rev/s")),
            ("/feedback/drivers[0]/measured_travel", Some(Angle), Some(Numbered(0)), None),
            ("drivers[1]/speed [rpm]", Some(Speed), Some(Numbered(1)), Some("rpm")),
            ("left.halfturns", Some(Angle), Some(Left), Some("rev")),
            ("amps_l", Some(Current), Some(Left), Some("A")),
            ("out.wl.Data", Some(Speed), Some(Left), None),
            ("Right Wheel/Speed (rpm):1", Some(Speed), Some(Right), Some("rpm")),
            ("Speed (rpm):2", Some(Speed), Some(Numbered(2)), Some("rpm")),
            ("logsout.signals.values.ir", Some(Current), Some(Right), None),
        ];
        for (name, quantity, side, unit) in cases {
            let found = named(name);
            assert_eq!((found.quantity, found.side, found.unit), (quantity, side, unit), "{name}");
        }
        assert!(named("cmd_vel_left").wished && !named("left_vel").wished);
        for name in ["current_10mA", "current [10 mA]"] {
            assert_eq!((named(name).unit, named(name).scale), (Some("mA"), Some(10.0)), "{name}");
        }
        let speed = named("right_speed_cm_s_x100");
        assert_eq!(
            (speed.quantity, speed.unit, speed.scale),
            (Some(Speed), Some("cm/s"), Some(0.01))
        );
        assert_eq!(named("speed [1/min]").scale, None);
        for half in ["left.halfturns", "left_half_turns", "left [half-turns]", "left_pos_halfrev"] {
            let found = named(half);
            assert_eq!(
                (found.unit, found.scale, found.quantity),
                (Some("rev"), Some(0.5), Some(Angle))
            );
        }
        assert!(named("battery_voltage_mV").battery && named("Vbat").battery);
        assert!(named("bat").battery && named("Battery").battery && named("vbatt").battery);
        assert!(!named("battery_charge").battery && !named("battery [%]").battery);
        assert!(!named("battery_mA").battery);
    }
}
