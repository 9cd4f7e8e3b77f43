//! A lag and a delay of the input, distinguished in spite of the noise of the recorded input.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Search;
use crate::compare::noisier_drive;
use crate::diagnose::fit::{WindowFit, fit};
use crate::diagnose::input_timing::shifts;
use crate::diagnose::outcome::Ranked;
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::windows::Windows;
use crate::math::distribution::t_survival;
use crate::recording::Recording;

/// Pairs of draws of the noise: what they leave of its effect on a sum over all rows is below a hundredth of it.
const DRAWS: usize = 4;

impl Search<'_> {
    /// Orders the shifts of the input among each other, where one of them comes first: their criterion becomes that
    /// of the lowest and what [`evidence`] says against each.
    ///
    /// The windows' error does not tell a lag from a delay of the same length: they differ in the second order, and
    /// a lag smooths the noise of the recorded input, which lowers its error whether the robot has one or not.
    pub(super) fn tell_shifts(&self, ranked: &mut [Ranked]) {
        let is_shift = |r: &Ranked| r.candidate.is_shift() && r.refit.is_some();
        let places: Vec<usize> = (0..ranked.len()).filter(|&n| is_shift(&ranked[n])).collect();
        if places.len() < 2 || places[0] != 0 {
            return;
        }
        let squares = |n: &usize| {
            let fit = ranked[*n].refit.as_ref()?;
            let held = self.held.as_ref().map(|held| noiseless(held, fit));
            let train = noiseless(&self.windows, fit)?;
            Some(train.into_iter().chain(held.unwrap_or(Some(vec![]))?).collect())
        };
        let squares: Option<Vec<Vec<f64>>> = places.par_iter().map(squares).collect();
        let Some(squares) = squares else { return };
        let least = places.iter().map(|&n| ranked[n].bic).fold(f64::INFINITY, f64::min);
        let sum = |n: usize| squares[n].iter().sum::<f64>();
        let best = (0..places.len()).min_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap_or(0);
        for (k, &n) in places.iter().enumerate() {
            ranked[n].bic = least + evidence(&squares[k], &squares[best]);
        }
    }
}

/// Evidence for the second of two models from what each leaves in every window.
///
/// ```text
/// z² = (Σ d)²/(Σ (d - mean d)² m/(m - 1)),   d: difference in each of m windows
/// ```
/// Source: Vuong, Econometrica 57 (1989), test of two models of which neither contains the other; z² in place of the
/// likelihood ratio, which takes the rows of a window for independent.
fn evidence(one: &[f64], other: &[f64]) -> f64 {
    let d: Vec<f64> = one.iter().zip(other).map(|(a, b)| a - b).collect();
    let (m, sum) = (d.len() as f64, d.iter().sum::<f64>());
    let square: f64 = d.iter().map(|v| (v - sum / m).powi(2)).sum();
    if square > 0.0 { sum * sum / (square * m / (m - 1.0)) } else { 0.0 }
}

impl Search<'_> {
    /// Probability of a shift as large on held-out recordings, where it is estimated anew, if the input acted no later
    /// than logging explains (one-sided t).
    ///
    /// ```text
    /// t = (T - h/2)/se,   m - p degrees of freedom: windows, free parameters
    /// ```
    /// A fall of the error would ask for a shift beyond half of the way to the one that was fitted: a window whose error
    /// would be least there has the same error at both ends.
    pub(super) fn probability_of_logging(&self, after: &WindowFit) -> f64 {
        let Some(held) = &self.held else { return 1.0 };
        let Some(e) = shifts(&after.model).next_back() else { return 1.0 };
        let j = after.model.slots(e).start;
        let Some(own) = fit(held, &after.model, &after.p, &self.scale) else { return 1.0 };
        let degrees = held.windows.len() as f64 - after.model.free().len() as f64;
        let t = (own.p[j] - THRESHOLDS.logging * self.scale.step) / own.covariance[(j, j)].sqrt();
        if degrees >= 1.0 && t.is_finite() { t_survival(t, degrees) } else { 1.0 }
    }
}

/// Squared innovations of every window, less what noise of the recorded input makes of them: by as much as it raises
/// them once more when it is added again, in pairs of opposite sign so that what is linear in it cancels.
///
/// Source: Cook and Stefanski, J. Am. Stat. Assoc. 89 (1994), simulation and extrapolation.
fn noiseless(windows: &Windows, fit: &WindowFit) -> Option<Vec<f64>> {
    let squares = |w: &Windows| Some(w.innovations(&w.errors(&fit.model, &fit.p)?));
    let plain = squares(windows)?;
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut out = plain.clone();
    let each = 1.0 / (2 * DRAWS) as f64;
    for _ in 0..DRAWS {
        let recordings = windows.recordings.iter();
        let noisy: Vec<Vec<[f64; 2]>> =
            recordings.map(|r| noisier_drive(r, r.noise().moment, &mut rng)).collect();
        for sign in [1.0, -1.0] {
            let with = |(r, noisy): (&&Recording, &Vec<[f64; 2]>)| {
                let rows = r.moment().iter().zip(noisy);
                let moved = rows.map(|(m, n)| [0, 1].map(|i| m[i] + sign * (n[i] - m[i])));
                r.with_moment(moved.collect())
            };
            let moved: Vec<Recording> = windows.recordings.iter().zip(&noisy).map(with).collect();
            let moved = squares(&windows.with_recordings(moved.iter().collect()))?;
            out.iter_mut()
                .zip(moved.iter().zip(&plain))
                .for_each(|(o, (m, p))| *o -= each * (m - p));
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_evidence_of_a_worked_example_is_the_square_of_a_t_test() {
        // scipy.stats.ttest_1samp([ln 2, ln 4, ln 2, 0, ln 2, ln 4], 0) gives t = 3.7963, whose square is 14.4118
        let d = [2.0_f64, 4.0, 2.0, 1.0, 2.0, 4.0].map(f64::ln);
        assert!((evidence(&d, &[0.0; 6]) - 14.4118).abs() < 1e-3);
        assert_eq!(evidence(&d, &d), 0.0);
    }
}
