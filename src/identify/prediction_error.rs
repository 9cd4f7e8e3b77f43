//! Prediction error with a horizon: the default method.

mod choice;
mod descent;
mod disagreement;
mod held;
mod held_shapes;
mod interval;
mod likelihood;
mod rival;

use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

use super::identifiability::identified;
use super::inverse_dynamics::Regression;
use super::one_size::start_without_friction;
use super::open_loop::{OpenLoop, mean};
use super::profile::{Profile, profile};
use super::torque_regression::TorqueRegression;
use super::unexcited::with_combination;
use super::{
    Estimate, Fit, Identifier, IdentifyError, MethodDescription, NoStart, Note, OptionError,
    SingleAxis, Task, from_options, options_schema, start,
};
use crate::filter::{HorizonFilter, Prepared, Reading, pieces, prepare};
use crate::model::Model;
use crate::model::base::{A1, A2};
use crate::recording::Recording;
use choice::{Candidate, HORIZONS, SAFE, choose};
use descent::{Solution, descend};
use held::Held;
use interval::{Spread, of_scores, spread};

/// Prediction error of a filter whose memory is a horizon.
///
/// ```text
/// minimise  N ln(Σ e²/S / N) + Σ ln S         e: innovation of an extended Kalman filter, S: its variance
/// δθ = H⁻¹ g,  g = Σ ψ e/S,  H = Σ ψ ψ'/S,   ψ: derivative of the prediction
/// R_angle = s_a² + q T⁴/(4 D),  R_speed = s_w² + q T²/D,  q = s_M² D/a1²
/// ```
/// T = 0 is maximum likelihood with the noise levels of the channels; it reaches the Cramér-Rao
/// bound if the model is correct. With increasing horizon the fit approaches that of a free
/// simulation, which is better if the model is incomplete. With `horizon_s = "auto"` the
/// horizon is chosen by cross-validation of the 2 s simulation error over pieces of the training data;
/// T = 0 is kept unless another horizon is better by more than one paired standard error. If a regression of
/// torques is better still, or if the weak form or the free simulation has an error smaller by more than one half, the
/// values of that method are used, and a note states this. If noise of the input would bias the
/// maximum-likelihood fit by more than its standard error (light robots with much friction), or if
/// the innovations are twice as large as the noise explains, the horizons begin at 0.2 s; in the second case
/// the noise of the input is assumed equal in all rows, and the intervals include the disagreement with the regression
/// of torques. Intervals are computed from the scores of blocks with Student's t, and are valid for an incomplete model
/// too. Unidentifiable parameters are fixed at their initial values. For a single axis that is mapped to both wheels,
/// sums over both wheels are estimated.
///
/// The step of the filter is that of the simulation: the input is interpolated linearly, stops and reversals are
/// located within the row. A time shift between input and motion, up to half a row, is estimated with the parameters,
/// except in a model with a delay, which is equivalent. The shape parameters of a regression whose values are used are
/// those of the filter, with their standard errors.
///
/// Source: Ljung, System Identification (1999), ch. 7 (prediction error), ch. 9 (sandwich); Kristensen,
/// Madsen and Jørgensen, Automatica 40 (2004) for the filter. The horizon is derived here.
#[derive(Clone, Debug, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PredictionError {
    /// Horizon of the predictions \[s\]: 0 is maximum likelihood, "auto" chooses by cross-validation.
    pub horizon_s: Horizon,
    /// Whether all noise levels, including that of a slow unknown torque, are estimated instead of using a horizon.
    pub slow_moment: bool,
    /// Symbols of the parameters whose profile likelihood is computed and plotted.
    pub profile: Vec<String>,
}

/// The horizon: chosen on held-out data, or given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(untagged, expecting = "`horizon_s` must be \"auto\" or a number of seconds")]
pub enum Horizon {
    /// Chosen from the recordings.
    Rule(Rule),
    /// This long \[s\].
    Seconds(f64),
}

/// How a horizon is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// On held-out pieces of the training data.
    Auto,
}

impl Default for Horizon {
    fn default() -> Self {
        Self::Rule(Rule::Auto)
    }
}

/// Name in experiment files.
const NAME: &str = "prediction_error";

impl Identifier for PredictionError {
    fn describe(&self) -> MethodDescription {
        MethodDescription {
            name: NAME.into(),
            title: "Prediction error with a horizon (extended Kalman filter)".into(),
            equation:
                "minimise N ln(Σ e²/S / N) + Σ ln S over innovations e, of variance S, of an \
                       extended Kalman filter with a memory of `horizon_s`"
                    .into(),
            source: "Ljung, System Identification, 1999, ch. 7; Kristensen et al. 2004".into(),
            use_when: "first, for any recording: efficient if the model is correct (noisy torques and noisy \
                       speeds), simulates well if it is not; its intervals cover the true values"
                .into(),
            avoid_when: "the robot hardly moves, or the sampling is slower than the motion".into(),
        }
    }

    fn rank(&self) -> Option<usize> {
        Some(0)
    }

    fn is_default(&self) -> bool {
        true
    }

