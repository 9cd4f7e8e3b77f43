//! Distributions that convert a statistic into a probability, and corrections for multiple tests.
//!
//! A parameter outside its range gives NaN, as in R.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::{gamma_ur, ln_gamma};

/// The 97.5 % quantile of the standard normal distribution: half the width of a 95 % interval in standard errors.
pub const NORMAL_95: f64 = 1.96;

/// Quantile of the standard normal distribution at probability `p` in (0, 1).
///
/// # Examples
/// ```
/// use amigo_ident::math::distribution::normal_quantile;
/// assert!((normal_quantile(0.975) - 1.959963984540054).abs() < 1e-12);
/// ```
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    quantile(Normal::new(0.0, 1.0).ok(), p)
}

/// Cumulative standard normal distribution.
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * (1.0 + libm::erf(x / std::f64::consts::SQRT_2))
}

/// Quantile of Student's t distribution at probability `p`; `dof` > 0.
///
/// # Examples
/// ```
/// use amigo_ident::math::distribution::t_quantile;
/// assert!((t_quantile(0.975, 4.0) - 2.776445105198).abs() < 1e-9);
/// ```
#[must_use]
pub fn t_quantile(p: f64, dof: f64) -> f64 {
    quantile(StudentsT::new(0.0, 1.0, dof).ok(), p)
}

/// Upper tail probability of Student's t distribution with `dof` degrees of freedom.
#[must_use]
pub fn t_survival(t: f64, dof: f64) -> f64 {
    StudentsT::new(0.0, 1.0, dof).map_or(f64::NAN, |d| d.sf(t))
}

/// Quantile of the chi-squared distribution at probability `p`; `dof` > 0.
#[must_use]
pub fn chi2_quantile(p: f64, dof: f64) -> f64 {
    quantile(ChiSquared::new(dof).ok(), p)
}

/// Natural logarithm of the probability that a chi-squared variable exceeds `t`.
///
/// ```text
/// ln P(chi2_k > t) = ln Gamma(a, x) - ln Gamma(a),   a = k/2, x = t/2
/// ```
///
/// For x > a + 1 by Legendre's continued fraction of Gamma(a, x), whose leading factor is kept as
/// a logarithm: no underflow however large `t` is.
///
/// Source: W. H. Press et al., *Numerical Recipes*, 3rd ed., 6.2 (modified Lentz).
///
/// # Examples
/// ```
/// use amigo_ident::math::distribution::chi2_log_survival;
/// // two degrees of freedom: exactly -t/2
/// assert!((chi2_log_survival(3000.0, 2.0) + 1500.0).abs() < 1e-9);
/// ```
#[must_use]
pub fn chi2_log_survival(t: f64, dof: f64) -> f64 {
    if t.is_nan() || !(dof > 0.0 && dof.is_finite()) {
        return f64::NAN;
    }
    let (a, x) = (0.5 * dof, 0.5 * t);
    if x <= 0.0 {
        0.0
    } else if x == f64::INFINITY {
        f64::NEG_INFINITY
    } else if x < a + 1.0 {
        gamma_ur(a, x).ln()
    } else {
        a * x.ln() - x - ln_gamma(a) + upper_gamma_fraction(a, x).ln()
    }
}

/// The continued fraction `Gamma(a, x) e^x x^-a` for `x > a + 1`.
fn upper_gamma_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    const MAX_TERMS: usize = 10_000;
    let nonzero = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / b;
    let mut value = d;
    for i in 1..=MAX_TERMS {
        let term = -(i as f64) * (i as f64 - a);
        b += 2.0;
        d = 1.0 / nonzero(term * d + b);
        c = nonzero(b + term / c);
        value *= c * d;
        if (c * d - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

/// Holm's adjusted p-values: rejecting those below `q` keeps the chance of any false rejection
/// below `q`, whatever the dependence of the tests.
///
/// ```text
/// p~(i) = max_{j <= i} min(1, (m - j + 1) p(j)),   p(1) <= p(2) <= ... <= p(m)
/// ```
///
/// Source: S. Holm, Scand. J. Statist. 6 (1979). NaN stays NaN and is not counted as a test.
#[must_use]
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let order = ascending(p_values);
    let mut adjusted = vec![f64::NAN; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, &i) in order.iter().enumerate() {
        largest = largest.max(((order.len() - rank) as f64 * p_values[i]).min(1.0));
        adjusted[i] = largest;
    }
    adjusted
}

fn ascending(p_values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p_values.len()).filter(|&i| !p_values[i].is_nan()).collect();
    order.sort_by(|&i, &j| p_values[i].total_cmp(&p_values[j]));
    order
}

fn quantile(distribution: Option<impl ContinuousCDF<f64, f64>>, p: f64) -> f64 {
    match distribution {
        Some(d) if p > 0.0 && p < 1.0 => d.inverse_cdf(p),
        Some(d) if p == 0.0 => d.min(),
        Some(d) if p == 1.0 => d.max(),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn close(found: f64, expected: f64, relative: f64) {
        assert!((found - expected).abs() <= relative * expected.abs(), "{found} not {expected}");
    }

    #[test]
    fn quantiles_equal_scipy() {
        // scipy 1.17; statrs promises about ten digits
        close(normal_quantile(0.975), 1.959963984540054, 1e-12);
        close(normal_cdf(1.5), 0.9331927987311419, 1e-15);
        close(normal_quantile(1e-10), -6.361340902404056, 1e-12);
        close(chi2_quantile(0.95, 4.0), 9.487729036781154, 1e-10);
        close(chi2_quantile(0.5, 19.0), 18.337652896756474, 1e-10);
        close(chi2_quantile(0.001, 2.5), 0.008815875243366968, 1e-10);
    }

    #[test]
    fn the_log_tail_of_chi_squared_equals_mpmath_up_to_a_million() {
        // mpmath at 60 digits: (t, k, ln P)
        let table = [
            (0.5, 1.0, -0.7350111298370844),
            (7.0, 3.0, -2.6325099953127196),
            (90.0, 5.0, -39.54154480947961),
            (1400.0, 1.0, -703.8486181251224),
            (3000.0, 2.0, -1500.0),
            (1e4, 8.0, -4976.2395798350035),
            (1e6, 1.0, -500007.1335476316),
            (1e6, 40.0, -499790.01494201587),
            (30.0, 40.0, -0.1332813839164755),
            (60.0, 40.0, -3.822480863297408),
        ];
        for (t, k, expected) in table {
            close(chi2_log_survival(t, k), expected, 1e-12);
        }
    }

    #[test]
    fn adjusted_p_values_equal_statsmodels() {
        let p = [0.01, 0.04, 0.03, 0.005, 0.55, 0.2, 0.0004];
        let by_holm = [0.05, 0.12, 0.12, 0.03, 0.55, 0.4, 0.0028];
        for i in 0..p.len() {
            close(holm(&p)[i], by_holm[i], 1e-14);
        }
        assert!(holm(&[0.3, f64::NAN])[1].is_nan());
        assert_eq!(holm(&[0.3, f64::NAN])[0], 0.3);
    }

    #[test]
    fn meaningless_parameters_give_nan_and_never_panic() {
        assert!(chi2_log_survival(1.0, 0.0).is_nan());
        assert_eq!(chi2_log_survival(-1.0, 2.0), 0.0);
        assert_eq!(chi2_log_survival(f64::INFINITY, 2.0), f64::NEG_INFINITY);
        assert!(chi2_quantile(1.5, 3.0).is_nan() && chi2_quantile(0.5, -1.0).is_nan());
    }
}
