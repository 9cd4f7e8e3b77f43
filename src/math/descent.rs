//! Damped Gauss-Newton for costs given by value, gradient and curvature.

mod options;
mod quadratic;
mod quadratic_model;

use nalgebra::{DMatrix, DVector};

pub use self::options::MinimiseOptions;
pub use self::quadratic::Quadratic;
use self::quadratic_model::{QuadraticModel, RIDGE};
pub use super::damped::MinimumStatus;
use super::damped::{Attempt, DampedSearch, Proposal, take_steps};

/// Result of a minimisation, with the curvature at the minimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The parameters.
    pub x: DVector<f64>,
    /// Cost at `x`, the lowest that was reached.
    pub cost: f64,
    /// Gradient at `x`; near zero if the descent converged.
    pub gradient: DVector<f64>,
    /// The curvature at `x`.
    pub hessian: DMatrix<f64>,
    /// Accepted steps.
    pub iterations: usize,
    /// Evaluations of the cost, with or without derivatives.
    pub evaluations: usize,
    /// How it ended.
    pub status: MinimumStatus,
}

/// Relative damping above which no step can lower the cost.
const MAX_DAMPING: f64 = 1e12;
/// Factor on the damping after a rejected step, doubled with each further rejection.
const FIRST_FACTOR: f64 = 2.0;
/// Number of consecutive accepted steps with a negligible decrease of the cost after which the descent ends.
const IDLE: usize = 2;
/// Least ratio of the actual to the predicted decrease of a step, and largest ratio of the next predicted decrease to
/// it, for decreases to be extrapolated: the descent then converges at least linearly, by that ratio.
const AS_PREDICTED: f64 = 0.9;
const FAST: f64 = 0.1;

/// The damping of the next step, by Nielsen's rule.
struct Damping {
    value: f64,
    /// Factor after the next rejection.
    factor: f64,
}

impl Damping {
    /// Whether the last step was accepted, or none was tried yet.
    fn follows_success(&self) -> bool {
        self.factor == FIRST_FACTOR
    }

    /// After an accepted step; `gain`: actual over predicted decrease of the cost.
    fn accept(&mut self, gain: f64) {
        let shrink = 1.0 - (2.0 * gain - 1.0).powi(3);
        // a gain that is not a number comes from a step cut at a bound
        self.value *= if shrink.is_nan() { 1.0 } else { shrink.clamp(1.0 / 3.0, 2.0) };
        self.value = self.value.max(1e-15);
        self.factor = FIRST_FACTOR;
    }

    fn reject(&mut self) {
        self.value *= self.factor;
        self.factor *= 2.0;
    }
}

/// Minimises a cost by Levenberg and Marquardt's method within simple bounds.
///
/// ```text
/// (S + lambda I) D d = -D^-1 g,   S = D^-1 H D^-1,   D = diag(sqrt h_ii)
/// ```
///
/// `evaluate` gives cost, gradient and curvature, `cost_only` the cost of a trial; both return `None` where the cost
/// does not exist, and such a trial, like one that is not finite, is a rejected step. Parameters at an active bound are
/// fixed, also those that the step of all would move beyond it; steps are truncated at the bounds. Scaling makes the
/// result independent of units.
///
/// Source: D. W. Marquardt, J. SIAM 11 (1963); damping rule of H. B. Nielsen, IMM-REP-1999-05.
///
/// # Examples
/// ```
/// use amigo_ident::math::descent::{MinimiseOptions, MinimumStatus, Quadratic, minimise};
/// use nalgebra::{DMatrix, DVector};
/// // x - ln x has its minimum at 1 and does not exist below 0
/// let cost = |x: &DVector<f64>| (x[0] > 0.0).then(|| x[0] - x[0].ln());
/// let quadratic = |x: &DVector<f64>| {
///     Some(Quadratic {
///         cost: cost(x)?,
///         gradient: DVector::from_element(1, 1.0 - 1.0 / x[0]),
///         hessian: DMatrix::from_element(1, 1, 1.0 / (x[0] * x[0])),
///         scatter: 0.0,
///     })
/// };
/// let start = DVector::from_element(1, 10.0);
/// let minimum = minimise(&start, quadratic, cost, &MinimiseOptions::default());
/// assert_eq!(minimum.status, MinimumStatus::Converged);
/// assert!((minimum.x[0] - 1.0).abs() < 1e-6);
/// ```
pub fn minimise(
    start: &DVector<f64>,
    mut evaluate: impl FnMut(&DVector<f64>) -> Option<Quadratic>,
    cost_only: impl FnMut(&DVector<f64>) -> Option<f64>,
    options: &MinimiseOptions,
) -> Minimum {
    let usable = |q: &Quadratic| is_usable(q, start.len());
    let bounds_fit = [&options.lower, &options.upper]
        .into_iter()
        .all(|b| b.as_ref().is_none_or(|b| b.len() == start.len()));
    if !bounds_fit {
        return no_start(start, 0);
    }
    let x = project(start, options);
    let Some(here) = evaluate(&x).filter(usable) else { return no_start(&x, 1) };
    let damping = Damping { value: options.initial_damping, factor: FIRST_FACTOR };
    let (idle, fallen, evaluations) = (0, 0.0, 1);
    let mut descent =
        Descent { x, here, damping, idle, fallen, evaluations, evaluate, cost_only, options };
    let (status, iterations) = take_steps(&mut descent);
    let Descent { x, here, evaluations, .. } = descent;
    let Quadratic { cost, gradient, hessian, .. } = here;
    Minimum { x, cost, gradient, hessian, iterations, evaluations, status }
}

