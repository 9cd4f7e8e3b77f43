//! Fitting a model by the simulation error over short windows.

use nalgebra::{DMatrix, DVector};

use super::input_timing::{INTERPOLATION, SYMBOL};
use super::windows::{Sums, Windows, bounds, quadratic_of};
use crate::effects::Scale;
use crate::identify::among_all;
use crate::math::{Information, MinimiseOptions, minimise, raise_errors};
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

    /// Number of the effect `id` in its model.
    pub(super) fn place_of(&self, id: &str) -> Option<usize> {
        self.model.effects().iter().position(|effect| effect.id() == id)
    }

    /// Its model and parameters without effect number `e`, the others unchanged.
    pub(super) fn without(&self, e: usize) -> (Model, Vec<f64>) {
        let mut p = self.p.clone();
        p.drain(self.model.slots(e));
        (self.model.without(e), p)
    }

    /// Degrees of freedom of the standard errors: windows less free parameters, at least one.
    #[must_use]
    pub fn degrees(&self) -> f64 {
        (self.windows as f64 - self.model.free().len() as f64).max(1.0)
    }
}

/// Fits the free parameters of `model` from `start` by Levenberg and Marquardt's method. `None` where the
/// start cannot be simulated, and without windows.
///
/// ```text
/// minimise ½ Σ_windows Σ_k (w(k) - ŵ(k; θ))²/s²
/// covariance (m - 1)/m Σ_b δ_b δ_b',   δ_b = (H - H_b)⁻¹ g_b: change of the fit without window b of m, by one step
/// ```
/// A few windows, those with a stop or a reversal, determine the friction: the sandwich of the scores, which are
/// smaller in the windows that decide, is too small. A shift of the input is known to lie within its limits, with the
/// variance of an even distribution: recordings that hardly show it would otherwise leave every parameter unknown.
///
/// Source of the covariance: Bell and McCaffrey, Survey Methodology 28 (2002), the jackknife by clusters.
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
    let mut covariance = covariance(&sums);
    for (n, &j) in free.iter().enumerate() {
        if model.parameters()[j].spec.symbol == SYMBOL {
            know(&mut covariance, n, (upper[n] - lower[n]).powi(2) / 12.0);
        }
    }
    let covariance = among_all(model, &covariance);
    let edge = |n: usize| minimum.x[n] <= lower[n] || minimum.x[n] >= upper[n];
    let mut at_bound = vec![false; p.len()];
    free.iter().enumerate().for_each(|(n, &j)| at_bound[j] = edge(n));
    let (model, windows) = (model.clone(), sums.len());
    cost.is_finite().then_some(WindowFit { model, p, cost, covariance, at_bound, windows })
}

/// A model with the parameters `p` of another method as a fit. Its scores do not vanish together; the covariance is
/// that of their deviations from the mean. `None` where it cannot be simulated, and without windows.
#[must_use]
pub(super) fn fit_at(windows: &Windows, model: &Model, p: &[f64]) -> Option<WindowFit> {
    let free = model.free();
    let mut sums = windows.sums(model, p, &free)?;
    let count = sums.len() as f64;
    let total: DVector<f64> = sums.iter().map(|s| &s.score).sum();
    sums.iter_mut().for_each(|s| s.score -= &total / count);
    let cost = quadratic_of(&sums, free.len())?.cost;
    let covariance = among_all(model, &covariance(&sums));
    let (model, p, at_bound, windows) =
        (model.clone(), p.to_vec(), vec![false; p.len()], sums.len());
    cost.is_finite().then_some(WindowFit { model, p, cost, covariance, at_bound, windows })
}

/// A fit to `windows` with standard errors that include the unknown input between its rows: the change of its parameter
/// by omitting every other row of the input, the mean of both ways, by one step. That error does not appear in the
/// residuals, since the parameters absorb it, and is independent of theirs. A held input is known between its rows;
/// there the time of the input is wrong by the error of its interpolation.
///
/// ```text
/// se² + q δθ²,   δθ = H⁻¹ (mean of the scores at half the rate - score),   q: [`Windows::allowed_sampling`]
/// ```
pub(super) fn with_sampling(mut fit: WindowFit, windows: &Windows) -> WindowFit {
    let free = fit.model.free();
    let sums = |windows: &Windows| -> Option<(DVector<f64>, DMatrix<f64>)> {
        let sums = windows.sums(&fit.model, &fit.p, &free)?;
        Some((sums.iter().map(|s| &s.score).sum(), sums.iter().map(|s| &s.information).sum()))
    };
    if windows.hold == Hold::Constant {
        let time = fit.model.index_of(SYMBOL).ok();
        let place = time.and_then(|j| free.iter().position(|&k| k == j));
        if let (Some(n), Some((_, information))) = (place, sums(windows)) {
            let rows = windows.recordings.iter().map(|r| r.step());
            let late = INTERPOLATION * rows.fold(0.0, f64::max);
            add_errors(&mut fit, &free, &by_time(&information, n, late));
        }
        return fit;
    }
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
    let allowed = windows.allowed_sampling(&fit.model, &fit.p).unwrap_or(1.0);
    add_errors(&mut fit, &free, &(allowed.sqrt() * moved));
    fit
}

