//! Keys of an experiment file that are valid but have unexpected consequences.

use toml::{Table, Value};

use super::remark::{FixedMovement, Remark};
use crate::conditioning::{Action, Channel, Finding, Kind};
use crate::effects;
use crate::model::Model;
use crate::recording::{DriveUnit, Recording};

/// Remarks on a file. `table` contains only the keys that are written in it, because defaults need no remark.
pub(super) fn remarks(table: &Table) -> Vec<Remark> {
    [unused_length(table), other_gain(table)].into_iter().flatten().collect()
}

/// Length and top speed apply only to rich movements.
fn unused_length(table: &Table) -> Option<Remark> {
    let simulation = table.get("simulation")?.as_table()?;
    let movement = match simulation.get("movement")? {
        Value::String(name) if name == "paper" => FixedMovement::Paper,
        Value::Array(_) => FixedMovement::Segments,
        _ => return None,
    };
    let grid = table.get("grid").and_then(Value::as_table);
    let varies = |key: &str| {
        grid.is_some_and(|g| g.contains_key(key) || g.contains_key(&format!("simulation.{key}")))
    };
    if varies("movement") {
        return None;
    }
    let is_written = |key: &&str| simulation.contains_key(*key) || varies(key);
    let keys: Vec<&str> =
        ["duration_s", "top_speed_rad_s"].into_iter().filter(is_written).collect();
    (!keys.is_empty()).then_some(Remark::Unused { keys, movement })
}

/// A fuzzy method is fitted in an emulator, with its own gain if the file specifies none.
fn other_gain(table: &Table) -> Option<Remark> {
    let emulator = table.get("emulator").and_then(Value::as_table);
    let positive = |v: &Value| v.as_float().or(v.as_integer().map(|k| k as f64)) > Some(0.0);
    let states = |key: &str| emulator.is_some_and(|e| e.contains_key(key));
    if states("poles") || states("matrix") || emulator?.get("gain").is_none_or(positive) {
        return None;
    }
    let tables = table.get("method")?.as_array()?.iter().filter_map(Value::as_table);
    let methods: Vec<String> = tables
        .filter(|m| !m.contains_key("gain"))
        .filter_map(|m| m.get("name")?.as_str())
        .filter(|name| crate::identify::find(name).is_some_and(|m| m.fits_emulator()))
        .map(String::from)
        .collect();
    (!methods.is_empty()).then_some(Remark::OtherGain { methods })
}

/// Effects that belong to an input in this unit and that the model has neither itself nor by an
/// equivalent.
pub(super) fn without_effects(model: &Model, input: DriveUnit) -> Vec<Remark> {
    let ids: Vec<String> = model.effects().iter().map(|effect| effect.id()).collect();
    let is_absent = |id: &String| {
        let alike = effects::find(id).map_or(vec![], |effect| effect.description().equivalent);
        !ids.contains(id) && !alike.iter().any(|id| ids.contains(id))
    };
    let absent = effects::belonging_to(input).into_iter().filter(is_absent);
    absent.map(|effect| Remark::WithoutEffect { input, effect }).collect()
}

/// Recordings with the samples of an earlier one: the places of both.
pub(super) fn repeated(recordings: &[&Recording]) -> Vec<(usize, usize)> {
    let is_same = |a: &Recording, b: &Recording| {
        a.len() == b.len() && a.torque() == b.torque() && a.omega() == b.omega()
    };
    let first = |k: usize| (0..k).find(|j| is_same(recordings[*j], recordings[k]));
    (1..recordings.len()).filter_map(|k| Some((first(k)?, k))).collect()
}

/// Share of the rows with wheels turning in opposite directions above which a mirrored motor is suspected:
/// otherwise this occurs only in tests of turning.
const OPPOSED: f64 = 2.0 / 3.0;
/// Share of the top speed below which a wheel is at rest.
const RESTS: f64 = 0.05;

/// The share of these rows of speeds in which the wheels turn in opposite directions, if nearly always.
pub(super) fn opposed(rows: &[[f64; 2]]) -> Option<f64> {
    let top = |i: usize| rows.iter().map(|w| w[i].abs()).fold(0.0, f64::max);
    let tops = [top(0), top(1)];
    let moving = rows.iter().filter(|w| (0..2).all(|i| w[i].abs() > RESTS * tops[i]));
    let (mut count, mut against) = (0, 0);
    for w in moving {
        count += 1;
        against += usize::from(w[0] * w[1] < 0.0);
    }
    let share = f64::from(against as u32) / f64::from(count.max(1));
    (share > OPPOSED).then_some(share)
}

/// The remark on wheels whose `speeds` nearly always have opposite directions, with the wheel whose angle was inverted
/// according to the `findings` of conditioning, because its speed and its input have the other sign.
pub(super) fn opposed_wheels<'a>(
    speeds: &[[f64; 2]],
    mut findings: impl Iterator<Item = &'a Finding>,
) -> Option<Remark> {
    let share = opposed(speeds)?;
    let inverted = findings.find_map(|f| match f {
        Finding { channel: Channel::Angle(i), kind: Kind::Sign, action: Action::Corrected(_) } => {
            Some(*i)
        }
        _ => None,
    });
    Some(Remark::Opposed { share, inverted })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        let remarks = remarks(&toml::from_str(text).unwrap());
        remarks.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn a_length_that_the_movement_does_not_take_is_named() {
        let text = "[simulation]\nmovement = \"paper\"\nduration_s = 60.0\n";
        assert!(
            said(text)
                .starts_with("simulation.duration_s has no effect, because the movement is \"pap")
        );
        assert!(
            said("[simulation]\nmovement = \"paper\"\n[grid]\nduration_s = [4, 8]\n")
                .contains("duration_s has")
        );
        assert_eq!(said("[simulation]\nmovement = \"rich\"\nduration_s = 60.0\n"), "");
        assert_eq!(said("[simulation]\nduration_s = 60.0\n"), "");
        assert_eq!(said(&format!("{text}[grid]\nmovement = [\"rich\", \"paper\"]\n")), "");
        assert_eq!(said("[simulation]\nmovement = \"paper\"\n"), "");
    }

    #[test]
    fn a_fuzzy_method_that_is_fitted_at_another_gain_is_named() {
        let method = "[[method]]\nname = \"fuzzy_anfis\"\n";
        let zero = "[emulator]\ngain = 0.0\n";
        assert!(said(&format!("{zero}{method}")).contains("the evaluation only: fuzzy_anfis is"));
        assert_eq!(said(&format!("{zero}{method}gain = 0.0\n")), "");
        assert_eq!(said(&format!("[emulator]\ngain = 2\n{method}")), "");
        assert_eq!(said(&format!("[emulator]\npoles = [-1.0, -2.0]\n{method}")), "");
        assert_eq!(said(&format!("{zero}[[method]]\nname = \"output_error\"\n")), "");
    }

    #[test]
    fn of_an_inverted_angle_the_remark_names_the_columns_with_the_wrong_sign() {
        let said = Remark::Opposed { share: 1.0, inverted: Some(0) }.to_string();
        assert!(said.contains("write scale = -1 in dalpha1 and M1, and not in alpha1"), "{said}");
    }
}
