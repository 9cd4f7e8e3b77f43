//! Measured and simulated motion, with the residual torque.

use super::fitted::{FittedModel, FittedModels};
use crate::compare::simulate_recording;
use crate::diagnose::with_later_input;
use crate::effects::{Motion, Terms, along};
use crate::math::sgn;
use crate::recording::{LocalMotion, Recording};
use crate::simulate::{Hold, PhysicalDynamics, SimulateError, at_rows};

/// A recording with its simulations, as a table of numbers with one row per sample.
///
/// | column | what | unit |
/// |---|---|---|
/// | `t_s` | time | s |
/// | `alpha1_rad`, `dalpha1_rad_s` | measured angle and speed | rad, rad/s |
/// | `input1_N_m` | recorded input | that of the input: `N_m`, `V`, `A` |
/// | `dalpha1_simulated_rad_s` | free simulation from the input alone | rad/s |
/// | `dalpha1_simulated_2s_rad_s` | simulation started anew every 2 s | rad/s |
/// | `residual_torque1_N_m` | torque that the model does not explain | that of the input |
/// | `…_with_effects_…` | the same three with the effects that were found | |
/// | `slope_torque1_N_m` | resisting torque of an effect that was found | that of the input |
///
/// Wheel 1 is the right one; each column is there for wheel 2 too. The residual torque is
///
/// ```text
/// acting input - A a - torque - Σ_j d_j level_j sgn(d_j · w)
/// ```
/// at the smoothed measured motion; it is NaN where a direction with dry friction is at rest, since
/// friction is then whatever balances the input. Of a two-mass drivetrain it is that of the rigid robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Name of the recording.
    pub recording: String,
    /// Columns by name.
    pub columns: Vec<(String, Vec<f64>)>,
}

/// The overlay of a recording of the plan and the models of an experiment.
///
/// # Errors
/// The mass matrix is not positive definite.
pub fn overlay(
    recording: &Recording,
    hold: Hold,
    models: &FittedModels,
) -> Result<Overlay, SimulateError> {
    let unit = recording.drive_unit().symbol().replace(' ', "_");
    let mut out = Table(vec![("t_s".into(), recording.t().to_vec())]);
    out.pair(|i| format!("alpha{i}_rad"), recording.alpha());
    out.pair(|i| format!("dalpha{i}_rad_s"), recording.omega());
    out.pair(|i| format!("input{i}_{unit}"), recording.torque());
    out.version(recording, hold, &models.given, "", &unit)?;
    if let Some(found) = &models.found {
        out.version(recording, hold, found, "_with_effects", &unit)?;
        let given = models.given.model.effects().len();
        for (e, effect) in found.model.effects().iter().enumerate().skip(given) {
            let torque = effect_torque(found, e, recording);
            let id = effect.id();
            out.pair(|i| format!("{id}_torque{i}_{unit}"), &torque);
        }
    }
    Ok(Overlay { recording: recording.name().into(), columns: out.0 })
}

struct Table(Vec<(String, Vec<f64>)>);

impl Table {
    fn pair(&mut self, name: impl Fn(usize) -> String, rows: &[[f64; 2]]) {
        for i in 0..2 {
            self.0.push((name(i + 1), rows.iter().map(|row| row[i]).collect()));
        }
    }

    fn version(
        &mut self,
        recording: &Recording,
        hold: Hold,
        fitted: &FittedModel,
        mark: &str,
        unit: &str,
    ) -> Result<(), SimulateError> {
        let recording = &with_later_input(recording, fitted.input_shift_s, hold);
        let dynamics = PhysicalDynamics { model: fitted.model.clone(), p: fitted.values() };
        let simulated = simulate_recording(&dynamics, recording, hold)?;
        let speeds = |states: &[crate::robot::State]| -> Vec<[f64; 2]> {
            states.iter().map(|s| s.omega).collect()
        };
        self.pair(|i| format!("dalpha{i}_simulated{mark}_rad_s"), &speeds(&simulated.free));
        self.pair(|i| format!("dalpha{i}_simulated_2s{mark}_rad_s"), &speeds(&simulated.windows));
        let residual = residual_torque(fitted, recording, hold);
        self.pair(|i| format!("residual_torque{i}{mark}_{unit}"), &residual);
        Ok(())
    }
}

/// The acting input minus inertial, resisting and friction torques.
fn residual_torque(fitted: &FittedModel, recording: &Recording, hold: Hold) -> Vec<[f64; 2]> {
    let p = fitted.values();
    let acting = fitted.model.input_of(recording, recording.torque(), &p);
    let acting = at_rows(recording.pieces(), &acting, hold);
    let row = |(k, m): (usize, &LocalMotion)| {
        let needed = needed(&fitted.model.terms(&at(fitted, recording, k), &p), m);
        [0, 1].map(|i| acting[k][i] - needed[i])
    };
    recording.local_motion().iter().enumerate().map(row).collect()
}

/// The resisting torque of effect number `e`, including its change of the input.
fn effect_torque(fitted: &FittedModel, e: usize, recording: &Recording) -> Vec<[f64; 2]> {
    let (effect, p) = (&fitted.model.effects()[e], fitted.values());
    let p = &p[fitted.model.slots(e)];
    let changed = effect.input(recording.t(), recording.torque(), p);
    let changed = changed.unwrap_or_else(|| recording.torque().to_vec());
    let row = |(k, m): (usize, &LocalMotion)| {
        let needed = needed(&effect.terms(&at(fitted, recording, k), p), m);
        [0, 1].map(|i| needed[i] + recording.torque()[k][i] - changed[k][i])
    };
    recording.local_motion().iter().enumerate().map(row).collect()
}

fn at<'a>(fitted: &'a FittedModel, recording: &Recording, k: usize) -> Motion<'a, f64> {
    let LocalMotion { alpha, omega, .. } = recording.local_motion()[k];
    let t = recording.t()[k] - recording.t()[0];
    Motion::at(t, alpha, omega, fitted.model.robot())
}

/// The torque required by the terms at a measured motion; NaN if the direction of a friction is unknown.
fn needed(terms: &Terms<f64>, m: &LocalMotion) -> [f64; 2] {
    let sign = |j: usize| {
        let speed = along(j, &m.omega);
        let [v1, v2] = m.omega_variance;
        let variance = [v1, v2, v1 + v2, v1 + v2][j];
        // within two standard deviations of zero the sign is undetermined
        if terms.level[j] > 0.0 && speed * speed <= 4.0 * variance { f64::NAN } else { sgn(speed) }
    };
    terms.total_torque(&m.acceleration, &std::array::from_fn(sign))
}