    fn is_efficient(&self) -> bool {
        true
    }

    fn schema(&self) -> schemars::Schema {
        options_schema::<Self>()
    }

    fn configure(&self, options: &toml::Table) -> Result<Box<dyn Identifier>, OptionError> {
        let method: Self = from_options(NAME, options)?;
        if let Horizon::Seconds(horizon) = method.horizon_s
            && !(horizon >= 0.0 && horizon.is_finite())
        {
            let message = "`horizon_s` must be \"auto\", zero or a positive number".to_string();
            return Err(OptionError { method: NAME.into(), message });
        }
        Ok(Box::new(method))
    }

    fn identify(&self, task: &Task) -> Result<Fit, IdentifyError> {
        if self.slow_moment {
            return likelihood::identify(task, &self.profile);
        }
        let prepared: Vec<Prepared> = task.train.iter().map(prepare).collect();
        self.fit(task, &prepared)
    }
}

impl PredictionError {
    fn fit(&self, task: &Task, prepared: &[Prepared]) -> Result<Fit, IdentifyError> {
        let recordings: Vec<&Recording> = task.train.iter().collect();
        let (train, hold, pieces) = (task.train, task.hold, pieces(&recordings));
        let open = OpenLoop { train, hold, pieces };
        let begin = |(error, p): (f64, Vec<f64>)| {
            let filter = HorizonFilter::new(prepared, task.hold, task.model, &p);
            let solution = descend(&filter, task.model, (&p, 0.0), 0.0)?;
            Some((filter, solution, (error, p)))
        };
        // the regression of torques, for initial values and for the fallback
        let rows = TorqueRegression::default().rows(task).ok();
        let starts = ranked(task, &open, starts(task, rows.as_ref())?);
        let (mut filter, first, (square, start)) =
            starts.into_iter().find_map(begin).ok_or_else(|| IdentifyError::NoStart {
                method: NAME.into(),
                reason: NoStart::Likelihood,
            })?;
        let mut held = Held::of(task, &filter, first, (&start, &open));
        filter.alike = held.solution.scale() > MISFIT;
        let horizons = match self.horizon_s {
            Horizon::Rule(Rule::Auto) => compared(&filter, &held),
            Horizon::Seconds(horizon) => vec![horizon],
        };
        let choose = |held: &Held| {
            let begin = (&held.solution, start.as_slice());
            choose(&filter, &held.model, begin, &horizons, &open).ok_or_else(|| {
                IdentifyError::NoStart { method: NAME.into(), reason: NoStart::Horizon }
            })
        };
        let mut chosen = choose(&held)?;
        let spread_out = held.spread_over_track(task, &filter, &chosen.solution);
        if spread_out {
            chosen = choose(&held)?;
        }
        let mut fit = physical(task, &filter, &held, (&chosen, open.unit()), &self.horizon_s);
        for symbol in &self.profile {
            add_profile(&filter, &held.model, &chosen.solution, symbol, &mut fit)?;
        }
        // a regression would find the same unbounded inertia
        if self.horizon_s == Horizon::default() && !spread_out {
            let fit = rival::better((task, rows), &open, &chosen, fit, filter.alike);
            return Ok(rival::unless_it_fails(task, &open, fit, (filter.alike, square.sqrt())));
        }
        Ok(fit)
    }
}

/// Mean square of the normalised innovations above which maximum likelihood is not appropriate: they are
/// twice as large as noise, so that errors of the model dominate.
const MISFIT: f64 = 4.0;

/// Horizons that are compared, the preferred one first.
fn compared(filter: &HorizonFilter, held: &Held) -> Vec<f64> {
    if !filter.has_memory() {
        return vec![0.0];
    }
    let first = if filter.alike || biased_by_noise(filter, held) { SAFE } else { 0.0 };
    HORIZONS.into_iter().filter(|horizon| *horizon >= first).collect()
}

/// Whether derivatives along the recorded input, with its noise, would change a parameter of the
/// maximum-likelihood fit by more than its standard error: then the bias that remains with the
/// smoothed input is relevant too.
fn biased_by_noise(filter: &HorizonFilter, held: &Held) -> bool {
    let (model, solution) = (&held.model, &held.solution);
    let Some(moved) = solution.moved_by(filter, model, Reading::Noisy) else { return true };
    let parameters = solution.columns.iter().filter(|&&j| j < solution.p.len()).count();
    let beyond =
        |spread: Spread| (0..parameters).any(|i| moved[i].abs() > spread.covariance[(i, i)].sqrt());
    // the sampling of the input, which takes two passes, makes the errors of the scores no smaller
    beyond(of_scores(solution)) && beyond(spread(solution, filter, model))
}

/// Initial values of descents: the weak form, the regression of torques, the construction.
fn starts(task: &Task, rows: Option<&Regression>) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let mut all = vec![start::start(task, NAME)?];
    if let Some(Ok(fit)) = rows.map(|rows| TorqueRegression::default().fit(rows, false)) {
        let mut p: Vec<f64> = fit.estimates.iter().map(|e| e.value).collect();
        start::sound(task.model, &mut p);
        all.push(p);
    }
    all.extend(start_without_friction(task));
    all.push(task.model.initial());
    Ok(all)
}

