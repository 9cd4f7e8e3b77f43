//! Fitting a model by the simulation error over short windows.

use nalgebra::{DMatrix, DVector};

use super::windows::{Sums, Windows, bounds, quadratic_of};
use crate::effects::Scale;
use crate::identify::among_all;
use crate::math::{Information, MinimiseOptions, minimise, raise_errors, sandwich};
use crate::model::Model;
use crate::simulate::Hold;

/// Maximum number of Levenberg-Marquardt steps; more are needed only along a flat ridge of the cost.
const STEPS: usize = 20;
/// Negligible relative decrease of the cost: with a thousand independent values it changes the criterion by
/// 0.1.
const TOLERANCE: f64 = 1e-4;

/// A model fitted by the error of its windows.
#[derive(Clone)]
pub struct WindowFit {
    /// The fitted model, including fixed parameters.
    pub model: Model,
    /// One value per parameter.
    pub p: Vec<f64>,
    /// Half of `Σ e²/s²` over the training windows.
    pub cost: f64,
    /// Covariance of all parameters, from the scores of the windows; zero for those that are held,
    /// infinite for those that the data do not identify.
    pub covariance: DMatrix<f64>,
    /// For each parameter, whether it is free and at a bound.
    pub at_bound: Vec<bool>,
    /// Windows that it was fitted to.
    pub windows: usize,
}

impl WindowFit {
    /// Whether there are no more windows than free parameters, so that no covariance can be computed.
    #[must_use]
    pub fn is_short(&self) -> bool {
        self.windows <= self.model.free().len()
    }
}

/// Fits the free parameters of `model` from `start` by Levenberg and Marquardt's method. `None` where the
/// start cannot be simulated, and without windows.
///
/// ```text
/// minimise ½ Σ_windows Σ_k (w(k) - ŵ(k; θ))²/s²
/// covariance H⁻¹ (Σ g_b g_b') H⁻¹ m/(m - p),   g_b: gradient of window b of m, p parameters
/// ```
/// Source of the covariance: sandwich of White, Econometrica 50 (1982), clustered by windows.
#[must_use]
pub fn fit(windows: &Windows, model: &Model, start: &[f64], scale: &Scale) -> Option<WindowFit> {
    fit_within(windows, model, start, scale, 0.0)
}

/// [`fit`] that ends when the cost decreases by less than `negligible`.
#[must_use]
pub(super) fn fit_within(
    windows: &Windows,
    model: &Model,
    start: &[f64],
    scale: &Scale,
    negligible: f64,
) -> Option<WindowFit> {
    if windows.windows.is_empty() {
        return None;
    }
    let free = model.free();
    let [lower, upper] = bounds(model, scale, &free);
    let place = |x: &DVector<f64>| {
        let mut p = start.to_vec();
        free.iter().zip(x.iter()).for_each(|(&j, v)| p[j] = *v);
        p
    };
    let first = DVector::from_iterator(free.len(), free.iter().map(|&j| start[j]));
    let first = first.zip_zip_map(&lower, &upper, |v, low, high| v.clamp(low, high));
    let options = MinimiseOptions {
        max_iterations: STEPS,
        relative_tolerance: TOLERANCE,
        absolute_tolerance: negligible,
        lower: Some(lower.clone()),
        upper: Some(upper.clone()),
        ..MinimiseOptions::default()
    };
    // the sums at the lowest cost so far, for the covariance
    let mut lowest: (f64, Vec<Sums>) = (f64::INFINITY, vec![]);
    let evaluate = |x: &DVector<f64>| {
        let sums = windows.sums(model, &place(x), &free)?;
        let quadratic = quadratic_of(&sums, free.len())?;
        if quadratic.cost < lowest.0 {
            lowest = (quadratic.cost, sums);
        }
        Some(quadratic)
    };
    let minimum = minimise(&first, evaluate, |x| windows.cost(model, &place(x)), &options);
    minimum.cost.is_finite().then_some(())?;
    let p = place(&minimum.x);
    let (cost, sums) = lowest;
    let covariance = among_all(model, &covariance(&sums));
    let edge = |n: usize| minimum.x[n] <= lower[n] || minimum.x[n] >= upper[n];
    let mut at_bound = vec![false; p.len()];
    free.iter().enumerate().for_each(|(n, &j)| at_bound[j] = edge(n));
    let (model, windows) = (model.clone(), sums.len());
    cost.is_finite().then_some(WindowFit { model, p, cost, covariance, at_bound, windows })
}

/// A fit to `windows` with standard errors that include the unknown input between its rows: none is smaller than the change
/// of its parameter by omitting every other row of the input, the mean of both ways, by one step. That error does not
/// appear in the residuals, since the parameters absorb it. A held input is known between its rows.
///
/// ```text
/// δθ = H⁻¹ (mean of the scores at half the rate - score)
/// ```
pub(super) fn with_sampling(mut fit: WindowFit, windows: &Windows) -> WindowFit {
    if windows.hold == Hold::Constant {
        return fit;
    }
    let free = fit.model.free();
    let sums = |windows: &Windows| -> Option<(DVector<f64>, DMatrix<f64>)> {
        let sums = windows.sums(&fit.model, &fit.p, &free)?;
        Some((sums.iter().map(|s| &s.score).sum(), sums.iter().map(|s| &s.information).sum()))
    };
    let halved = |phase: usize| {
        let recordings = windows.halved(phase);
        sums(&windows.with_recordings(recordings.iter().collect()))
    };
    let (Some((score, information)), Some((even, _)), Some((odd, _))) =
        (sums(windows), halved(0), halved(1))
    else {
        return fit;
    };
    let moved = Information::new(&information).solve(&(0.5 * (even + odd) - score));
    let mut all = DVector::zeros(fit.p.len());
    free.iter().zip(moved.iter()).for_each(|(&j, by)| all[j] = *by);
    raise_errors(&mut fit.covariance, &all);
    fit
}

/// Covariance of the free parameters from the sums of the windows over them.
fn covariance(sums: &[Sums]) -> DMatrix<f64> {
    let known = Information::new(&sums.iter().map(|s| &s.information).sum());
    let (m, p) = (sums.len() as f64, known.scale().len() as f64);
    let inflation = if m > p { m / (m - p) } else { f64::INFINITY };
    let mut out = sandwich(&known.inverse(), sums.iter().map(|s| &s.score)) * inflation;
    known.unidentifiable().into_iter().for_each(|j| out[(j, j)] = f64::INFINITY);
    out
}
