//! The time shift between recorded input and motion.
//!
//! A logger that averages the input over a row, holds it, or differentiates an encoder shifts the input
//! against the motion by up to half a row. This is timing, not physics; a longer delay is a property of the
//! actuator.

use std::cell::LazyCell;
use std::sync::Arc;

use super::balance::{by_balance, lowest_of_balance};
use super::dead_time::{Timing, agree};
use super::fit::{WindowFit, fit};
use super::input_timing::{Between, INTERPOLATION, InputTiming, SYMBOL, with_later_input};
use super::onset::{in_motion, latest_dead_time};
use super::regression::Regression;
use super::scale::scale_of;
use super::smoothed::Smoothed;
use super::thresholds::THRESHOLDS;
use super::untimed::Untimed;
use super::windows::Windows;
use crate::effects::Scale;
use crate::filter::likelihood_of_steps;
use crate::math::Information;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{BETWEEN_ROWS, Hold};

/// Windows of 1 s that are simulated at most: their error of a shift is far below that of logging.
const WINDOWS: usize = 120;

/// Estimates the shift of the input of `recordings` against the motion, with a model at `p`: from the balance of the
/// torques over the whole range, then by simulation from there, if it is more than a row, and from zero.
///
/// The balance is wrong by fractions of a row where friction decides, since its sign comes from a smoothed
/// speed; a simulation stops and breaks away by itself.
///
/// # Errors
/// Where the motion does not carry it, where it began earlier after a step from rest, or where a model above the floor
/// of noise is simulated best outside the range.
pub fn timing(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    hold: Hold,
) -> Result<Timing, Untimed> {
    let step = recordings.iter().map(|r| r.step()).fold(0.0, f64::max);
    let scale = scale_of(model, p, recordings);
    let smoothed = Smoothed::new(recordings, scale.bandwidth);
    let regression =
        Regression::new(model, p, &smoothed, scale.speed).ok_or(Untimed::NotExcited)?;
    let range = (THRESHOLDS.earliest, THRESHOLDS.longest_delay_s);
    let coarse = lowest_of_balance(&regression, step, range).ok_or(Untimed::NoMinimum)?;
    let balanced = LazyCell::new(|| by_balance(&regression, step, &coarse));
    // a wheel that breaks away late, under more torque than it then needs, moves the balance to another minimum; within
    // half a row of zero the fine search stays within a row of it
    let far = (coarse.shift.abs() > 0.5 * step).then(|| *balanced).flatten();
    let balanced_start = far.map(|(shift, _)| shift).filter(|shift| shift.abs() > step);
    let starts: Vec<f64> = balanced_start.into_iter().chain([0.0]).collect();
    let simulated = in_simulation(model, p, &starts, (recordings, hold), &scale);
    let shift = simulated.and_then(|s| s.shift);
    let above_floor = simulated.is_some_and(|s| s.error > THRESHOLDS.above_floor);
    // a model above the floor whose simulation fits no time lacks what the balance takes for one
    if shift.is_none() && above_floor {
        return Err(Untimed::AboveFloor);
    }
    let balanced = || balanced.map(|balanced| of_input(balanced, step, hold));
    let (dead_time_s, std_error_s) = shift.or_else(balanced).ok_or(Untimed::NoMinimum)?;
    let earliest = dead_time_s - THRESHOLDS.uncertain * std_error_s;
    // a motion that began before contradicts the time: the model lacks what it stands for
    if let Some(onset_s) = latest_dead_time(recordings).filter(|onset| earliest > *onset) {
        return Err(Untimed::Later { time_s: dead_time_s, onset_s });
    }
    let late = earliest > scale.logging;
    let nothing = dead_time_s.abs() < THRESHOLDS.uncertain * std_error_s;
    // above the floor another effect is missing, which the shift may compensate; without a simulation this is not known
    let something_else = shift.is_none() || above_floor;
    // a motion cannot begin before its input: only logging makes it early
    let latest = dead_time_s + THRESHOLDS.uncertain * std_error_s;
    let early = shift.is_some() && latest < -THRESHOLDS.logging * step;
    let kept = late || nothing || something_else && !early;
    let correction_s =
        if kept { 0.0 } else { dead_time_s.clamp(THRESHOLDS.earliest * step, scale.logging) };
    let std_error_s = std_error_s.hypot(INTERPOLATION * step);
    Ok(Timing {
        dead_time_s,
        std_error_s,
        correction_s,
        logging_s: scale.logging,
        step_s: step,
        above_floor,
        other: None,
    })
}

