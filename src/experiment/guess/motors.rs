//! Several motors or wheels on a side: front and rear, leader and follower, 1 and 2.

use super::guessed::{Candidate, Guess, Guessed};
use super::names::Named;
use super::values::{is_constant, values_of};
use crate::io::PreviewColumn;
use crate::recording::DriveUnit;

/// Words in which the names of motors of one side differ.
const PLACES: [&str; 17] = [
    "front",
    "rear",
    "back",
    "mid",
    "middle",
    "center",
    "centre",
    "leader",
    "follower",
    "lead",
    "follow",
    "master",
    "slave",
    "main",
    "primary",
    "secondary",
    "second",
];
/// Words by which the name of a second motor on a side differs from that of the first.
const OTHERS: [&str; 6] = ["follower", "follow", "slave", "secondary", "second", "2"];
/// Difference of two wheels of one side, as a share of their motion, above which they do not turn together:
/// the slip of a skid-steered robot is smaller, wheels of an omnidirectional drive differ more.
const UNLIKE: f64 = 0.3;

/// Whether two names are those of the same quantity of two motors of one side.
pub(super) fn are_of_one_side(a: &Named, b: &Named) -> bool {
    let is_digit = |word: &str| word.len() == 1 && word.chars().all(|c| c.is_ascii_digit());
    let is_place = |word: &str| PLACES.contains(&word) || is_digit(word);
    let same = (a.quantity, a.side, a.wished, a.unit, a.scale)
        == (b.quantity, b.side, b.wished, b.unit, b.scale)
        && a.word == b.word;
    let differ: Vec<(&String, &String)> =
        a.rest.iter().zip(&b.rest).filter(|(a, b)| a != b).collect();
    let other = || b.rest.iter().position(|word| OTHERS.contains(&word.as_str()));
    let has_place = |n: &Named| n.rest.iter().any(|word| PLACES.contains(&word.as_str()));
    let others = |n: &Named| -> Vec<String> {
        n.rest.iter().filter(|word| !is_place(word)).cloned().collect()
    };
    // `master`, `slave 1` and `slave 2`
    let are_places = has_place(a) && has_place(b) && a.rest != b.rest && others(a) == others(b);
    same && (are_places
        || match (a.rest.len(), &differ[..]) {
            (n, [(x, y)]) if n == b.rest.len() => is_place(x) && is_place(y),
            (n, _) if n + 1 == b.rest.len() => other().is_some_and(|k| {
                let mut rest = b.rest.clone();
                rest.remove(k);
                rest == a.rest
            }),
            _ => false,
        })
}

/// The other columns of the same quantity and side, without those that never change.
fn beside<'a>(all: &'a [Candidate], one: &Guessed) -> Vec<&'a Candidate<'a>> {
    let Some(own) = all.iter().find(|c| c.column.name == one.name) else { return vec![] };
    let is_beside = |c: &&Candidate| {
        c.named.side.is_some()
            && are_of_one_side(&own.named, &c.named)
            && !is_constant(&c.column.values)
    };
    all.iter().filter(is_beside).collect()
}

/// Adds the torques or currents of the other motors of each side to those found; of angles and speeds the pair that
/// was found is kept, and a voltage is the same for all motors of a side.
pub(super) fn apply(all: &[Candidate], columns: &[PreviewColumn], guess: &mut Guess) {
    let adds_up = guess.drive_unit != DriveUnit::Volt;
    let beside: Vec<Vec<&Candidate>> = guess
        .columns
        .iter()
        .map(|one| if one.side_unsure { vec![] } else { beside(all, one) })
        .collect();
    let count = |key: &str| {
        let place = guess.columns.iter().position(|c| c.key == key);
        place.map_or(0, |k| beside[k].len())
    };
    let is_both = count("M1") == count("M2");
    let mut questions = vec![];
    for (one, others) in guess.columns.iter_mut().zip(&beside) {
        if others.is_empty() {
            continue;
        }
        let names =
            others.iter().map(|c| format!("`{}`", c.column.name)).collect::<Vec<_>>().join(", ");
        if !one.key.starts_with('M') {
            one.evidence.push(format!("{names} on the same side: one wheel of each side is used"));
            let unlike = others.iter().find(|c| !is_alike(columns, one, c));
            questions.extend(unlike.filter(|_| one.key.ends_with('1')).map(|c| {
                format!(
                    "`{}` and `{}` do not turn at the same speed: are they wheels of one side? The model \
                     has one speed for each side and does not describe an omnidirectional drive",
                    one.name, c.column.name
                )
            }));
        } else if !adds_up {
            one.evidence
                .push(format!("{names} on the same side: voltages of one side do not add up"));
        } else if is_both {
            one.plus = others.iter().map(|c| c.column.name.clone()).collect();
            one.evidence.push(format!("{names} on the same side: added up"));
        } else {
            questions.push(format!(
                "one side has {names} in addition to `{}`, and the other not as many: which motors drive each side? Write \
                 their columns as plus = [\"…\"] in M1 and M2, which adds them to `name`",
                one.name
            ));
        }
    }
    guess.ask_all(questions);
}

