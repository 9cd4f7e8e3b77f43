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
    pub(super) fn stands(&self, step: &Step) -> bool {
        let proven = self.passes(&step.last) && self.passes(&step.total);
        proven && self.is_sized(&step.fit, &step.id) && self.judge.acts(&step.fit, &step.id)
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

    /// Root mean square error over windows of 2 s of the recordings in the report; infinite if it cannot be
    /// simulated.
    pub(super) fn shown(&self, fit: &WindowFit) -> f64 {
        let judged = self.judge.judge(&fit.model, &fit.p).map(|j| j.window_rms);
        judged.ok().filter(|rms| rms.is_finite()).unwrap_or(f64::INFINITY)
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
    /// the rate. If the error before is less than what the sampling seems to leave open, the rows contain more than every
    /// other one of them, as those of a controller that answers to each, and half the rate shows nothing.
    pub(super) fn falling(&self, fits: &[&WindowFit], shown: &[f64]) -> usize {
        let Some(last) = fits.last() else { return 0 };
        let sampling = LazyCell::new(|| self.judge.sampling(&last.model, &last.p));
        let falls = |n: &usize| {
            let (before, after) = (shown[n - 1], shown[*n]);
            let (fit, next) = (fits[n - 1], fits[*n]);
            // sampling leaves a time uncertain by half a row, which a shift exceeds; from an infinite error any finite
            // one is a decrease
            let asked = !is_later(fit, next) && before.is_finite();
            let fall = before.powi(2) - after.powi(2);
            let resolved = || {
                let compensates = between_rows(next) > between_rows(fit);
                (fall >= after.powi(2) || fall >= sampling.part_of(after))
                    && (!compensates
                        || sampling.unresolved > before
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
