//! Counts per row: the increments of an encoder in place of its count.

use nalgebra::{DMatrix, DVector};

use super::guessed::{Candidate, Guess, Guessed};
use super::names::Quantity;
use super::times::{row_step, seconds};
use super::values::{extent, never_falls, values_of, whole};
use crate::io::{PreviewColumn, words};
use crate::math::{fit, mean, sgn};

/// Words of a difference between two rows.
const DIFFERENCES: [&str; 7] =
    ["diff", "delta", "deltas", "inc", "incr", "increment", "increments"];
/// Words of counts, also behind a `d`: `dEncL`, `dticks_l`.
const COUNTS: [&str; 9] =
    ["ticks", "tick", "counts", "count", "cnt", "enc", "encoder", "pulses", "pulse"];
/// Those of them that are units, in front of a stroke.
const UNITS_OF_COUNTS: [&str; 7] = ["ticks", "tick", "counts", "count", "cnt", "pulses", "pulse"];
/// Words of the interval in which the rows of a log are taken.
const ROWS: [&str; 8] = ["row", "loop", "sample", "cycle", "step", "frame", "interval", "tick"];
/// Unit of counts in a time.
const UNIT: &str = "ticks/s";

/// The interval of increments that a name states.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Interval {
    /// From row to row.
    Row,
    /// A time \[s\].
    Seconds(f64),
}

/// Interprets names of counts that state that they are increments: `left_ticks_diff`, `ticksL_per_10ms`, `dEncL`,
/// `L [counts/10ms]`. They are speeds, unless another column is the motion.
pub(super) fn by_name(all: &mut [Candidate]) {
    let found: Vec<Option<Interval>> = all
        .iter()
        .map(|c| interval(&c.column.name).filter(|_| whole(&c.column.values) && !c.named.foreign))
        .collect();
    let moves = |c: &Candidate| {
        matches!(c.named.quantity, Some(Quantity::Angle | Quantity::Speed))
            && c.named.side.is_some()
            && !c.named.wished
    };
    let are_needed = !all.iter().zip(&found).any(|(c, found)| found.is_none() && moves(c));
    for (c, interval) in all.iter_mut().zip(found) {
        let Some(interval) = interval else { continue };
        c.named.quantity = are_needed.then_some(Quantity::Speed);
        (c.named.unit, c.named.scale) = (Some(UNIT), None);
        match interval {
            Interval::Row => c.named.per_row = true,
            Interval::Seconds(seconds) => c.named.scale = Some(rounded(1.0 / seconds)),
        }
    }
}

/// The interval of a name of increments.
fn interval(name: &str) -> Option<Interval> {
    let words = words(&per_written_out(name));
    let is_count = |word: &str| COUNTS.contains(&word);
    if !words.iter().any(|w| is_count(w) || w.strip_prefix('d').is_some_and(is_count)) {
        return None;
    }
    let per = words.iter().position(|w| w == "per").map(|k| &words[k + 1..]);
    match per {
        Some([row, ..]) if ROWS.contains(&row.as_str()) => return Some(Interval::Row),
        Some([number, unit, ..]) => {
            let second = match unit.as_str() {
                "ms" => 1e-3,
                "us" => 1e-6,
                "s" | "sec" => 1.0,
                _ => return None,
            };
            let size = number.parse::<f64>().ok().filter(|n| *n > 0.0)?;
            return Some(Interval::Seconds(size * second));
        }
        // per second, per turn
        Some(_) => return None,
        None => {}
    }
    let is_behind_d = words.windows(2).any(|w| w[0] == "d" && is_count(&w[1]))
        || words.iter().any(|w| w.strip_prefix('d').is_some_and(is_count));
    let is_one = is_behind_d || words.iter().any(|w| DIFFERENCES.contains(&w.as_str()));
    is_one.then_some(Interval::Row)
}

/// A name with the stroke behind a unit of counts as a word; any other one separates the parts of a path, as in
/// `left_wheel_encoder/tick`.
fn per_written_out(name: &str) -> String {
    let mut parts = name.split('/');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_unit = words(&out).last().is_some_and(|w| UNITS_OF_COUNTS.contains(&w.as_str()));
        out.push_str(if is_unit { " per " } else { " " });
        out.push_str(part);
    }
    out
}

/// Rows whose mean is one value of the comparison with the input: counts are coarse.
const BLOCK: usize = 8;
/// Fewest blocks that show it.
const BLOCKS: usize = 40;
/// Part of the variance of the input that a speed must explain beyond its change, and how many times what an angle
/// would explain. Speeds explain 0.04 to 0.8 of it and angles less than 0.001, at a ratio of more than 100 either way.
const EXPLAINED: f64 = 0.03;
const RATIO: f64 = 10.0;

