//! Damped Gauss-Newton for costs that come as value, gradient and curvature.

use nalgebra::{Cholesky, DMatrix, DVector};

/// A cost with its gradient and a positive semidefinite stand-in for its Hessian (`J'J` of a
/// least-squares problem, the information matrix of a likelihood).
#[derive(Debug, Clone, PartialEq)]
pub struct Quadratic {
    /// The cost.
    pub cost: f64,
    /// First derivatives of the cost.
    pub gradient: DVector<f64>,
    /// Approximate second derivatives of the cost.
    pub hessian: DMatrix<f64>,
}

/// Settings of [`minimise`].
#[derive(Debug, Clone, PartialEq)]
pub struct MinimiseOptions {
    /// Most accepted steps.
    pub max_iterations: usize,
    /// Converged when the expected decrease falls below this share of the cost.
    pub relative_tolerance: f64,
    /// Converged when the expected decrease falls below this, in the unit of the cost (1e-6 is
    /// a thousandth of a standard error for a negative log-likelihood).
    pub absolute_tolerance: f64,
    /// Smallest value of each parameter, if bounded.
    pub lower: Option<DVector<f64>>,
    /// Largest value of each parameter, if bounded.
    pub upper: Option<DVector<f64>>,
    /// Damping of the first step, relative to the curvature.
    pub initial_damping: f64,
}

impl Default for MinimiseOptions {
    fn default() -> Self {
        Self {
            max_iterations: 100,
            relative_tolerance: 1e-12,
            absolute_tolerance: 1e-14,
            lower: None,
            upper: None,
            initial_damping: 1e-3,
        }
    }
}

/// How a minimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MinimumStatus {
    /// The expected decrease fell below the tolerance.
    Converged,
    /// The allowed number of steps was taken.
    MaxIterations,
    /// No step, however short, lowered the cost: rounding, or gradient and cost disagree.
    Stalled,
    /// The cost could not be computed at the start, or start, bounds and gradient differ in
    /// length; nothing was done.
    NoStart,
}

/// Where a minimisation ended, with the curvature there.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The parameters.
    pub x: DVector<f64>,
    /// The cost at `x`.
    pub cost: f64,
    /// The gradient at `x`.
    pub gradient: DVector<f64>,
    /// The curvature at `x`.
    pub hessian: DMatrix<f64>,
    /// Accepted steps.
    pub iterations: usize,
    /// Computations of the cost, with derivatives or without.
    pub evaluations: usize,
    /// How it ended.
    pub status: MinimumStatus,
}

/// Relative damping above which no step can lower the cost.
const MAX_DAMPING: f64 = 1e12;
/// Keeps the factorisation going along directions without curvature.
const RIDGE: f64 = 1e-12;

/// Minimises a cost by Levenberg and Marquardt's method within simple bounds.
///
/// ```text
/// (S + lambda I) D d = -D^-1 g,   S = D^-1 H D^-1,   D = diag(sqrt h_ii)
/// ```
///
/// `evaluate` gives cost, gradient and curvature, `cost_only` the cost of a trial; both return
/// `None` where the cost does not exist, and such a trial, like one that is not finite, is a
/// rejected step. Parameters at a bound that the gradient pushes against are held; steps are cut
/// at the bounds. Scaling makes the result independent of units.
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
    mut cost_only: impl FnMut(&DVector<f64>) -> Option<f64>,
    options: &MinimiseOptions,
) -> Minimum {
    let usable = |q: &Quadratic| is_usable(q, start.len());
    let bounds_fit = [&options.lower, &options.upper]
        .into_iter()
        .all(|b| b.as_ref().is_none_or(|b| b.len() == start.len()));
    if !bounds_fit {
        return no_start(start, 0);
    }
    let mut x = project(start, options);
    let Some(mut here) = evaluate(&x).filter(usable) else { return no_start(&x, 1) };
    let (mut iterations, mut evaluations) = (0, 1);
    let (mut damping, mut factor) = (options.initial_damping, 2.0);
    let status = loop {
        let model = Model::at(&x, &here, options);
        if model.is_settled(&here, options) {
            break MinimumStatus::Converged;
        }
        if iterations == options.max_iterations {
            break MinimumStatus::MaxIterations;
        }
        if damping > MAX_DAMPING {
            break MinimumStatus::Stalled;
        }
        let trial = model.step(damping).map(|d| project(&(&x + d), options));
        let mut accepted = None;
        if let Some(trial) = trial.filter(|trial| *trial != x) {
            evaluations += 1;
            if let Some(cost) = cost_only(&trial).filter(|&c| c < here.cost) {
                let gain = (here.cost - cost) / expected_decrease(&here, &(&trial - &x));
                evaluations += 1;
                accepted = evaluate(&trial).filter(usable).map(|there| (trial, there, gain));
            }
        }
        if let Some((trial, there, gain)) = accepted {
            (x, here) = (trial, there);
            iterations += 1;
            let shrink = 1.0 - (2.0 * gain - 1.0).powi(3);
            // a gain that is not a number comes from a step cut at a bound
            damping *= if shrink.is_nan() { 1.0 } else { shrink.clamp(1.0 / 3.0, 2.0) };
            damping = damping.max(1e-15);
            factor = 2.0;
        } else {
            damping *= factor;
            factor *= 2.0;
        }
    };
    let Quadratic { cost, gradient, hessian } = here;
    Minimum { x, cost, gradient, hessian, iterations, evaluations, status }
}