/// Adds independent errors of the `free` parameters to their standard errors.
fn add_errors(fit: &mut WindowFit, free: &[usize], errors: &DVector<f64>) {
    let mut all = DVector::zeros(fit.p.len());
    let both = |j: usize, by: f64| fit.covariance[(j, j)].sqrt().hypot(by);
    free.iter().zip(errors.iter()).for_each(|(&j, by)| all[j] = both(j, *by));
    raise_errors(&mut fit.covariance, &all);
}

/// Change of a fit, with its information over the free parameters, if the time at place `n` among them is wrong by
/// `late`.
///
/// ```text
/// δ_others = -H⁻¹ h late,   H: information of the others, h: their column of the time
/// ```
fn by_time(information: &DMatrix<f64>, n: usize, late: f64) -> DVector<f64> {
    let others = information.clone().remove_row(n).remove_column(n);
    let column = information.column(n).into_owned().remove_row(n);
    let moved = Information::new(&others).solve(&(column * -late));
    moved.insert_row(n, late)
}

/// Covariance with what is known of parameter `n` beforehand, of variance `known`, as of another measurement of it.
///
/// ```text
/// C - c c'/(C_nn + known),   c: column n of C
/// ```
fn know(covariance: &mut DMatrix<f64>, n: usize, known: f64) {
    let column = covariance.column(n).into_owned();
    if column.iter().all(|v| v.is_finite()) {
        *covariance -= &column * column.transpose() / (column[n] + known);
    } else {
        covariance[(n, n)] = covariance[(n, n)].min(known);
    }
}

/// Covariance of the free parameters from the sums of the windows over them; infinite where fewer windows than
/// parameters, or a single window, determine a parameter.
fn covariance(sums: &[Sums]) -> DMatrix<f64> {
    let total: DMatrix<f64> = sums.iter().map(|s| &s.information).sum();
    let known = Information::new(&total);
    let (m, columns) = (sums.len(), known.scale().len());
    let mut unknown = known.unidentifiable();
    let mut out = DMatrix::zeros(columns, columns);
    for window in sums {
        let without = Information::new(&(&total - &window.information));
        let change = without.solve(&window.score);
        out += &change * change.transpose();
        unknown.extend(without.unidentifiable());
    }
    out *= (m as f64 - 1.0) / m as f64;
    if m <= columns {
        unknown = (0..columns).collect();
    }
    unknown.into_iter().for_each(|j| out[(j, j)] = f64::INFINITY);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_covariance_is_that_of_the_jackknife() {
        // y = c x by least squares, one row a window, is linear: one step is the fit without that window
        let rows = [(1.0, 1.0), (1.0, 3.0), (2.0, 4.0), (3.0, 5.0)];
        let all = rows.iter().map(|(x, y)| x * y).sum::<f64>() / 15.0;
        let sums: Vec<Sums> = rows
            .iter()
            .map(|(x, y)| Sums {
                square: 0.0,
                score: DVector::from_element(1, x * (y - all * x)),
                information: DMatrix::from_element(1, 1, x * x),
            })
            .collect();
        let without = |n: usize| {
            let others = || rows.iter().enumerate().filter(move |(k, _)| *k != n).map(|(_, r)| r);
            let square: f64 = others().map(|(x, _)| x * x).sum();
            others().map(|(x, y)| x * y).sum::<f64>() / square
        };
        let expected = 0.75 * (0..4).map(|n| (without(n) - all).powi(2)).sum::<f64>();
        assert!((covariance(&sums)[(0, 0)] - expected).abs() < 1e-14);
    }

    #[test]
    fn a_parameter_that_one_window_determines_has_no_error() {
        let window = |a: f64, b: f64| Sums {
            square: 0.0,
            score: DVector::from_vec(vec![0.1 * a, 0.1 * b]),
            information: DMatrix::from_diagonal(&DVector::from_vec(vec![a, b])),
        };
        let windows = [window(1.0, 0.0), window(1.0, 0.0), window(1.0, 1.0)];
        let covariance = covariance(&windows);
        assert!(covariance[(0, 0)].is_finite() && covariance[(1, 1)].is_infinite());
    }
    #[test]
    fn what_is_known_of_a_parameter_bounds_those_that_correlate_with_it() {
        // the inverse of C⁻¹ + diag(0, 1/0.09)
        let covariance = DMatrix::from_row_slice(2, 2, &[2.0, 1.5, 1.5, 1.8]);
        let mut found = covariance.clone();
        know(&mut found, 1, 0.09);
        let mut inverse = covariance.try_inverse().unwrap();
        inverse[(1, 1)] += 1.0 / 0.09;
        let expected = inverse.try_inverse().unwrap();
        assert!((&found - &expected).norm() < 1e-12, "{found} {expected}");
        assert!(found[(1, 1)] < 0.09 && found[(0, 0)] < 1.0);
    }
}
