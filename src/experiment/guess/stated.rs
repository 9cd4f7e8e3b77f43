//! Units that a header states and that are not known.

use super::commands::is_percent;
use super::guessed::{About, Guess, Guessed};
use crate::io::{ColumnMap, unknown_unit};
use crate::recording::DriveUnit;

/// Asks for the factor of columns whose header states a unit that is none of their quantity.
pub(super) fn apply(guess: &mut Guess) {
    let map = ColumnMap::new(guess.drive_unit, None);
    let input = guess.drive_unit;
    // a share of a voltage is a command, of which the question is another
    let is_share = |c: &Guessed| {
        let is_input = ["M1", "M2"].contains(&c.key) && input != DriveUnit::Volt;
        is_input && is_percent(&c.name.to_lowercase())
    };
    let stated = |c: &Guessed| {
        let written = unknown_unit(&map, c.key, &c.name);
        written.map(Into::into).or_else(|| is_share(c).then(|| "%".to_owned()))
    };
    let is_of_clock = |c: &Guessed| c.key == "t" && stated(c).is_some_and(|s| is_clock(&s));
    let is_unknown = |c: &Guessed| {
        if is_of_clock(c) {
            return false;
        }
        c.unit.is_none() && c.per_turn.is_none() && c.nanoseconds.is_none() && stated(c).is_some()
    };
    let mut questions = vec![];
    // the question for the factor replaces that for the unit
    let unknown: Vec<About> = guess
        .columns
        .iter()
        .filter(|c| is_unknown(c))
        .map(|c| About::Unit(c.name.clone()))
        .collect();
    unknown.iter().for_each(|about| guess.answer(about));
    for one in guess.columns.iter_mut().filter(|c| is_unknown(c)) {
        let stated = stated(one).unwrap_or_default();
        let si = si(one.key, input);
        // both wheels in one question
        if !one.key.ends_with('2') {
            questions.push(format!(
                "`{}` is in `{stated}`, which is not a known unit for it: how many {si} is one of it{}? Write this factor as scale",
                one.name,
                if stated.contains('%') { RATED } else { "" }
            ));
        }
        (one.unit, one.scale) = (Some(si.into()), None);
        (one.scale_open, one.unit_open) = (true, false);
    }
    guess.ask_all(questions);
}

/// Words in brackets behind a time that state which clock it is, and no unit.
const CLOCKS: [&str; 19] = [
    "abs", "absolute", "rel", "relative", "utc", "gmt", "local", "cet", "cest", "est", "edt",
    "pst", "pdt", "unix", "epoch", "ros", "sim", "wall", "system",
];

/// Whether a text in brackets states the clock of a time: `UTC`, `UTC+2`.
fn is_clock(stated: &str) -> bool {
    let words = crate::io::words(stated);
    let mut lettered = words.iter().filter(|w| w.chars().all(char::is_alphabetic)).peekable();
    lettered.peek().is_some() && lettered.all(|w| CLOCKS.contains(&w.as_str()) || w == "time")
}

/// Reference values of a share.
const RATED: &str = " (a share of the rated value: 0.01 of it for 1 %, 0.001 for 0.1 %)";

/// Unit of the program.
pub(super) fn si(key: &str, input: DriveUnit) -> &'static str {
    match key {
        "t" => "s",
        "alpha1" | "alpha2" => "rad",
        "dalpha1" | "dalpha2" => "rad/s",
        _ => input.symbol(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    #[test]
    fn the_name_of_a_clock_is_no_unit() {
        for (stated, is_one) in
            [("abs", true), ("UTC+2", true), ("wall time", true), ("jiffies", false)]
        {
            assert_eq!(super::is_clock(stated), is_one, "{stated}");
        }
    }

    #[test]
    fn the_factor_of_a_unit_that_is_not_known_is_asked() {
        let column = |name: &str| PreviewColumn {
            name: name.into(),
            values: (0..200).map(|k| 40.0 * (0.05 * f64::from(k)).sin()).collect(),
            ..PreviewColumn::default()
        };
        for (names, unit) in [
            (["left [rpm]", "right [rpm]", "left torque [0.1%]", "right torque [0.1%]"], "`0.1%`"),
            (["left_rpm", "right_rpm", "left_torque_percent", "right_torque_percent"], "`%`"),
        ] {
            let mut log: Vec<PreviewColumn> = names.iter().map(|n| column(n)).collect();
            let values = (0..200).map(|k| 0.05 * f64::from(k)).collect();
            log.push(PreviewColumn { name: "t".into(), values, ..PreviewColumn::default() });
            let g = guess(&log);
            let m1 = g.columns.iter().find(|c| c.key == "M1").unwrap();
            assert_eq!((m1.unit.as_deref(), m1.scale_open), (Some("N m"), true));
            let asked =
                g.questions.iter().filter(|q| q.text.contains(&format!("is in {unit}"))).count();
            assert!(asked == 1 && g.columns.iter().all(|c| c.key != "dalpha1" || !c.scale_open));
        }
    }
}
