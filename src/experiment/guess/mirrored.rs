//! A wheel with the opposite sign, because its motor is mounted mirrored.

use super::guessed::{Guess, Guessed};
use super::heading::{Turned, turned};
use super::values::is_never_negative;
use crate::experiment::remark::{Remark, mirrored_question};
use crate::experiment::remarks::opposed;
use crate::io::PreviewColumn;
use crate::math::noise::white_noise_variance;
use crate::math::{correlation, sgn};

/// Names of a rate of turning about the vertical, letters and numbers alone.
const TURNING: [&str; 8] = [
    "gyroz",
    "yawrate",
    "headingrate",
    "angularvelocityz",
    "angularz",
    "omegaz",
    "turnrate",
    "gyroyaw",
];
/// Smallest correlation of the wheels with the turn rate, and smallest margin over the other sign.
const SHOWN: f64 = 0.8;
const CLEARER: f64 = 0.2;

/// Relative difference of two equal speeds, and share of the rows with equal speeds (judgement).
const SAME: f64 = 0.15;
const OFTEN: f64 = 0.25;
/// Rows per block for the noise (judgement).
const BLOCK: usize = 36;

/// Inverts a wheel that is mirrored according to a measured turn rate. Without one it asks, if the wheels nearly always
/// turn in opposite directions, each in that of its input: a robot that turned on the spot gives the same data.
pub(super) fn apply(columns: &[PreviewColumn], guess: &mut Guess) {
    let of = |guess: &Guess, key: &str| {
        let one = guess.columns.iter().find(|c| c.key == key)?;
        let sign = one.scale.unwrap_or(1.0).signum();
        let values = &columns.iter().find(|c| c.name == one.name)?.values;
        Some((one.name.clone(), values.iter().map(|v| sign * v).collect::<Vec<f64>>()))
    };
    let Some(((right, w1), (left, w2))) = of(guess, "dalpha1").zip(of(guess, "dalpha2")) else {
        return;
    };
    if right == left || guess.columns.iter().any(|c| c.sign.is_some() && c.key.starts_with('d')) {
        return;
    }
    let (input1, input2) = (of(guess, "M1").map(|x| x.1), of(guess, "M2").map(|x| x.1));
    let drives = |m: &Option<Vec<f64>>, w: &[f64]| m.as_ref().is_none_or(|m| work(m, w) > 0.0);
    if let Some(turning) = turning(columns, guess, [&w1, &w2]) {
        let [right, left] = &turning.wheels;
        let by = |sign: f64| {
            let sum: Vec<f64> = right.iter().zip(left).map(|(a, b)| a + sign * b).collect();
            let pairs = turning.heading.iter().copied().zip(sum);
            correlation(pairs.filter(|(a, b)| a.is_finite() && b.is_finite()))
        };
        let (difference, sum) = (by(-1.0), by(1.0));
        if sum.abs() > SHOWN && sum.abs() > difference.abs() + CLEARER && is_no_veer(right, left) {
            // counter-clockwise is positive: the right wheel ahead of the left one
            let wheel = if sum > 0.0 { '2' } else { '1' };
            let (input, speed) = if wheel == '2' { (&input2, &w2) } else { (&input1, &w1) };
            let why = format!(
                "mirrored: `{}` changes in proportion to the sum of the wheels' motions, not to their difference",
                turning.name
            );
            turn(guess, wheel, drives(input, speed), &why);
            return;
        }
        if difference.abs() > SHOWN {
            return;
        }
    }
    let rows: Vec<[f64; 2]> = w1.iter().zip(&w2).map(|(a, b)| [*a, *b]).collect();
    let Some(share) = opposed(&rows) else { return };
    if let Some(wheel) = of_angles(guess, of).and_then(|angles| wrong_speed(angles, [&w1, &w2])) {
        let (input, speed) = if wheel == '2' { (&input2, &w2) } else { (&input1, &w1) };
        // a magnitude has the sign of neither
        let has_sign =
            input.as_ref().is_some_and(|m| !is_never_negative(m) && work(m, speed) > 0.0);
        return turn_speed(guess, wheel, has_sign);
    }
    if !(drives(&input1, &w1) && drives(&input2, &w2) && mirror_each_other(&rows)) {
        // only one sign is wrong, which conditioning reports; or the two wheels move independently
        guess.ask(Remark::Opposed { share, inverted: None }.to_string());
        return;
    }
    let mut scales = vec![];
    for one in guess.columns.iter_mut().filter(|c| is_of(c, '2')) {
        let scale = one.scale.unwrap_or(1.0);
        one.scale_open = true;
        scales.push(format!("`{}` {:?} or {scale:?}", one.name, -scale));
    }
    guess.ask(format!(
        "{} Write as scale, of a mirrored motor of the left wheel or of a turn on the spot: {} (of a mirrored right \
         motor as of a turn on the spot, and scale = -1.0 in the columns of the right wheel)",
        mirrored_question(share),
        scales.join(", ")
    ));
}

