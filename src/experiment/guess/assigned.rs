//! Numbered columns with other columns that state their side: the data show which input moves which wheel.

use super::guessed::{Guess, Guessed};
use super::times::{seconds, time};
use super::values::values_of;
use crate::conditioning::{Channel, Context, Kind, Settings, condition};
use crate::io::PreviewColumn;
use crate::recording::{Channels, DriveUnit};

/// Gives numbered speeds or angles to the inputs that move them, or numbered inputs to the wheels that they move, where
/// the names of the others state the side and the data show it.
pub(super) fn apply(columns: &[PreviewColumn], guess: &mut Guess) {
    let is_input = |c: &Guessed| c.key.starts_with('M');
    let unsure = |input: bool| {
        let mut found = guess.columns.iter().filter(|c| c.key != "t" && is_input(c) == input);
        found.any(|c| c.side_unsure)
    };
    let of_input = unsure(true);
    if of_input == unsure(false) || guess.one_axis {
        return;
    }
    let Some(channels) = channels(columns, guess) else { return };
    let mut swapped = channels.clone();
    swapped.torque.iter_mut().for_each(|m| m.swap(0, 1));
    let exchanged = match (are_exchanged(channels, guess), are_exchanged(swapped, guess)) {
        (true, false) => true,
        (false, true) => false,
        _ => return,
    };
    if exchanged {
        exchange(guess, of_input);
    }
    let why =
        "its number does not state the side: assigned by the response of the wheels to the inputs";
    for one in guess.columns.iter_mut().filter(|c| c.side_unsure) {
        one.side_unsure = false;
        one.evidence.push(why.into());
    }
}

/// Exchanges the columns of the right and the left wheel, of the inputs or of the motion.
fn exchange(guess: &mut Guess, of_input: bool) {
    for one in guess.columns.iter_mut() {
        if one.key == "t" || one.key.starts_with('M') != of_input {
            continue;
        }
        one.key = match one.key {
            "alpha1" => "alpha2",
            "alpha2" => "alpha1",
            "dalpha1" => "dalpha2",
            "dalpha2" => "dalpha1",
            "M1" => "M2",
            _ => "M1",
        };
    }
    guess.columns.sort_by_key(|c| ORDER.iter().position(|key| *key == c.key));
}

/// The keys in the order in which they are written.
const ORDER: [&str; 7] = ["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "M1", "M2"];

/// The columns without conversion, with the time in seconds; the assignment of inputs to wheels does not
/// depend on other units.
fn channels(columns: &[PreviewColumn], guess: &Guess) -> Option<Channels> {
    let of = |key: &str| {
        let one = guess.columns.iter().find(|c| c.key == key)?;
        Some(values_of(columns, &one.name))
    };
    let pair = |right: &str, left: &str| -> Option<Vec<[f64; 2]>> {
        let (right, left) = (of(right)?, of(left)?);
        (right.len() == left.len()).then(|| right.iter().zip(left).map(|(a, b)| [*a, *b]).collect())
    };
    let mut clock = guess.columns.iter().find(|c| c.key == "t")?.clone();
    if clock.sum || clock.scale_open || clock.nanoseconds.is_some() {
        return None;
    }
    time(of("t")?, &mut clock);
    let second = seconds(&clock) * clock.scale.unwrap_or(1.0);
    let start = of("t")?.first()?;
    let t: Vec<f64> = of("t")?.iter().map(|t| (t - start) * second).collect();
    let (alpha, omega) = (pair("alpha1", "alpha2"), pair("dalpha1", "dalpha2"));
    let torque = pair("M1", "M2")?;
    let fits = |rows: &Option<Vec<[f64; 2]>>| rows.as_ref().is_none_or(|r| r.len() == t.len());
    (fits(&alpha) && fits(&omega) && torque.len() == t.len()).then_some(Channels {
        t,
        alpha,
        omega,
        torque,
    })
}

/// Whether the inputs move the wheel of the other side.
fn are_exchanged(channels: Channels, guess: &Guess) -> bool {
    let settings = Settings { refuse: false, ..Settings::default() };
    let context = Context { commanded: guess.drive_unit == DriveUnit::Volt, ..Context::default() };
    condition(channels, &settings, &context).is_ok_and(|done| {
        done.findings
            .iter()
            .any(|f| matches!(f.channel, Channel::Input(_)) && matches!(f.kind, Kind::Exchanged))
    })
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn the_data_give_numbered_speeds_to_the_inputs_that_move_them() {
        let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
            name: name.into(),
            values: (0..3000).map(|k| of(0.01 * f64::from(k))).collect(),
            ..PreviewColumn::default()
        };
        let speed = |rate: f64| move |t: f64| 5.0 * (rate * t).sin();
        let input = |rate: f64| {
            move |t: f64| 0.15 * rate * (rate * t).cos() + 0.1 * (rate * t).sin().signum()
        };
        for (first, second) in [(1.3, 2.1), (2.1, 1.3)] {
            let g = guess(&[
                column("t", &|t| t),
                column("omega_1", &speed(first)),
                column("omega_2", &speed(second)),
                column("amps_left", &input(1.3)),
                column("amps_right", &input(2.1)),
            ]);
            let right = g.columns.iter().find(|c| c.key == "dalpha1").unwrap();
            let expected = if second == 2.1 { "omega_2" } else { "omega_1" };
            assert_eq!(right.name, expected);
            assert!(!g.questions.iter().any(|q| q.text.contains("is the right wheel")));
        }
    }
}
