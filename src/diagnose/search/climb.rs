//! The forward search: the best effect of a ranking, then the best in addition to it, and other starts if the
//! search ends unexplained.

use std::cell::LazyCell;

use super::order::{equals, is_lower};
use super::steps::has_size;
use super::{Search, is_two_mass};
use crate::diagnose::fit::WindowFit;
use crate::diagnose::outcome::{Ranked, Step};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::verdict::unexplained;

/// The effect that a search adds first.
#[derive(Clone, Copy)]
enum First {
    /// The best of the ranking that lowers the reported error.
    Best,
    /// The first of the ranking, whatever the others are.
    Given,
}

/// The steps that held-out windows prove, and the ranking at each step.
type Climbed = (Vec<Step>, Vec<Vec<Ranked>>);

impl Search<'_> {
    /// The search from the best candidates of the base; from others if the larger part of the error above the
    /// noise floor remains.
    pub(super) fn climb_from_best(&self, base: &WindowFit) -> Climbed {
        let mut climbed = self.climb(base, self.rank(base, true), First::Best);
        let is_unexplained = |steps: &[Step]| self.is_unexplained(last_of(base, steps));
        let mut unexplained = is_unexplained(&climbed.0);
        // before the verdict "unknown" every effect of the catalogue must have been simulated
        if unexplained && let Some(ranking) = self.with_second_bodies(base, &climbed.1[0]) {
            let again = self.climb(base, ranking, First::Best);
            let error = |steps: &[Step]| self.shown(last_of(base, steps));
            if error(&again.0) < error(&climbed.0) {
                climbed = again;
                unexplained = is_unexplained(&climbed.0);
            }
        }
        if unexplained
            && self.unexplained(base, &climbed.0) > THRESHOLDS.unexplained
            && let Some(again) = self.other_beginnings(base, &climbed.1[0])
        {
            climbed = again;
        }
        climbed
    }

    /// [`unexplained`] of the reported errors of the base and after the last of `steps`.
    fn unexplained(&self, base: &WindowFit, steps: &[Step]) -> f64 {
        let last = last_of(base, steps);
        let square = |fit: &WindowFit| self.shown(fit).powi(2);
        let floor = self.judge.floor(&last.model, &last.p).expected.powi(2);
        unexplained(square(base), square(last), floor)
    }

    /// Repeatedly adds the best candidate of a ranking that lowers the reported error, and ranks anew.
    /// Each ranking is returned with the added effect first. The effect added first is the best or the `given` one,
    /// the first of the ranking.
    fn climb(&self, base: &WindowFit, first: Vec<Ranked>, added: First) -> Climbed {
        let mut tried: Vec<(Ranked, Vec<String>)> = Vec::new();
        let mut rankings = vec![first];
        let (mut present, mut shown) = (base.clone(), self.shown(base));
        while tried.len() < self.settings.max_effects {
            let ranking = rankings.last_mut().expect("there is one per step");
            // no accepted sequence may contain a step that does not lower the reported error
            let now = (shown, &present);
            let choice = match added {
                First::Given if tried.is_empty() => &ranking[..ranking.len().min(1)],
                _ => &ranking[..],
            };
            let Some((n, next)) = self.first_that_lowers(choice, now) else { break };
            ranking[..=n].rotate_right(1);
            self.compare_with_first(ranking);
            let mut best = ranking[0].clone();
            let Some(refit) = best.refit.take().map(|fit| self.released(fit)) else { break };
            shown = next.min(self.shown(&refit));
            best.refit = Some(refit.clone());
            present = refit.clone();
            tried.push((best, equals(ranking)));
            rankings.push(self.rank(&refit, false));
        }
        let steps = self.proven(base, &tried);
        let steps = self.exchanged(base, steps, &rankings);
        (self.pruned(base, steps), rankings)
    }

    /// Index and reported error of the first candidate in the ranking that improves the criterion, has a size, and
    /// whose reported error is [lower](Self::lowers) than `shown`. The candidate with the best criterion may raise it:
    /// if two effects are missing, a flexible one fits a part of both to the training recordings. One without a size
    /// may contain a simpler effect as a limit (a sliding caster far behind the axle acts as turning scrub), which
    /// comes after it: if the input between the rows leaves its size open, the first later one is taken that has a size
    /// and is hardly less probable. Of effects that the training recordings do not distinguish, or of which their torque
    /// balance prefers the first, which leaves an error above the floor, and their simulation the other, one that predicts
    /// held-out recordings better by a relevant share is taken. If the present error is at the floor of the
    /// present model or of that with the effect, an effect that clips the input clips noise of its record, which is part
    /// of the floor.
    fn first_that_lowers(
        &self,
        ranking: &[Ranked],
        (shown, present): (f64, &WindowFit),
    ) -> Option<(usize, f64)> {
        let better = ranking.iter().enumerate().filter(|(_, r)| r.bic < 0.0);
        let fits = better.filter_map(|(n, r)| Some((n, &r.candidate.id, r.refit.as_ref()?)));
        // simulated only for an effect that clips
        let floor_of = |fit: &WindowFit| self.judge.floor(&fit.model, &fit.p).expected;
        let floor = LazyCell::new(|| floor_of(present));
        let is_noise = |fit: &WindowFit| shown <= *floor || shown <= floor_of(fit);
        let mut sized = fits.filter(|(n, id, fit)| {
            has_size(fit, id) && !(ranking[*n].candidate.clips() && is_noise(fit))
        });
        let with_error = |(n, id, fit)| Some((n, id, fit, self.shown(fit)));
        let lowers = |one: &(usize, &String, &WindowFit, f64)| self.lowers(shown, one.3, one.2);
        let (first, id, fit, error) = sized.by_ref().filter_map(with_error).find(lowers)?;
        // the torque balance may prefer the one that the simulation does not
        let is_open = self.is_unexplained(fit);
        let is_about_as_good = |n: usize| {
            let (one, other) = (&ranking[first], &ranking[n]);
            let alike = other.bic - one.bic < THRESHOLDS.alike;
            let simulates_better = is_open && other.bic_windows < one.bic_windows;
            other.bic_windows < 0.0 && (alike || simulates_better || self.is_undecided(one, other))
        };
        let alike = sized.filter(|(n, ..)| is_about_as_good(*n)).filter_map(with_error);
        let mut alike =
            alike.filter(|one| lowers(one) && self.is_sized(one.2, one.1)).map(|(n, .., e)| (n, e));
        let other = match self.is_sized(fit, id) {
            false => alike.next(),
            true if self.held.is_some() => alike
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, other)| is_lower(*other, error)),
            true => None,
        };
        Some(other.unwrap_or((first, error)))
    }

    /// The search started with another effect of the first ranking, if it ends near the floor: if several
    /// effects are missing, the one added first decides from which minimum the others are fitted.
    fn other_beginnings(&self, base: &WindowFit, ranking: &[Ranked]) -> Option<Climbed> {
        let shown = self.shown(base);
        let lowers = |r: &Ranked| r.refit.as_ref().is_some_and(|fit| self.shown(fit) < shown);
        let others = (1..ranking.len()).filter(|&n| ranking[n].bic < 0.0 && lowers(&ranking[n]));
        others.take(THRESHOLDS.exchanged).find_map(|n| {
            let mut ranking = ranking.to_vec();
            ranking[..=n].rotate_right(1);
            let climbed = self.climb(base, ranking, First::Given);
            (!self.is_unexplained(last_of(base, &climbed.0))).then_some(climbed)
        })
    }

    /// Whether the reported error of a model is larger than noise explains.
    pub(super) fn is_unexplained(&self, fit: &WindowFit) -> bool {
        self.shown(fit) > THRESHOLDS.above_floor * self.judge.floor(&fit.model, &fit.p).expected
    }

    /// A ranking with the effects that have a second body refitted too, if one of them is then first.
    fn with_second_bodies(&self, present: &WindowFit, ranking: &[Ranked]) -> Option<Vec<Ranked>> {
        let mut ranked = ranking.to_vec();
        let is_open = |n: &usize| is_two_mass(&ranked[*n]) && ranked[*n].refit.is_none();
        let open: Vec<usize> = (0..ranked.len()).filter(is_open).collect();
        if open.is_empty() {
            return None;
        }
        self.refit_all(present, &mut ranked, &open, None);
        self.order(present, &mut ranked);
        ranked.first().is_some_and(is_two_mass).then_some(ranked)
    }
}

