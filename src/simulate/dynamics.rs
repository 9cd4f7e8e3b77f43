//! Dynamics under an input: a physical model with parameter values, or a fuzzy emulator.

use std::ops::Range;

use super::simulation::{NOWHERE, simulate_windows};
use super::{FuzzyDynamics, Input, SimulateError, contact, simulate};
use crate::effects::Motion;
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::State;

/// The identified dynamics, physical or fuzzy.
pub trait Dynamics: Send + Sync {
    /// Wheel acceleration [rad/s^2] at time `t` \[s\] since the start under the acting input [N m]; the
    /// right-hand side f + G u of eq. (17).
    ///
    /// # Errors
    /// The mass matrix is not positive definite.
    fn acceleration(
        &self,
        t: f64,
        state: &State,
        torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError>;

    /// The acting input, computed from the recorded one.
    fn input(&self, t: &[f64], recorded: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let _ = t;
        recorded.to_vec()
    }

    /// The acting input at the rows of a recording, taking into account the input before the first row.
    fn input_of(&self, recording: &Recording, input: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.input(recording.t(), input)
    }

    /// Free simulation from the recorded input, one state per sample.
    ///
    /// # Errors
    /// The motion diverges, or the mass matrix is not positive definite.
    fn simulate(&self, input: &Input, start: State) -> Result<Vec<State>, SimulateError>;

    /// Simulation of windows of a stretch of a recording without gaps, each from its own initial state.
    /// `input.torque` is the acting input ([`Dynamics::input`] over the whole recording), and time is
    /// relative to its first row. The body of a two-mass drivetrain, which is not measured, keeps its slip
    /// and twist from one window to the next. States of a window that diverges are NaN.
    ///
    /// # Errors
    /// The mass matrix is not positive definite.
    fn simulate_windows(
        &self,
        input: &Input,
        windows: &[(Range<usize>, State)],
    ) -> Result<Vec<Vec<State>>, SimulateError> {
        let one = |(rows, start): &(Range<usize>, State)| {
            let (t, torque) = (&input.t[rows.clone()], &input.torque[rows.clone()]);
            match self.simulate(&Input { t, torque, ..*input }, *start) {
                Err(SimulateError::Diverged { .. }) => Ok(vec![NOWHERE; rows.len()]),
                other => other,
            }
        };
        windows.iter().map(one).collect()
    }

    /// The physical model and its parameter values, if the dynamics are physical.
    fn physical(&self) -> Option<(&Model, &[f64])> {
        None
    }

    /// The fuzzy emulator, if the dynamics are fuzzy.
    fn fuzzy(&self) -> Option<&FuzzyDynamics> {
        None
    }
}

/// A physical model with parameter values.
#[derive(Clone, Debug)]
pub struct PhysicalDynamics {
    /// Model whose equations of motion are solved.
    pub model: Model,
    /// One value per parameter.
    pub p: Vec<f64>,
}

impl Dynamics for PhysicalDynamics {
    fn acceleration(
        &self,
        t: f64,
        state: &State,
        torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError> {
        let x = Motion::at(t, state.alpha, state.omega, self.model.robot());
        let terms = self.model.terms(&x, &self.p);
        Ok(contact(&terms, torque, &state.omega)?.acceleration)
    }

    fn input(&self, t: &[f64], recorded: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.model.input(t, recorded, &self.p)
    }

    fn input_of(&self, recording: &Recording, input: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.model.input_of(recording, input, &self.p)
    }

    fn simulate(&self, input: &Input, start: State) -> Result<Vec<State>, SimulateError> {
        simulate(&self.model, &self.p, input, start)
    }

    fn simulate_windows(
        &self,
        input: &Input,
        windows: &[(Range<usize>, State)],
    ) -> Result<Vec<Vec<State>>, SimulateError> {
        simulate_windows(&self.model, &self.p, input, input.t[0], windows)
    }

    fn physical(&self) -> Option<(&Model, &[f64])> {
        Some((&self.model, &self.p))
    }
}

impl Dynamics for FuzzyDynamics {
    fn acceleration(
        &self,
        _t: f64,
        state: &State,
        torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError> {
        Ok(self.rate(&state.omega, torque))
    }

    fn simulate(&self, input: &Input, start: State) -> Result<Vec<State>, SimulateError> {
        FuzzyDynamics::simulate(self, input, start)
    }

    fn fuzzy(&self) -> Option<&Self> {
        Some(self)
    }
}
