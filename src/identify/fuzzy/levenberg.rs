//! Levenberg-Marquardt over consequents (and premises) with a pull to a reference.

use nalgebra::{DMatrix, DVector};

use super::problem::{Journal, Problem};
use super::settings::Start;
use crate::identify::{IdentifyError, Status};
use crate::simulate::Structure;

/// Where a descent stops.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Steps tried at the most.
    pub iterations: usize,
    /// Relative fall of the cost below which it has converged.
    pub tolerance: f64,
}

/// Minimises ISE(theta) + weight |theta - about|² from `theta`.
///
/// ```text
/// (H + weight I + mu diag H) d = g - weight (theta - about)
/// ```
/// mu falls by 10 after a step that lowers the cost, and rises by 4 after one that does not
/// (Marquardt, SIAM J. 11 (1963)). `weight` = ridge tr(H)/n at the start.
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
    let mut theta = theta.clone();
    let Some(mut normal) = problem.normal(theta.as_slice(), false) else {
        return (theta, 0, Status::Stalled);
    };
    journal.note(normal.cost);
    let n = theta.len();
    let weight = ridge * normal.h.trace() / n as f64;
    let total = |cost: f64, theta: &DVector<f64>| cost + weight * (theta - about).norm_squared();
    let mut cost = total(normal.cost, &theta);
    let mut mu = 1e-3;
    let mut small = 0;
    for iteration in 0..limits.iterations {
        let right = &normal.g - (&theta - about) * weight;
        let floor = 1e-9 * normal.h.trace() / n as f64;
        let mut matrix = normal.h.clone() + DMatrix::identity(n, n) * weight;
        for j in 0..n {
            matrix[(j, j)] += mu * (normal.h[(j, j)] + floor);
        }
        let step = matrix.cholesky().map(|factor| factor.solve(&right));
        let trial = step.map(|step| &theta + step);
        let better = trial.and_then(|trial| {
            // the cost alone is cheap: derivatives only where the step is taken
            let ise = problem.cost(trial.as_slice());
            journal.note(ise);
            let new = total(ise, &trial);
            (new < cost).then_some((trial, new))
        });
        match better {
            Some((trial, new)) => {
                let fall = (cost - new) / cost;
                small = if fall < limits.tolerance { small + 1 } else { 0 };
                (theta, cost) = (trial, new);
                if small >= 2 {
                    return (theta, iteration + 1, Status::Converged);
                }
                let Some(next) = problem.normal(theta.as_slice(), false) else {
                    return (theta, iteration + 1, Status::Stalled);
                };
                journal.note(next.cost);
                normal = next;
                mu = (0.1 * mu).max(1e-12);
            }
            None if mu > 1e8 => {
                // no step of any length helps: at the minimum to rounding
                return (theta, iteration + 1, Status::Converged);
            }
            None => mu *= 4.0,
        }
    }
    (theta, limits.iterations, Status::IterationLimit)
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