/// Whether two columns differ by a small share of their size.
fn is_alike(columns: &[PreviewColumn], one: &Guessed, other: &Candidate) -> bool {
    let pairs = values_of(columns, &one.name).iter().zip(&other.column.values);
    let (mut size, mut difference) = (0.0, 0.0);
    for (a, b) in pairs.filter(|(a, b)| a.is_finite() && b.is_finite()) {
        (size, difference) = (size + a * a + b * b, difference + (a - b).powi(2));
    }
    // two that have nothing to do with each other differ by their whole size
    one.key.starts_with("alpha") || difference <= UNLIKE * UNLIKE * size
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    fn column(name: &str, of: impl Fn(f64) -> f64) -> PreviewColumn {
        let values = (0..400).map(|k| of(0.05 * f64::from(k))).collect();
        PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
    }

    fn found<'a>(g: &'a Guess, key: &str) -> &'a Guessed {
        g.columns.iter().find(|c| c.key == key).unwrap()
    }

    #[test]
    fn torques_of_front_and_rear_wheels_are_added_and_one_speed_is_used() {
        let speed = |t: f64| 5.0 * t.sin();
        let log = |rear: &dyn Fn(f64) -> f64| {
            guess(&[
                column("time", |t| t),
                column("front_left_joint.velocity", speed),
                column("front_right_joint.velocity", speed),
                column("rear_left_joint.velocity", rear),
                column("rear_right_joint.velocity", rear),
                column("front_left_joint.effort", f64::cos),
                column("front_right_joint.effort", f64::cos),
                column("rear_left_joint.effort", |t| 0.9 * t.cos()),
                column("rear_right_joint.effort", |t| 0.8 * t.cos()),
            ])
        };
        let g = log(&|t| speed(t) + 0.1);
        assert_eq!(found(&g, "dalpha2").name, "front_left_joint.velocity");
        assert_eq!(found(&g, "M1").plus, ["rear_right_joint.effort"]);
        assert_eq!(found(&g, "M2").plus, ["rear_left_joint.effort"]);
        let asks = |g: &Guess| {
            g.questions.iter().any(|q| q.text.contains("do not turn at the same speed"))
        };
        assert!(!asks(&g) && asks(&log(&|t| -speed(t))), "{:?}", g.questions);
    }

    #[test]
    fn currents_of_followers_are_added_and_voltages_are_not() {
        for (leader, follower, word) in [
            ("leftLeader", "leftFollower", "Current"),
            ("left_1", "left_2", "_amps"),
            ("left", "left_slave", "_current"),
        ] {
            let right = |name: &str| format!("{}{word}", name.replace("left", "right"));
            let g = guess(&[
                column("t", |t| t),
                column("left_vel", |t| 5.0 * t.sin()),
                column("right_vel", |t| 5.0 * t.sin()),
                column(&format!("{leader}{word}"), f64::cos),
                column(&right(leader), f64::cos),
                column(&format!("{follower}{word}"), f64::cos),
                column(&right(follower), f64::cos),
            ]);
            assert_eq!(found(&g, "M1").name, right(leader));
            assert_eq!(found(&g, "M1").plus, [right(follower)], "{follower}");
        }
        let g = guess(&[
            column("t", |t| t),
            column("left_vel", |t| 5.0 * t.sin()),
            column("right_vel", |t| 5.0 * t.sin()),
            column("left_front_volts", |t| 5.0 * t.cos()),
            column("right_front_volts", |t| 5.0 * t.cos()),
            column("left_back_volts", |t| 5.0 * t.cos()),
            column("right_back_volts", |t| 5.0 * t.cos()),
        ]);
        assert!(found(&g, "M1").plus.is_empty() && !found(&g, "M1").evidence.is_empty());
    }
}
