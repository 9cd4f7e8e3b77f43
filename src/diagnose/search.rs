//! The forward search: which effects are missing, and how many of them are proven.

mod base;
mod climb;
mod order;
mod rebuild;
mod refit;
mod release;
mod shifts;
mod starts;
mod steps;

use std::sync::Arc;

use rayon::prelude::*;

pub use self::starts::{StartAngle, start_angles};
use super::candidate::Candidate;
use super::candidates::candidates;
use super::fit::{WindowFit, with_sampling};
use super::input_timing::SYMBOL;
use super::judge::Judge;
use super::outcome::{Diagnosis, Ranked, Step};
use super::regression::{Buffers, Regression};
use super::scale::scale_of;
use super::screen::Screen;
use super::smoothed::Smoothed;
use super::thresholds::THRESHOLDS;
use super::windows::Windows;
use crate::effects::{Change, Effect, Scale};
use crate::identify::IdentifyError;
use crate::math::median_high;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::Hold;

/// Called with the number of candidates fitted so far in a round, and their total. The number of rounds
/// depends on the result.
pub type Progress = Arc<dyn Fn(usize, usize) + Send + Sync>;

/// Settings of the diagnosis.
#[derive(Clone)]
pub struct Settings {
    /// Ids of the candidates; empty: all.
    pub candidates: Vec<String>,
    /// Candidates beside the catalogue: formulas of the user.
    pub own: Vec<Arc<dyn Effect>>,
    /// Level of the test of each effect on held-out data.
    pub false_alarm: f64,
    /// Largest number of effects that are added.
    pub max_effects: usize,
    /// Estimates of the model as given by other methods, one value per parameter. A fit from one of them replaces
    /// those from the starts if it has less than half of their squared error: it is then in another minimum. One that
    /// predicts the held-out recordings better, by the test of an effect, replaces the fit of the model as given.
    pub estimates: Vec<Vec<f64>>,
    /// Symbols of parameters that the model fixes because its fit does not determine them; they are estimated again
    /// with each effect that is added.
    pub held: Vec<String>,
    /// Called as candidates are fitted.
    pub progress: Option<Progress>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            candidates: vec![],
            own: vec![],
            false_alarm: 0.05,
            max_effects: 3,
            estimates: vec![],
            held: vec![],
            progress: None,
        }
    }
}

/// The recordings of a diagnosis.
#[derive(Clone, Copy)]
pub struct Data<'a> {
    /// Those that models are fitted to.
    pub train: &'a [Recording],
    /// Those that are held out; may be empty.
    pub validation: &'a [Recording],
    /// The input between the rows.
    pub hold: Hold,
    /// Shift of the input that is already applied, [`super::timing`] \[s\].
    pub corrected_s: f64,
}

/// Searches for the effects that are missing from `model`: screening, refits, addition of the best effect,
/// repeated. The result is the longest sequence of steps that is proven by the held-out error.
///
/// A step is proven if it and all steps up to it together each reduce the held-out error significantly at
/// `settings.false_alarm` and by a relevant share, and if no step raises the reported error.
///
/// # Errors
/// If the model as given cannot be simulated from any start.
pub fn diagnose(
    model: &Model,
    starts: &[Vec<f64>],
    data: &Data,
    settings: &Settings,
) -> Result<Diagnosis, IdentifyError> {
    let search = Search::new(model, starts, data, settings)?;
    let base = search.base(model, starts)?;
    let (steps, rankings) = search.climb_from_best(&base);
    let mut ranking = search.with_falls(&base, rankings[0].clone());
    // that of a step was compared when its first was added
    if rankings.len() == 1 {
        search.compare_with_first(&mut ranking);
    }
    // the remaining candidates were ranked together with the steps that were tried, which others may have
    // replaced
    let tried = |s: &Step| rankings[..steps.len()].iter().any(|r| r[0].candidate.id == s.id);
    let rest = match steps.last() {
        // without effects the first ranking is that of the remaining candidates
        None => ranking.clone(),
        Some(last) => {
            let rest = match rankings.get(steps.len()) {
                _ if !steps.iter().all(tried) => search.rank(&last.fit, false),
                ranking => ranking.cloned().unwrap_or_default(),
            };
            search.with_falls(&last.fit, rest)
        }
    };
    let validated = search.held.is_some();
    let tested = search.held.as_ref().unwrap_or(&search.windows).windows.len();
    let widened = |fit: WindowFit| with_sampling(fit, &search.windows);
    let taken: Vec<String> = steps.iter().map(|step| step.id.clone()).collect();
    let finished = |step: Step| {
        // an effect that is found too is no alternative
        let equals = step.equals.into_iter().filter(|id| !taken.contains(id)).collect();
        Step { fit: widened(step.fit), equals, ..step }
    };
    let steps = steps.into_iter().map(finished).collect();
    Ok(Diagnosis { base: widened(base), ranking, steps, rest, validated, tested })
}

