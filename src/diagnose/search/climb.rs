//! The forward search: the best effect of a ranking, then the best in addition to it, and other starts if the
//! search ends unexplained.

use super::order::equals;
use super::steps::has_size;
use super::{Search, is_two_mass};
use crate::diagnose::fit::WindowFit;
use crate::diagnose::outcome::{Ranked, Step};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::verdict::Errors;

/// The steps that held-out windows prove, and the ranking at each step.
type Climbed = (Vec<Step>, Vec<Vec<Ranked>>);

impl Search<'_> {
    /// The search from the best candidates of the base; from others if the larger part of the error above the
    /// noise floor remains.
    pub(super) fn climb_from_best(&self, base: &WindowFit) -> Climbed {
        let mut climbed = self.climb(base, self.rank(base, true));
        let is_unexplained = |steps: &[Step]| self.is_unexplained(last_of(base, steps));
        let mut unexplained = is_unexplained(&climbed.0);
        // before the verdict "unknown" every effect of the catalogue must have been simulated
        if unexplained && let Some(ranking) = self.with_second_bodies(base, &climbed.1[0]) {
            let again = self.climb(base, ranking);
            let error = |steps: &[Step]| self.shown(last_of(base, steps));
            if error(&again.0) < error(&climbed.0) {
                climbed = again;
                unexplained = is_unexplained(&climbed.0);
            }
        }
        if unexplained
            && self.errors(base, &climbed.0).unexplained() > THRESHOLDS.unexplained
            && let Some(again) = self.other_beginnings(base, &climbed.1[0])
        {
            climbed = again;
        }
        climbed
    }

    /// The reported errors, of the base and after the last of `steps`.
    fn errors(&self, base: &WindowFit, steps: &[Step]) -> Errors {
        let last = last_of(base, steps);
        let square = |fit: &WindowFit| self.shown(fit).powi(2);
        let floor = self.judge.floor(&last.model, &last.p);
        Errors {
            before: square(base),
            after: square(last),
            floor: floor.expected.powi(2),
            most: floor.most.powi(2),
            uncertain: 0.0,
            slow_floor: floor.is_slow(),
            speed: 1.0,
        }
    }

    /// Repeatedly adds the best candidate of a ranking that does not raise the reported error, and ranks anew.
    /// Each ranking is returned with the added effect first.
    fn climb(&self, base: &WindowFit, first: Vec<Ranked>) -> Climbed {
        let mut tried: Vec<(Ranked, Vec<String>)> = Vec::new();
        let mut rankings = vec![first];
        let mut shown = self.shown(base);
        while tried.len() < self.settings.max_effects {
            let ranking = rankings.last_mut().expect("there is one per step");
            // no accepted sequence may contain a step that raises the reported error
            let Some((n, next)) = self.first_that_lowers(ranking, shown) else { break };
            ranking[..=n].rotate_right(1);
            shown = next;
            let best = ranking[0].clone();
            let Some(refit) = best.refit.clone() else { break };
            tried.push((best, equals(ranking)));
            rankings.push(self.rank(&refit, false));
        }
        let steps = self.proven(base, &tried);
        let steps = self.exchanged(base, steps, &rankings);
        (self.pruned(base, steps), rankings)
    }

    /// Index and reported error of the first candidate in the ranking that improves the criterion, has a size, and
    /// whose reported error does not exceed `shown`. The candidate with the best criterion may raise it: if two effects
    /// are missing, a flexible one fits a part of both to the training recordings. One without a size may contain a
    /// simpler effect as a limit (a sliding caster far behind the axle acts as turning scrub), which comes after it: if
    /// the input between the rows leaves its size open, the first later one is taken that has a size and is hardly less
    /// probable.
    fn first_that_lowers(&self, ranking: &[Ranked], shown: f64) -> Option<(usize, f64)> {
        let better = ranking.iter().enumerate().filter(|(_, r)| r.bic < 0.0);
        let fits = better.filter_map(|(n, r)| Some((n, &r.candidate.id, r.refit.as_ref()?)));
        let sized = fits.filter(|(_, id, fit)| has_size(fit, id));
        let errors = sized.map(|(n, id, fit)| (n, id, fit, self.shown(fit)));
        let mut lowering = errors.filter(|(.., error)| *error <= shown);
        let (first, id, fit, error) = lowering.next()?;
        if self.is_sized(fit, id) {
            return Some((first, error));
        }
        let is_about_as_good = |n: usize| {
            let (one, other) = (&ranking[first], &ranking[n]);
            let open = self.open_share(one, other).max(THRESHOLDS.alike);
            other.bic_windows < 0.0 && other.bic - one.bic < open
        };
        let other = lowering
            .filter(|(n, ..)| is_about_as_good(*n))
            .find(|(_, id, fit, _)| self.is_sized(fit, id));
        Some(other.map_or((first, error), |(n, .., error)| (n, error)))
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
            let climbed = self.climb(base, ranking);
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
