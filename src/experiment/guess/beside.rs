//! Interpretation of ambiguous names from other columns.

use super::guessed::Candidate;
use super::names::{Named, Quantity, Side, WISHED};
use super::samples::never_varies;

/// Reinterprets names whose meaning depends on the other names, and returns the questions on them.
///
/// ```text
/// right_p, right_i, right_d      terms of a controller; i is no current
/// current_right, target_right    present value and set-point; no electric current
/// v_right, pwm_right             a speed and an input; v is no voltage
/// ctrl_right                     command of the motor, if no other column is one
/// ```
pub(super) fn apply(all: &mut [Candidate]) -> Vec<String> {
    controller_terms(all);
    outputs(all);
    bare_speeds(all);
    present_values(all).into_iter().collect()
}

/// Number of columns from which on the letter of a matrix is no quantity.
const OF_A_MATRIX: usize = 3;

/// Removes the quantity that the letter of a matrix with several columns would denote: `M(:,3)` is no torque.
pub(super) fn matrices(all: &mut [Candidate]) {
    let letter = |c: &Candidate| {
        let (stem, index) = c.column.name.split_once("(:,")?;
        let is_one = stem.chars().count() == 1 && index.ends_with(')');
        is_one.then(|| stem.to_owned())
    };
    let letters: Vec<Option<String>> = all.iter().map(letter).collect();
    for (c, own) in all.iter_mut().zip(&letters) {
        let count = letters.iter().filter(|other| own.is_some() && *other == own).count();
        if count >= OF_A_MATRIX {
            c.named.quantity = None;
            c.named.rest = own.iter().cloned().collect();
        }
    }
}

/// Words of a name that is the output of a controller, if it contains no other quantity.
const OUTPUTS: [&str; 11] =
    ["output", "outputs", "out", "ctrl", "control", "controls", "drive", "pid", "vm", "u", "pwr"];
/// Words beside these in the messages of PX4.
const ACTUATORS: [&str; 3] = ["actuator", "actuators", "motors"];

/// Words of a share.
const SHARES: [&str; 4] = ["percent", "pct", "percentage", "fraction"];

/// Whether a name contains only a wheel and the output of a controller: `ctrl_r`, `Right Output Percent`,
/// `actuator_outputs_0.output[1]`.
pub(super) fn is_output(named: &Named) -> bool {
    let is_one = |w: &String| {
        let lists = [&OUTPUTS[..], &ACTUATORS, &SHARES, &WISHED];
        lists.iter().any(|words| words.contains(&w.as_str()))
            || w.chars().all(|c| c.is_ascii_digit())
    };
    let says = named.rest.iter().any(|w| OUTPUTS.contains(&w.as_str()));
    named.quantity.is_none() && named.side.is_some() && says && named.rest.iter().all(is_one)
}

/// Interprets outputs of controllers as inputs of the motors if both wheels have one and no other column is their
/// input.
fn outputs(all: &mut [Candidate]) {
    let is_input = |c: &Candidate| {
        matches!(c.named.quantity, Some(Quantity::Torque | Quantity::Current | Quantity::Voltage))
            && !(c.named.word == "v" && c.named.unit.is_none())
            && is_of_wheel(c)
    };
    // those of other actuators do not change
    let is_one = |c: &Candidate| is_output(&c.named) && !never_varies(c.column);
    let found: Vec<bool> = all.iter().map(is_one).collect();
    if all.iter().any(is_input) || found.iter().filter(|is_one| **is_one).count() != 2 {
        return;
    }
    for (c, _) in all.iter_mut().zip(&found).filter(|(_, is_one)| **is_one) {
        c.named.quantity = Some(Quantity::Voltage);
    }
}

fn words(c: &Candidate, but: &[&str]) -> Vec<String> {
    let mut words: Vec<String> =
        c.named.rest.iter().filter(|w| !but.contains(&w.as_str())).cloned().collect();
    words.sort();
    words
}

