//! Whether an effect lowers the error on recordings that nothing was fitted to.

use super::thresholds::THRESHOLDS;
use crate::math::distribution::t_survival;
use crate::math::mean;

/// The fall of the error from one model to the next over held-out windows.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Fall {
    /// Probability of a mean fall as large if the effect did nothing (one-sided).
    pub p_value: f64,
    /// Fall of the geometric mean of the windows' errors (root mean square), as a share.
    pub share: f64,
    /// Error after over error before, root mean square over all windows.
    pub ratio: f64,
    /// Held-out windows on which both errors rest.
    pub windows: usize,
    /// Whether the effect delays the input, so that its size is a time. A controller depends on it, although
    /// the simulation error hardly changes.
    pub later: bool,
}

impl Fall {
    /// No windows to judge on.
    pub const NONE: Self = Self { p_value: 1.0, share: 0.0, ratio: 1.0, windows: 0, later: false };

    /// Whether the fall is significant at `rate`, at least `least` unless the effect delays the input, and
    /// the root mean square does not rise.
    #[must_use]
    pub fn passes(&self, rate: f64, least: f64) -> bool {
        self.p_value < rate && (self.later || self.share >= least) && self.ratio <= 1.0
    }
}

/// The fall between the squared errors of windows, in the order of time, with what each window shows of it
/// (`weight`, 0 to 1).
///
/// ```text
/// d_b = ln(before_b) - ln(after_b),   mean = Σ w d/Σ w,   t = mean/se
/// se² = Σ w² (d - mean)²/(Σ w)² m/(m - 1) (1 + r)/(1 - r),   m = (Σ w)²/Σ w²
/// r = r' + (1 + 3 r')/m,   degrees of freedom m (1 - r)/(1 + r) - 1
/// ```
/// r', the correlation of neighbouring windows, is too low by (1 + 3 r)/m (Kendall, Biometrika 41, 1954); r is limited to
/// 0 to 0.9. Logarithms keep one window from deciding. The weights
/// must not depend on the errors: those of windows in which both models move alike are small, so that an effect
/// that acts in a few windows (a warm-up, a limit that is seldom reached) is not tested on the noise of all others.
/// Where fewer than four windows show anything, all count alike.
#[must_use]
pub(super) fn fall_of(before: &[f64], after: &[f64], weight: &[f64]) -> Fall {
    let rows = before.iter().zip(after).zip(weight);
    let (d, w): (Vec<f64>, Vec<f64>) = rows
        .filter(|((b, a), _)| **b > 0.0 && **a > 0.0)
        .map(|((b, a), w)| (b.ln() - a.ln(), *w))
        .unzip();
    if d.len() < THRESHOLDS.fewest_windows || !d.iter().all(|v| v.is_finite()) {
        return Fall::NONE;
    }
    let is_enough = effective(&w) >= THRESHOLDS.fewest_windows as f64;
    let w = if is_enough { w } else { vec![1.0; d.len()] };
    let p_value = probability(&d, &w);
    let mean = mean(d.iter().copied());
    let ratio = (after.iter().sum::<f64>() / before.iter().sum::<f64>()).sqrt();
    Fall { p_value, share: 1.0 - (-0.5 * mean).exp(), ratio, windows: d.len(), later: false }
}

/// How many values of equal weight are as good as these.
fn effective(weight: &[f64]) -> f64 {
    let (sum, square): (f64, f64) = weight.iter().fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    if square > 0.0 { sum * sum / square } else { 0.0 }
}