/// The quadratic model over the parameters that are free to move, in scaled units.
struct Model {
    free: Vec<usize>,
    root: DVector<f64>,
    gradient: DVector<f64>,
    curvature: DMatrix<f64>,
    size: usize,
}

impl Model {
    fn at(x: &DVector<f64>, q: &Quadratic, options: &MinimiseOptions) -> Self {
        let held = |i: usize| {
            let low = options.lower.as_ref().is_some_and(|b| x[i] <= b[i]) && q.gradient[i] > 0.0;
            let high = options.upper.as_ref().is_some_and(|b| x[i] >= b[i]) && q.gradient[i] < 0.0;
            low || high
        };
        let free: Vec<usize> = (0..x.len()).filter(|&i| !held(i)).collect();
        let n = free.len();
        let root = DVector::from_fn(n, |k, _| {
            let h = q.hessian[(free[k], free[k])];
            if h > 0.0 { h.sqrt() } else { 1.0 }
        });
        let gradient = DVector::from_fn(n, |k, _| q.gradient[free[k]] / root[k]);
        let curvature =
            DMatrix::from_fn(n, n, |k, l| q.hessian[(free[k], free[l])] / root[k] / root[l]);
        Self { free, root, gradient, curvature, size: x.len() }
    }

    /// The damped step, zero for held parameters; none if the damped curvature is not positive.
    fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let scaled = self.solve(damping)?;
        let mut step = DVector::zeros(self.size);
        for (k, &i) in self.free.iter().enumerate() {
            step[i] = scaled[k] / self.root[k];
        }
        Some(step)
    }

    fn solve(&self, damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.curvature.clone();
        for k in 0..self.free.len() {
            damped[(k, k)] += damping.max(RIDGE);
        }
        Cholesky::new(damped).map(|c| -c.solve(&self.gradient))
    }

    /// Whether even the undamped step promises next to nothing.
    fn is_settled(&self, q: &Quadratic, options: &MinimiseOptions) -> bool {
        if self.free.is_empty() {
            return true;
        }
        let tolerance = options.absolute_tolerance.max(options.relative_tolerance * q.cost.abs());
        self.solve(RIDGE).is_some_and(|step| -0.5 * self.gradient.dot(&step) <= tolerance)
    }
}

fn expected_decrease(q: &Quadratic, step: &DVector<f64>) -> f64 {
    -(q.gradient.dot(step) + 0.5 * step.dot(&(&q.hessian * step)))
}

