//! The tried steps: those that held-out windows prove, and the effects that remain.

use std::cell::LazyCell;
use std::sync::OnceLock;

use rayon::prelude::*;

use super::Search;
use crate::diagnose::acceptance::{Fall, fall_of};
use crate::diagnose::fit::{WindowFit, fit, with_sampling};
use crate::diagnose::input_timing::shifts;
use crate::diagnose::outcome::{Ranked, Step};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::windows::Errors;
use crate::effects::{Change, ParameterKind, ParameterSpec};
use crate::math::distribution::t_quantile;
use crate::simulate::Hold;

/// A fit evaluated on held-out recordings.
pub(super) struct HeldOut<'a> {
    pub(super) fit: &'a WindowFit,
    /// The errors of the windows, where they can be simulated.
    errors: Option<Vec<Errors>>,
    /// The reported error [rad/s].
    pub(super) shown: f64,
    /// [`Search::probability_of_logging`], which requires a fit, computed on first use.
    by_logging: OnceLock<f64>,
}

impl Search<'_> {
    /// The errors of held-out windows under models, in order: each fitted to the training recordings, or, without
    /// validation, to the other fold.
    pub(super) fn held_out<'f>(&self, fits: &[&'f WindowFit]) -> Vec<HeldOut<'f>> {
        let one = |fit: &&'f WindowFit| {
            let errors = match &self.held {
                Some(held) => held.errors(&fit.model, &fit.p),
                None => self.crossed(fit),
            };
            HeldOut { fit, errors, shown: self.shown(fit), by_logging: OnceLock::new() }
        };
        fits.par_iter().map(one).collect()
    }

    /// The errors of all training windows, each under the fit to the windows of the other fold.
    fn crossed(&self, whole: &WindowFit) -> Option<Vec<Errors>> {
        let fold = |n: usize| self.windows.fold(n);
        let of = |f: usize| {
            let other = self.windows.only(|n| fold(n) != f);
            let fit = fit(&other, &whole.model, &whole.p, &self.scale)?;
            self.windows.errors(&fit.model, &fit.p)
        };
        let both = of(0)?.into_iter().zip(of(1)?).enumerate();
        Some(both.map(|(n, (first, second))| if fold(n) == 0 { first } else { second }).collect())
    }

    /// The fall from one fit to another: by its mean over the windows, or by the likelihood if the second fit
    /// explains all of the error.
    pub(super) fn fall(&self, before: &HeldOut, after: &HeldOut) -> Fall {
        let (Some(from), Some(to)) = (&before.errors, &after.errors) else { return Fall::NONE };
        let windows = self.held.as_ref().unwrap_or(&self.windows);
        let fall = fall_of(
            &windows.squares_of(from),
            &windows.squares_of(to),
            &windows.contrast(from, to),
        );
        let fall = Fall { later: is_later(before.fit, after.fit), ..fall };
        // the others are evaluated only if the decision depends on them
        if self.passes(&fall) || !self.passes(&Fall { p_value: 0.0, ..fall }) {
            return fall;
        }
        let likelihood = self.explained(before, after);
        let by_logging = || self.probability_of_logging(after.fit);
        let shift = if fall.later { *after.by_logging.get_or_init(by_logging) } else { 1.0 };
        Fall { p_value: fall.p_value.min(likelihood).min(shift), ..fall }
    }

    /// Bound of the p-value from the likelihood ratio of the held-out data; one unless the second fit is at
    /// the noise floor, so that only noise remains. An effect that acts in a few windows only (a warm-up, a
    /// limit that is seldom reached) lowers the error there by a large amount, but the mean over all windows
    /// has a large standard error.
    ///
    /// ```text
    /// p <= L(before)/L(after) = exp(-values (rms_before^2 - rms_after^2)/(2 floor^2))
    /// ```
    /// The bound is Markov's inequality for the likelihood ratio of models that were fitted to other data.
    /// Each wheel counts as one value per window of 2 s, because its errors within a window are correlated;
    /// the noise of the two wheels is independent. With slow noise of the input this does not hold, and the
    /// floor is too uncertain.
    fn explained(&self, before: &HeldOut, after: &HeldOut) -> f64 {
        let (from, to) = (before.shown, after.shown);
        if self.held.is_none() || to >= from {
            return 1.0;
        }
        let floor = self.judge.floor(&after.fit.model, &after.fit.p);
        if floor.is_slow() || to > THRESHOLDS.likely_above_floor * floor.expected {
            return 1.0;
        }
        let floor = floor.expected;
        (-0.5 * self.judge.values() * (from.powi(2) - to.powi(2)) / floor.powi(2)).exp()
    }

    pub(super) fn passes(&self, fall: &Fall) -> bool {
        let rate = self.settings.false_alarm;
        match self.held {
            Some(_) => fall.passes(rate, THRESHOLDS.least_fall),
            None => fall.passes(THRESHOLDS.crossed_rate * rate, THRESHOLDS.least_fall_crossed),
        }
    }

    /// Whether the step and all steps up to it are proven by held-out windows, in which its effect acts, and the effect
    /// differs from zero.
    fn stands(&self, step: &Step) -> bool {
        let proven = self.passes(&step.last) && self.passes(&step.total);
        proven && has_size(&step.fit, &step.id) && self.judge.acts(&step.fit, &step.id)
    }

    /// Whether an effect of a fit [`has_size`], with the standard errors of the report: those of the residuals, and of
    /// a change of a torque also those of the unknown input between the rows.
    pub(super) fn is_sized(&self, fit: &WindowFit, id: &str) -> bool {
        let change = fit.place_of(id).map(|e| fit.model.effects()[e].change());
        let is_shift = change == Some(Change::TimeShift);
        has_size(fit, id) && (is_shift || has_size(&with_sampling(fit.clone(), &self.windows), id))
    }

    /// The longest sequence of tried steps whose last step and whose total are proven, and which never raises
    /// the reported error.
    pub(super) fn proven(&self, base: &WindowFit, tried: &[(Ranked, Vec<String>)]) -> Vec<Step> {
        // without a step no held-out errors of the base, which require fits, are needed
        if tried.is_empty() {
            return vec![];
        }
        let fits: Vec<&WindowFit> = std::iter::once(base)
            .chain(tried.iter().filter_map(|(r, _)| r.refit.as_ref()))
            .collect();
        let held_out = self.held_out(&fits);
        let shown: Vec<f64> = held_out.iter().map(|h| h.shown).collect();
        let falling = self.falling(&fits, &shown);
        let steps: Vec<Step> = tried
            .iter()
            .enumerate()
            .filter_map(|(n, (r, equals))| {
                Some(Step {
                    id: r.candidate.id.clone(),
                    fit: r.refit.clone()?,
                    last: self.fall(&held_out[n], &held_out[n + 1]),
                    total: self.fall(&held_out[0], &held_out[n + 1]),
                    equals: equals.clone(),
                })
            })
            .collect();
        let proven = |n: &usize| *n <= falling && self.stands(&steps[n - 1]);
        let length = (1..=steps.len()).rev().find(proven).unwrap_or(0);
        let run = &steps[..length];
        let shift = tried.get(length).is_some_and(|(r, _)| r.candidate.is_shift());
        if shift && length > 0 && length < falling && self.is_unexplained(&run[length - 1].fit) {
            let turned = self.with_shift_before(base, &steps[..=length]);
            return turned.unwrap_or_else(|| run.to_vec());
        }
        run.to_vec()
    }

    /// Steps whose last one is a lag or delay, with that one placed before the last of the others, if they are
    /// proven in this order. A delay acts only in the few windows in which the input changes, so that the mean over
    /// all windows does not prove it after an effect that acts in each; it is tried only if its own interval proves
    /// it.
    fn with_shift_before(&self, base: &WindowFit, steps: &[Step]) -> Option<Vec<Step>> {
        let mut order = steps.to_vec();
        let last = order.len().checked_sub(1)?;
        order.swap(last.checked_sub(1)?, last);
        let turned = self.rebuilt(base, &order);
        (turned.len() == steps.len() && self.stands(turned.last()?)).then_some(turned)
    }

    /// Root mean square error over windows of 2 s of the recordings in the report; infinite if it cannot be
    /// simulated.
    pub(super) fn shown(&self, fit: &WindowFit) -> f64 {
        let judged = self.judge.judge(&fit.model, &fit.p).map(|j| j.window_rms);
        judged.ok().filter(|rms| rms.is_finite()).unwrap_or(f64::INFINITY)
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
            return self.pruned(base, self.rebuilt(base, &kept));
        }
        steps
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
                next[n] = Step { id: other.candidate.id.clone(), fit, equals: vec![], ..next[n] };
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

    /// Whether the reported error falls from one value to that of `fit` by a relevant share, or to the floor without a
    /// rise.
    pub(super) fn lowers(&self, before: f64, after: f64, fit: &WindowFit) -> bool {
        let share = 1.0 - (after / before).powi(2);
        let relevant = before.is_infinite() || share >= THRESHOLDS.least_fall;
        after <= before && (relevant || !self.is_unexplained(fit))
    }

    /// Number of consecutive steps from the first of `fits` that reduce the reported error `shown`, each by more than
    /// the error due to the sampling of the input.
    ///
    /// ```text
    /// rms_before² - rms_after² >= min(rms_unresolved², rms_after² - noise²)
    /// ```
    /// The error due to the sampling remains after an effect that exists, so it is at most what noise of the speeds
    /// leaves of the remaining error. An effect that only compensates for the sampling would have to remove the larger
    /// part. A shift acts in the few windows in which the input changes: it must only exceed the smallest share. An
    /// effect that [`Change::acts_between_rows`] must also [lower the error alike](Self::is_alike_at_half_rate) at half
    /// the rate. If the error before is less than what the sampling seems to leave open, the rows tell more than every
    /// other one of them, as those of a controller that answers to each, and half the rate shows nothing.
    fn falling(&self, fits: &[&WindowFit], shown: &[f64]) -> usize {
        let Some(last) = fits.last() else { return 0 };
        let open = LazyCell::new(|| self.judge.unresolved(&last.model, &last.p));
        let by_sampling = |after: f64| self.judge.by_sampling(&last.model, &last.p, after);
        let falls = |n: &usize| {
            let (before, after) = (shown[n - 1], shown[*n]);
            let (fit, next) = (fits[n - 1], fits[*n]);
            // sampling leaves a time uncertain by half a row, which a shift exceeds; from an infinite error any finite
            // one is a decrease
            let asked = !is_later(fit, next) && before.is_finite();
            let fall = before.powi(2) - after.powi(2);
            let resolved = || {
                let compensates = between_rows(next) > between_rows(fit);
                (fall >= after.powi(2) || fall >= by_sampling(after))
                    && (!compensates
                        || *open > before
                        || self.is_alike_at_half_rate(fit, next, fall))
            };
            self.lowers(before, after, next) && (!asked || resolved())
        };
        (1..shown.len()).take_while(falls).count()
    }

    /// Whether the squared reported error of one fit exceeds that of the other with every other row of the input by
    /// about as much as with all rows, `fall` [rad^2/s^2]. What compensates for an error of interpolation removes four
    /// times as much or more at half the rate, as the error is larger by that factor, or raises it. An input that is
    /// held has no such error.
    fn is_alike_at_half_rate(&self, before: &WindowFit, after: &WindowFit, fall: f64) -> bool {
        if self.windows.hold == Hold::Constant {
            return true;
        }
        let error = |fit: &WindowFit| self.judge.at_half_rate(&fit.model, &fit.p);
        let halved = error(before).zip(error(after)).map(|(before, after)| before - after);
        let most = THRESHOLDS.alike_at_half_rate;
        halved.is_some_and(|halved| (fall / most..=fall * most).contains(&halved))
    }

    /// Adds the held-out falls to the refitted candidates.
    pub(super) fn with_falls(&self, before: &WindowFit, mut ranking: Vec<Ranked>) -> Vec<Ranked> {
        let refits: Vec<&WindowFit> = std::iter::once(before)
            .chain(ranking.iter().filter_map(|r| r.refit.as_ref()))
            .collect();
        let held_out = self.held_out(&refits);
        let falls: Vec<Fall> =
            held_out[1..].par_iter().map(|after| self.fall(&held_out[0], after)).collect();
        let refitted = ranking.iter_mut().filter(|r| r.refit.is_some());
        refitted.zip(falls).for_each(|(r, fall)| r.fall = Some(fall));
        ranking
    }
}