/// Probability of a weighted mean as large if there were none (one-sided t).
fn probability(d: &[f64], w: &[f64]) -> f64 {
    let (total, count) = (w.iter().sum::<f64>(), effective(w));
    let mean = d.iter().zip(w).map(|(d, w)| d * w).sum::<f64>() / total;
    let off: Vec<f64> = d.iter().zip(w).map(|(d, w)| w * (d - mean)).collect();
    let square: f64 = off.iter().map(|v| v * v).sum();
    let product: f64 = off.windows(2).map(|v| v[0] * v[1]).sum();
    let seen = product / square.max(f64::MIN_POSITIVE);
    let r = (seen + (1.0 + 3.0 * seen) / count).clamp(0.0, THRESHOLDS.most_correlated);
    let variance = square / (total * total) * count / (count - 1.0);
    let (longer, degrees) = ((1.0 + r) / (1.0 - r), count * (1.0 - r) / (1.0 + r) - 1.0);
    let se = (variance * longer).sqrt();
    if se > 0.0 { t_survival(mean / se, degrees.max(1.0)) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fall_of_a_worked_example_is_that_of_a_t_test() {
        // d = ln 4, ln 2, ln 4, ln 1, ln 4, ln 2: mean 8/6 ln 2, scipy.stats.ttest_1samp(d, 0,
        // alternative="greater") gives t = 4.0, p = 0.005162; neighbours correlate negatively
        let after = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        let before = [4.0, 2.0, 4.0, 1.0, 4.0, 2.0];
        let fall = fall_of(&before, &after, &[1.0; 6]);
        let mean = 8.0 / 6.0 * 2.0_f64.ln();
        assert!((fall.share - (1.0 - (-0.5 * mean).exp())).abs() < 1e-12);
        assert!((fall.p_value - 0.005_162).abs() < 5e-5, "{}", fall.p_value);
        assert!((fall.ratio - (6.0_f64 / 17.0).sqrt()).abs() < 1e-12);
        assert!(fall.passes(0.05, 0.01) && !fall.passes(0.005, 0.01));
    }

    #[test]
    fn windows_that_resemble_their_neighbours_are_fewer_than_they_are() {
        // numpy: r' = 0.1458, r = 0.2656, t = 5.629 of 5.963 degrees of freedom instead of 7.389 of 11, with
        // scipy.stats.t.sf p = 6.86e-4 instead of 6.9e-6
        let before = [2.0, 3.0, 2.0, 4.0, 4.0, 3.0, 1.5, 2.0, 1.0, 3.0, 3.0, 4.0];
        let fall = fall_of(&before, &[1.0; 12], &[1.0; 12]);
        assert!((fall.p_value / 6.8634e-4 - 1.0).abs() < 1e-3, "{}", fall.p_value);
    }

    #[test]
    fn too_few_windows_prove_nothing() {
        assert_eq!(fall_of(&[2.0, 2.0], &[1.0, 1.0], &[1.0, 1.0]), Fall::NONE);
    }

    #[test]
    fn windows_that_do_not_tell_leave_the_test_to_those_that_do() {
        // the test of the six windows above, with two of weight zero in between
        let after = [1.0; 8];
        let before = [4.0, 2.0, 9.0, 4.0, 1.0, 0.1, 4.0, 2.0];
        let weight = [1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0];
        let fall = fall_of(&before, &after, &weight);
        assert!((fall.p_value - 0.005_162).abs() < 5e-5, "{}", fall.p_value);
        // three that show it are too few: all count
        let three = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0];
        assert_eq!(fall_of(&before, &after, &three), fall_of(&before, &after, &[1.0; 8]));
    }

    #[test]
    fn an_effect_of_a_few_windows_is_found_among_many_that_it_leaves_alone() {
        // noise of 0.1 in all windows, a fall of 1.4 in five of forty
        let noise = crate::math::least_squares::tests::lcg(40, 7);
        let acts = |n: usize| n % 8 == 3;
        let fall = |n: usize| if acts(n) { 1.4 } else { 0.0 };
        let before: Vec<f64> = (0..40).map(|n| (fall(n) + 0.2 * noise[n]).exp()).collect();
        let weight: Vec<f64> = (0..40).map(|n| if acts(n) { 0.9 } else { 0.01 }).collect();
        let [alike, weighted] = [vec![1.0; 40], weight].map(|w| fall_of(&before, &[1.0; 40], &w));
        assert!(weighted.p_value < 1e-3 * alike.p_value, "{weighted:?} {alike:?}");
        assert_eq!(weighted.share, alike.share);
    }
}
