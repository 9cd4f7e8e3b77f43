//! Checks that the columns of a wheel belong together: speed, angle and input.

use nalgebra::{DMatrix, DVector};

use super::quantile;
use super::window::Window;
use crate::math::distribution::t_survival;
use crate::math::{Moments, correlation, fit, sgn};

/// Smallest number of windows in motion for a check.
pub(super) const FEWEST: usize = 10;
/// Correlation above which two signals are the same.
const SAME: f64 = 0.98;
/// Probability by chance of an inertia as negative as the fitted one: five standard errors of a normal variable.
const CHANCE: f64 = 2.9e-7;
/// The same for an input that brakes a wheel from rest on, which excludes a constant brake on a slope.
const SLOPE: f64 = 0.01;
/// Part of the work without signs that negative work must be to brake nearly always.
const BRAKES: f64 = 0.9;
/// Part of the top speed below which a wheel starts from rest.
const AT_REST: f64 = 0.2;
/// Unexplained share of an input when fitted to the other wheel, relative to the fit to its own wheel and to
/// the total, below which the inputs are exchanged.
const EXCHANGED: f64 = 0.3;

/// Whether the speed of each wheel matches the angle of the other wheel instead of its own.
pub(crate) fn exchanged_speeds(windows: &[Window]) -> bool {
    let windows = smooth(windows);
    let follows =
        |i: usize, j: usize| correlation(windows.iter().map(|w| (w.speed[i], w.angle_rate[j])));
    let crossed = follows(0, 1).abs() > SAME && follows(1, 0).abs() > SAME;
    let straight = follows(0, 0).abs() > 0.9 && follows(1, 1).abs() > 0.9;
    windows.len() >= FEWEST && crossed && !straight
}

/// Whether the input of each wheel drives the other one.
pub(crate) fn exchanged_input(windows: &[Window]) -> bool {
    let crossed = |i: usize| -> Option<bool> {
        let of = |j: usize| simple_fit(windows, i, j).filter(|fit| fit.windows >= 3 * FEWEST);
        let (own, other) = (of(i)?, of(1 - i)?);
        Some(other.rest < EXCHANGED * own.rest && other.rest < EXCHANGED)
    };
    crossed(0) == Some(true) && crossed(1) == Some(true)
}

/// Whether an input opposes the acceleration and has negative work: its sign is then wrong, because friction and
/// inertia require positive work. In few windows it is the work that shows it: nothing gains speed from rest while its
/// motor brakes nearly always, but a wheel that rolls down a slope against a constant brake; that one does not rest
/// [before its input begins](is_at_rest_undriven).
pub(crate) fn opposing_input(windows: &[Window], i: usize) -> bool {
    let power = || windows.iter().map(|w| w.torque[i] * w.speed[i]);
    let (work, most): (f64, f64) = (power().sum(), power().map(f64::abs).sum());
    let top = quantile(windows.iter().map(|w| w.speed[i]), 1.0);
    let starts = windows.first().is_some_and(|w| w.speed[i].abs() < AT_REST * top);
    let brakes = starts && work < -BRAKES * most;
    if brakes && is_at_rest_undriven(windows, i) {
        return true;
    }
    let Some(fit) = simple_fit(windows, i, i) else { return false };
    let chance = t_survival(-fit.inertia / fit.std_error, (fit.windows - COEFFICIENTS) as f64);
    let is_short = fit.windows < 3 * FEWEST;
    work < 0.0 && (chance < CHANCE || brakes && is_short && chance < SLOPE)
}

/// Whether of a wheel whose input opposes its motion it is the sensors that have the wrong sign, by the torques between
/// the wheels, which depend on the direction in which the other one turns. `false` where these do not show it.
///
/// ```text
/// M1 = a1 w1' + a2 w2' + a3 w2 (w2 - w1)                        (and with the wheels exchanged; a1 to a3 common)
///      + c1 + c2 sgn w1 + c3 w1 + c4 w1 |w1| + c5 sgn(w1 - w2) + c6 sgn(w1 + w2)
/// ```
/// The terms in c are as good with one direction as with the other: friction that the model may lack is no evidence.
pub(crate) fn counts_backwards(windows: &[Window], i: usize) -> bool {
    let [input, sensors] = [1.0, -1.0].map(|speed| balance(windows, i, speed, -speed));
    input.zip(sensors).is_some_and(|(input, sensors)| is_surely_better(&input, &sensors))
}

/// Whether one of the wheels is counted backwards, sensors and input alike, by the same torques: these depend then on the
/// sum of the wheels' speeds in place of their difference. Which of the wheels it is they do not show.
pub(crate) fn is_mirrored(windows: &[Window]) -> bool {
    let [given, turned] = [1.0, -1.0].map(|sign| balance(windows, 1, sign, sign));
    given.zip(turned).is_some_and(|(given, turned)| is_surely_better(&given, &turned))
}

