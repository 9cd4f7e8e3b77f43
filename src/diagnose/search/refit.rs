//! Fits with a candidate added.

use rayon::prelude::*;

use super::Search;
use crate::diagnose::candidate::{Candidate, column_size};
use crate::diagnose::fit::{WindowFit, fit};
use crate::diagnose::input_timing::SYMBOL;
use crate::diagnose::outcome::Ranked;
use crate::diagnose::regression::Regression;
use crate::diagnose::thresholds::THRESHOLDS;
use crate::diagnose::timing::LOGGING;
use crate::diagnose::windows::bounds;
use crate::effects::ParameterKind;
use crate::model::Model;

impl Search<'_> {
    /// Refits a candidate, with its criterion by the windows and its size.
    pub(super) fn set_refit(
        &self,
        present: &WindowFit,
        r: &mut Ranked,
        by_torque: Option<&Regression>,
    ) {
        r.refit = self.refit(present, r, by_torque);
        if let Some(refit) = &r.refit {
            let ratio = self.degrees * (present.cost / refit.cost).ln();
            r.bic_windows = self.bic(&r.candidate, ratio);
            r.torque_rms = self.size(present, r);
        }
    }

    /// The fit with the candidate added; `None` where there is none within its limits.
    pub(super) fn refit(
        &self,
        present: &WindowFit,
        r: &Ranked,
        by_torque: Option<&Regression>,
    ) -> Option<WindowFit> {
        let candidate = &r.candidate;
        let shift = candidate.is_shift();
        let before = if shift { self.untimed(present) } else { present.clone() };
        let model = before.model.add_effect(candidate.effect.clone()).ok()?;
        let mut starts: Vec<Vec<f64>> = vec![self.start(&before, candidate, &r.estimate)];
        // a shape may not lead to another, and a simulation may hang on sticking where the balance of the
        // torques does not
        let several = shift || candidate.effect.several_starts();
        for shape in r.shapes.iter().filter(|_| several) {
            let none = if shift { vec![] } else { vec![0.0; shape.columns()] };
            starts.push(self.start(&before, shape, &none));
        }
        let shapes = if several { r.shapes.as_slice() } else { std::slice::from_ref(candidate) };
        for shape in shapes.iter().filter(|s| !s.linear.is_empty()) {
            let Some((p, own)) = by_torque.and_then(|b| b.start(shape)) else { continue };
            starts.push(self.start(&WindowFit { p, ..before.clone() }, shape, &own));
        }
        let followed = if model.is_coupled() { 1 } else { THRESHOLDS.followed };
        let starts = self.lowest(&model, starts, followed);
        let fits: Vec<WindowFit> = starts
            .par_iter()
            .filter_map(|start| fit(&self.windows, &model, start, &self.scale))
            .collect();
        let best = fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        self.valid(candidate, &best).then_some(best)
    }

    /// Root mean square torque of a candidate at its estimates [N m].
    pub(super) fn size(&self, present: &WindowFit, r: &Ranked) -> f64 {
        let (recordings, motions) = (&self.windows.recordings, &self.windows.motions);
        let sizes = column_size(&r.candidate, &present.model, recordings, motions);
        let squares = r.estimate.iter().zip(&sizes).map(|(e, s)| (e * s).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// The `count` starts of lowest cost.
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
        order.truncate(count);
        order.into_iter().map(|n| starts[n].clone()).collect()
    }

    /// The fit with the input where it was recorded: a shift explains all of the time, or none.
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
            own[0] = estimate.first().copied().unwrap_or(own[0]).max(LOGGING * self.scale.step);
        } else {
            for (value, &j) in estimate.iter().zip(&candidate.linear) {
                own[j] = *value;
            }
        }
        present.p.iter().copied().chain(own).collect()
    }

    /// Whether the parameters of the candidate lie within their limits: at the edge of a shape an effect is
    /// another one, and a shift of less than logging explains is timing.
    fn valid(&self, candidate: &Candidate, fit: &WindowFit) -> bool {
        let first = fit.p.len() - candidate.p.len();
        let specs = candidate.effect.parameters();
        let shape = |j: usize| specs[j].kind == ParameterKind::Shape;
        let inside =
            (0..specs.len()).all(|j| !shape(j) || specs[j].whole || !fit.at_bound[first + j]);
        let errors: Vec<f64> =
            (first..fit.p.len()).map(|j| fit.covariance[(j, j)].sqrt()).collect();
        let inside = inside && candidate.effect.is_itself(&fit.p[first..], &errors);
        let some = candidate.linear.is_empty()
            || candidate.linear.iter().any(|&j| !fit.at_bound[first + j]);
        let error = fit.covariance[(first, first)].sqrt();
        let beyond = fit.p[first] - THRESHOLDS.uncertain * error > LOGGING * self.scale.step;
        let late = !candidate.is_shift() || beyond;
        inside && some && late
    }
}
