//! Levenberg-Marquardt over consequents with a penalty on the distance from a reference.

use nalgebra::{DMatrix, DVector};

use super::problem::{Journal, Normal, Problem};
use super::settings::Start;
use crate::identify::{IdentifyError, Status};
use crate::math::{MinimiseOptions, Quadratic, minimise};
use crate::simulate::Structure;

/// Stopping criteria of a descent.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest number of steps.
    pub iterations: usize,
    /// Relative decrease of the cost below which the descent has converged.
    pub tolerance: f64,
}

/// ISE(theta) + weight |theta - about|², the cost that is minimised over [`Problem::free`].
#[derive(Clone, Copy, Debug)]
pub struct Penalty<'a> {
    /// The reference consequents [rad/s²].
    pub about: &'a DVector<f64>,
    /// See [`Problem::penalty`].
    pub weight: f64,
}

impl Penalty<'_> {
    /// weight |theta - about|².
    #[must_use]
    pub fn of(&self, theta: &DVector<f64>) -> f64 {
        self.weight * (theta - self.about).norm_squared()
    }

    /// Its derivatives with respect to the consequents `free`.
    #[must_use]
    pub fn slope(&self, theta: &DVector<f64>, free: &[usize]) -> DVector<f64> {
        let one = |k: usize| 2.0 * self.weight * (theta[free[k]] - self.about[free[k]]);
        DVector::from_fn(free.len(), |k, _| one(k))
    }
}

/// Minimises ISE(theta) + weight |theta - about|² from `theta` by [`minimise`].
///
/// ```text
/// gradient = -2 g + 2 weight (theta - about),   curvature = 2 H + 2 weight I
/// ```
///
/// Returns the consequents, the number of steps and the status.
#[must_use]
pub fn levenberg_marquardt(
    problem: &Problem,
    theta: &DVector<f64>,
    penalty: Penalty,
    limits: Limits,
    journal: &Journal,
) -> (DVector<f64>, usize, Status) {
    let free = problem.free();
    let n = free.len();
    let with = |x: &DVector<f64>| {
        let mut theta = theta.clone();
        free.iter().zip(x.iter()).for_each(|(&j, x)| theta[j] = *x);
        theta
    };
    let quadratic = |theta: &DVector<f64>, normal: Normal| {
        journal.note(normal.cost);
        Quadratic {
            cost: normal.cost + penalty.of(theta),
            gradient: penalty.slope(theta, &free) - normal.g * 2.0,
            hessian: (normal.h + DMatrix::identity(n, n) * penalty.weight) * 2.0,
            scatter: 0.0,
        }
    };
    let options = MinimiseOptions {
        max_iterations: limits.iterations,
        relative_tolerance: limits.tolerance,
        ..MinimiseOptions::default()
    };
    let minimum = minimise(
        &DVector::from_fn(n, |k, _| theta[free[k]]),
        |x| {
            let theta = with(x);
            Some(quadratic(&theta, problem.normal(theta.as_slice(), false)?))
        },
        |x| {
            let theta = with(x);
            let ise = problem.cost(theta.as_slice());
            journal.note(ise);
            Some(ise + penalty.of(&theta))
        },
        &options,
    );
    (with(&minimum.x), minimum.iterations, minimum.status.into())
}

/// Gains of the continuation, in order [1/s].
const LADDER: [f64; 8] = [20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
/// Factor by which the tolerance at intermediate gains is larger.
const COARSER: f64 = 30.0;

/// Descents at gains of 20, 10, 5, ... 1/s down to that of `problem`, each from the consequents of the previous
/// one; the first from the closed form or the friction level, whichever has the lower cost.
///
/// With a high gain the emulator follows the data, and the cost is nearly quadratic. The
/// serial-parallel structure is linear in the consequents and needs only the last gain.
///
/// # Errors
/// See [`Problem::closed_form`], and those of `descend`.
pub fn continuation(
    problem: &Problem,
    level: &DVector<f64>,
    ridge: f64,
    limits: Limits,
    journal: &Journal,
    method: &str,
    descend: impl Fn(&Problem, &DVector<f64>, Limits) -> Result<Descent, IdentifyError>,
) -> Result<Descent, IdentifyError> {
    let parallel = problem.structure == Structure::Parallel;
    let mut gains: Vec<f64> =
        LADDER.into_iter().filter(|k| parallel && *k > problem.gain).collect();
    gains.push(problem.gain);
    let mut theta = Start::Best.of(&problem.with_gain(gains[0]), level, ridge, method)?;
    let (mut iterations, mut status) = (0, Status::Converged);
    for (i, &gain) in gains.iter().enumerate() {
        let last = i + 1 == gains.len();
        let tolerance = if last { 1.0 } else { COARSER } * limits.tolerance;
        let limits = Limits { tolerance, ..limits };
        journal.restart();
        let steps;
        (theta, steps, status) = descend(&problem.with_gain(gain), &theta, limits)?;
        iterations += steps;
    }
    Ok((theta, iterations, status))
}

/// Consequents, number of steps, and status of a descent.
pub type Descent = (DVector<f64>, usize, Status);