struct Search<'a> {
    train: &'a [Recording],
    windows: Windows<'a>,
    /// Windows of the validation recordings, with the evaluation of the reported error.
    held: Option<Windows<'a>>,
    judge: Judge,
    settings: &'a Settings,
    /// The training recordings after the low-pass of the screening.
    smoothed: Smoothed<'a>,
    degrees: f64,
    scale: Scale,
    /// Shifts of the input that logging explains \[s\].
    range: (f64, f64),
    /// Shift of the input that is already applied \[s\].
    corrected: f64,
}

impl<'a> Search<'a> {
    fn new(
        model: &Model,
        starts: &[Vec<f64>],
        data: &Data<'a>,
        settings: &'a Settings,
    ) -> Result<Self, IdentifyError> {
        let train: Vec<&Recording> = data.train.iter().collect();
        let start = starts.first().cloned().unwrap_or_else(|| model.initial());
        let scale = scale_of(model, &start, &train);
        let smoothed = Smoothed::new(&train, scale.bandwidth);
        let windows = Windows::weighted(train, data.hold, model, &start);
        let validation: Vec<&Recording> = data.validation.iter().collect();
        let held = (!validation.is_empty())
            .then(|| Windows::weighted(validation, data.hold, model, &start));
        let judged = if data.validation.is_empty() { data.train } else { data.validation };
        let judge = Judge::new(judged.to_vec(), data.hold);
        let corrected = data.corrected_s;
        let range = (THRESHOLDS.earliest * scale.step - corrected, scale.logging - corrected);
        let degrees = 0.0;
        let this = Self {
            train: data.train,
            windows,
            held,
            judge,
            settings,
            smoothed,
            degrees,
            scale,
            range,
            corrected,
        };
        Ok(this.with_degrees(model, &start))
    }

    fn with_degrees(mut self, model: &Model, start: &[f64]) -> Self {
        let regression = Regression::new(model, start, &self.smoothed, self.scale.speed);
        let rows: usize = self.windows.recordings.iter().map(|r| r.len()).sum();
        // without a regression every row of a window counts as one at the cut-off
        let fallback = rows as f64 * 2.0 * self.smoothed.cutoff * self.scale.step;
        self.degrees = regression.map_or(fallback, |r| r.degrees).max(10.0);
        self
    }

