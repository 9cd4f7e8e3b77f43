//! Tests against numpy and statsmodels on noisy data.

use super::*;

/// Uniform numbers in [-0.5, 0.5) of a linear congruential generator, easily repeated in Python.
pub(crate) fn lcg(count: usize, seed: u32) -> Vec<f64> {
    let mut x = seed;
    let next = || {
        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(x) / 4_294_967_296.0 - 0.5
    };
    std::iter::repeat_with(next).take(count).collect()
}

#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

/// 40 rows of y = 2 - 0.3 x1 + 4e-4 x2 + uniform noise, x1 ~ 5, x2 ~ 5000.
pub(crate) fn noisy_line() -> (DMatrix<f64>, DVector<f64>) {
    let n = 40;
    let u = lcg(4 * n, 7);
    let x = DMatrix::from_fn(n, 3, |i, j| [1.0, 10.0 * u[i], 1e4 * u[n + i]][j]);
    let noise = DVector::from_column_slice(&u[3 * n..]);
    let y = &x * DVector::from_row_slice(&[2.0, -0.3, 4e-4]) + noise;
    (x, y)
}

fn weights() -> DVector<f64> {
    DVector::from_fn(40, |i, _| 1.0 + (i % 4) as f64)
}

#[test]
fn a_noisy_weighted_fit_equals_statsmodels_wls() {
    let (x, y) = noisy_line();
    let fit = fit(&x, &y, Some(&weights())).unwrap();
    // statsmodels 0.14 WLS; the scaled condition is 1.4, so rounding stays near 1e-15
    let b = [2.013835637815404, -0.2911700968816938, 0.00040324550354965737];
    let covariance: [[f64; 3]; 3] = [
        [0.002841020937913545, -0.00013341706259537304, -1.2748351871723817e-07],
        [-0.00013341706259537304, 0.0003108311775865935, 6.6974839545392e-08],
        [-1.2748351871723817e-07, 6.6974839545392e-08, 4.014635410420255e-10],
    ];
    for i in 0..3 {
        assert_close(fit.coefficients[i], b[i], 1e-12);
        assert_close(fit.std_errors[i], covariance[i][i].sqrt(), 1e-12);
        for j in 0..3 {
            assert_close(fit.covariance[(i, j)], covariance[i][j], 1e-11);
        }
    }
    assert_close(fit.residual_variance, 0.275856612055222, 1e-12);
    assert_eq!((fit.rank, fit.degrees_of_freedom), (3, 37));
}

#[test]
fn a_dependent_column_affects_its_partners_and_no_others() {
    let (x, y) = noisy_line();
    let mut wide = x.clone().insert_column(3, 0.0);
    for i in 0..40 {
        wide[(i, 3)] = 2e-6 * x[(i, 2)] - 3.0 * x[(i, 1)];
    }
    let deficient = fit(&wide, &y, None).unwrap();
    let full = fit(&x, &y, None).unwrap();
    assert_eq!((deficient.rank, deficient.degrees_of_freedom), (3, 37));
    assert_eq!(deficient.unidentifiable, [1, 3]);
    assert!(deficient.std_errors[1].is_infinite() && deficient.std_errors[3].is_infinite());
    // x2 takes part with 2e-6 * 3e3 / 3 / 3: below PARTICIPATION, so its error stays finite
    assert!(deficient.std_errors[2].is_finite());
    assert_close(deficient.std_errors[0], full.std_errors[0], 1e-10);
    assert_close(deficient.residual_variance, full.residual_variance, 1e-10);
}

#[test]
fn a_zero_weight_removes_its_row() {
    let (x, mut y) = noisy_line();
    let mut w = weights();
    w[39] = 0.0;
    let without = fit(
        &x.rows(0, 39).into_owned(),
        &y.rows(0, 39).into_owned(),
        Some(&w.rows(0, 39).into_owned()),
    )
    .unwrap();
    y[39] = 1e3;
    let with = fit(&x, &y, Some(&w)).unwrap();
    assert_eq!(with.degrees_of_freedom, without.degrees_of_freedom);
    assert_close(with.std_errors[2], without.std_errors[2], 1e-11);
}

#[test]
fn bad_input_is_refused_with_the_row() {
    let (x, mut y) = noisy_line();
    y[5] = f64::NAN;
    let quantity = "the right-hand side";
    assert_eq!(fit(&x, &y, None).unwrap_err(), MathError::NotFinite { quantity, row: 5 });
    let short = DVector::zeros(3);
    let error = fit(&x, &short, None).unwrap_err();
    assert_eq!(error, MathError::LengthMismatch { quantity, found: 3, expected: 40 });
    let three = x.rows(0, 3).into_owned();
    assert!(matches!(fit(&three, &short, None), Err(MathError::TooFewSamples { .. })));
}