/// Takes whole numbers that were taken for angles as speeds, where the input of both wheels follows them so: where
/// they are large, and not where they change fast. Beside speeds they are left out.
pub(super) fn by_values(
    columns: &[PreviewColumn],
    input: Option<&[Guessed; 2]>,
    angles: &mut Option<[Guessed; 2]>,
    speeds: &mut Option<[Guessed; 2]>,
) {
    let Some(input) = input else { return };
    let of = |one: &Guessed| values_of(columns, &one.name);
    let is_free = |c: &Guessed| {
        c.name != c.key && matches!(c.unit.as_deref(), None | Some("ticks")) && c.scale.is_none()
    };
    let are = |pair: &mut [Guessed; 2]| {
        let mut wheels = pair.iter().zip(input);
        wheels.all(|(c, input)| is_free(c) && whole(of(c)) && are_speeds(of(c), of(input)))
    };
    let Some(pair) = angles.take_if(are) else { return };
    let why = "the input follows them as speeds and not as angles: counts per row";
    match speeds {
        Some(speeds) => {
            let names = pair.each_ref().map(|c| format!("`{}`", c.name)).join(" and ");
            speeds[0].evidence.push(format!("{names}: {why}"));
        }
        None => {
            let mut keys = super::SPEEDS.into_iter();
            *speeds = Some(pair.map(|one| Guessed {
                key: keys.next().unwrap_or_default(),
                unit: Some(UNIT.into()),
                per_row: true,
                evidence: [one.evidence, vec![why.into()]].concat(),
                ..one
            }));
        }
    }
}

/// Whether values are the speed that an input drives, and not the angle.
///
/// ```text
/// u = c + a x'' + b x' + d sgn x'  +  e x + f sgn x
///         inertia of an angle         friction and back-EMF of a speed
/// ```
/// Without the last two terms the fit loses what only a speed explains, without `x''` and `sgn x'` what only an angle
/// does.
fn are_speeds(values: &[f64], input: &[f64]) -> bool {
    let rows = values.iter().zip(input).filter(|(x, u)| x.is_finite() && u.is_finite());
    let rows: Vec<(f64, f64)> = rows.map(|(x, u)| (*x, *u)).collect();
    let (low, high) = extent(values);
    let jumps = |w: &[(f64, f64)]| (w[1].0 - w[0].0).abs() > 0.5 * (high - low);
    // a counter wraps or is reset; one that never falls is not a speed, which returns to zero
    if rows.windows(2).any(jumps) || never_falls(values) {
        return false;
    }
    let of_block = |block: &[(f64, f64)]| {
        (mean(block.iter().map(|(x, _)| *x)), mean(block.iter().map(|(_, u)| *u)))
    };
    let blocks: Vec<(f64, f64)> = rows.chunks_exact(BLOCK).map(of_block).collect();
    if values.len() != input.len() || blocks.len() < BLOCKS {
        return false;
    }
    let terms = |w: &[(f64, f64)]| {
        let (before, x, after) = (w[0].0, w[1].0, w[2].0);
        let slope = 0.5 * (after - before);
        [1.0, slope, after - 2.0 * x + before, sgn(slope), x, sgn(x)]
    };
    let all: Vec<[f64; 6]> = blocks.windows(3).map(terms).collect();
    let driven: Vec<f64> = blocks.windows(3).map(|w| w[1].1).collect();
    // squares of what these terms leave
    let left = |of: &[usize]| -> Option<f64> {
        let x = DMatrix::from_fn(all.len(), of.len(), |row, k| all[row][of[k]]);
        let y = DVector::from_column_slice(&driven);
        Some(fit(&x, &y, None).ok()?.residuals.norm_squared())
    };
    let (Some(none), Some(full), Some(as_angle), Some(as_speed)) =
        (left(&[0]), left(&[0, 1, 2, 3, 4, 5]), left(&[0, 1, 2, 3]), left(&[0, 1, 4, 5]))
    else {
        return false;
    };
    let (of_speed, of_angle) = (as_angle - full, as_speed - full);
    of_speed > EXPLAINED * none && of_speed > RATIO * of_angle
}