fn is_usable(q: &Quadratic, n: usize) -> bool {
    q.gradient.len() == n
        && q.hessian.shape() == (n, n)
        && q.cost.is_finite()
        && q.gradient.iter().chain(q.hessian.iter()).all(|v| v.is_finite())
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
mod tests {
    use super::super::least_squares::tests::{assert_close, lcg};
    use super::super::symmetric::information_to_covariance;
    use super::*;

    /// Half the sum of squares of residuals with their Jacobian, as normal equations.
    fn normal(r: &DVector<f64>, j: &DMatrix<f64>) -> Quadratic {
        let (gradient, hessian) = (j.transpose() * r, j.transpose() * j);
        Quadratic { cost: 0.5 * r.norm_squared(), gradient, hessian }
    }

    /// y = a exp(-b t) + c with uniform noise of 0.1, 30 samples.
    fn decay(q: &DVector<f64>) -> Quadratic {
        let noise = lcg(30, 21);
        let time = |k: usize| 3.0 * k as f64 / 29.0;
        let shape = |k: usize| (-q[1] * time(k)).exp();
        let y = |k: usize| 2.0 * (-1.3 * time(k)).exp() + 0.5 + 0.1 * noise[k];
        let r = DVector::from_fn(30, |k, _| q[0] * shape(k) + q[2] - y(k));
        let j = DMatrix::from_fn(30, 3, |k, i| [shape(k), -q[0] * time(k) * shape(k), 1.0][i]);
        normal(&r, &j)
    }

    fn rosenbrock(x: &DVector<f64>) -> Quadratic {
        let r = DVector::from_row_slice(&[10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        normal(&r, &DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0]))
    }

    fn run(
        f: impl Fn(&DVector<f64>) -> Quadratic,
        start: &[f64],
        options: &MinimiseOptions,
    ) -> Minimum {
        let start = DVector::from_row_slice(start);
        minimise(&start, |x| Some(f(x)), |x| Some(f(x).cost), options)
    }

    #[test]
    fn a_noisy_exponential_and_its_errors_equal_scipy_curve_fit() {
        let found = run(decay, &[1.0, 1.0, 0.0], &MinimiseOptions::default());
        assert_eq!(found.status, MinimumStatus::Converged);
        let expected = [1.9718030519200558, 1.277279094318876, 0.4946616534912675];
        let errors = [0.017177092111114737, 0.029351413936101967, 0.01180357644982392];
        let known = information_to_covariance(&found.hessian);
        let sigma = (2.0 * found.cost / 27.0).sqrt();
        for i in 0..3 {
            // an expected decrease of 1e-12 of the cost is 5e-6 of a standard error
            assert_close(found.x[i], expected[i], 1e-6);
            assert_close(sigma * known.std_errors[i], errors[i], 1e-5);
        }
        assert_close(2.0 * found.cost, 0.017464749800076815, 1e-10);
        assert!(found.iterations <= 8, "{} iterations", found.iterations);
    }

    #[test]
    fn a_bound_is_held_and_the_other_parameters_adapt_as_in_scipy() {
        let upper = Some(DVector::from_row_slice(&[9.0, 1.0, 9.0]));
        let options = MinimiseOptions { upper, ..MinimiseOptions::default() };
        let found = run(decay, &[1.0, 0.5, 0.0], &options);
        assert_eq!((found.status, found.x[1]), (MinimumStatus::Converged, 1.0));
        // curve_fit of a and c with b = 1
        assert_close(found.x[0], 1.9730509979392181, 1e-6);
        assert_close(found.x[2], 0.3764289718003234, 1e-6);
        assert!(found.gradient[1] < 0.0);
    }

    #[test]
    fn the_valley_of_rosenbrock_is_followed_to_its_end_in_any_units() {
        let plain = run(rosenbrock, &[-1.2, 1.0], &MinimiseOptions::default());
        assert_eq!(plain.status, MinimumStatus::Converged);
        assert!((&plain.x - DVector::from_row_slice(&[1.0, 1.0])).amax() < 1e-6);
        assert!(plain.evaluations < 80, "{} evaluations", plain.evaluations);
        let units = DVector::from_row_slice(&[1e-4, 1e5]);
        let stretched = |z: &DVector<f64>| {
            let mut q = rosenbrock(&z.component_mul(&units));
            q.gradient.component_mul_assign(&units);
            q.hessian = DMatrix::from_diagonal(&units) * q.hessian * DMatrix::from_diagonal(&units);
            q
        };
        let other = run(stretched, &[-1.2e4, 1e-5], &MinimiseOptions::default());
        assert_eq!(other.iterations, plain.iterations);
    }

    #[test]
    fn trials_without_a_finite_cost_are_rejected_steps() {
        // ln-barrier: the full step from 5 lands at a negative x
        let cost = |x: &DVector<f64>| x[0] - x[0].ln(); // NaN below zero
        let quadratic = |x: &DVector<f64>| {
            let gradient = DVector::from_element(1, 1.0 - 1.0 / x[0]);
            let hessian = DMatrix::from_element(1, 1, 1.0 / (x[0] * x[0]));
            Some(Quadratic { cost: cost(x), gradient, hessian })
        };
        let start = DVector::from_element(1, 5.0);
        let found = minimise(&start, quadratic, |x| Some(cost(x)), &MinimiseOptions::default());
        assert_eq!(found.status, MinimumStatus::Converged);
        assert!((found.x[0] - 1.0).abs() < 1e-6);
        assert!(found.evaluations > 2 * found.iterations + 1);
    }

    #[test]
    fn a_direction_without_curvature_stays_where_it_is() {
        let flat = |x: &DVector<f64>| {
            let r = DVector::from_element(1, x[0] + x[1] - 3.0);
            normal(&r, &DMatrix::from_row_slice(1, 2, &[1.0, 1.0]))
        };
        let found = run(flat, &[0.0, 1.0], &MinimiseOptions::default());
        assert_eq!(found.status, MinimumStatus::Converged);
        assert!((found.x[0] - 1.0).abs() < 1e-5 && (found.x[1] - 2.0).abs() < 1e-5);
    }

    #[test]
    fn every_way_to_end_has_its_status() {
        let short = MinimiseOptions { max_iterations: 2, ..MinimiseOptions::default() };
        assert_eq!(run(rosenbrock, &[-1.2, 1.0], &short).status, MinimumStatus::MaxIterations);
        let uphill =
            |x: &DVector<f64>| Quadratic { gradient: -rosenbrock(x).gradient, ..rosenbrock(x) };
        let lost = run(uphill, &[-1.2, 1.0], &MinimiseOptions::default());
        assert_eq!(lost.status, MinimumStatus::Stalled);
        let nowhere = minimise(&DVector::zeros(2), |_| None, |_| None, &MinimiseOptions::default());
        assert_eq!(nowhere.status, MinimumStatus::NoStart);
    }
}