/// The time of an input that was on the line between the rows in the balance. Its sign of friction is that of a
/// smoothed speed, so that the time is that of an instant anywhere in its row.
fn of_input((shift, std_error): (f64, f64), step: f64, hold: Hold) -> (f64, f64) {
    let held = if hold == Hold::Constant { 0.5 * step } else { 0.0 };
    (shift - held, std_error.hypot(step / 12.0_f64.sqrt()))
}

/// A shift by simulation.
#[derive(Clone, Copy)]
struct ShiftFit {
    /// The shift and its standard error \[s\]; `None` outside its range.
    shift: Option<(f64, f64)>,
    /// Ratio of the error of the windows to its value under noise. Above the floor the model lacks another
    /// effect, which the shift may compensate.
    error: f64,
}

impl ShiftFit {
    /// Whether the motion is later than logging explains \[s\].
    fn is_late(&self, logging: f64) -> bool {
        self.shift.is_some_and(|(shift, error)| shift - THRESHOLDS.uncertain * error > logging)
    }

    /// The shift by all windows, or that by the `moving` wheels alone if they contradict it: friction that is larger at
    /// rest than in motion delays the onset, not the motion. Without a shift by these, one of a model above the floor
    /// of noise is not determined.
    fn without_breakaway(self, moving: Option<Self>) -> Self {
        match (self.shift, moving.filter(|fit| fit.shift.is_some())) {
            (Some(all), Some(fit)) if fit.shift.is_some_and(|moving| agree(all, moving)) => self,
            (_, Some(fit)) => fit,
            (_, None) if self.error > THRESHOLDS.above_floor => Self { shift: None, ..self },
            (_, None) => self,
        }
    }
}

/// The shift by all windows of recordings from the best of some `starts`, and if that is later than logging explains by
/// those of wheels in motion.
fn in_simulation(
    model: &Model,
    p: &[f64],
    starts: &[f64],
    (recordings, hold): (&[&Recording], Hold),
    scale: &Scale,
) -> Option<ShiftFit> {
    let over = |windows: &Windows| simulated(model, p, starts, windows, scale);
    let all = over(&over_windows(model, p, recordings, hold))?;
    let late = all.is_late(scale.logging);
    let moving = late.then(|| moving_windows(model, p, recordings, hold)).flatten();
    Some(moving.map_or(all, |moving| all.without_breakaway(over(&moving))))
}

/// The shift by simulation from the best of some `starts`; one inside its range is preferred.
fn simulated(
    model: &Model,
    p: &[f64],
    starts: &[f64],
    windows: &Windows,
    scale: &Scale,
) -> Option<ShiftFit> {
    let fits = starts.iter().filter_map(|start| by_simulation(model, p, *start, windows, scale));
    fits.min_by(|a, b| {
        let outside = |fit: &ShiftFit| fit.shift.is_none();
        outside(a).cmp(&outside(b)).then(a.error.total_cmp(&b.error))
    })
}

