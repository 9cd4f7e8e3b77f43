//! The firmware of VESC: electrical speeds as rpm, currents in amperes.

use super::guessed::{Guess, Guessed};
use super::names::named;
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Names of the values that the firmware of VESC sends together with `rpm`, which is the electrical speed, and of the
/// columns of VESC Tool.
const VESC: [&str; 14] = [
    "avg_motor_current",
    "avg_input_current",
    "duty_now",
    "duty_cycle_now",
    "temp_mos",
    "temp_fet",
    "tachometer_abs",
    "amp_hours_charged",
    "watt_hours_charged",
    "current_motor",
    "motor_current_avg",
    "current_in",
    "ms_today",
    "erpm",
];

/// Fields of the messages `vesc_msgs/VescState` of ROS, whose `speed` is the electrical one in rpm.
const STATE: [&str; 6] = [
    "current_motor",
    "charge_drawn",
    "energy_drawn",
    "displacement",
    "distance_traveled",
    "temperature_pcb",
];

/// Two of these names among the columns.
fn known(columns: &[PreviewColumn], names: &[&'static str]) -> Option<[&'static str; 2]> {
    let plain = |name: &str| {
        let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
        parts.collect::<Vec<_>>().join("_").to_lowercase()
    };
    let columns: Vec<String> = columns.iter().map(|c| plain(&c.name)).collect();
    let has = |value: &&str| columns.iter().any(|name| name.contains(value));
    let mut known = names.iter().copied().filter(has);
    Some([known.next()?, known.next()?])
}

/// Gives currents of VESC their unit: the firmware sends and VESC Tool writes amperes, whatever their size.
pub(super) fn currents(columns: &[PreviewColumn], guess: &mut Guess) {
    let known = known(columns, &VESC).or_else(|| known(columns, &STATE));
    let Some([first, second]) = known else { return };
    let is_open =
        |c: &&mut Guessed| c.key.starts_with('M') && c.unit.is_none() && c.scale.is_none();
    if guess.drive_unit == DriveUnit::Ampere {
        for one in guess.columns.iter_mut().filter(is_open) {
            one.unit = Some("A".into());
            one.evidence
                .push(format!("`{first}` and `{second}` are names of VESC, which logs amperes"));
        }
    }
}

/// Gives speeds of the messages of ROS their unit.
pub(super) fn speeds(columns: &[PreviewColumn], guess: &mut Guess) {
    if known(columns, &STATE).is_none() {
        return;
    }
    let is_open = |c: &&mut Guessed| {
        c.key.starts_with("dalpha") && c.unit.is_none() && named(&c.name).word == "speed"
    };
    guess.columns.iter_mut().filter(is_open).for_each(|c| c.unit = Some("rpm".into()));
}

/// The question on speeds in rpm of VESC, whose factor is then open.
pub(super) fn mark(columns: &[PreviewColumn], guess: &mut Guess) -> Option<String> {
    let is_rpm = |c: &Guessed| {
        c.key.starts_with("dalpha") && c.unit.as_deref() == Some("rpm") && !c.is_electrical()
    };
    let first = guess.columns.iter().find(|c| is_rpm(c))?.name.clone();
    let known = known(columns, &VESC).or_else(|| known(columns, &STATE))?;
    for one in guess.columns.iter_mut().filter(|c| is_rpm(c)) {
        one.scale_open |= one.scale.is_none();
    }
    Some(format!(
        "`{first}` with `{}` and `{}` is from the VESC firmware, which counts electrical turns: write 1/(pole pairs of \
         the motor x gear) as scale, 0.14 for 7 pole pairs without gear; 1 where the log holds turns of the wheel",
        known[0], known[1]
    ))
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn rpm_of_the_vesc_firmware_is_electrical() {
        let log = |of: [&str; 3]| {
            let column = |name: String| PreviewColumn {
                name,
                values: (0..200).map(|k| 900.0 * (0.05 * f64::from(k)).sin()).collect(),
                ..PreviewColumn::default()
            };
            let sides = ["left", "right"].map(|s| of.map(|name| column(format!("{s}.{name}"))));
            guess(&sides.into_iter().flatten().collect::<Vec<_>>())
        };
        let vesc = log(["rpm", "avg_motor_current", "duty_now"]);
        let speed = vesc.columns.iter().find(|c| c.key == "dalpha1").unwrap();
        assert!(speed.scale_open, "{speed:?}");
        assert!(
            vesc.questions.iter().any(|q| q.text.contains("pole pairs")),
            "{:?}",
            vesc.questions
        );
        // a large motor: its currents are no milliamperes
        let m1 = vesc.columns.iter().find(|c| c.key == "M1").unwrap();
        assert_eq!(m1.unit.as_deref(), Some("A"));
        assert!(m1.evidence[0].contains("VESC, which logs amperes"), "{m1:?}");
        let ros = log(["state.speed", "state.current_motor", "state.charge_drawn"]);
        let speed = ros.columns.iter().find(|c| c.key == "dalpha1").unwrap();
        assert_eq!((speed.unit.as_deref(), speed.scale_open), (Some("rpm"), true));
        let other = log(["rpm", "motor_current", "duty"]);
        assert!(other.columns.iter().all(|c| !c.scale_open), "{other:?}");
    }
}
