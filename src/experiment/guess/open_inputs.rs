//! The question on the input if no name denotes one and few columns are left.

use super::guessed::{Guess, Guessed};
use super::model_key::effects_of;
use super::names::{Named, Quantity, Side, named};
use super::values::{largest, never_varies};
use super::{ANGLES, SPEEDS};
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// The keys to be written together with the columns.
fn beside() -> String {
    format!(
        "drive_unit as \"V\" of a voltage or PWM, with hold = \"constant\" below it and {} under [model]",
        effects_of(DriveUnit::Volt)
    )
}

/// Words for the output of a controller that drives all motors.
const CONTROLS: [&str; 6] = ["output", "out", "command", "cmd", "control", "input"];

/// Whether a name contains such words alone.
fn is_of_controller(n: &Named) -> bool {
    !n.rest.is_empty() && n.rest.iter().all(|w| CONTROLS.contains(&w.as_str()))
}

/// The text on values between -1 and 1: a share, by its size.
fn share_of(values: &[f64]) -> &'static str {
    let top = largest(values);
    if top > 0.0 && top < 1.001 {
        "; its values are between -1 and 1: for a share of the battery voltage also write scale = 12.0 for 12 V"
    } else {
        ""
    }
}

/// The question with the remaining column or pair that may be the input; `None` if there are several or none.
pub(super) fn question(columns: &[PreviewColumn], guess: &Guess) -> Option<String> {
    let of = |key: &str| guess.columns.iter().find(|c| c.key == key).map(|c| &c.name);
    let are_wheels = |[right, left]: [&str; 2]| of(right).is_some() && of(right) != of(left);
    let is_asked = [ANGLES, SPEEDS].iter().any(|[right, _]| guess.asks_which(right));
    if !is_asked && !are_wheels(ANGLES) && !are_wheels(SPEEDS) {
        return None;
    }
    let is_used = |c: &PreviewColumn| guess.columns.iter().any(|g: &Guessed| g.name == c.name);
    let open: Vec<(&PreviewColumn, Named)> = columns
        .iter()
        .filter(|c| !is_used(c) && !never_varies(c))
        .map(|c| (c, named(&c.name)))
        .filter(|(_, name)| !name.foreign)
        .collect();
    shared(&open).or_else(|| pair(&open))
}

/// The one input that both wheels may share.
fn shared(open: &[(&PreviewColumn, Named)]) -> Option<String> {
    let is_input = |n: &Named| {
        let quantity = n.quantity;
        matches!(quantity, Some(Quantity::Torque | Quantity::Current | Quantity::Voltage))
            && !n.battery
            && (n.word.len() > 1 || n.unit.is_some())
            || quantity.is_none() && is_of_controller(n)
    };
    let found: Vec<_> = open.iter().filter(|(_, n)| is_input(n)).collect();
    let [(column, name)] = found[..] else { return None };
    name.side.is_none().then(|| {
        format!(
            "`{}` is the only input: do both wheels have it? Then write it as M1 and as M2, and {}{}",
            column.name,
            beside(),
            share_of(&column.values)
        )
    })
}

/// The only pair of columns whose names differ only in the side and do not denote motion.
fn pair(open: &[(&PreviewColumn, Named)]) -> Option<String> {
    let is_of = |n: &Named, side: Side| {
        n.side == Some(side)
            && !n.rest.is_empty()
            && !matches!(n.quantity, Some(Quantity::Angle | Quantity::Speed))
    };
    let of = |side: Side| open.iter().filter(move |(_, n)| is_of(n, side));
    let same =
        |a: &Named, b: &Named| (a.quantity, &a.rest, a.unit) == (b.quantity, &b.rest, b.unit);
    let mut pairs = of(Side::Right)
        .flat_map(|right| of(Side::Left).map(move |left| (right, left)))
        .filter(|(right, left)| same(&right.1, &left.1));
    let (right, left) = pairs.next()?;
    pairs.next().is_none().then(|| {
        format!(
            "is `{}` the input of the right wheel, and `{}` that of the left one? Then write them as M1 and M2, and {}{}",
            right.0.name,
            left.0.name,
            beside(),
            share_of(&[&right.0.values[..], &left.0.values].concat())
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    fn questions(names: &[&str]) -> String {
        let column = |name: &&str| PreviewColumn {
            name: (*name).into(),
            values: (0..200).map(|k| 50.0 * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        guess(&names.iter().map(column).collect::<Vec<_>>()).asked()
    }

    #[test]
    fn the_pair_that_is_left_and_an_input_of_both_wheels_are_named() {
        let asked = questions(&["leftRpm", "rightRpm", "leftCommand", "rightCommand"]);
        assert!(asked.contains("is `rightCommand` the input of the right wheel"), "{asked}");
        let asked = questions(&["RPM_R", "RPM_L", "PWM_percent"]);
        assert!(asked.contains("`PWM_percent` is the only input: do both wheels"), "{asked}");
        let asked = questions(&["left_angle", "right_angle", "left_rpm", "right_rpm", "output"]);
        assert!(asked.contains("`output` is the only input: do both wheels"), "{asked}");
        let asked = questions(&["Enc1", "Enc2", "Enc3", "PWM"]);
        assert!(asked.contains("which of `Enc1`, `Enc2`, `Enc3` are those"), "{asked}");
        assert!(asked.contains("`PWM` is the only input: do both wheels"), "{asked}");
        assert!(!asked.contains("which columns hold"), "{asked}");
        let asked = questions(&["RPM_R", "RPM_L", "a_l", "a_r", "b_l", "b_r"]);
        assert!(!asked.contains("is `"), "{asked}");
    }
}