fn last_of<'s>(base: &'s WindowFit, steps: &'s [Step]) -> &'s WindowFit {
    steps.last().map_or(base, |step| &step.fit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::recorded;
    use crate::diagnose::{Data, Settings};
    use crate::model::Model;
    use crate::recording::Recording;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn of_effects_that_training_does_not_distinguish_that_with_the_lower_held_out_error_is_added() {
        let base = Model::base(Robot::amigobot());
        let model = base.add("turning_scrub").unwrap();
        let mut truth = base.initial();
        truth.push(0.05);
        let [train, validation] = [3, 4].map(|seed| recorded(&model, &truth, seed));
        let candidates = ["yaw_viscous", "turning_scrub"].map(str::to_owned).to_vec();
        let settings = Settings { candidates, ..Settings::default() };
        let starts = [base.initial()];
        let added = |validation: &[Recording]| {
            let data = Data { train: &train, validation, hold: Hold::Linear, corrected_s: 0.0 };
            let search = Search::new(&base, &starts, &data, &settings).unwrap();
            let present = search.base(&base, &starts).unwrap();
            let mut ranking = search.rank(&present, true);
            // the evidence of the training recordings for the wrong effect is larger, by less than decides
            ranking.sort_by_key(|r| r.candidate.id == "turning_scrub");
            ranking[0].bic = ranking[1].bic - 0.5 * THRESHOLDS.alike;
            let (first, _) = search.first_that_lowers(&ranking, (f64::INFINITY, &present)).unwrap();
            ranking[first].candidate.id.clone()
        };
        assert_eq!(added(&validation), "turning_scrub");
        let data =
            Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
        let search = Search::new(&base, &starts, &data, &settings).unwrap();
        let present = search.base(&base, &starts).unwrap();
        let first = |added: First| {
            let mut ranking = search.rank(&present, true);
            ranking.sort_by_key(|r| r.candidate.id == "turning_scrub");
            let (_, rankings) = search.climb(&present, ranking, added);
            rankings[0][0].candidate.id.clone()
        };
        assert_eq!([First::Given, First::Best].map(first), ["yaw_viscous", "turning_scrub"]);
        assert_eq!(added(&[]), "yaw_viscous");
    }
}
