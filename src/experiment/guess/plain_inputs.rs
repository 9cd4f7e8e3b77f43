//! Inputs that only their values show: commands in whole numbers, and the step test of a motor.

use super::guessed::Candidate;
use super::names::{Named, Quantity, Side};
use super::values::{largest, whole};

/// Words of a command that does not state what it commands.
const COMMANDS: [&str; 4] = ["command", "commands", "commanded", "cmd"];
/// Words of a command that all motors may share.
const PWMS: [&str; 2] = ["pwm", "duty"];
/// Largest PWM of 8 bits, and the smallest largest value that is no fraction of a speed.
const BITS: (f64, f64) = (20.0, 255.0);
/// Mean deviation of a speed from its set-point, as a share of the mean set-point: smaller ones are those of a
/// controller.
const FOLLOWED: f64 = 0.4;

/// Input and output of a system, as System Identification Toolbox and most scripts of step tests name them.
const SYSTEM: [(&[&str], &[&str]); 2] = [(&["input", "in"], &["output", "out"]), (&["u"], &["y"])];

/// Interprets such columns where no other column is an input, and returns the questions on them.
pub(super) fn apply(all: &mut [Candidate]) -> Vec<String> {
    commands(all);
    speeds_of_motors(all);
    step_test(all).into_iter().collect()
}

/// Whether a name contains only a side and a word for a command.
pub(super) fn is_command(named: &Named) -> bool {
    named.quantity.is_none()
        && matches!(named.side, Some(Side::Right | Side::Left))
        && has_only(named, &COMMANDS)
}

/// Whether a name has words, and all are among these.
fn has_only(named: &Named, words: &[&str]) -> bool {
    !named.rest.is_empty() && named.rest.iter().all(|w| words.contains(&w.as_str()))
}

fn is_input(c: &Candidate) -> bool {
    matches!(c.named.quantity, Some(Quantity::Torque | Quantity::Current | Quantity::Voltage))
}

/// Interprets two commands in whole numbers up to 255 as the PWM of the motors, unless the speeds follow them.
fn commands(all: &mut [Candidate]) {
    let is_followed = |command: &Candidate| {
        all.iter().any(|c| {
            c.named.quantity == Some(Quantity::Speed)
                && c.named.side == command.named.side
                && follows(&c.column.values, &command.column.values)
        })
    };
    let is_pwm = |c: &Candidate| {
        let values = &c.column.values;
        is_command(&c.named)
            && whole(values)
            && (BITS.0..=BITS.1).contains(&largest(values))
            && !is_followed(c)
    };
    let found: Vec<bool> = all.iter().map(is_pwm).collect();
    let is_other = |c: &Candidate| is_input(c) && c.named.side.is_some();
    if all.iter().any(is_other) || found.iter().filter(|is_one| **is_one).count() != 2 {
        return;
    }
    for (c, _) in all.iter_mut().zip(&found).filter(|(_, is_one)| **is_one) {
        c.named.quantity = Some(Quantity::Voltage);
    }
}

/// Interprets `m1`, `m2`, … beside one PWM as the speeds of motors that share it, where no column is a motion: an `m`
/// alone would be a torque.
fn speeds_of_motors(all: &mut [Candidate]) {
    let is_motion =
        |c: &Candidate| matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed));
    let is_pwm = |c: &Candidate| {
        let n = &c.named;
        n.quantity == Some(Quantity::Voltage) && n.side.is_none() && PWMS.contains(&&*n.word)
    };
    if all.iter().any(is_motion) || !all.iter().any(is_pwm) {
        return;
    }
    let is_number = |word: &String| word.chars().all(|c| c.is_ascii_digit());
    let is_motor = |n: &Named| {
        n.quantity == Some(Quantity::Torque)
            && n.word == "m"
            && n.unit.is_none()
            && n.rest.iter().all(is_number)
    };
    for c in all.iter_mut().filter(|c| is_motor(&c.named)) {
        c.named.quantity = Some(Quantity::Speed);
    }
}

/// Whether a speed has about the values of a set-point.
fn follows(speed: &[f64], set: &[f64]) -> bool {
    let rows = || speed.iter().zip(set).filter(|(w, s)| w.is_finite() && s.is_finite());
    let deviation: f64 = rows().map(|(w, s)| (w - s).abs()).sum();
    speed.len() == set.len() && deviation < FOLLOWED * rows().map(|(_, s)| s.abs()).sum::<f64>()
}

