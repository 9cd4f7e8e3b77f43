//! Levenberg-Marquardt over consequents with a penalty on the distance from a reference.

use nalgebra::{DMatrix, DVector};

use super::problem::{Journal, Normal, Problem};
use super::settings::Start;
use crate::identify::{IdentifyError, Status};
use crate::math::{MinimiseOptions, Quadratic, minimise};
use crate::simulate::Structure;

/// Where a descent stops.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Steps at the most.
    pub iterations: usize,
    /// Relative fall of the cost below which it has converged.
    pub tolerance: f64,
}

/// Minimises ISE(theta) + weight |theta - about|² from `theta` by [`minimise`].
///
/// ```text
/// gradient = -2 g + 2 weight (theta - about),   curvature = 2 H + 2 weight I
/// ```
/// `weight` = ridge tr(H)/n at the start.
///
/// Returns the consequents, the number of steps, and how it ended.
#[must_use]
pub fn levenberg_marquardt(
    problem: &Problem,
    theta: &DVector<f64>,
    about: &DVector<f64>,
    ridge: f64,
    limits: Limits,
    journal: &Journal,
) -> (DVector<f64>, usize, Status) {
    let n = theta.len();
    let Some(first) = problem.normal(theta.as_slice(), false) else {
        return (theta.clone(), 0, Status::Stalled);
    };
    let weight = ridge * first.h.trace() / n as f64;
    let total = |ise: f64, theta: &DVector<f64>| ise + weight * (theta - about).norm_squared();
    let quadratic = |theta: &DVector<f64>, normal: Normal| {
        journal.note(normal.cost);
        Quadratic {
            cost: total(normal.cost, theta),
            gradient: (theta - about) * (2.0 * weight) - normal.g * 2.0,
            hessian: (normal.h + DMatrix::identity(n, n) * weight) * 2.0,
        }
    };
    let mut first = Some(first);
    let options = MinimiseOptions {
        max_iterations: limits.iterations,
        relative_tolerance: limits.tolerance,
        ..MinimiseOptions::default()
    };
    let minimum = minimise(
        theta,
        |theta| {
            let normal = first.take().or_else(|| problem.normal(theta.as_slice(), false))?;
            Some(quadratic(theta, normal))
        },
        |theta| {
            let ise = problem.cost(theta.as_slice());
            journal.note(ise);
            Some(total(ise, theta))
        },
        &options,
    );
    (minimum.x, minimum.iterations, minimum.status.into())
}

/// Gains through which the continuation goes [1/s].
const LADDER: [f64; 8] = [20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
/// Relative fall of the cost at which an intermediate gain is left.
const ENOUGH: f64 = 1e-3;

/// Levenberg-Marquardt at gains of 20, 10, 5, ... 1/s down to that of `problem`, each from the
/// consequents of the one before; the first from the closed form or the friction level, whichever
/// costs less.
///
/// A high gain holds the emulator at the data, where the cost is nearly quadratic. The
/// serial-parallel structure is linear in the consequents and needs the last gain alone.
///
/// # Errors
/// See [`Problem::closed_form`].
pub fn continuation(
    problem: &Problem,
    level: &DVector<f64>,
    ridge: f64,
    limits: Limits,
    journal: &Journal,
    method: &str,
) -> Result<(DVector<f64>, usize, Status), IdentifyError> {
    let parallel = problem.structure == Structure::Parallel;
    let mut gains: Vec<f64> =
        LADDER.into_iter().filter(|k| parallel && *k > problem.gain).collect();
    gains.push(problem.gain);
    let mut theta = Start::Best.of(&problem.with_gain(gains[0]), level, ridge, method)?;
    let (mut iterations, mut status) = (0, Status::Converged);
    for (i, &gain) in gains.iter().enumerate() {
        let last = i + 1 == gains.len();
        let tolerance = if last { limits.tolerance } else { ENOUGH };
        let limits = Limits { tolerance, ..limits };
        journal.restart();
        let steps;
        (theta, steps, status) =
            levenberg_marquardt(&problem.with_gain(gain), &theta, level, ridge, limits, journal);
        iterations += steps;
    }
    Ok((theta, iterations, status))
}