/// The shift by the simulation error of windows of 1 s, fitted with the parameters from `start` on. Of what half
/// of the rows of the input moves the shift by, the share of the rows themselves is in the error. `None` where the
/// model cannot follow them.
fn by_simulation(
    model: &Model,
    p: &[f64],
    start: f64,
    windows: &Windows,
    scale: &Scale,
) -> Option<ShiftFit> {
    let timed = timed_over(model, p, start, (windows.clone(), windows.hold.into()), scale)?;
    let error = timed.error();
    let Timed { windows, fit, shift: j } = timed;
    let moved = [0, 1].map(|phase| {
        // between its rows a held input is known
        if windows.hold == Hold::Constant {
            return 0.0;
        }
        let halved = windows.halved(phase);
        let windows = windows.with_recordings(halved.iter().collect());
        step_of(&windows, &fit, j).unwrap_or(f64::INFINITY)
    });
    let sampling = 0.5 * BETWEEN_ROWS.powi(2) * (moved[0].powi(2) + moved[1].powi(2));
    let std_error = (fit.covariance[(j, j)] + sampling).sqrt();
    let found = !fit.at_bound[j] && std_error.is_finite() && std_error > 0.0;
    Some(ShiftFit { shift: found.then_some((fit.p[j], std_error)), error })
}

/// A model fitted over windows of recordings along with the time of their input.
pub(super) struct Timed<'a> {
    pub(super) windows: Windows<'a>,
    pub(super) fit: WindowFit,
    /// Place of the shift among the parameters.
    shift: usize,
}

impl Timed<'_> {
    /// How much later than recorded the input acts \[s\].
    pub(super) fn time_s(&self) -> f64 {
        self.fit.p[self.shift]
    }

    /// Standard error of that \[s\].
    pub(super) fn std_error_s(&self) -> f64 {
        self.fit.covariance[(self.shift, self.shift)].sqrt()
    }

    /// Whether the motion is later than logging explains \[s\].
    pub(super) fn is_late(&self, logging: f64) -> bool {
        self.shift_less_errors(1.0) > logging
    }

    /// Whether the motion is earlier than logging explains \[s\].
    pub(super) fn is_early(&self, logging: f64) -> bool {
        self.shift_less_errors(-1.0) < -logging
    }

    /// The shift less so many times its uncertainty \[s\].
    fn shift_less_errors(&self, times: f64) -> f64 {
        self.time_s() - times * (THRESHOLDS.uncertain * self.std_error_s())
    }

    /// Ratio of the error of the windows to its value under noise.
    pub(super) fn error(&self) -> f64 {
        (self.fit.cost / (0.5 * self.windows.values() as f64)).sqrt()
    }
}

/// Log-likelihood of whole `recordings` under a fit, with their input at its time; an input that is held changes at the
/// rows, another one at uniformly distributed times in them.
pub(super) fn log_likelihood(
    fit: &WindowFit,
    recordings: &[&Recording],
    hold: Hold,
) -> Option<f64> {
    let scatter = if hold == Hold::Constant { 0.0 } else { 1.0 };
    likelihood_with_scatter(fit, recordings, hold, scatter)
}

/// The same with another scatter of these times ([`likelihood_of_steps`]).
pub(super) fn likelihood_with_scatter(
    fit: &WindowFit,
    recordings: &[&Recording],
    hold: Hold,
    scatter: f64,
) -> Option<f64> {
    let mut p = fit.p.clone();
    let shift = fit.model.index_of(SYMBOL).map_or(0.0, |j| std::mem::take(&mut p[j]));
    let moved: Vec<Recording> =
        recordings.iter().map(|r| with_later_input(r, shift, hold)).collect();
    let moved: Vec<&Recording> = moved.iter().collect();
    likelihood_of_steps(&fit.model, &p, &moved, hold, scatter)
}

/// Fits `model` from `p` and the shift `start` \[s\] over some windows of 1 s of `recordings`. `None` where the model
/// cannot follow them.
pub(super) fn timed<'a>(
    model: &Model,
    p: &[f64],
    start: f64,
    recordings: &[&'a Recording],
    between: impl Into<Between>,
    scale: &Scale,
) -> Option<Timed<'a>> {
    let between = between.into();
    let windows = over_windows(model, p, recordings, between.hold());
    timed_over(model, p, start, (windows, between), scale)
}