/// Interprets input and output of a log that has no other as the voltage and the speed of one motor.
fn step_test(all: &mut [Candidate]) -> Option<String> {
    let is_known = |c: &Candidate| {
        let is_motion = matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed));
        (is_motion || is_input(c)) && !has_word(c, &["u", "y"])
    };
    if all.iter().any(is_known) {
        return None;
    }
    let one = |words: &[&str]| {
        let mut found = (0..all.len()).filter(|k| has_word(&all[*k], words));
        found.next().filter(|_| found.next().is_none())
    };
    let (input, output) = SYSTEM.iter().find_map(|(i, o)| Some((one(i)?, one(o)?)))?;
    for (k, quantity) in [(input, Quantity::Voltage), (output, Quantity::Speed)] {
        let named = &mut all[k].named;
        (named.quantity, named.wished, named.side) = (Some(quantity), false, None);
        (named.word, named.rest) = (String::new(), vec![]);
    }
    let [input, output] = [input, output].map(|k| &all[k].column.name);
    Some(format!(
        "are `{input}` and `{output}` the voltage and the speed of one motor, as assumed? If `{output}` is an angle, write alpha1 and \
         alpha2 in place of dalpha1 and dalpha2; for a current write drive_unit = \"A\""
    ))
}

/// Whether the whole name of a column is one of these words.
fn has_word(c: &Candidate, words: &[&str]) -> bool {
    words.contains(&c.column.name.trim().to_lowercase().as_str())
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::experiment::guess::Guess;
    use crate::io::PreviewColumn;
    use crate::recording::DriveUnit;

    fn column(name: &str, of: impl Fn(f64) -> f64) -> PreviewColumn {
        let values = (0..400).map(|k| of(0.05 * f64::from(k))).collect();
        PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
    }

    fn name<'a>(g: &'a Guess, key: &str) -> Option<&'a str> {
        g.columns.iter().find(|c| c.key == key).map(|c| c.name.as_str())
    }

    #[test]
    fn commands_in_whole_numbers_are_a_pwm_unless_the_speeds_follow_them() {
        let log = |command: fn(f64) -> f64| {
            guess(&[
                column("t", |t| t),
                column("leftRPM", |t| 200.0 * (0.7 * t).sin()),
                column("rightRPM", |t| 200.0 * (0.7 * t).sin()),
                column("leftCommand", command),
                column("rightCommand", command),
            ])
        };
        let pwm = log(|t| (220.0 * (0.7 * t + 0.8).sin()).round());
        assert_eq!(
            (name(&pwm, "M1"), name(&pwm, "M2")),
            (Some("rightCommand"), Some("leftCommand"))
        );
        assert_eq!(pwm.drive_unit, DriveUnit::Volt);
        let words = pwm.words();
        assert!(words.contains("whole numbers that the speeds do not follow"), "{words}");
        assert!(words.contains("and reaches 220: with 255 for the full 12 V"), "{words}");
        let set_point = log(|t| (210.0 * (0.7 * t + 0.05).sin()).round());
        assert_eq!(name(&set_point, "M1"), None);
        assert!(set_point.asked().contains("is `rightCommand` the input"), "{}", set_point.asked());
        // fractions state no scale
        assert_eq!(name(&log(|t| 0.8 * (0.7 * t + 0.8).sin()), "M1"), None);
    }

    #[test]
    fn motors_with_a_number_beside_one_pwm_are_speeds() {
        let log = |names: &[&str]| {
            let wave = |name: &&str| column(name, |t| 40.0 * (0.7 * t).sin());
            guess(&names.iter().map(wave).collect::<Vec<_>>()).asked()
        };
        let asked = log(&["pwm", "m1", "m2", "m3", "m4", "mean"]);
        assert!(
            asked.contains("`m3`, `m4` are those of the right and of the left wheel (dalpha1"),
            "{asked}"
        );
        assert!(asked.contains("`pwm` is the only input: do both wheels have it?"), "{asked}");
        assert!(!asked.contains("M1, M2)") && !asked.contains("which columns hold"), "{asked}");
        // torques beside speeds; which of several is asked once
        let asked = log(&["rpm_l", "rpm_r", "m1", "m2", "m3", "m4"]);
        assert_eq!(asked.matches("(M1, M2)").count(), 1, "{asked}");
    }

    #[test]
    fn input_and_output_alone_are_those_of_one_motor() {
        for names in [["input", "output"], ["u", "y"], ["Input", "Output"]] {
            let step = |t: f64| if t < 1.0 { 0.0 } else { 6.0 };
            let g = guess(&[
                column("time", |t| t),
                column(names[0], step),
                column(names[1], |t| step(t) * (1.0 - (1.0 - t).exp())),
            ]);
            assert!(g.one_axis, "{names:?}: {}", g.words());
            assert_eq!((name(&g, "M1"), name(&g, "dalpha1")), (Some(names[0]), Some(names[1])));
            assert_eq!(g.drive_unit, DriveUnit::Volt);
            let asked = g.asked();
            assert!(asked.contains("the voltage and the speed of one motor"), "{asked}");
            assert!(asked.contains("in rad/s, rpm, deg/s"), "{asked}");
        }
        // beside other columns of a wheel they may be anything
        let g = guess(&[
            column("time", |t| t),
            column("input", f64::sin),
            column("output", f64::cos),
            column("wheel_rpm", f64::sin),
        ]);
        assert_ne!(name(&g, "M1"), Some("input"));
    }
}
