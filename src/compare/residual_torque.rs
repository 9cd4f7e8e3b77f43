//! The residual torque: the part of the recorded input that a fitted model does not explain.

use super::low_pass::{filtered, smooth_motion};
use crate::effects::{Motion, along};
use crate::math::Real;
use crate::model::Model;
use crate::recording::{LocalMotion, Recording};
use crate::simulate::{Hold, at_rows};

/// Speed, as a share of the top speed, below which a row counts as rest: after the low-pass the direction of
/// dry friction is unknown there.
pub(crate) const REST: f64 = 0.016;
/// Width of the smoothed sign of a speed, as a share of the top speed.
pub(crate) const WIDTH: f64 = 0.00125;
/// Residual torque of a model with parameters `p` in every row of a recording [N m]; NaN if the wheel, or a
/// direction of the body with dry friction in the model, is near rest or changes its direction, and within 1/(2 cutoff)
/// of that: the low-pass spreads the step of dry friction, whose time it also shifts, over rows that are not independent.
///
/// ```text
/// r = LP(acting input) - LP(mass dω/dt + torque + dry friction),   on the motion after the low-pass LP
/// ```
/// The acting input is that at the time of the row, of an input that is held the mean before and after it.
/// The zero-phase low-pass with cut-off `cutoff` \[Hz\] is applied to both sides. A second mass behind the
/// wheels is not included in the balance.
#[must_use]
pub fn residual_torque(
    model: &Model,
    p: &[f64],
    recording: &Recording,
    hold: Hold,
    cutoff: f64,
) -> Vec<[f64; 2]> {
    let t = recording.t();
    let motion = smooth_motion(recording, cutoff);
    let top = recording.top_speed().max(f64::MIN_POSITIVE);
    // the motion has passed the filter once before it is filtered as torque, so the input passes it twice
    let acting = model.input_of(recording, recording.torque(), p);
    let acting = filtered(recording, cutoff, &at_rows(recording.pieces(), &acting, hold));
    let balance = |(k, m): (usize, &LocalMotion)| {
        let x = motion_of(model, t[k] - t[0], m);
        let sign = std::array::from_fn(|j| Real::erf(along(j, &m.omega) / (WIDTH * top)));
        let needed = model.terms(&x, p).total_torque(&m.acceleration, &sign);
        [0, 1].map(|i| acting[k][i] - needed[i])
    };
    let balance: Vec<[f64; 2]> = motion.iter().enumerate().map(balance).collect();
    let mut out = filtered(recording, cutoff, &balance);
    let mut unknown = stops(model, p, recording, &motion);
    spread(&mut unknown, recording, 0.5 / cutoff);
    for (row, unknown) in out.iter_mut().zip(unknown) {
        (0..2).filter(|&i| unknown[i]).for_each(|i| row[i] = f64::NAN);
    }
    out
}

/// For every row and wheel whether the wheel, or a direction of the body with dry friction in the model, is near rest or
/// has reversed since the row before.
fn stops(
    model: &Model,
    p: &[f64],
    recording: &Recording,
    motion: &[LocalMotion],
) -> Vec<[bool; 2]> {
    let t = recording.t();
    let rest = REST * recording.top_speed().max(f64::MIN_POSITIVE);
    let row = |k: usize, before: usize| {
        let level = model.terms(&motion_of(model, t[k] - t[0], &motion[k]), p).level;
        let stops = |j: usize| {
            let (speed, last) = (along(j, &motion[k].omega), along(j, &motion[before].omega));
            speed.abs() <= rest || speed * last < 0.0
        };
        let of_body = (2..level.len()).any(|j| level[j] != 0.0 && stops(j));
        [0, 1].map(|i| of_body || stops(i))
    };
    let pieces = recording.pieces().iter();
    let rows = pieces.flat_map(|piece| piece.clone().map(|k| row(k, k.max(piece.start + 1) - 1)));
    rows.collect()
}

/// Extends what holds in rows to those within `reach` \[s\] of them in the same piece.
fn spread(holds: &mut [[bool; 2]], recording: &Recording, reach: f64) {
    let t = recording.t();
    for piece in recording.pieces() {
        for i in 0..2 {
            let rows: Vec<usize> = piece.clone().filter(|&k| holds[k][i]).collect();
            let mut next = 0;
            for k in piece.clone() {
                while rows.get(next).is_some_and(|&row| t[row] < t[k] - reach) {
                    next += 1;
                }
                holds[k][i] = rows.get(next).is_some_and(|&row| t[row] <= t[k] + reach);
            }
        }
    }
}

pub(super) fn motion_of<'a>(model: &'a Model, t: f64, m: &LocalMotion) -> Motion<'a, f64> {
    Motion::at(t, m.alpha, m.omega, model.robot())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Channels, DriveUnit};

    #[test]
    fn the_residual_torque_of_the_true_model_is_small_beside_the_step_of_friction() {
        use crate::model::base::{A4, A5};
        use crate::robot::Robot;
        use crate::simulate::{Movement, NoiseLevel, Recorder, record};
        let model = Model::base(Robot::amigobot());
        let p = model.initial();
        let movement = Movement::rich(model.robot(), 3, 30.0, 12.0);
        let noise = NoiseLevel { alpha: 1e-6, dalpha: 1e-6, torque: 1e-6 };
        let recorder = Recorder { rate: 200.0, control_rate: 1000.0, noise, ticks: None, seed: 3 };
        let r = record("true", &model, &p, &movement, &recorder).unwrap();
        for cutoff in [2.0, 5.0, 10.0] {
            let residual = residual_torque(&model, &p, &r, Hold::Linear, cutoff);
            let kept: Vec<[f64; 2]> =
                residual.into_iter().filter(|row| row.iter().all(|v| v.is_finite())).collect();
            assert!(kept.len() > 1000, "{cutoff} Hz: {}", kept.len());
            let largest = kept.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
            // what the low-pass makes of accelerations that change between rows, some percent of the friction
            let share = largest / p[A4].max(p[A5]);
            assert!(share < 0.05, "{cutoff} Hz: {share}");
        }
    }

    #[test]
    fn what_holds_in_a_row_spreads_over_rows_of_its_piece() {
        // 10 rows of 0.1 s, a gap of 1 s, 5 rows
        let t: Vec<f64> =
            (0..15).map(|k| 0.1 * f64::from(k) + if k < 10 { 0.0 } else { 1.0 }).collect();
        let channels = Channels {
            alpha: None,
            omega: Some((0..15).map(|k| [f64::from(k); 2]).collect()),
            torque: vec![[1.0; 2]; 15],
            t,
        };
        let r = Recording::new("rows", channels, DriveUnit::NewtonMetre).unwrap();
        assert_eq!(r.pieces().len(), 2);
        let mut holds = vec![[false; 2]; 15];
        (holds[4][0], holds[9][0]) = (true, true);
        spread(&mut holds, &r, 0.25);
        let rows: Vec<usize> = (0..15).filter(|&k| holds[k][0]).collect();
        assert_eq!(rows, [2, 3, 4, 5, 6, 7, 8, 9]);
        assert!(holds.iter().all(|row| !row[1]));
    }
}
