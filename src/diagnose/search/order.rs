//! The ranking of candidates: its criterion, and the order of equivalent ones.

use std::cmp::Ordering;

use super::Search;
use crate::diagnose::fit::WindowFit;
use crate::diagnose::outcome::Ranked;
use crate::diagnose::thresholds::THRESHOLDS;

impl Search<'_> {
    /// Puts candidates that were refitted in addition to `present` in order.
    pub(super) fn order(&self, present: &WindowFit, ranked: &mut [Ranked]) {
        self.set_criteria(ranked);
        ranked.sort_by(before);
        self.order_shifts(ranked);
        ranked.sort_by(before);
        self.add_held_out(present, ranked);
        self.choose_alike(ranked);
    }

    /// Adds the evidence of the held-out recordings to the criterion, if the first candidate leaves their error above
    /// the floor and another one explains all of it. The training recordings may contain too little of the motion that
    /// separates the two, and the criterion of a model that is wrong is too certain. A false alarm is not concerned:
    /// the error is above the floor with the candidate that the training recordings prefer.
    ///
    /// ```text
    /// ΔBIC = values (rms_after² - rms_before²)/floor²
    /// ```
    fn add_held_out(&self, present: &WindowFit, ranked: &mut [Ranked]) {
        let fit_of = |n: usize| {
            let supported = ranked[n].bic_windows < 0.0 && ranked[n].bic < 0.0;
            ranked[n].refit.as_ref().filter(|_| supported)
        };
        if ranked.is_empty() || self.held.is_none() {
            return;
        }
        if !fit_of(0).is_some_and(|first| self.is_unexplained(first)) {
            return;
        }
        let errors: Vec<(usize, f64)> =
            (0..ranked.len()).filter_map(|n| Some((n, self.shown(fit_of(n)?)))).collect();
        let lowest = errors.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        let Some(lowest) = lowest.and_then(|(n, _)| fit_of(*n)) else { return };
        if self.is_unexplained(lowest) {
            return;
        }
        let floor = self.judge.floor(&lowest.model, &lowest.p).expected.powi(2);
        let (from, values) = (self.shown(present).powi(2), self.judge.values());
        for (n, error) in errors {
            ranked[n].bic += values * (error.powi(2) - from) / floor;
        }
        ranked.sort_by(before);
    }

    /// Sets the ranking criterion: regression and windows together. If a column is computed from the input,
    /// its noise is on both sides of the regression, so such an effect is compared with the best of the
    /// others by the windows alone.
    fn set_criteria(&self, ranked: &mut [Ranked]) {
        let of_input = |r: &Ranked| r.candidate.is_of_input();
        for r in ranked.iter_mut().filter(|r| r.refit.is_some() && !of_input(r)) {
            r.bic = self.bic(&r.candidate, r.by_regression) + r.bic_windows;
        }
        let others = ranked.iter().filter(|r| r.refit.is_some() && !of_input(r));
        let first = others.min_by(|a, b| before(a, b)).map(|r| (r.bic, r.bic_windows));
        for r in ranked.iter_mut().filter(|r| r.refit.is_some() && of_input(r)) {
            let by_regression = self.bic(&r.candidate, r.by_regression);
            let clips = r.candidate.linear.is_empty() && !r.candidate.is_shift();
            r.bic = match first {
                // a dead zone can fit noise by clipping small torques, so the torque balance must
                // also support it
                _ if clips && by_regression > -THRESHOLDS.alike => f64::INFINITY,
                Some((bic, by_windows)) if r.bic_windows < 0.0 => {
                    bic + 2.0 * (r.bic_windows - by_windows)
                }
                _ => 2.0 * r.bic_windows,
            };
        }
    }

    /// Among the candidates that training windows do not distinguish, ranks first the one with the lowest
    /// held-out error. This applies far above the noise, where the remaining errors are not independent
    /// values and the criterion is far too certain, if the first leaves an error above the floor.
    fn choose_alike(&self, ranked: &mut [Ranked]) {
        let Some(first) = ranked.first().filter(|r| r.refit.is_some()) else { return };
        let open = || first.refit.as_ref().is_some_and(|fit| self.is_unexplained(fit));
        let near = |r: &Ranked| r.bic_windows - first.bic_windows < self.open_share(first, r);
        let shifts = |r: &Ranked| first.candidate.is_shift() && r.candidate.is_shift();
        let error = |r: &Ranked| r.refit.as_ref().map_or(f64::INFINITY, |fit| self.shown(fit));
        let others = (1..ranked.len()).filter(|&n| {
            let r = &ranked[n];
            r.refit.is_some() && !shifts(r) && near(r)
        });
        let errors = others.map(|n| (n, error(&ranked[n])));
        let lowest = errors.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((n, _)) = lowest.filter(|(_, least)| *least < error(first) && open()) {
            ranked[..=n].rotate_right(1);
        }
    }

    /// Difference of the criterion below which training windows do not distinguish two refits far above their
    /// noise; zero nearer to it, where the uncertainty of the criterion is valid.
    pub(super) fn open_share(&self, a: &Ranked, b: &Ranked) -> f64 {
        let far = self.is_far_above(a) && self.is_far_above(b);
        if far { THRESHOLDS.alike_share * a.bic_windows.abs() } else { 0.0 }
    }

    /// Whether the errors of the windows of a refit are far larger than their noise.
    pub(super) fn is_far_above(&self, r: &Ranked) -> bool {
        r.refit.as_ref().is_some_and(|fit| self.is_far(fit.cost))
    }

    /// Whether a cost is far larger than noise explains.
    pub(super) fn is_far(&self, cost: f64) -> bool {
        cost > 0.5 * THRESHOLDS.far_above_floor.powi(2) * self.windows.values() as f64
    }
}

/// The order of candidates: first those that simulation supports, since the torque balance may be far off where
/// friction dominates; then by the criterion.
fn before(a: &Ranked, b: &Ranked) -> Ordering {
    let refuted = |r: &Ranked| r.bic_windows >= 0.0;
    refuted(a).cmp(&refuted(b)).then(a.bic.total_cmp(&b.bic))
}

/// Effects that the data do not distinguish from the best, and those that are the same by their equations.
pub(super) fn equals(ranking: &[Ranked]) -> Vec<String> {
    let Some(best) = ranking.first() else { return vec![] };
    let mut out = best.candidate.effect.description().equivalent;
    for other in ranking[1..].iter().filter(|r| alike(best, r)) {
        if !out.contains(&other.candidate.id) {
            out.push(other.candidate.id.clone());
        }
    }
    out
}

/// Whether the data hardly distinguish two candidates that were refitted.
fn alike(best: &Ranked, other: &Ranked) -> bool {
    other.refit.is_some() && (other.bic - best.bic).abs() < THRESHOLDS.alike
}
