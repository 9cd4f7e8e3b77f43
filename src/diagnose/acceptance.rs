//! Whether an effect lowers the error on recordings that nothing was fitted to.

use crate::math::distribution::t_survival;

/// Largest correlation of neighbouring windows that is corrected for.
const MOST_CORRELATED: f64 = 0.9;
/// Fewest windows on which a fall can be tested.
const FEWEST: usize = 4;

/// The fall of the error from one model to the next over held-out windows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Fall {
    /// Probability of a mean fall as large if the effect did nothing (one-sided).
    pub p_value: f64,
    /// Fall of the geometric mean of the windows' errors (root mean square), as a share.
    pub share: f64,
    /// Error after over error before, root mean square over all windows.
    pub ratio: f64,
    /// Windows.
    pub windows: usize,
}

impl Fall {
    /// No windows to judge on.
    pub const NONE: Self = Self { p_value: 1.0, share: 0.0, ratio: 1.0, windows: 0 };

    /// Whether it is significant at `rate`, at least `least` and no rise of the root mean square.
    #[must_use]
    pub fn passes(&self, rate: f64, least: f64) -> bool {
        self.p_value < rate && self.share >= least && self.ratio <= 1.0
    }
}

/// The fall between the squared errors of windows, in the order of time.
///
/// ```text
/// d_b = ln(before_b) - ln(after_b),  t = mean(d)/se,  se² = var(d)/B (1 + r)/(1 - r)
/// ```
/// r is the correlation of neighbouring windows (0 to 0.9). Logarithms keep one window from deciding.
#[must_use]
pub fn fall_of(before: &[f64], after: &[f64]) -> Fall {
    let d: Vec<f64> = before
        .iter()
        .zip(after)
        .filter(|(b, a)| **b > 0.0 && **a > 0.0)
        .map(|(b, a)| b.ln() - a.ln())
        .collect();
    let count = d.len() as f64;
    if d.len() < FEWEST || !d.iter().all(|v| v.is_finite()) {
        return Fall::NONE;
    }
    let mean = d.iter().sum::<f64>() / count;
    let variance = d.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let product: f64 = d.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    let r =
        (product / (variance * (count - 1.0)).max(f64::MIN_POSITIVE)).clamp(0.0, MOST_CORRELATED);
    let se = (variance / count * (1.0 + r) / (1.0 - r)).sqrt();
    let p_value = if se > 0.0 { t_survival(mean / se, count - 1.0) } else { 1.0 };
    let ratio = (after.iter().sum::<f64>() / before.iter().sum::<f64>()).sqrt();
    Fall { p_value, share: 1.0 - (-0.5 * mean).exp(), ratio, windows: d.len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fall_of_a_worked_example_is_that_of_a_t_test() {
        // d = ln 2, ln 4, ln 2, ln 1, ln 2, ln 4: mean 7/6 ln 2, scipy.stats.ttest_1samp(d, 0,
        // alternative="greater") gives t = 3.7966, p = 0.006338; neighbours correlate negatively
        let after = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        let before = [2.0, 4.0, 2.0, 1.0, 2.0, 4.0];
        let fall = fall_of(&before, &after);
        let mean = 7.0 / 6.0 * 2.0_f64.ln();
        assert!((fall.share - (1.0 - (-0.5 * mean).exp())).abs() < 1e-12);
        assert!((fall.p_value - 0.006_338).abs() < 5e-5, "{}", fall.p_value);
        assert!((fall.ratio - (6.0_f64 / 15.0).sqrt()).abs() < 1e-12);
        assert!(fall.passes(0.05, 0.01) && !fall.passes(0.005, 0.01));
    }

    #[test]
    fn too_few_windows_prove_nothing() {
        assert_eq!(fall_of(&[2.0, 2.0], &[1.0, 1.0]), Fall::NONE);
    }
}
