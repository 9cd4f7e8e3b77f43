//! A lag and a delay of the input, distinguished in spite of the noise of the recorded input.

use rayon::prelude::*;

use super::Search;
use crate::diagnose::evidence::{evidence, noiseless};
use crate::diagnose::fit::{WindowFit, fit};
use crate::diagnose::input_timing::shifts;
use crate::diagnose::outcome::Ranked;
use crate::math::distribution::t_survival;

impl Search<'_> {
    /// Re-ranks lags and delays if one of them is first: the criterion of each becomes the lowest one plus its
    /// [`evidence`] against the best.
    ///
    /// The windows' error does not distinguish a lag from a delay of the same length: they differ in the second order,
    /// and a lag smooths the noise of the recorded input, which lowers its error whether the robot has one or not.
    pub(super) fn order_shifts(&self, ranked: &mut [Ranked]) {
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

impl Search<'_> {
    /// Probability of a shift as large as that estimated on the held-out recordings, if the input acted no later
    /// than logging explains (one-sided t).
    ///
    /// ```text
    /// t = (T - T_l)/se,   T_l: what logging explains,   m - p degrees of freedom: windows, free parameters
    /// ```
    /// A reduction of the error would only require a true shift of more than half of the fitted one: at exactly
    /// half, the errors with and without the shift are equal.
    pub(super) fn probability_of_logging(&self, after: &WindowFit) -> f64 {
        let Some(held) = &self.held else { return 1.0 };
        let Some(e) = shifts(&after.model).next_back() else { return 1.0 };
        let j = after.model.slots(e).start + after.model.effects()[e].time();
        let Some(own) = fit(held, &after.model, &after.p, &self.scale) else { return 1.0 };
        let degrees = held.windows.len() as f64 - after.model.free().len() as f64;
        let t = (own.p[j] - self.scale.logging) / own.covariance[(j, j)].sqrt();
        if degrees >= 1.0 && t.is_finite() { t_survival(t, degrees) } else { 1.0 }
    }
}