fn controller_terms(all: &mut [Candidate]) {
    let is_term = |i: &Candidate| {
        let beside = |letter: &str| {
            all.iter().any(|c| {
                c.named.side == i.named.side
                    && c.named.rest.iter().any(|w| w == letter)
                    && words(c, &[letter]) == words(i, &[])
            })
        };
        i.named.word == "i" && i.named.unit.is_none() && beside("p") && beside("d")
    };
    let terms: Vec<bool> = all.iter().map(is_term).collect();
    forget(all, &terms);
}

/// Removes the quantity of columns.
fn forget(all: &mut [Candidate], flags: &[bool]) {
    all.iter_mut().zip(flags).filter(|(_, flag)| **flag).for_each(|(c, _)| c.named.quantity = None);
}

/// Whether a wheel's motion was measured.
fn moves(c: &Candidate) -> bool {
    matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed))
        && !c.named.wished
        && is_of_wheel(c)
}

fn is_of_wheel(c: &Candidate) -> bool {
    matches!(c.named.side, Some(Side::Right | Side::Left | Side::Numbered(_)))
}

/// `v` beside another input is a speed where no speeds are known; beside currents and torques, where no motion is.
fn bare_speeds(all: &mut [Candidate]) {
    let is_bare = |c: &Candidate| {
        c.named.quantity == Some(Quantity::Voltage) && c.named.word == "v" && c.named.unit.is_none()
    };
    let is_input = |c: &Candidate| {
        c.named.quantity == Some(Quantity::Voltage) && c.named.word != "v" && is_of_wheel(c)
    };
    let speeds = || all.iter().any(|c| c.named.quantity == Some(Quantity::Speed) && moves(c));
    let is_measured = |c: &Candidate| {
        matches!(c.named.quantity, Some(Quantity::Current | Quantity::Torque)) && is_of_wheel(c)
    };
    let is_only_motion = || all.iter().any(is_measured) && !all.iter().any(moves);
    if all.iter().any(is_input) && !speeds() || is_only_motion() {
        for c in all.iter_mut().filter(|c| is_bare(c) && is_of_wheel(c)) {
            c.named.quantity = Some(Quantity::Speed);
        }
    }
}

fn present_values(all: &mut [Candidate]) -> Option<String> {
    if all.iter().any(moves) {
        return None;
    }
    let is_present = |c: &Candidate| {
        c.named.quantity == Some(Quantity::Current)
            && c.named.word.starts_with("cur")
            && c.named.unit.is_none()
            && all.iter().any(|w| {
                w.named.wished
                    && w.named.quantity.is_none()
                    && w.named.side == c.named.side
                    && words(w, &WISHED) == words(c, &[])
            })
    };
    let flags: Vec<bool> = all.iter().map(is_present).collect();
    forget(all, &flags);
    let names = all.iter().zip(&flags).filter(|(_, flag)| **flag);
    let names: Vec<String> = names.map(|(c, _)| format!("`{}`", c.column.name)).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{} have set-points of the same name: are they the measured speeds (dalpha1, dalpha2), or electric \
             currents (M1, M2)?",
            names.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;
    use crate::recording::DriveUnit;

    #[test]
    fn outputs_by_number_are_inputs_if_two_of_them_change() {
        let column = |name: &str, scale: f64| PreviewColumn {
            name: name.into(),
            values: (0..400).map(|k| scale * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        for name in ["control", "actuator_outputs_0.output", "actuator_motors.control"] {
            let output = |k: u32, scale: f64| column(&format!("{name}[{k}]"), scale);
            let speeds = [0, 1].map(|k| column(&format!("wheel_encoders_0.wheel_speed[{k}]"), 9.0));
            let log = |third: f64| {
                guess(&[&speeds[..], &[output(0, 0.8), output(1, 0.8), output(2, third)]].concat())
            };
            let g = log(0.0);
            let inputs = g.columns.iter().filter(|c| c.key.starts_with('M')).count();
            assert_eq!((inputs, g.drive_unit), (2, DriveUnit::Volt), "{name}: {}", g.asked());
            // three that change may be those of any wheels
            assert!(!log(0.5).columns.iter().any(|c| c.key == "M1"), "{name}");
        }
    }
}
