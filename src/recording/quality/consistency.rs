//! Checks that the columns of a wheel belong together: speed, angle and input.

use nalgebra::{DMatrix, DVector};

use super::quantile;
use super::window::Window;
use crate::math::{correlation, fit, sgn};

/// Smallest number of windows in motion for a check.
pub(super) const FEWEST: usize = 10;
/// Correlation above which two signals are the same.
const SAME: f64 = 0.98;
/// Number of standard errors by which a fitted inertia must be negative.
const SURE: f64 = 5.0;
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
        let (own, other) = (simple_fit(windows, i, i)?, simple_fit(windows, i, 1 - i)?);
        Some(other.rest < EXCHANGED * own.rest && other.rest < EXCHANGED)
    };
    crossed(0) == Some(true) && crossed(1) == Some(true)
}

/// Whether an input opposes the acceleration and has negative work: its sign is then wrong, because friction
/// and inertia require positive work.
pub(crate) fn opposing_input(windows: &[Window], i: usize) -> bool {
    let Some(fit) = simple_fit(windows, i, i) else { return false };
    let work: f64 = windows.iter().map(|w| w.torque[i] * w.speed[i]).sum();
    fit.inertia < -SURE * fit.std_error && work < 0.0
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
}

fn simple_fit(windows: &[Window], input: usize, wheel: usize) -> Option<SimpleFit> {
    let slow = 0.05 * quantile(windows.iter().map(|w| w.speed[wheel]), 0.99);
    let used: Vec<&Window> = windows.iter().filter(|w| w.speed[wheel].abs() > slow).collect();
    if used.len() < 3 * FEWEST {
        return None;
    }
    let x = DMatrix::from_fn(used.len(), 3, |k, j| match j {
        0 => used[k].acceleration[wheel],
        1 => sgn(used[k].speed[wheel]),
        _ => used[k].speed[wheel],
    });
    let y = DVector::from_fn(used.len(), |k, _| used[k].torque[input]);
    let total = y.norm_squared();
    let fitted = fit(&x, &y, None).ok()?;
    (total > 0.0 && fitted.rank == 3).then(|| SimpleFit {
        inertia: fitted.coefficients[0],
        std_error: fitted.std_errors[0],
        rest: fitted.residuals.norm_squared() / total,
    })
}