/// Turns counts per row into counts per second by the time between the rows, which is asked for where it is not known.
pub(super) fn per_second(columns: &[PreviewColumn], guess: &mut Guess) {
    if !guess.columns.iter().any(|c| c.per_row) {
        return;
    }
    let time = guess.columns.iter().find(|c| c.key == "t" && !c.scale_open && !c.unit_open);
    let row = time.filter(|t| t.nanoseconds.is_none()).and_then(|t| {
        let step = row_step(values_of(columns, &t.name), t.sum)?;
        Some(step * seconds(t) * t.scale.unwrap_or(1.0).abs())
    });
    let names: Vec<String> =
        guess.columns.iter().filter(|c| c.per_row).map(|c| format!("`{}`", c.name)).collect();
    if row.is_none() {
        guess.ask(format!(
            "{} are counts per row: how many rows are taken in a second? Write this number as scale of dalpha1 and dalpha2",
            names.join(" and ")
        ));
    }
    for one in guess.columns.iter_mut().filter(|c| c.per_row) {
        one.per_row = false;
        match row {
            Some(row) => {
                one.scale = Some(rounded(1.0 / row));
                one.evidence.push(format!("counts per row of {row:.4} s"));
            }
            None => one.scale_open = true,
        }
    }
}

/// A rate without the noise of its time stamps.
fn rounded(rate: f64) -> f64 {
    (rate * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use super::*;

    /// Speed of a wheel that rests, moves both ways and rests again, three times [counts/s].
    fn speed(t: f64) -> f64 {
        let phase = std::f64::consts::TAU * (t % 4.0 - 1.0).max(0.0) / 3.0;
        3000.0 * (phase.sin() + 0.6 * (2.0 * phase).sin())
    }

    /// Rows of 10 ms, in counts: the count and its increment.
    fn counted() -> (Vec<f64>, Vec<f64>) {
        let way = (0..1200).scan(0.0, |way, k| {
            *way += 0.01 * speed(0.01 * f64::from(k));
            Some(*way)
        });
        let count: Vec<f64> = way.map(f64::floor).collect();
        (count, (0..1200).map(|k| (0.01 * speed(0.01 * f64::from(k))).round()).collect())
    }

    fn of(names: [&str; 2], values: &[f64]) -> Guess {
        let column = |name: &str, values: Vec<f64>| PreviewColumn {
            name: name.into(),
            values,
            ..PreviewColumn::default()
        };
        let pwm: Vec<f64> = (0..1200).map(|k| 0.05 * speed(0.01 * f64::from(k))).collect();
        guess(&[
            column("ms", (0..1200).map(|k| 10.0 * f64::from(k)).collect()),
            column(names[0], values.to_vec()),
            column(names[1], values.to_vec()),
            column("L_pwm", pwm.iter().map(|u| u.round()).collect()),
            column("R_pwm", pwm.iter().map(|u| u.round()).collect()),
        ])
    }

    #[test]
    fn counts_that_the_input_follows_as_speeds_are_speeds() {
        let (count, step) = counted();
        let g = of(["L_counts", "R_counts"], &step);
        let right = g.columns.iter().find(|c| c.key == "dalpha1").unwrap();
        assert_eq!((right.name.as_str(), right.unit.as_deref()), ("R_counts", Some(UNIT)));
        assert_eq!((right.scale, right.needs_per_turn()), (Some(100.0), true));
        assert!(right.evidence[0].contains("as speeds"), "{:?}", right.evidence);
        // a count is an angle, and so is one that is reset while the robot moves
        let reset: Vec<f64> =
            (0..1200).map(|k| if k % 400 < 20 { 0.0 } else { count[k] + 500.0 }).collect();
        for values in [&count, &reset] {
            let g = of(["L_counts", "R_counts"], values);
            assert!(g.columns.iter().any(|c| c.key == "alpha1"), "{:?}", g.columns);
        }
    }

    #[test]
    fn names_of_increments_are_those_of_speeds() {
        let (_, step) = counted();
        for (names, scale) in [
            (["left_ticks_diff", "right_ticks_diff"], 100.0),
            (["ticksL_per_10ms", "ticksR_per_10ms"], 100.0),
            (["L [counts/20ms]", "R [counts/20ms]"], 50.0),
            (["dEncL", "dEncR"], 100.0),
            (["delta_ticks_left", "delta_ticks_right"], 100.0),
        ] {
            // the input does not show it
            let moving: Vec<f64> = (0..1200).map(|k| (step[k] + 97.0 * k as f64) % 89.0).collect();
            let g = of(names, &moving);
            let found = g.columns.iter().find(|c| c.key == "dalpha2");
            let found = found.unwrap_or_else(|| panic!("{names:?} {}", g.words()));
            assert_eq!(found.name, names[0]);
            assert_eq!((found.unit.as_deref(), found.scale), (Some(UNIT), Some(scale)));
        }
        for name in [
            "ticks_per_s_l",
            "counts_per_turn",
            "enc_l",
            "enc_vel_L",
            "d_angle_l",
            "left_encoder/tick",
        ] {
            assert_eq!(interval(name), None, "{name}");
        }
    }
}