    /// Screens all candidates, refits the best, and ranks them.
    fn rank(&self, present: &WindowFit, is_base: bool) -> Vec<Ranked> {
        // the shift of the input, a nuisance parameter, is fixed while lags and delays are screened,
        // because it is equivalent to them
        let held = held_in_time(present);
        let of = |model| self.criteria(model, &present.p);
        let criteria = rayon::join(|| of(&present.model), || of(&held)).into();
        let mut ranked = self.screened(present, &criteria);
        ranked.sort_by(|a, b| a.screened.total_cmp(&b.screened));
        let (first, second) = self.wanted(present, &ranked);
        self.refit_all(present, &mut ranked, &first, Some(&criteria));
        let refits = || ranked.iter().filter_map(|r| Some((r, r.refit.as_ref()?.cost)));
        let most_is_left = |cost: f64| cost > THRESHOLDS.most_left * present.cost;
        let widens = is_base || present.model.is_coupled();
        if widens && refits().all(|(r, cost)| self.is_far_above(r) && most_is_left(cost)) {
            self.refit_all(present, &mut ranked, &second, Some(&criteria));
        }
        self.order(present, &mut ranked);
        ranked
    }

    /// The two tests of the screening, on the residuals of `model` at `p`.
    fn criteria<'b>(&'b self, model: &'b Model, p: &'b [f64]) -> Criteria<'b> {
        let by_torque = Regression::new(model, p, &self.smoothed, self.scale.speed);
        (by_torque, Screen::new(model, p, &self.windows, self.degrees))
    }

    /// The indices of the candidates to be refitted, and of those to be refitted if none of the first
    /// explains the larger part of an error far above the noise: effects with a second body, whose fit is ten
    /// times as expensive and to which the screening is insensitive if the base fit has absorbed them; if the
    /// model already has a second body, where every fit is as expensive, those that follow in the screening.
    fn wanted(&self, present: &WindowFit, ranked: &[Ranked]) -> (Vec<usize>, Vec<usize>) {
        let coupled = present.model.is_coupled();
        let count = if coupled { THRESHOLDS.refitted_coupled } else { THRESHOLDS.refitted };
        let lead = ranked.first().map_or(0.0, |r| r.screened.min(0.0));
        let chosen = |n: usize, r: &Ranked| {
            // candidates that the first-order screening cannot assess are always refitted, unless the
            // regression rules them out
            let blind = r.candidate.effect.several_starts() && !is_two_mass(r);
            let open = self.bic(&r.candidate, r.by_regression) < THRESHOLDS.ruled_out;
            let behind = is_two_mass(r) && r.screened > THRESHOLDS.far_behind * lead;
            (n < count || blind && !coupled && open) && !behind
        };
        let places = 0..ranked.len();
        let first: Vec<usize> = places.clone().filter(|&n| chosen(n, &ranked[n])).collect();
        let is_next =
            |n: usize| if coupled { n < THRESHOLDS.refitted } else { is_two_mass(&ranked[n]) };
        let second = places.filter(|n| is_next(*n) && !first.contains(n)).collect();
        (first, second)
    }

    /// Every candidate at its best shape.
    fn screened(&self, present: &WindowFit, criteria: &[Criteria; 2]) -> Vec<Ranked> {
        let recordings = &self.windows.recordings;
        let all = candidates(
            &present.model,
            &present.p,
            &self.settings.candidates,
            &self.settings.own,
            recordings,
            &self.scale,
        );
        let mut looked: Vec<Ranked> = all
            .into_par_iter()
            .map_init(Buffers::default, |buffer, candidate| {
                let (regression, screen) = &criteria[usize::from(candidate.is_shift())];
                let (by_regression, first) =
                    regression.as_ref().map_or((0.0, vec![]), |r| r.ratio(&candidate, buffer));
                let (by_windows, second) =
                    screen.as_ref().map_or((0.0, vec![]), |s| s.ratio(&candidate));
                let estimate = if by_windows > 0.0 { second } else { first };
                let screened =
                    self.bic(&candidate, by_regression) + self.bic(&candidate, by_windows);
                Ranked {
                    candidate,
                    shapes: vec![],
                    by_regression,
                    by_windows,
                    estimate,
                    screened,
                    torque_rms: f64::NAN,
                    refit: None,
                    bic_windows: f64::INFINITY,
                    bic: f64::INFINITY,
                    fall: None,
                }
            })
            .collect();
        self.level_grids(&mut looked);
        best_shapes(looked)
    }

    /// Divides the likelihood ratios of an effect with many orders and several columns by their median:
    /// coloured errors raise all orders alike, and the maximum over many orders would otherwise be
    /// selected by chance. Shapes that are not whole numbers are correlated, and all of them respond to
    /// the effect.
    fn level_grids(&self, looked: &mut [Ranked]) {
        let mut ids: Vec<String> = looked.iter().map(|r| r.candidate.id.clone()).collect();
        ids.dedup();
        for id in ids {
            let own: Vec<usize> =
                (0..looked.len()).filter(|&n| looked[n].candidate.id == id).collect();
            let first = own.first().map(|&n| &looked[n].candidate);
            let columns = first.map_or(0, Candidate::columns);
            if !first.is_some_and(Candidate::is_of_orders)
                || own.len() < THRESHOLDS.many_orders
                || columns < 2
            {
                continue;
            }
            let expected = crate::math::distribution::chi2_quantile(0.5, columns as f64);
            let median = |value: &dyn Fn(&Ranked) -> f64| {
                (median_high(own.iter().map(|&n| value(&looked[n]))) / expected).max(1.0)
            };
            let by = (median(&|r| r.by_regression), median(&|r| r.by_windows));
            for n in own {
                let r = &mut looked[n];
                r.by_regression /= by.0;
                r.by_windows /= by.1;
                r.screened =
                    self.bic(&r.candidate, r.by_regression) + self.bic(&r.candidate, r.by_windows);
            }
        }
    }

    /// Twice the log-likelihood ratio of a fit to another one, by their costs.
    fn ratio(&self, from: &WindowFit, to: &WindowFit) -> f64 {
        self.degrees * (from.cost / to.cost).ln()
    }

    /// Bayesian information criterion of a candidate with that ratio; the penalty is ln n for every
    /// parameter, including shapes.
    fn bic(&self, candidate: &Candidate, ratio: f64) -> f64 {
        candidate.parameters() as f64 * self.degrees.ln() - ratio
    }
}