/// How many effects of a fit may compensate for the unknown input between its rows.
fn between_rows(fit: &WindowFit) -> usize {
    fit.model.effects().iter().filter(|effect| effect.change().acts_between_rows()).count()
}

/// Whether one fit has an effect that delays the input and the other does not.
fn is_later(before: &WindowFit, after: &WindowFit) -> bool {
    shifts(&after.model).count() > shifts(&before.model).count()
}

/// Whether a linear parameter of an effect, the time of a shift, or a shape of an effect without linear parameters
/// differs from zero, by its 95 % interval: an effect that the training recordings do not show may lower the held-out
/// error by accident. Recordings with fewer windows than parameters do not give the error of a time.
pub(super) fn has_size(fit: &WindowFit, id: &str) -> bool {
    let Some(e) = fit.place_of(id) else { return false };
    let (effect, slots) = (&fit.model.effects()[e], fit.model.slots(e));
    let quantile = t_quantile(0.975, fit.degrees());
    let is_sized = |j: usize| fit.p[j].abs() > quantile * fit.covariance[(j, j)].sqrt();
    if effect.change() == Change::TimeShift {
        return fit.is_short() || is_sized(slots.start + effect.time());
    }
    let specs = effect.parameters();
    let of_kind =
        |(j, spec): (usize, &ParameterSpec)| (spec.kind == ParameterKind::Linear).then_some(j);
    let linear: Vec<usize> = slots.clone().zip(&specs).filter_map(of_kind).collect();
    if linear.is_empty() {
        // the error of a shape at its limit is not known
        let is_zero = |j: usize| fit.covariance[(j, j)].is_finite() && !is_sized(j);
        return !slots.into_iter().all(is_zero);
    }
    linear.into_iter().any(is_sized)
}
