//! The descent against SciPy, and its status codes.

use super::*;
use crate::math::Information;
use crate::math::least_squares::tests::{assert_close, lcg};

/// Half the sum of squares of residuals with their Jacobian, as normal equations.
fn normal(r: &DVector<f64>, j: &DMatrix<f64>) -> Quadratic {
    let (gradient, hessian) = (j.transpose() * r, j.transpose() * j);
    Quadratic { cost: 0.5 * r.norm_squared(), gradient, hessian, scatter: 0.0 }
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
    let covariance = Information::new(&found.hessian).covariance();
    let sigma = (2.0 * found.cost / 27.0).sqrt();
    for i in 0..3 {
        // an expected decrease of 1e-12 of the cost is 5e-6 of a standard error
        assert_close(found.x[i], expected[i], 1e-6);
        assert_close(sigma * covariance[(i, i)].sqrt(), errors[i], 1e-5);
    }
    assert_close(2.0 * found.cost, 0.017464749800076815, 1e-10);
    assert!(found.iterations <= 8, "{} iterations", found.iterations);
}

#[test]
fn the_last_step_spares_an_evaluation_where_decreases_shrink_fast() {
    let options =
        |last_step| MinimiseOptions { last_step, relative_tolerance: 1e-6, ..Default::default() };
    let [plain, last] = [false, true].map(|way| run(decay, &[1.0, 1.0, 0.0], &options(way)));
    assert!(last.evaluations < plain.evaluations, "{} {}", last.evaluations, plain.evaluations);
    let best = run(decay, &[1.0, 1.0, 0.0], &MinimiseOptions::default());
    let covariance = Information::new(&best.hessian).covariance();
    for i in 0..3 {
        // a decrease of 1e-6 of the cost, 27/2 sigma², is (2 · 13.5e-6)^(1/2) = 5e-3 standard errors
        let error = (2.0 * best.cost / 27.0 * covariance[(i, i)]).sqrt();
        assert!((last.x[i] - best.x[i]).abs() < 5e-3 * error, "{i}: {}", last.x[i] - best.x[i]);
    }
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
fn a_parameter_that_a_step_would_move_beyond_its_bound_does_not_move_the_others() {
    // ½ (x - c)' H (x - c) with c = (-1, 3), x1 not negative: minimum at (0, 2.1). The gradient at (0, 0) points
    // inwards
    let hessian = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]);
    let quadratic = |x: &DVector<f64>| {
        let from = x - DVector::from_row_slice(&[-1.0, 3.0]);
        let gradient = &hessian * &from;
        Quadratic {
            cost: 0.5 * from.dot(&gradient),
            gradient,
            hessian: hessian.clone(),
            scatter: 0.0,
        }
    };
    let lower = Some(DVector::from_row_slice(&[0.0, -9.0]));
    let options = MinimiseOptions { lower, initial_damping: 1e-12, ..MinimiseOptions::default() };
    let found = run(quadratic, &[0.0, 0.0], &options);
    assert_eq!((found.status, found.iterations), (MinimumStatus::Converged, 1));
    assert!((found.x - DVector::from_row_slice(&[0.0, 2.1])).amax() < 1e-9);
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
        Some(Quadratic { cost: cost(x), gradient, hessian, scatter: 0.0 })
    };
    let start = DVector::from_element(1, 5.0);
    let found = minimise(&start, quadratic, |x| Some(cost(x)), &MinimiseOptions::default());
    assert_eq!(found.status, MinimumStatus::Converged);
    assert!((found.x[0] - 1.0).abs() < 1e-6);
    assert!(found.evaluations > found.iterations + 1);
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

#[test]
fn a_decrease_within_the_scatter_of_sampling_is_negligible() {
    // half x² has the decrease 0.02 ahead of x = 0.2, and sampling places x by a scatter of 9, three units: 0.0022 of
    // it
    let cost = |x: &DVector<f64>| Quadratic { scatter: 9.0, ..normal(x, &DMatrix::identity(1, 1)) };
    let options = |scatter_tolerance| MinimiseOptions { scatter_tolerance, ..Default::default() };
    let from = |share| {
        let start = DVector::from_element(1, 0.2);
        minimise(&start, |x| Some(cost(x)), |x| Some(cost(x).cost), &options(share))
    };
    let [coarse, fine] = [0.0023, 0.0021].map(from);
    assert_eq!((coarse.status, coarse.iterations), (MinimumStatus::Converged, 0));
    assert!(fine.iterations > 0 && fine.x[0].abs() < 0.01, "{fine:?}");
}