/// The turning of the robot beside the motions of its wheels: the heading beside their angles, which quantisation and
/// vibration do not hide, else the turn rate beside their speeds.
fn turning(columns: &[PreviewColumn], guess: &Guess, speeds: [&[f64]; 2]) -> Option<Turned> {
    turned(columns, guess, true).or_else(|| {
        let rate = columns.iter().find(|c| is_turning(&c.name))?;
        let (name, heading) = (rate.name.clone(), rate.values.clone());
        Some(Turned { name, heading, wheels: speeds.map(<[f64]>::to_vec), in_metres: false })
    })
}

/// Whether the speeds as logged differ by more than those of a robot that drives straight ahead. Such a robot veers
/// slightly, in proportion to its speed: its turn rate is correlated with the sum of the speeds although no wheel is
/// mirrored.
fn is_no_veer(w1: &[f64], w2: &[f64]) -> bool {
    let size = |sign: f64| {
        let sums: Vec<f64> =
            w1.iter().zip(w2).map(|(a, b)| a + sign * b).filter(|w| w.is_finite()).collect();
        let noise =
            white_noise_variance(std::slice::from_ref(&sums), BLOCK, 1, |_| true).unwrap_or(0.0);
        let square = sums.iter().map(|w| w * w).sum::<f64>() / sums.len().max(1) as f64;
        (square - noise).max(0.0).sqrt()
    };
    size(-1.0) > SAME * size(1.0)
}

/// The angles of two wheels as logged.
fn of_angles(
    guess: &Guess,
    of: impl Fn(&Guess, &str) -> Option<(String, Vec<f64>)>,
) -> Option<[Vec<f64>; 2]> {
    Some([of(guess, "alpha1")?.1, of(guess, "alpha2")?.1])
}

/// The wheel whose speed has the opposite sign of its angle, if the angles of both wheels turn in the same direction:
/// then the sign of this speed is wrong, and the wheels do not turn against each other.
fn wrong_speed(angles: [Vec<f64>; 2], speeds: [&[f64]; 2]) -> Option<char> {
    let [right, left] = &angles;
    let known: Vec<usize> = (0..right.len().min(left.len()))
        .filter(|&k| right[k].is_finite() && left[k].is_finite())
        .collect();
    let step = |w: &[usize], i: usize| angles[i][w[1]] - angles[i][w[0]];
    let against: Vec<[f64; 2]> = known.windows(2).map(|w| [step(w, 0), -step(w, 1)]).collect();
    opposed(&against)?;
    let agrees = |i: usize| {
        let signs = known.windows(2).filter(|w| speeds[i].get(w[1]).is_some_and(|w| w.is_finite()));
        signs.map(|w| sgn(step(w, i)) * sgn(speeds[i][w[1]])).sum::<f64>() > 0.0
    };
    match [agrees(0), agrees(1)] {
        [false, true] => Some('1'),
        [true, false] => Some('2'),
        _ => None,
    }
}

/// Inverts the speed of a wheel, and its input if that has the sign of the speed.
fn turn_speed(guess: &mut Guess, wheel: char, with_input: bool) {
    let angle = guess.columns.iter().find(|c| c.key.starts_with('a') && is_of(c, wheel));
    let why = format!(
        "mirrored: opposite to `{}`, and the angles of the wheels turn in the same direction",
        angle.map_or("", |c| c.name.as_str())
    );
    for one in guess.columns.iter_mut().filter(|c| is_of(c, wheel)) {
        if one.key.starts_with('d') || with_input && one.key.starts_with('M') {
            one.scale = Some(-one.scale.unwrap_or(1.0));
            one.evidence.push(why.clone());
        }
    }
}

/// Whether the wheels have opposite speeds in many rows, as on a straight run with a mirrored motor.
fn mirror_each_other(rows: &[[f64; 2]]) -> bool {
    let top = rows
        .iter()
        .flatten()
        .fold(0.0_f64, |top, w| if w.is_finite() { top.max(w.abs()) } else { top });
    let moving = rows.iter().filter(|w| w[0].abs() > SAME * top && w[1].abs() > SAME * top);
    let same = |w: &&[f64; 2]| (w[0] + w[1]).abs() < SAME * (w[0].abs() + w[1].abs());
    let (count, alike) = moving.fold((0, 0), |(n, k), w| (n + 1, k + usize::from(same(&w))));
    alike as f64 > OFTEN * f64::from(count)
}

fn is_of(one: &Guessed, wheel: char) -> bool {
    one.key != "t" && one.key.ends_with(wheel)
}

