//! Distributions that turn a statistic into a probability, and corrections for many tests.
//!
//! A parameter outside its range gives NaN, as in R: the caller's statistic is then meaningless.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};
use statrs::function::gamma::{gamma_ur, ln_gamma};

/// Value that a standard normal variable stays below with probability `p` in (0, 1).
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

/// Probability that a standard normal variable exceeds `z`.
#[must_use]
pub fn normal_survival(z: f64) -> f64 {
    0.5 * libm::erfc(z / std::f64::consts::SQRT_2)
}

/// Probability that a standard normal variable is farther from zero than `z`.
#[must_use]
pub fn normal_two_sided_p(z: f64) -> f64 {
    libm::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Value that a Student t variable stays below with probability `p`; `dof` > 0.
#[must_use]
pub fn t_quantile(p: f64, dof: f64) -> f64 {
    quantile(StudentsT::new(0.0, 1.0, dof).ok(), p)
}

/// Probability that a Student t variable exceeds `t`; `dof` > 0.
#[must_use]
pub fn t_survival(t: f64, dof: f64) -> f64 {
    survival(StudentsT::new(0.0, 1.0, dof).ok(), t)
}

/// Probability that a Student t variable is farther from zero than `t`; `dof` > 0.
#[must_use]
pub fn t_two_sided_p(t: f64, dof: f64) -> f64 {
    2.0 * t_survival(t.abs(), dof)
}

/// Value that an F variable stays below with probability `p`; both degrees of freedom > 0.
#[must_use]
pub fn f_quantile(p: f64, numerator_dof: f64, denominator_dof: f64) -> f64 {
    quantile(FisherSnedecor::new(numerator_dof, denominator_dof).ok(), p)
}

/// Probability that an F variable exceeds `f`; both degrees of freedom > 0.
#[must_use]
pub fn f_survival(f: f64, numerator_dof: f64, denominator_dof: f64) -> f64 {
    survival(FisherSnedecor::new(numerator_dof, denominator_dof).ok(), f)
}

/// Value that a chi-squared variable stays below with probability `p`; `dof` > 0.
#[must_use]
pub fn chi2_quantile(p: f64, dof: f64) -> f64 {
    quantile(ChiSquared::new(dof).ok(), p)
}

/// Probability that a chi-squared variable exceeds `t`; `dof` > 0.
#[must_use]
pub fn chi2_survival(t: f64, dof: f64) -> f64 {
    chi2_log_survival(t, dof).exp()
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

/// Benjamini and Hochberg's adjusted p-values: rejecting those below `q` keeps the expected share
/// of false ones among the rejected below `q` for independent tests.
///
/// ```text
/// p~(i) = min_{j >= i} min(1, m/j p(j)),   p(1) <= p(2) <= ... <= p(m)
/// ```
///
/// Source: Y. Benjamini, Y. Hochberg, J. R. Statist. Soc. B 57 (1995). NaN stays NaN and is not
/// counted as a test.
#[must_use]
pub fn benjamini_hochberg(p_values: &[f64]) -> Vec<f64> {
    let order = ascending(p_values);
    let mut adjusted = vec![f64::NAN; p_values.len()];
    let mut smallest = 1.0_f64;
    for (rank, &i) in order.iter().enumerate().rev() {
        smallest = smallest.min(order.len() as f64 / (rank + 1) as f64 * p_values[i]);
        adjusted[i] = smallest;
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

fn survival(distribution: Option<impl ContinuousCDF<f64, f64>>, x: f64) -> f64 {
    match distribution {
        Some(d) if !x.is_nan() => d.sf(x),
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
        close(normal_quantile(1e-10), -6.361340902404056, 1e-12);
        close(t_quantile(0.975, 3.0), 3.1824463052837078, 1e-10);
        close(t_quantile(0.995, 17.5), 2.8880229797364643, 1e-10);
        close(t_quantile(0.6, 1.0), 0.32491969623290634, 1e-10);
        close(f_quantile(0.95, 3.0, 20.0), 3.098391212140781, 1e-10);
        close(f_quantile(0.05, 7.0, 9.0), 0.2719848999119875, 1e-10);
        close(chi2_quantile(0.95, 4.0), 9.487729036781154, 1e-10);
        close(chi2_quantile(0.5, 19.0), 18.337652896756474, 1e-10);
        close(chi2_quantile(0.001, 2.5), 0.008815875243366968, 1e-10);
    }

    #[test]
    fn survival_functions_equal_scipy_far_into_the_tail() {
        close(normal_survival(6.0), 9.865876450376946e-10, 1e-12);
        close(normal_two_sided_p(-3.3), 0.0009668482847675549, 1e-12);
        close(normal_two_sided_p(37.0), 1.1451142445047853e-299, 1e-10);
        close(t_survival(2.5, 7.0), 0.020496109292876444, 1e-10);
        close(t_survival(30.0, 12.0), 5.886590953509468e-13, 1e-9);
        close(t_survival(-1.0, 4.0), 0.8130495168499705, 1e-10);
        close(f_survival(4.2, 3.0, 20.0), 0.018557419834826203, 1e-10);
        close(f_survival(60.0, 2.0, 30.0), 3.276800000000003e-11, 1e-9);
        close(chi2_survival(7.0, 3.0), 0.07189777249646509, 1e-12);
        close(chi2_survival(90.0, 5.0), 6.719319364852582e-18, 1e-12);
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
        let by_bh = [0.07 / 3.0, 0.056, 0.0525, 0.0175, 0.55, 0.7 / 3.0, 0.0028];
        for i in 0..p.len() {
            close(holm(&p)[i], by_holm[i], 1e-14);
            close(benjamini_hochberg(&p)[i], by_bh[i], 1e-14);
        }
        assert!(holm(&[0.3, f64::NAN])[1].is_nan());
        assert_eq!(holm(&[0.3, f64::NAN])[0], 0.3);
    }

    #[test]
    fn meaningless_parameters_give_nan_and_never_panic() {
        assert!(t_quantile(1.5, 3.0).is_nan());
        assert!(t_survival(1.0, -1.0).is_nan());
        assert!(f_survival(f64::NAN, 1.0, 1.0).is_nan());
        assert!(chi2_log_survival(1.0, 0.0).is_nan());
        assert_eq!(chi2_log_survival(-1.0, 2.0), 0.0);
        assert_eq!(chi2_survival(f64::INFINITY, 2.0), 0.0);
    }
}
