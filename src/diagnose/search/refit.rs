//! Fits with a candidate added.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

use super::{Criteria, Search};
use crate::diagnose::candidate::{Candidate, Form, column_size};
use crate::diagnose::fit::{WindowFit, fit, fit_within};
use crate::diagnose::input_timing::SYMBOL;
use crate::diagnose::outcome::Ranked;
use crate::diagnose::regression::Regression;
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::whole::{followed, over_whole_numbers, whole_numbers};
use crate::diagnose::windows::bounds;
use crate::effects::ParameterKind;
use crate::identify::{Task, start::start};
use crate::model::Model;

impl Search<'_> {
    /// Refits the candidates at the places `wanted`, with their criterion by the windows and their size: the first of
    /// them to convergence, the others until their steps gain little compared with it, and to convergence if they
    /// come near the best. Those whose parameters leave their limits have no refit.
    pub(super) fn refit_all(
        &self,
        present: &WindowFit,
        ranked: &mut [Ranked],
        wanted: &[usize],
        criteria: Option<&[Criteria; 2]>,
    ) {
        let Some((lead, others)) = wanted.split_first() else { return };
        let done = AtomicUsize::new(0);
        let refit = |r: &mut Ranked, negligible: f64| {
            let own = criteria.map(|criteria| &criteria[usize::from(r.candidate.is_shift())]);
            let by_torque = own.and_then(|(by_torque, _)| by_torque.as_ref());
            r.refit = self.refit(present, r, by_torque, negligible);
            let done = done.fetch_add(1, Relaxed) + 1;
            self.settings.progress.iter().for_each(|report| report(done, wanted.len()));
        };
        refit(&mut ranked[*lead], 0.0);
        let gain = |cost: f64| (present.cost - cost).max(0.0);
        let of_lead = ranked[*lead].refit.as_ref().map_or(0.0, |fit| gain(fit.cost));
        let negligible = THRESHOLDS.negligible_share * of_lead;
        of(ranked, others).for_each(|r| refit(r, negligible));

        let within = |r: &Ranked, fit: &WindowFit| self.valid(&r.candidate, fit);
        let fits = || ranked.iter().filter_map(|r| Some((r, r.refit.as_ref()?)));
        let costs = fits().filter(|(r, fit)| within(r, fit)).map(|(_, fit)| fit.cost);
        let least = costs.fold(f64::INFINITY, f64::min);
        let near = |fit: &WindowFit| fit.cost - least < THRESHOLDS.near_share * gain(least);
        of(ranked, wanted).for_each(|r| {
            let Some(mut found) = r.refit.take() else { return };
            if negligible > 0.0 && near(&found) {
                let end = fit(&self.windows, &found.model, &found.p, &self.scale);
                found = end.unwrap_or(found);
            }
            r.refit = (within(r, &found) && self.is_driven(present, r, &found)).then_some(found);
            let is_noise = !self.is_far_above(r);
            if let Some(refit) = &r.refit {
                let ratio = self.ratio(present, refit);
                let by_time = if is_noise { self.ratio_of_shift(&r.candidate, refit) } else { 0.0 };
                let ratio = ratio.max(by_time);
                r.bic_windows = self.bic(&r.candidate, ratio);
                r.torque_rms = self.size(present, r);
            }
        });
    }

    /// Ratio of a shift of the input to its standard error, zero for other effects.
    ///
    /// ```text
    /// z² = ((T - T_l)/se)²,   T_l: what logging explains,   se from the scores of the windows
    /// ```
    /// Near the floor the error of a window is mostly integrated noise of the input. A shift acts in the few
    /// rows in which the input changes; its effect on the cost is therefore hidden, but not its effect on the
    /// scores.
    ///
    /// Source: Wald's test with the covariance of White, Econometrica 50 (1982).
    fn ratio_of_shift(&self, candidate: &Candidate, fit: &WindowFit) -> f64 {
        if !candidate.is_shift() {
            return 0.0;
        }
        let j = fit.p.len() - candidate.p.len() + candidate.effect.time();
        let beyond = (fit.p[j] - self.scale.logging).max(0.0);
        let variance = fit.covariance[(j, j)];
        if variance > 0.0 { beyond.powi(2) / variance } else { 0.0 }
    }

    /// The fit with the candidate added.
    fn refit(
        &self,
        present: &WindowFit,
        r: &Ranked,
        by_torque: Option<&Regression>,
        negligible: f64,
    ) -> Option<WindowFit> {
        let candidate = &r.candidate;
        let shift = candidate.is_shift();
        let before = if shift { self.untimed(present) } else { present.clone() };
        let model = before.model.add_effect(candidate.effect.clone()).ok()?;
        let mut starts: Vec<Vec<f64>> = vec![self.start(&before, candidate, &r.estimate)];
        // a descent may not leave its initial shape, and a simulation may stick at rest where the torque
        // balance does not
        let several = shift || candidate.effect.several_starts();
        for shape in r.shapes.iter().filter(|_| several) {
            let none = if shift { vec![] } else { vec![0.0; shape.columns()] };
            starts.push(self.start(&before, shape, &none));
        }
        if candidate.is_of_input() && self.is_far(present.cost) {
            starts.extend(r.shapes.iter().filter_map(|shape| self.anew(&model, shape)));
        }
        let shapes = if several { r.shapes.as_slice() } else { std::slice::from_ref(candidate) };
        for shape in shapes.iter().filter(|s| !s.linear.is_empty()) {
            let Some((p, own)) = by_torque.and_then(|b| b.start(shape)) else { continue };
            starts.push(self.start(&WindowFit { p, ..before.clone() }, shape, &own));
        }
        // a single minimum: start from the better of two initial values
        let followed = if several && !model.is_coupled() { THRESHOLDS.followed } else { 1 };
        let starts = self.lowest(&model, starts, followed);
        let fits: Vec<WindowFit> = starts
            .par_iter()
            .filter_map(|start| fit_within(&self.windows, &model, start, &self.scale, negligible))
            .collect();
        let best = fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let e = model.effects().len() - 1;
        Some(over_whole_numbers(&self.windows, best, e, &self.scale, negligible))
    }

    /// Initial values estimated with the input changed by `shape`: in a fit without it the other parameters compensate
    /// for it (a long lag and a limit of the torque resemble inertia), and a descent from there ends in another
    /// minimum.
    fn anew(&self, model: &Model, shape: &Candidate) -> Option<Vec<f64>> {
        let first = model.parameters().len() - shape.p.len();
        let own = shape.p.iter().enumerate();
        let model = own.fold(model.clone(), |m, (n, value)| m.starting_at(first + n, *value));
        let task = Task { model: &model, train: self.train, hold: self.windows.hold, seed: 0 };
        start(&task, "start").ok()
    }

    /// Root mean square torque of a candidate at its estimates [N m].
    pub(super) fn size(&self, present: &WindowFit, r: &Ranked) -> f64 {
        self.size_at(present, r, &r.estimate)
    }

    /// The same at other values of its columns.
    fn size_at(&self, present: &WindowFit, r: &Ranked, values: &[f64]) -> f64 {
        let sizes = column_size(&r.candidate, &present.model, &self.windows.recordings);
        let squares = values.iter().zip(&sizes).map(|(e, s)| (e * s).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Whether the torque of a refitted candidate is no larger (rms) than the largest input of the recordings. A larger
    /// one is cancelled by another term of the model, from which the recordings do not distinguish it: an offset
    /// by friction or back-EMF where the robot kept to one speed.
    fn is_driven(&self, present: &WindowFit, r: &Ranked, fit: &WindowFit) -> bool {
        if !matches!(r.candidate.form, Form::Instant) {
            return true;
        }
        let first = fit.p.len() - r.candidate.p.len();
        let own: Vec<f64> = r.candidate.linear.iter().map(|&j| fit.p[first + j]).collect();
        self.size_at(present, r, &own) <= self.scale.torque_quantile(1.0)
    }

    /// The `count` starts with the lowest cost; of every whole number of the last effect the best comes first.
    fn lowest(&self, model: &Model, starts: Vec<Vec<f64>>, count: usize) -> Vec<Vec<f64>> {
        if starts.len() <= count {
            return starts;
        }
        let free = model.free();
        let [lower, upper] = bounds(model, &self.scale, &free);
        let cost = |p: &Vec<f64>| {
            let mut p = p.clone();
            for (n, &j) in free.iter().enumerate() {
                p[j] = p[j].clamp(lower[n], upper[n]);
            }
            self.windows.cost(model, &p).unwrap_or(f64::INFINITY)
        };
        let costs: Vec<f64> = starts.par_iter().map(cost).collect();
        let mut order: Vec<usize> = (0..starts.len()).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        let last = model.effects().len() - 1;
        let order = followed(order, count, |n| whole_numbers(model, last, &starts[*n]));
        order.into_iter().map(|n| starts[n].clone()).collect()
    }

    /// The fit with the input at its recorded time: a lag or delay explains all of the shift, or
    /// none.
    pub(super) fn untimed(&self, present: &WindowFit) -> WindowFit {
        let recorded = -self.corrected;
        let Ok(j) = present.model.index_of(SYMBOL) else { return present.clone() };
        let Ok(model) = present.model.fix(SYMBOL, recorded) else { return present.clone() };
        let mut p = present.p.clone();
        p[j] = recorded;
        WindowFit { model, p, ..present.clone() }
    }

    pub(super) fn start(
        &self,
        present: &WindowFit,
        candidate: &Candidate,
        estimate: &[f64],
    ) -> Vec<f64> {
        let mut own = candidate.p.clone();
        if candidate.is_shift() {
            let time = &mut own[candidate.effect.time()];
            *time = estimate.first().copied().unwrap_or(*time).max(self.scale.logging);
        } else {
            for (value, &j) in estimate.iter().zip(&candidate.linear) {
                own[j] = *value;
            }
        }
        present.p.iter().copied().chain(own).collect()
    }

    /// Whether the parameters of the candidate lie within their limits: at the bound of a shape an effect
    /// degenerates to another one, and a shift of less than logging explains is timing.
    fn valid(&self, candidate: &Candidate, fit: &WindowFit) -> bool {
        let first = fit.p.len() - candidate.p.len();
        let specs = candidate.effect.parameters();
        let shape = |j: usize| specs[j].kind == ParameterKind::Shape;
        let inside =
            (0..specs.len()).all(|j| !shape(j) || specs[j].whole || !fit.at_bound[first + j]);
        let errors: Vec<f64> =
            (first..fit.p.len()).map(|j| fit.covariance[(j, j)].sqrt()).collect();
        let inside =
            inside && candidate.effect.is_itself(&fit.p[first..], &errors, fit.model.robot());
        let some = candidate.linear.is_empty()
            || candidate.linear.iter().any(|&j| !fit.at_bound[first + j]);
        inside && some && (!candidate.is_shift() || self.is_late(candidate, fit))
    }

    /// Whether the time of a shift significantly exceeds what logging explains; recordings with fewer windows than
    /// parameters do not determine its error.
    fn is_late(&self, candidate: &Candidate, fit: &WindowFit) -> bool {
        let j = fit.p.len() - candidate.p.len() + candidate.effect.time();
        let (beyond, error) = (fit.p[j] - self.scale.logging, fit.covariance[(j, j)].sqrt());
        let significant = fit.is_short() || beyond > THRESHOLDS.uncertain * error;
        significant && beyond > THRESHOLDS.least_shift * self.scale.step
    }
}

/// The candidates at `places`, in parallel.
fn of<'a>(
    ranked: &'a mut [Ranked],
    places: &'a [usize],
) -> impl ParallelIterator<Item = &'a mut Ranked> {
    let all = ranked.par_iter_mut().enumerate();
    all.filter(|(n, _)| places.contains(n)).map(|(_, r)| r)
}
