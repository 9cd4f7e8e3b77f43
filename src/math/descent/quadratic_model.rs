//! The quadratic model of a cost, from which a damped step is solved.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::options::MinimiseOptions;
use super::quadratic::Quadratic;

/// Relative ridge that keeps the factorisation positive definite along directions without curvature.
pub(super) const RIDGE: f64 = 1e-12;

/// The quadratic model over the parameters that are free to move, in scaled units.
pub(super) struct QuadraticModel {
    free: Vec<usize>,
    /// Whether a free parameter is at its lower and at its upper bound.
    bound: Vec<[bool; 2]>,
    root: DVector<f64>,
    gradient: DVector<f64>,
    curvature: DMatrix<f64>,
    size: usize,
}

impl QuadraticModel {
    pub(super) fn at(x: &DVector<f64>, q: &Quadratic, options: &MinimiseOptions) -> Self {
        let bound = |i: usize| {
            let low = options.lower.as_ref().is_some_and(|b| x[i] <= b[i]);
            [low, options.upper.as_ref().is_some_and(|b| x[i] >= b[i])]
        };
        let held = |i: usize| goes_beyond(bound(i), -q.gradient[i]);
        let free: Vec<usize> = (0..x.len()).filter(|&i| !held(i)).collect();
        let bound = free.iter().map(|&i| bound(i)).collect();
        let n = free.len();
        let root = DVector::from_fn(n, |k, _| {
            let h = q.hessian[(free[k], free[k])];
            if h > 0.0 { h.sqrt() } else { 1.0 }
        });
        let gradient = DVector::from_fn(n, |k, _| q.gradient[free[k]] / root[k]);
        let curvature =
            DMatrix::from_fn(n, n, |k, l| q.hessian[(free[k], free[l])] / root[k] / root[l]);
        Self { free, bound, root, gradient, curvature, size: x.len() }
    }

    /// The damped step, zero for held parameters; none if the damped curvature is not positive.
    pub(super) fn step(&self, damping: f64) -> Option<DVector<f64>> {
        let scaled = self.scaled_step(damping)?;
        let mut step = DVector::zeros(self.size);
        for (k, &i) in self.free.iter().enumerate() {
            step[i] = scaled[k] / self.root[k];
        }
        Some(step)
    }

    /// The step in scaled units. Truncating it at a bound would leave the others with their answer to a move that is
    /// not made, so parameters at a bound that it would cross stay there.
    fn scaled_step(&self, damping: f64) -> Option<DVector<f64>> {
        let mut moving: Vec<usize> = (0..self.free.len()).collect();
        loop {
            let step = self.solve(&moving, damping)?;
            let steps = moving.iter().zip(step.iter());
            let inside = steps.filter(|(k, d)| !goes_beyond(self.bound[**k], **d));
            let inside: Vec<usize> = inside.map(|(k, _)| *k).collect();
            if inside.len() == moving.len() {
                let mut all = DVector::zeros(self.free.len());
                moving.iter().zip(step.iter()).for_each(|(&k, d)| all[k] = *d);
                return Some(all);
            }
            moving = inside;
        }
    }

    /// By Cholesky: [`crate::math::Information::solve_damped`] leaves out directions without curvature, in which a
    /// bounded descent has to move.
    fn solve(&self, moving: &[usize], damping: f64) -> Option<DVector<f64>> {
        let mut damped = self.curvature.select_rows(moving).select_columns(moving);
        for k in 0..moving.len() {
            damped[(k, k)] += damping.max(RIDGE);
        }
        Cholesky::new(damped).map(|c| -c.solve(&self.gradient.select_rows(moving)))
    }

    /// The decrease of the cost that the undamped step predicts; infinite if the curvature is not positive.
    pub(super) fn promise(&self) -> f64 {
        if self.free.is_empty() {
            return 0.0;
        }
        self.scaled_step(RIDGE).map_or(f64::INFINITY, |step| -0.5 * self.gradient.dot(&step))
    }
}

/// Whether a parameter at its lower or its upper bound would leave it outwards by a step.
fn goes_beyond([low, high]: [bool; 2], step: f64) -> bool {
    (low && step < 0.0) || (high && step > 0.0)
}