/// A minimisation under way.
struct Descent<'a, E, C> {
    x: DVector<f64>,
    here: Quadratic,
    damping: Damping,
    /// Accepted steps in a row with a negligible decrease.
    idle: usize,
    /// Decrease of the cost by the last step; zero if it was not as predicted.
    fallen: f64,
    evaluations: usize,
    evaluate: E,
    cost_only: C,
    options: &'a MinimiseOptions,
}

impl<E, C> DampedSearch for Descent<'_, E, C>
where
    E: FnMut(&DVector<f64>) -> Option<Quadratic>,
    C: FnMut(&DVector<f64>) -> Option<f64>,
{
    /// Where the step leads, if the damped curvature is positive.
    type Step = Option<DVector<f64>>;

    fn propose(&mut self, accepted: usize, _: usize) -> Proposal<Self::Step> {
        let (x, here, options) = (&self.x, &self.here, self.options);
        let model = QuadraticModel::at(x, here, options);
        let tolerance = options.tolerance(here);
        let promise = model.promise();
        let settled =
            promise <= tolerance || options.last_step && self.leaves(promise) <= tolerance;
        if settled || self.idle >= IDLE {
            if let Some(step) = model.step(RIDGE).filter(|_| options.last_step && self.idle == 0) {
                self.x = project(&(x + step), options);
            }
            return Proposal::End(MinimumStatus::Converged);
        }
        if accepted == options.max_iterations {
            return Proposal::End(MinimumStatus::MaxIterations);
        }
        if self.damping.value > MAX_DAMPING {
            return Proposal::End(MinimumStatus::Stalled);
        }
        let trial = model.step(self.damping.value).map(|d| project(&(x + d), options));
        let promise = trial.as_ref().map(|trial| expected_decrease(here, &(trial - x)));
        let promises = promise.is_none_or(|promise| !(promise <= tolerance));
        if accepted > 0 && !self.damping.follows_success() && !promises {
            // longer steps failed, and this one is negligible
            let idle = self.idle > 0;
            let end = if idle { MinimumStatus::Converged } else { MinimumStatus::Stalled };
            return Proposal::End(end);
        }
        Proposal::Step(trial)
    }

    fn attempt(&mut self, trial: Self::Step) -> Attempt {
        let (size, here) = (self.x.len(), self.here.cost);
        let accepted = trial.filter(|trial| *trial != self.x).and_then(|trial| {
            // after an accepted step the next one is seldom rejected, so derivatives are computed at once
            let hopeful = self.damping.follows_success();
            self.evaluations += 1;
            if !hopeful {
                (self.cost_only)(&trial).filter(|cost| *cost < here)?;
                self.evaluations += 1;
            }
            let there = (self.evaluate)(&trial).filter(|q| is_usable(q, size) && q.cost < here)?;
            let gain = (here - there.cost) / expected_decrease(&self.here, &(&trial - &self.x));
            Some((trial, there, gain))
        });
        let Some((trial, there, gain)) = accepted else {
            self.damping.reject();
            return Attempt::Rejected;
        };
        self.fallen = if gain > AS_PREDICTED { here - there.cost } else { 0.0 };
        let negligible = here - there.cost <= self.options.tolerance(&self.here);
        self.idle = if negligible { self.idle + 1 } else { 0 };
        (self.x, self.here) = (trial, there);
        self.damping.accept(gain);
        Attempt::Accepted
    }
}

impl<E, C> Descent<'_, E, C> {
    /// Decrease of the cost that is left after a step that promises one, if decreases shrink further by the same ratio;
    /// infinite if they do not shrink fast.
    fn leaves(&self, promise: f64) -> f64 {
        if promise <= FAST * self.fallen { promise * promise / self.fallen } else { f64::INFINITY }
    }
}

fn expected_decrease(q: &Quadratic, step: &DVector<f64>) -> f64 {
    -(q.gradient.dot(step) + 0.5 * step.dot(&(&q.hessian * step)))
}

fn is_usable(q: &Quadratic, n: usize) -> bool {
    q.gradient.len() == n && q.hessian.shape() == (n, n) && q.is_finite()
}

fn project(x: &DVector<f64>, options: &MinimiseOptions) -> DVector<f64> {
    let mut inside = x.clone();
    for i in 0..x.len() {
        if let Some(lower) = &options.lower {
            inside[i] = inside[i].max(lower[i]);
        }
        if let Some(upper) = &options.upper {
            inside[i] = inside[i].min(upper[i]);
        }
    }
    inside
}

fn no_start(x: &DVector<f64>, evaluations: usize) -> Minimum {
    let n = x.len();
    Minimum {
        x: x.clone(),
        cost: f64::INFINITY,
        gradient: DVector::zeros(n),
        hessian: DMatrix::zeros(n, n),
        iterations: 0,
        evaluations,
        status: MinimumStatus::NoStart,
    }
}

#[cfg(test)]
#[path = "descent_tests.rs"]
mod tests;