/// Every effect once, at the shape with the best criterion, with all of its shapes.
fn best_shapes(looked: Vec<Ranked>) -> Vec<Ranked> {
    let mut best: Vec<Ranked> = Vec::new();
    for mut one in looked {
        match best.iter_mut().find(|b| b.candidate.id == one.candidate.id) {
            Some(b) => {
                b.shapes.push(one.candidate.clone());
                if one.screened < b.screened {
                    one.shapes = std::mem::take(&mut b.shapes);
                    *b = one;
                }
            }
            None => {
                one.shapes.push(one.candidate.clone());
                best.push(one);
            }
        }
    }
    best
}

fn is_two_mass(r: &Ranked) -> bool {
    r.candidate.effect.change() == Change::TwoMass
}

/// The two criteria of the screening for the residuals of a model.
type Criteria<'a> = (Option<Regression<'a>>, Option<Screen<'a>>);

/// The model of a fit with the time of its input held.
fn held_in_time(present: &WindowFit) -> Model {
    let Ok(j) = present.model.index_of(SYMBOL) else { return present.model.clone() };
    present.model.fix(SYMBOL, present.p[j]).unwrap_or_else(|_| present.model.clone())
}

/// A recording of 15 s of a model for the tests of the search.
#[cfg(test)]
fn recorded(model: &Model, p: &[f64], seed: u64) -> [Recording; 1] {
    use crate::simulate::{Movement, NoiseLevel, Recorder, record};
    let noise = NoiseLevel { alpha: 5e-4, dalpha: 0.02, torque: 0.002 };
    let movement = Movement::rich(model.robot(), seed, 15.0, 12.0);
    let recorder = Recorder { rate: 100.0, control_rate: 1000.0, noise, ticks: None, seed };
    [record("made", model, p, &movement, &recorder).unwrap()]
}