/// The same over given windows.
fn timed_over<'a>(
    model: &Model,
    p: &[f64],
    start: f64,
    (windows, between): (Windows<'a>, Between),
    scale: &Scale,
) -> Option<Timed<'a>> {
    let timed = with_timing(model, between, scale)?;
    let shift = timed.index_of(SYMBOL).ok()?;
    let from: Vec<f64> = p.iter().copied().chain([start]).collect();
    let fit = fit(&windows, &timed, &from, scale)?;
    Some(Timed { windows, fit, shift })
}

/// The model with a time of its input over the whole range.
pub(super) fn with_timing(
    model: &Model,
    between: impl Into<Between>,
    scale: &Scale,
) -> Option<Model> {
    let between = between.into();
    let limits = (
        THRESHOLDS.earliest * scale.step,
        THRESHOLDS.longest_delay_s.max(-THRESHOLDS.earliest * scale.step),
    );
    model.add_effect(Arc::new(InputTiming { limits, between })).ok()
}

/// Some windows of 1 s of `recordings`, weighted for a model at `p`.
pub(super) fn over_windows<'a>(
    model: &Model,
    p: &[f64],
    recordings: &[&'a Recording],
    hold: Hold,
) -> Windows<'a> {
    some(Windows::new(recordings.to_vec(), hold, model, p), model, p)
}

/// The same of the rows [`in_motion`]; `None` if these are all rows.
fn moving_windows<'a>(
    model: &Model,
    p: &[f64],
    recordings: &[&'a Recording],
    hold: Hold,
) -> Option<Windows<'a>> {
    let rows: Vec<_> = recordings.iter().map(|r| in_motion(r)).collect();
    let all = recordings.iter().zip(&rows).all(|(r, rows)| rows == r.pieces());
    let windows = || Windows::of_rows(recordings.to_vec(), hold, (model, p), &rows);
    (!all).then(|| some(windows(), model, p))
}

/// At most so many of the windows, evenly, weighted for a model at `p`.
fn some<'a>(all: Windows<'a>, model: &Model, p: &[f64]) -> Windows<'a> {
    let every = all.windows.len().div_ceil(WINDOWS).max(1);
    all.only(|n| n % every == 0).sampled(model, p)
}

/// Change of parameter `j` of a fit by one Gauss-Newton step on other windows.
fn step_of(windows: &Windows, fit: &WindowFit, j: usize) -> Option<f64> {
    let free = fit.model.free();
    let quadratic = windows.quadratic(&fit.model, &fit.p, &free)?;
    let step = Information::new(&quadratic.hessian).solve(&quadratic.gradient);
    free.iter().position(|&k| k == j).map(|n| -step[n])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheels_in_motion_decide_on_a_time_that_breakaway_may_cause() {
        let fit = |shift, error| ShiftFit { shift, error };
        let (all, floor) = (fit(Some((0.12, 0.01)), 4.0), fit(Some((0.12, 0.01)), 1.0));
        let of = |fit: ShiftFit| (fit.shift, fit.error);
        // another time, the same one, one of any size
        let [other, same, any] = [(0.0, 0.01), (0.10, 0.01), (0.0, 0.6)].map(|s| fit(Some(s), 2.0));
        assert_eq!(of(all.without_breakaway(Some(other))), of(other));
        assert_eq!(of(all.without_breakaway(Some(same))), of(all));
        assert_eq!(of(all.without_breakaway(Some(any))), of(all));
        for undetermined in [None, Some(fit(None, 2.0))] {
            assert_eq!(of(all.without_breakaway(undetermined)), (None, 4.0));
            assert_eq!(of(floor.without_breakaway(undetermined)), of(floor));
        }
    }
}
