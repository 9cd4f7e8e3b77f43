//! Recordings of a logger that was restarted for each: the phase between log and controller differs.

use super::fit::fit;
use super::input_timing::{SYMBOL, with_later_input};
use super::scale::scale_of;
use super::thresholds::THRESHOLDS;
use super::timing::{Timed, over_windows, timed};
use crate::compare::{simulate_recording, window_rms};
use crate::effects::Scale;
use crate::math::mean;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::{Hold, PhysicalDynamics};

/// Alignments in turn with the fit of the model: the first fit is to recordings that contradict each other.
const ROUNDS: usize = 3;

/// How much later the input of a recording acts than in the mean of the training recordings; zero where that is little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Time \[s\].
    pub shift_s: f64,
    /// Standard error of that \[s\].
    pub std_error_s: f64,
}

/// The phases of `recordings`, the first `train` of which are fitted with a model at `p`. `None` if all
/// phases are equal, or if the error of the model is still large with them, because a missing effect may look
/// like a phase.
///
/// ```text
/// T_i: time of the input of recording i with the parameters of all,   phase = T_i - mean of T over training
/// ```
/// The time is a property of the log, not of the robot, so a validation recording has its own.
#[must_use]
pub fn phases(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    train: usize,
    hold: Hold,
) -> Option<Vec<Phase>> {
    if recordings.len() < 2 {
        return None;
    }
    let scale = scale_of(model, p, &recordings[..train]);
    let mut moved: Vec<Recording> = recordings.iter().map(|r| (*r).clone()).collect();
    let mut phases = vec![Phase { shift_s: 0.0, std_error_s: 0.0 }; recordings.len()];
    for round in 0..ROUNDS {
        let now: Vec<&Recording> = moved.iter().collect();
        let own = own_times(model, p, &now, train, hold, &scale)?;
        let mean = mean(own[..train].iter().map(|own| own.shift_s));
        let differs = |own: &Phase| {
            let apart = (own.shift_s - mean).abs();
            apart > THRESHOLDS.phase_differs * own.std_error_s
                && apart > THRESHOLDS.least_phase * scale.step
        };
        if round == 0 && !own.iter().any(differs) {
            return None;
        }
        for (k, own) in own.iter().enumerate() {
            let shift_s = phases[k].shift_s + own.shift_s - mean;
            phases[k] = Phase { shift_s, ..*own };
            moved[k] = with_later_input(recordings[k], shift_s, hold);
        }
    }
    for (k, phase) in phases.iter_mut().enumerate() {
        if phase.shift_s.abs() <= THRESHOLDS.least_phase * scale.step {
            (phase.shift_s, moved[k]) = (0.0, recordings[k].clone());
        }
    }
    let near = phases.iter().all(|phase| phase.shift_s.abs() <= THRESHOLDS.most_phase * scale.step);
    let now: Vec<&Recording> = moved.iter().collect();
    let all = timed(model, p, 0.0, &now, hold, &scale)?;
    let error = all.error();
    let dynamics = PhysicalDynamics { model: all.fit.model, p: all.fit.p };
    let simulated = |r: &Recording| {
        let simulated = simulate_recording(&dynamics, r, hold).ok()?;
        Some(window_rms(r, &simulated.windows))
    };
    // where a wheel breaks away a row earlier or later, the windows above weigh little, and the simulation may fail
    let apart = |(phase, _): &(&Phase, _)| phase.shift_s != 0.0;
    let mut pairs = phases.iter().zip(recordings.iter().zip(&moved)).filter(apart);
    let falls = pairs.all(|(_, (before, after))| {
        let before = simulated(before).unwrap_or(f64::INFINITY);
        simulated(after).is_some_and(|after| after < before)
    });
    (near && falls && error <= THRESHOLDS.above_floor).then_some(phases)
}

/// The time of the input of each recording, with the parameters that the training recordings have in common.
fn own_times(
    model: &Model,
    p: &[f64],
    recordings: &[&Recording],
    train: usize,
    hold: Hold,
    scale: &Scale,
) -> Option<Vec<Phase>> {
    let Timed { fit: all, .. } = timed(model, p, 0.0, &recordings[..train], hold, scale)?;
    let known = all.model.symbols().into_iter().zip(&all.p).filter(|(symbol, _)| symbol != SYMBOL);
    let held = known.fold(all.model.clone(), |m, (symbol, value)| {
        m.fix(&symbol, *value).unwrap_or_else(|_| all.model.clone())
    });
    let j = held.index_of(SYMBOL).ok()?;
    let own = |r: &&Recording| {
        let windows = over_windows(model, &all.p[..p.len()], &[*r], hold);
        let fit = fit(&windows, &held, &all.p, scale)?;
        Some(Phase { shift_s: fit.p[j], std_error_s: fit.covariance[(j, j)].sqrt() })
    };
    recordings.iter().map(own).collect()
}