/// Whether the second of two balances leaves less, by Vuong's test of two models of which neither contains the other.
fn is_surely_better(one: &[f64], other: &[f64]) -> bool {
    let sample = Moments::of(one.iter().zip(other).map(|(a, b)| a * a - b * b));
    sample.mean > 0.0 && t_survival(sample.mean / sample.std_error(), sample.count - 1.0) < CHANCE
}

/// Residuals of both wheels' torques, with the speed and the torque of wheel `i` times these signs.
fn balance(windows: &[Window], i: usize, speed: f64, torque: f64) -> Option<Vec<f64>> {
    let turned = |w: &Window| {
        let mut w = *w;
        w.speed[i] *= speed;
        w.acceleration[i] *= speed;
        w.torque[i] *= torque;
        w
    };
    let windows: Vec<Window> = moving(windows, i).into_iter().map(turned).collect();
    if windows.len() < 3 * FEWEST {
        return None;
    }
    let x = DMatrix::from_fn(2 * windows.len(), 3 + 2 * 6, |k, j| {
        let (w, own) = (&windows[k / 2], k % 2);
        let (speed, other) = (w.speed[own], w.speed[1 - own]);
        match j {
            0 => w.acceleration[own],
            1 => w.acceleration[1 - own],
            2 => other * (other - speed),
            _ if (j - 3) / 6 != own => 0.0,
            _ => match (j - 3) % 6 {
                0 => 1.0,
                1 => sgn(speed),
                2 => speed,
                3 => speed * speed.abs(),
                4 => sgn(speed - other),
                _ => sgn(speed + other),
            },
        }
    });
    let y = DVector::from_fn(2 * windows.len(), |k, _| windows[k / 2].torque[k % 2]);
    Some(fit(&x, &y, None).ok()?.residuals.iter().copied().collect())
}

/// Whether a wheel is at rest until its input begins, which is not smaller than that of the other wheel: by its inertia
/// and friction it starts in the direction of the input, and on a slope friction held it already. One that is turned by
/// the other wheel, or pushed against a controller, moves with the smaller input or before it.
fn is_at_rest_undriven(windows: &[Window], i: usize) -> bool {
    let top = quantile(windows.iter().map(|w| w.speed[i]), 1.0);
    let largest = |i: usize| quantile(windows.iter().map(|w| w.torque[i]), 1.0);
    let is_driven = |w: &Window| w.torque[i].abs() > AT_REST * largest(i);
    let before = windows.iter().position(is_driven).unwrap_or(0);
    let at_rest = windows[..before].iter().all(|w| w.size[i] < AT_REST * top);
    before > 0 && at_rest && largest(i) >= largest(1 - i)
}

/// Whether a wheel moves, but in too few windows for the test of its input's sign.
pub(super) fn is_sign_untested(windows: &[Window], i: usize) -> bool {
    let moving = moving(windows, i).len();
    moving > 0 && moving < FEWEST
}

/// Windows without jumps of a wrapped angle.
fn smooth(windows: &[Window]) -> Vec<&Window> {
    let limit = 3.0 * quantile(windows.iter().flat_map(|w| w.angle_rate), 0.9);
    windows.iter().filter(|w| w.angle_rate.iter().all(|a| a.abs() <= limit)).collect()
}

/// Regression `M = c1 dω + c2 sgn(ω) + c3 ω` of the input of one wheel on the motion of one wheel.
struct SimpleFit {
    inertia: f64,
    std_error: f64,
    /// Unexplained share of the input \[1\].
    rest: f64,
    /// Number of windows.
    windows: usize,
}

/// Number of coefficients of the regression.
const COEFFICIENTS: usize = 3;

/// The windows in which a wheel moves.
fn moving(windows: &[Window], wheel: usize) -> Vec<&Window> {
    let slow = 0.05 * quantile(windows.iter().map(|w| w.speed[wheel]), 0.99);
    windows.iter().filter(|w| w.speed[wheel].abs() > slow).collect()
}

fn simple_fit(windows: &[Window], input: usize, wheel: usize) -> Option<SimpleFit> {
    let used = moving(windows, wheel);
    if used.len() < FEWEST {
        return None;
    }
    let x = DMatrix::from_fn(used.len(), COEFFICIENTS, |k, j| match j {
        0 => used[k].acceleration[wheel],
        1 => sgn(used[k].speed[wheel]),
        _ => used[k].speed[wheel],
    });
    let y = DVector::from_fn(used.len(), |k, _| used[k].torque[input]);
    let total = y.norm_squared();
    let fitted = fit(&x, &y, None).ok()?;
    (total > 0.0 && fitted.rank == COEFFICIENTS).then(|| SimpleFit {
        inertia: fitted.coefficients[0],
        std_error: fitted.std_errors[0],
        rest: fitted.residuals.norm_squared() / total,
        windows: used.len(),
    })
}
