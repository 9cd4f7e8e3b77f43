//! Steps in another order, with fewer effects, or with another effect in the place of one.

use super::Search;
use super::steps::has_size;
use crate::diagnose::fit::{WindowFit, fit};
use crate::diagnose::outcome::{Ranked, Step};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::effects::{Change, Description};

impl Search<'_> {
    /// Steps whose last one is a lag or delay, with that one placed before the last of the others, if they are
    /// proven in this order. A delay acts only in the few windows in which the input changes, so that the mean over
    /// all windows does not prove it after an effect that acts in each; it is tried only if its own interval proves
    /// it.
    pub(super) fn with_shift_before(&self, base: &WindowFit, steps: &[Step]) -> Option<Vec<Step>> {
        let mut order = steps.to_vec();
        let last = order.len().checked_sub(1)?;
        order.swap(last.checked_sub(1)?, last);
        let turned = self.rebuilt(base, &order);
        (turned.len() == steps.len() && self.stands(turned.last()?)).then_some(turned)
    }

    /// Removes effects that later ones made unnecessary: the criterion is lower without them, or their size
    /// may be zero.
    pub(super) fn pruned(&self, base: &WindowFit, steps: Vec<Step>) -> Vec<Step> {
        let given = base.model.effects().len();
        let Some(last) = steps.last() else { return steps };
        for n in 0..steps.len().saturating_sub(1) {
            let e = given + n;
            let slots = last.fit.model.slots(e);
            let (model, p) = last.fit.without(e);
            let Some(without) = fit(&self.windows, &model, &p, &self.scale) else { continue };
            let ratio = self.ratio(&without, &last.fit);
            if ratio > slots.len() as f64 * self.degrees.ln() && has_size(&last.fit, &steps[n].id) {
                continue;
            }
            let mut kept = steps.clone();
            kept.remove(n);
            return self.pruned(base, self.rebuilt_in_some_order(base, &kept));
        }
        steps
    }

    /// The same steps fitted anew, in the first of their orders in which all are proven, else in theirs: an effect that
    /// acts at low speeds only lowers the error after one that acts at all speeds, not before.
    fn rebuilt_in_some_order(&self, base: &WindowFit, steps: &[Step]) -> Vec<Step> {
        let given = self.rebuilt(base, steps);
        if given.len() == steps.len() {
            return given;
        }
        let others = orders(steps.len()).into_iter().skip(1);
        let mut rebuilt = others.map(|order| {
            let order: Vec<Step> = order.into_iter().map(|n| steps[n].clone()).collect();
            self.rebuilt(base, &order)
        });
        let proven = |r: &Vec<Step>| r.len() == steps.len() && r.iter().all(|s| self.stands(s));
        rebuilt.find(proven).unwrap_or(given)
    }

    /// Replaces each effect at most once by another of its step that lowers the criterion: if several effects
    /// are missing, the first one added also explains a part of the others and may be a wrong one. The result
    /// must be proven like the steps before, and must not raise the reported error.
    ///
    /// Source: sequential replacement, Miller, Subset Selection in Regression (2002), section 3.3.
    pub(super) fn exchanged(
        &self,
        base: &WindowFit,
        steps: Vec<Step>,
        rankings: &[Vec<Ranked>],
    ) -> Vec<Step> {
        if steps.len() < 2 {
            return steps;
        }
        let mut best = steps.clone();
        for n in 0..steps.len() {
            let taken = |id: &str| best.iter().any(|s| s.id == id);
            let others: Vec<&Ranked> = rankings[n]
                .iter()
                .filter(|r| r.refit.is_some() && r.bic < 0.0 && !taken(&r.candidate.id))
                .take(THRESHOLDS.exchanged)
                .collect();
            for other in others {
                let mut next = best.clone();
                let Some(fit) = other.refit.clone() else { continue };
                let Description { id, equivalent, .. } = other.candidate.effect.description();
                next[n] = Step { id, fit, equals: equivalent, ..next[n] };
                let next = self.rebuilt(base, &next);
                let (Some(now), Some(then)) = (best.last(), next.last()) else { continue };
                let more = then.fit.p.len() as f64 - now.fit.p.len() as f64;
                let gain = self.ratio(&now.fit, &then.fit) - more * self.degrees.ln();
                let lower = self.shown(&then.fit) <= self.shown(&now.fit);
                let better = gain > THRESHOLDS.alike && lower;
                // near the noise the criterion decides
                let sure =
                    || !self.is_far(then.fit.cost) || self.is_distinguished(&now.fit, &then.fit);
                if next.len() == steps.len() && better && sure() && self.stands(then) {
                    best = next;
                }
            }
        }
        best
    }

    /// The same steps fitted anew in their order, with their falls.
    fn rebuilt(&self, base: &WindowFit, steps: &[Step]) -> Vec<Step> {
        let mut out: Vec<Step> = Vec::new();
        let mut fits = vec![base.clone()];
        let first = &self.held_out(&[base])[0];
        let mut shown = vec![first.shown];
        for step in steps {
            let before = fits.last().expect("the base is there");
            let Some(e) = step.fit.place_of(&step.id) else { break };
            let effect = step.fit.model.effects()[e].clone();
            let shift = effect.change() == Change::TimeShift;
            let before = if shift { self.untimed(before) } else { before.clone() };
            let own = step.fit.p[step.fit.model.slots(e)].to_vec();
            let Ok(model) = before.model.add_effect(effect) else { break };
            let start: Vec<f64> = before.p.iter().copied().chain(own).collect();
            let Some(next) = fit(&self.windows, &model, &start, &self.scale) else { break };
            let next = self.released(next);
            let held_out = self.held_out(&[&before, &next]);
            out.push(Step {
                fit: next.clone(),
                last: self.fall(&held_out[0], &held_out[1]),
                total: self.fall(first, &held_out[1]),
                ..step.clone()
            });
            shown.push(held_out[1].shown);
            fits.push(next);
        }
        out.truncate(self.falling(&fits.iter().collect::<Vec<_>>(), &shown));
        out
    }
}

/// All orders of so many places, their own first.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let longer = |orders: Vec<Vec<usize>>, _| {
        let next = |order: &Vec<usize>| {
            let left: Vec<usize> = (0..count).filter(|n| !order.contains(n)).collect();
            let with = |n: usize| order.iter().copied().chain([n]).collect::<Vec<_>>();
            left.into_iter().map(with).collect::<Vec<_>>()
        };
        orders.iter().flat_map(next).collect()
    };
    (0..count).fold(vec![vec![]], longer)
}

#[cfg(test)]
mod tests {
    use super::orders;

    #[test]
    fn there_are_as_many_orders_as_permutations_and_their_own_is_first() {
        for (count, all) in [(0, 1), (1, 1), (2, 2), (3, 6)] {
            let mut found = orders(count);
            assert_eq!(found[0], (0..count).collect::<Vec<_>>());
            found.sort();
            found.dedup();
            assert_eq!(found.len(), all);
        }
    }
}