fn turn(guess: &mut Guess, wheel: char, with_input: bool, why: &str) {
    for one in guess.columns.iter_mut().filter(|c| is_of(c, wheel)) {
        if with_input || !one.key.starts_with('M') {
            one.scale = Some(-one.scale.unwrap_or(1.0));
            one.evidence.push(why.into());
        }
    }
}

fn is_turning(name: &str) -> bool {
    let bare: String = name.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    TURNING.iter().any(|word| bare.contains(word)) || ["gz", "wz"].contains(&bare.as_str())
}

/// Work of an input on its wheel, if both are recorded.
fn work(input: &[f64], speed: &[f64]) -> f64 {
    input.iter().zip(speed).map(|(m, w)| m * w).filter(|x| x.is_finite()).sum()
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    /// A robot that mostly drives straight, with the sign of its left wheel.
    fn log(left: f64, gyro: bool) -> Guess {
        let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
            name: name.into(),
            values: (0..800).map(|k| of(0.05 * f64::from(k))).collect(),
            ..PreviewColumn::default()
        };
        let speed = |t: f64| [5.0 + t.sin(), 5.0 - t.sin()];
        let mut log = vec![
            column("t", &|t| t),
            column("right_rad_s", &|t| speed(t)[0]),
            column("left_rad_s", &|t| left * speed(t)[1]),
            column("right_A", &|t| 0.1 * speed(t)[0]),
            column("left_A", &|t| left * 0.1 * speed(t)[1]),
        ];
        if gyro {
            log.push(column("gyro_z", &|t| 0.3 * (speed(t)[0] - speed(t)[1])));
        }
        guess(&log)
    }

    #[test]
    fn a_robot_that_veers_has_no_mirrored_wheel() {
        let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
            name: name.into(),
            values: (0..800).map(|k| of(0.05 * f64::from(k))).collect(),
            ..PreviewColumn::default()
        };
        let ripple = |t: f64| 0.2 * (7919.0 * t).sin();
        let speed = |t: f64| 5.0 + t.sin();
        let g = guess(&[
            column("t", &|t| t),
            column("right_rad_s", &|t| speed(t) + ripple(t)),
            column("left_rad_s", &|t| speed(t) - ripple(t)),
            column("right_A", &|t| 0.1 * speed(t)),
            column("left_A", &|t| 0.1 * speed(t)),
            column("gyro_z", &|t| 0.02 * speed(t)),
        ]);
        assert_eq!(scales(&g), [(None, false); 4]);
        assert!(g.questions.is_empty());
    }

    fn scales(g: &Guess) -> Vec<(Option<f64>, bool)> {
        g.columns.iter().skip(1).map(|c| (c.scale, c.scale_open)).collect()
    }

    #[test]
    fn a_turning_rate_decides_and_without_one_it_is_asked() {
        assert_eq!(scales(&log(1.0, true)), [(None, false); 4]);
        let turned = [(None, false), (Some(-1.0), false)];
        assert_eq!(scales(&log(-1.0, true)), [turned, turned].concat());
        assert!(log(-1.0, true).questions.is_empty());
        let open = [(None, false), (None, true)];
        assert_eq!(scales(&log(-1.0, false)), [open, open].concat());
        let asked = log(-1.0, false).asked();
        assert!(asked.contains("mirrored") && asked.contains("`left_A` -1.0 or 1.0"), "{asked}");
        assert_eq!(scales(&log(1.0, false)), [(None, false); 4]);
    }

    #[test]
    fn a_speed_against_its_angle_is_inverted_where_the_angles_agree() {
        let of = |volts: f64| {
            let column = |name: &str, of: &dyn Fn(f64) -> f64| PreviewColumn {
                name: name.into(),
                values: (0..400).map(|k| of(0.05 * f64::from(k))).collect(),
                ..PreviewColumn::default()
            };
            guess(&[
                column("t", &|t| t),
                column("right_rad", &|t| 5.0 * t - t.cos()),
                column("left_rad", &|t| 5.0 * t + t.cos()),
                column("right_rad_s", &|t| -5.0 - t.sin()),
                column("left_rad_s", &|t| 5.0 - t.sin()),
                column("right_V", &|t| volts * (5.0 + t.sin())),
                column("left_V", &|t| 5.0 - t.sin()),
            ])
        };
        // angles, speeds, voltages; a voltage that is mirrored too, and one that is not
        let (none, turned) = ((None, false), (Some(-1.0), false));
        assert_eq!(scales(&of(-1.0)), [none, none, turned, none, turned, none]);
        assert_eq!(scales(&of(1.0)), [none, none, turned, none, none, none]);
        assert!(of(-1.0).questions.is_empty(), "{}", of(-1.0).asked());
        assert!(of(-1.0).words().contains("opposite to `right_rad`"), "{}", of(-1.0).words());
    }
}
