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
/// direction of the body with dry friction in the model, is near rest.
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
    for (k, (row, m)) in out.iter_mut().zip(&motion).enumerate() {
        let level = model.terms(&motion_of(model, t[k] - t[0], m), p).level;
        let at_rest = |j: usize| along(j, &m.omega).abs() <= REST * top;
        let of_body = (2..level.len()).any(|j| level[j] != 0.0 && at_rest(j));
        for i in 0..2 {
            if of_body || at_rest(i) {
                row[i] = f64::NAN;
            }
        }
    }
    out
}

pub(super) fn motion_of<'a>(model: &'a Model, t: f64, m: &LocalMotion) -> Motion<'a, f64> {
    Motion::at(t, m.alpha, m.omega, model.robot())
}
