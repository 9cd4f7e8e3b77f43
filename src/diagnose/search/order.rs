//! The ranking of candidates: its criterion, and the order of equivalent ones.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::Search;
use crate::diagnose::evidence::evidence;
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
            r.bic = match first {
                // a dead zone can fit noise by clipping small torques, so the torque balance must
                // also support it
                _ if r.candidate.clips() && by_regression > -THRESHOLDS.alike => f64::INFINITY,
                Some((bic, by_windows)) if r.bic_windows < 0.0 => {
                    bic + 2.0 * (r.bic_windows - by_windows)
                }
                _ => 2.0 * r.bic_windows,
            };
        }
    }

    /// Among the candidates that training windows do not distinguish from the first, ranks first the one with the lowest
    /// held-out error, if lower by a relevant share; of those whose held-out errors differ by less, that with the fewest
    /// parameters: the others may contain it as a limit. This applies far above the noise, if the first leaves an error
    /// above the floor.
    fn choose_alike(&self, ranked: &mut [Ranked]) {
        let Some(first) = ranked.first() else { return };
        let Some(fit) = first.refit.as_ref().filter(|fit| self.is_unexplained(fit)) else { return };
        let shifts = |r: &Ranked| first.candidate.is_shift() && r.candidate.is_shift();
        let near = |r: &Ranked| r.bic_windows < first.bic_windows || self.is_undecided(first, r);
        let others = (1..ranked.len()).filter(|&n| !shifts(&ranked[n]) && near(&ranked[n]));
        let errors = others.filter_map(|n| Some((n, self.shown(ranked[n].refit.as_ref()?))));
        let all: Vec<(usize, f64)> = std::iter::once((0, self.shown(fit))).chain(errors).collect();
        let lowest = all.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
        let parameters = |n: usize| ranked[n].candidate.parameters();
        let alike = all.iter().filter(|(_, error)| !is_lower(lowest, *error));
        let simplest = alike.min_by(|a, b| {
            // the first stays if it is one of the simplest
            let order = (a.0 != 0).cmp(&(b.0 != 0)).then(a.1.total_cmp(&b.1));
            parameters(a.0).cmp(&parameters(b.0)).then(order)
        });
        if let Some((n, _)) = simplest {
            ranked[..=*n].rotate_right(1);
        }
    }

    /// Whether both refits are far above their noise and the training windows do not distinguish them. A shift in time
    /// that comes first stays first: with the input at a wrong time no other effect is judged.
    pub(super) fn is_undecided(&self, a: &Ranked, b: &Ranked) -> bool {
        let (Some(one), Some(other)) = (&a.refit, &b.refit) else { return false };
        self.is_far(one.cost) && self.is_far(other.cost) && !self.is_distinguished(one, other)
    }

    /// Whether the training windows distinguish two fits, if a window counts as one value: far above the noise the
    /// errors of its rows are those of the model, and not independent as the criterion assumes.
    pub(super) fn is_distinguished(&self, one: &WindowFit, other: &WindowFit) -> bool {
        let squares = |fit: &WindowFit| self.windows.squares(&fit.model, &fit.p);
        let both = squares(one).zip(squares(other));
        both.is_none_or(|(one, other)| evidence(&one, &other) > THRESHOLDS.alike)
    }

    /// The criterion of candidates far above the noise, as the evidence against them compared with the first: it is
    /// the one that is added, and they are not more probable.
    ///
    /// ```text
    /// ΔBIC = max(0, ±min(z², |ΔBIC|) - 2 ln p)
    /// ```
    /// z²: evidence of the training windows, with the sign of their ΔBIC; p: of the fall of the held-out error to that
    /// of the first.
    pub(super) fn compare_with_first(&self, ranked: &mut [Ranked]) {
        let Some((first, others)) = ranked.split_first_mut() else { return };
        let Some(fit) = first.refit.as_ref().filter(|fit| self.is_far(fit.cost)) else { return };
        let is_compared = |r: &&mut Ranked| {
            let shifts = first.candidate.is_shift() && r.candidate.is_shift();
            !shifts && r.refit.as_ref().is_some_and(|fit| self.is_far(fit.cost))
        };
        let squares = |fit: &WindowFit| self.windows.squares(&fit.model, &fit.p);
        let Some(own) = squares(fit) else { return };
        let held_out = |fit| self.held.as_ref().map(|_| self.held_out(&[fit]).remove(0));
        let after = held_out(fit);
        others.par_iter_mut().filter(is_compared).for_each(|r| {
            let Some(other) = &r.refit else { return };
            let Some(z2) = squares(other).map(|squares| evidence(&own, &squares)) else { return };
            let by = r.bic_windows - first.bic_windows;
            let both = held_out(other).zip(after.as_ref());
            let p = both.map_or(1.0, |(before, after)| self.fall(&before, after).p_value);
            let evidence = by.signum() * z2.min(by.abs()) - 2.0 * p.max(f64::MIN_POSITIVE).ln();
            r.bic = first.bic + evidence.max(0.0);
        });
        others.sort_by(before);
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

/// Whether a reported error is lower than another by a relevant share.
pub(super) fn is_lower(one: f64, other: f64) -> bool {
    one < (1.0 - THRESHOLDS.least_fall) * other
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::recorded;
    use crate::diagnose::{Data, Settings};
    use crate::model::Model;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn of_effects_that_predict_alike_far_above_the_floor_the_one_with_fewer_parameters_is_first() {
        // a drag that is no candidate leaves every refit far above the floor
        let base = Model::base(Robot::amigobot());
        let model = base.add("turning_scrub").unwrap().add("quadratic_drag").unwrap();
        let mut truth = base.initial();
        truth.extend([0.05, 1e-3, 1e-3]);
        let [train, validation] = [3, 4].map(|seed| recorded(&model, &truth, seed));
        let candidates = ["sliding_caster", "turning_scrub"].map(str::to_owned).to_vec();
        let settings = Settings { candidates, ..Settings::default() };
        let starts = [base.initial()];
        let data =
            Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
        let search = Search::new(&base, &starts, &data, &settings).unwrap();
        let present = search.base(&base, &starts).unwrap();
        let mut ranked = search.rank(&present, true);
        search.refit_all(&present, &mut ranked, &[0, 1], None);
        ranked.sort_by_key(|r| r.candidate.id == "turning_scrub");
        let [mut caster, scrub] = [0, 1].map(|n| ranked[n].clone());
        // a caster far behind the axle is scrub: the same motion with one parameter more
        caster.refit = scrub.refit.clone();
        assert!(search.is_undecided(&caster, &scrub));
        for mut both in [[caster.clone(), scrub.clone()], [scrub, caster]] {
            search.choose_alike(&mut both);
            assert_eq!(both[0].candidate.id, "turning_scrub");
        }
    }
}
