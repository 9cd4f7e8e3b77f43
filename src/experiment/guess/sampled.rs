//! Currents and voltages of the same motors in one log: which of them are the input.

use super::Input;
use super::commands::is_share_word;
use super::guessed::{Guess, Guessed};
use super::names::named;
use super::times::{rate, time};
use super::values::{is_never_negative, values_of};
use crate::conditioning::IMPORT;
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Rate of the rows \[Hz\] from which a current is used before a voltage: that at which half a row over the time constant of
/// a motor is the largest error of its inertia.
const SAMPLED: f64 = 0.5 / (IMPORT.sampled_error * IMPORT.motor_s);

/// The inputs with voltages first where the currents are sampled too slowly; and of currents and voltages those that
/// come last.
pub(super) fn order(
    columns: &[PreviewColumn],
    out: &Guess,
    inputs: Vec<Input>,
) -> (Vec<Input>, Option<Input>) {
    let of = |unit: DriveUnit| inputs.iter().position(|(_, u)| *u == unit);
    let (Some(current), Some(voltage)) = (of(DriveUnit::Ampere), of(DriveUnit::Volt)) else {
        return (inputs, None);
    };
    let volts = &inputs[voltage].0;
    // a side that drives forward only is never negative, nor is the battery
    let has_sign = |one: &Guessed| !is_never_negative(values_of(columns, &one.name));
    let are_volts = volts.iter().all(is_in_volts) && volts.iter().any(has_sign);
    if !are_volts || of(DriveUnit::NewtonMetre).is_some() {
        return (inputs, None);
    }
    let mut inputs = inputs;
    let rate = rate_of(columns, out);
    if rate.is_some_and(|rate| rate < SAMPLED) {
        inputs.swap(current, voltage);
        let [one, other] = inputs[voltage].0.each_ref().map(|c| c.name.clone());
        inputs[current].0[0].evidence.push(format!(
            "a voltage is known between the rows as well, where it is held; the currents `{one}` and `{other}` are \
             samples at {:.0} Hz",
            rate.unwrap_or_default()
        ));
    }
    let last = inputs[current.max(voltage)].clone();
    (inputs, Some(last))
}

/// Whether a column states volts.
fn is_in_volts(one: &Guessed) -> bool {
    let name = named(&one.name);
    let is_stated = matches!(name.unit, Some("V" | "mV")) || name.word.starts_with("volt");
    is_stated && !is_share_word(&one.name)
}

/// Rate of the rows \[Hz\]; `None` without a column of the time.
fn rate_of(columns: &[PreviewColumn], out: &Guess) -> Option<f64> {
    let mut one = out.columns.iter().find(|c| c.key == "t")?.clone();
    let values = values_of(columns, &one.name);
    time(values, &mut one);
    rate(values, &one)
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;
    use crate::recording::DriveUnit;

    #[test]
    fn volts_come_before_currents_that_are_sampled_slowly() {
        let log = |rate: f64| {
            let column = |(name, shift): (&str, f64)| PreviewColumn {
                name: name.into(),
                values: (0..2000).map(|k| (0.05 * f64::from(k) + shift).sin()).collect(),
                ..PreviewColumn::default()
            };
            let names = ["w_r", "w_l", "i_r_A", "i_l_A", "u_r_V", "u_l_V"];
            let mut log: Vec<PreviewColumn> =
                names.into_iter().zip([0.0, 0.1, 0.7, 0.8, 0.5, 0.6]).map(column).collect();
            let values = (0..2000).map(|k| f64::from(k) / rate).collect();
            log.push(PreviewColumn { name: "t".into(), values, ..PreviewColumn::default() });
            guess(&log)
        };
        let (slow, fast) = (log(50.0), log(1000.0));
        assert_eq!((slow.drive_unit, fast.drive_unit), (DriveUnit::Volt, DriveUnit::Ampere));
        let other = |g: &super::Guess| g.other_input.as_ref().map(|(pair, _)| pair[0].name.clone());
        assert_eq!(other(&slow).as_deref(), Some("i_r_A"));
        assert_eq!(other(&fast).as_deref(), Some("u_r_V"));
        assert!(
            slow.words().contains("`i_r_A` and `i_l_A` are samples at 50 Hz"),
            "{}",
            slow.words()
        );
    }

    #[test]
    fn volts_of_a_step_have_a_sign_by_the_mirrored_side() {
        let step = |name: &str, top: f64| PreviewColumn {
            name: name.into(),
            values: (0..200)
                .map(|k| if k < 50 { 0.0 } else { top + 0.01 * f64::from(k % 7) })
                .collect(),
            ..PreviewColumn::default()
        };
        let unit = |left: f64| {
            let names = [("Left Voltage", left), ("Right Voltage", 3.0), ("Left Current", 8.0)];
            let more =
                [("Right Current", 7.0), ("Left Speed rpm", 90.0), ("Right Speed rpm", 91.0)];
            let mut log: Vec<PreviewColumn> =
                names.into_iter().chain(more).map(|(name, top)| step(name, top)).collect();
            let values = (0..200).map(|k| 0.1 * f64::from(k)).collect();
            log.push(PreviewColumn { name: "t".into(), values, ..PreviewColumn::default() });
            guess(&log).drive_unit
        };
        assert_eq!(unit(-3.0), DriveUnit::Volt);
        // neither side shows that it can be negative: it may be the voltage of the battery
        assert_eq!(unit(3.0), DriveUnit::Ampere);
    }

    #[test]
    fn volts_that_only_a_word_states_and_currents_of_three_motors() {
        let log = |with_volts: bool| {
            let column = |(name, shift): (String, f64)| PreviewColumn {
                name,
                values: (0..400).map(|k| (0.05 * f64::from(k) + shift).sin()).collect(),
                ..PreviewColumn::default()
            };
            let motors = ["Master Current", "Slave 1 Current", "Slave 2 Current", "Speed rpm"];
            let volts = ["Voltage"].into_iter().filter(|_| with_volts);
            let names = motors.into_iter().chain(volts);
            let named = names.flat_map(|n| [format!("Left {n}"), format!("Right {n}")]);
            let mut log: Vec<PreviewColumn> =
                named.enumerate().map(|(k, name)| column((name, 0.1 * k as f64))).collect();
            let values = (0..400).map(|k| 0.1 * f64::from(k)).collect();
            log.push(PreviewColumn { name: "t".into(), values, ..PreviewColumn::default() });
            let g = guess(&log);
            let input = g.columns.into_iter().find(|c| c.key == "M1").unwrap();
            (input.name, input.plus, g.drive_unit)
        };
        let (name, plus, unit) = log(true);
        assert_eq!((name.as_str(), plus.len(), unit), ("Right Voltage", 0, DriveUnit::Volt));
        let (name, plus, unit) = log(false);
        assert_eq!((name.as_str(), unit), ("Right Master Current", DriveUnit::Ampere));
        assert_eq!(plus, ["Right Slave 1 Current", "Right Slave 2 Current"]);
    }
}
