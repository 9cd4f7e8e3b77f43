//! Logs with the newest row first: a time that falls is no countdown if the wheels would accelerate against their
//! input.

use nalgebra::Vector3;

use super::guessed::{Guess, Guessed};
use super::values::values_of;
use crate::io::PreviewColumn;
use crate::math::{NormalEquations, sgn};

/// Standard errors by which the response of both wheels must have the wrong sign.
const SURE: f64 = 6.0;

/// Leaves the time as it is where the rows read in their order contradict mechanics: the reader turns the rows round.
///
/// ```text
/// M = c1 dw/dt + c2 sgn(w) + c3 w + e      c1 < 0: the rows run backward   (speeds)
///                                          c2 < 0: the rows run backward   (angles alone: dw/dt keeps its sign)
/// ```
pub(super) fn apply(columns: &[PreviewColumn], guess: &mut Guess) {
    let is_countdown = |c: &&Guessed| c.key == "t" && c.scale.is_some_and(|scale| scale < 0.0);
    let Some(time) = guess.columns.iter().find(is_countdown) else { return };
    let t = values_of(columns, &time.name);
    let is_backward = |wheel: &str| {
        let of = |key: &str| {
            let one = guess.columns.iter().find(|c| c.key == format!("{key}{wheel}"))?;
            Some(values_of(columns, &one.name)).filter(|values| values.len() == t.len())
        };
        let input = of("M")?;
        match (of("dalpha"), of("alpha")) {
            (Some(speed), _) => negative(t, speed, input, 0),
            (None, Some(angle)) => negative(t, &slopes(t, angle), input, 1),
            (None, None) => None,
        }
    };
    if ["1", "2"].iter().all(|wheel| is_backward(wheel) == Some(true)) {
        for one in guess.columns.iter_mut().filter(|c| c.key == "t") {
            one.scale = one.scale.map(|scale| -scale).filter(|scale| *scale != 1.0);
            one.evidence = vec![
                "it falls, and in the order of the rows the wheels would accelerate against their inputs: the newest row is first".into(),
            ];
        }
    }
}

/// Whether the coefficient in this place is significantly negative, with the time turned round.
fn negative(t: &[f64], speed: &[f64], input: &[f64], place: usize) -> Option<bool> {
    let row = |k: usize| {
        let rate = (speed[k + 1] - speed[k - 1]) / (t[k - 1] - t[k + 1]);
        (Vector3::new(rate, sgn(speed[k]), speed[k]), input[k])
    };
    let is_finite = |(x, y): &(Vector3<f64>, f64)| x.iter().all(|v| v.is_finite()) && y.is_finite();
    let rows = (1..t.len().saturating_sub(1)).map(row).filter(is_finite);
    let fit = NormalEquations::of(rows).solve()?;
    Some(fit.values[place] < -SURE * fit.std_error(place))
}

/// Slopes of an angle over the neighbouring rows, with the time turned round.
fn slopes(t: &[f64], angle: &[f64]) -> Vec<f64> {
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(2), (k + 2).min(t.len() - 1));
        (angle[to] - angle[from]) / (t[from] - t[to])
    };
    (0..t.len()).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::super::guess;
    use crate::io::PreviewColumn;

    /// Columns of a robot, in the order of the time or turned round, with a time that falls.
    fn log(newest_first: bool, angles: bool) -> Vec<PreviewColumn> {
        let rows = 1000;
        let at = |k: usize| 0.01 * k as f64;
        let speed = |t: f64| 6.0 * (1.3 * t).sin();
        let angle = |t: f64| 6.0 / 1.3 * (1.0 - (1.3 * t).cos());
        let torque = |t: f64| 0.03 * 7.8 * (1.3 * t).cos() + 0.1 * speed(t).signum();
        let column = |name: &str, of: &dyn Fn(f64) -> f64| {
            let place = |k: usize| if newest_first { rows - 1 - k } else { k };
            let values = (0..rows).map(|k| of(at(place(k)))).collect();
            PreviewColumn { name: name.into(), values, ..PreviewColumn::default() }
        };
        let time = |t: f64| if newest_first { t } else { 10.0 - t };
        let motion = |t: f64| if angles { angle(t) } else { speed(t) };
        let name = |side: &str| match angles {
            true => format!("pos_{side}_rad"),
            false => format!("w_{side}"),
        };
        vec![
            column("time", &time),
            column(&name("right"), &motion),
            column(&name("left"), &motion),
            column("torque_right_Nm", &torque),
            column("torque_left_Nm", &torque),
        ]
    }

    #[test]
    fn a_time_that_falls_is_a_countdown_or_the_newest_row_is_first() {
        for angles in [false, true] {
            let g = guess(&log(true, angles));
            assert_eq!(g.columns[0].scale, None, "{:?}", g.columns);
            assert!(g.words().contains("the newest row is first"), "{}", g.words());
            let g = guess(&log(false, angles));
            assert_eq!(g.columns[0].scale, Some(-1.0), "{:?}", g.columns);
        }
    }
}
