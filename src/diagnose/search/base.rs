//! The fit of the model as given, that effects are added to.

use std::sync::Arc;

use super::Search;
use crate::diagnose::fit::{WindowFit, fit, fit_at};
use crate::diagnose::input_timing::{InputTiming, SYMBOL};
use crate::diagnose::thresholds::THRESHOLDS;
use crate::identify::{IdentifyError, NoStart};
use crate::model::Model;

impl Search<'_> {
    /// The model as given with the time of its input, from the start whose fit is lowest, or with the estimates of
    /// another method that predict the held-out recordings better.
    pub(super) fn base(
        &self,
        model: &Model,
        starts: &[Vec<f64>],
    ) -> Result<WindowFit, IdentifyError> {
        let timed = match model.shifts_input() {
            true => model.clone(),
            false => model.add_effect(Arc::new(InputTiming {
                limits: self.range,
                between: self.windows.hold.into(),
            }))?,
        };
        let lowest = |starts: &[Vec<f64>]| {
            let fits = starts.iter().filter_map(|start| {
                let mut start = start.clone();
                start.resize(timed.parameters().len(), 0.0);
                fit(&self.windows, &timed, &start, &self.scale)
            });
            fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
        };
        let none =
            || IdentifyError::NoStart { method: "diagnosis".into(), reason: NoStart::Windows };
        let Some(first) = lowest(starts) else {
            return lowest(&self.settings.estimates)
                .map(|fit| self.or_estimates(fit))
                .ok_or_else(none);
        };
        // at the noise floor no other minimum can be lower
        if !self.is_unexplained(&first) {
            return Ok(first);
        }
        let other = lowest(&self.settings.estimates);
        let lower = other.filter(|other| other.cost < THRESHOLDS.most_left * first.cost);
        Ok(self.or_estimates(lower.unwrap_or(first)))
    }

    /// The fit, or the estimates of another method that predict the held-out recordings better, by the test that an
    /// effect has to pass. Windows of one second determine less than the whole recordings where the model is wrong; an
    /// effect that only undoes an error of the fit must not be called missing. Without held-out recordings, those of
    /// the fit and of the methods are the same, and nothing is exchanged.
    fn or_estimates(&self, base: WindowFit) -> WindowFit {
        if self.held.is_none() {
            return base;
        }
        let others: Vec<WindowFit> =
            self.settings.estimates.iter().filter_map(|p| self.with_time_of(&base, p)).collect();
        let fits: Vec<&WindowFit> = std::iter::once(&base).chain(&others).collect();
        let held_out = self.held_out(&fits);
        let better =
            held_out[1..].iter().filter(|other| self.passes(&self.fall(&held_out[0], other)));
        let best = better.min_by(|a, b| a.shown.total_cmp(&b.shown));
        best.map_or_else(|| base.clone(), |other| other.fit.clone())
    }

    /// The estimates `p` of another method for the model of `base`, with the time of the input that fits them best.
    fn with_time_of(&self, base: &WindowFit, p: &[f64]) -> Option<WindowFit> {
        let model = &base.model;
        let mut start = base.p.clone();
        start.get_mut(..p.len())?.copy_from_slice(p);
        let symbols = model.symbols();
        let others = (0..start.len()).filter(|&j| symbols[j] != SYMBOL);
        let held =
            others.fold(model.clone(), |held, j| held.fix(&symbols[j], start[j]).unwrap_or(held));
        let timed = match held.free().is_empty() {
            true => start,
            false => fit(&self.windows, &held, &start, &self.scale)?.p,
        };
        fit_at(&self.windows, model, &timed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::search::recorded;
    use crate::diagnose::{Data, Settings};
    use crate::model::base::A1;
    use crate::robot::Robot;
    use crate::simulate::Hold;

    #[test]
    fn estimates_that_predict_held_out_recordings_better_replace_the_fit() {
        let model = Model::base(Robot::amigobot());
        let truth = model.initial();
        let [train, validation] = [3, 4].map(|seed| recorded(&model, &truth, seed));
        let data =
            Data { train: &train, validation: &validation, hold: Hold::Linear, corrected_s: 0.0 };
        let with = |estimate: &[f64], held_out: bool, of: &dyn Fn(&Search)| {
            let settings = Settings { estimates: vec![estimate.to_vec()], ..Settings::default() };
            let validation = if held_out { data.validation } else { &[] };
            let data = Data { validation, ..data };
            of(&Search::new(&model, std::slice::from_ref(&truth), &data, &settings).unwrap());
        };
        let mut wrong = truth.clone();
        wrong[A1] *= 1.3;
        let bad_of = |search: &Search| {
            let fitted = search.base(&model, std::slice::from_ref(&truth)).unwrap();
            let mut p = fitted.p.clone();
            p[A1] = wrong[A1];
            (fit_at(&search.windows, &fitted.model, &p).unwrap(), fitted)
        };
        with(&truth, true, &|search| {
            let (bad, _) = bad_of(search);
            assert_eq!(search.or_estimates(bad).p[..truth.len()], truth[..]);
        });
        with(&wrong, true, &|search| {
            let (_, fitted) = bad_of(search);
            assert_eq!(search.or_estimates(fitted.clone()).p, fitted.p);
        });
        // without held-out recordings nothing is exchanged
        with(&truth, false, &|search| {
            let (bad, _) = bad_of(search);
            assert_eq!(search.or_estimates(bad.clone()).p, bad.p);
        });
    }
}