/// Starts in the order of their mean square 2 s simulation error, with it; those that cannot be simulated come last.
fn ranked(task: &Task, open: &OpenLoop, starts: Vec<Vec<f64>>) -> Vec<(f64, Vec<f64>)> {
    let mut by_error: Vec<(f64, Vec<f64>)> =
        starts.into_iter().map(|p| (open.mean(task.model, &p), p)).collect();
    by_error.sort_by(|a, b| a.0.total_cmp(&b.0));
    by_error
}

/// The fit of a chosen solution.
fn physical(
    task: &Task,
    filter: &HorizonFilter,
    held: &Held,
    (chosen, unit_of_error): (&Candidate, &'static str),
    horizon: &Horizon,
) -> Fit {
    let solution = &chosen.solution;
    let spread = spread(solution, filter, &held.model);
    let total = solution.p.len();
    let (mut covariance, mut information) =
        (DMatrix::zeros(total, total), DMatrix::zeros(total, total));
    let own = solution.information();
    for (i, &a) in solution.columns.iter().enumerate().filter(|(_, a)| **a < total) {
        for (k, &b) in solution.columns.iter().enumerate().filter(|(_, b)| **b < total) {
            covariance[(a, b)] = spread.covariance[(i, k)];
            information[(a, b)] = own[(i, k)];
        }
    }
    let known = identified(
        &held.model,
        &solution.p,
        &information,
        Some(&covariance),
        SingleAxis::CountedOnce,
        task.train,
    );
    let mut covariance = known.covariance;
    held.places.iter().for_each(|&j| covariance[(j, j)] = f64::INFINITY);
    let unit = task.train[0].drive_unit();
    let fit = Fit::physical(NAME, task.model, solution.p.clone(), covariance, unit);
    let mut fit = fit.with_degrees(spread.degrees);
    fit.notes = held.notes(task);
    fit.notes.extend(known.notes);
    fit.notes.push(note_of(chosen, unit_of_error, horizon));
    fit.notes.extend(note_of_shift(task, solution, &spread));
    fit.horizon_s = Some(solution.horizon);
    fit.status = solution.status;
    fit.work.iterations = solution.iterations;
    fit.work.evaluations = solution.evaluations;
    // a1 then contains all that is determined of both
    let inertia = held.places.contains(&A2) && fit.estimates[A1].identifiable;
    if inertia { with_combination(fit, task.model, 1.0, &[]) } else { fit }
}

/// The note on the horizon.
fn note_of(chosen: &Candidate, unit: &'static str, horizon: &Horizon) -> Note {
    Note::Horizon {
        seconds: chosen.solution.horizon,
        chosen: matches!(horizon, Horizon::Rule(Rule::Auto)),
        error: mean(&chosen.held_out).sqrt(),
        unit,
    }
}

/// The note on a significant shift in time.
fn note_of_shift(task: &Task, solution: &Solution, spread: &Spread) -> Option<Note> {
    let i = solution.columns.iter().position(|&j| j == solution.p.len())?;
    let step = task.train[0].step();
    let (late, error) = (-solution.shift * step, spread.covariance[(i, i)].sqrt() * step);
    let t = crate::math::distribution::t_quantile(0.975, spread.degrees);
    (late.abs() > t * error).then_some(Note::InputShift(late, error))
}

fn add_profile(
    filter: &HorizonFilter,
    model: &Model,
    solution: &Solution,
    symbol: &str,
    fit: &mut Fit,
) -> Result<(), IdentifyError> {
    let at = |held: &Model, p: &[f64]| {
        let there = descend(filter, held, (p, solution.shift), solution.horizon);
        Ok(there.map_or(f64::NEG_INFINITY, |there| -there.cost()))
    };
    let j = model.index_of(symbol)?;
    note_profile(&solution.p, j, fit, |place| profile(model, &solution.p, place, at))
}

/// Adds the profile of parameter `j` to a fit, where there is one.
fn note_profile(
    p: &[f64],
    j: usize,
    fit: &mut Fit,
    profile: impl FnOnce(&super::profile::Place) -> Result<Profile, IdentifyError>,
) -> Result<(), IdentifyError> {
    let Estimate { symbol, unit, value, std_error, interval: by_std_error, .. } =
        fit.estimates[j].clone();
    if !(std_error.is_finite() && std_error > 0.0) {
        fit.notes.push(Note::NoProfile(symbol));
        return Ok(());
    }
    let mut found = profile(&super::profile::Place { j, std_error, unit: unit.clone() })?;
    let moved = value - p[j];
    found.trace.at.iter_mut().for_each(|v| *v += moved);
    let (low, high) = found.interval;
    let interval = (low + moved, high + moved);
    fit.notes.push(Note::Profile { symbol, unit, interval, by_std_error });
    fit.traces.push(found.trace);
    Ok(())
}

#[cfg(test)]
mod tests;
