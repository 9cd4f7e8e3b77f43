//! Anything that moves under an input: a physical model with values, or a fuzzy emulator.

use super::{FuzzyDynamics, Input, RunIn, SimulateError, contact, simulate, simulate_acting};
use crate::effects::Motion;
use crate::model::Model;
use crate::recording::Recording;
use crate::robot::State;

/// What a method identified, able to move. Physics and fuzzy emulators alike.
pub trait Dynamics: Send + Sync {
    /// Wheel acceleration [rad/s^2] at time `t` \[s\] since the start under the acting input [N m];
    /// the right-hand side f + G u of eq. (17).
    ///
    /// # Errors
    /// Where the dynamics has no acceleration.
    fn acceleration(
        &self,
        t: f64,
        state: &State,
        torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError>;

    /// The acting input from the recorded one.
    fn input(&self, t: &[f64], recorded: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let _ = t;
        recorded.to_vec()
    }

    /// The acting input from one at the rows of a recording, before which there may have been none.
    fn input_of(&self, recording: &Recording, input: &[[f64; 2]]) -> Vec<[f64; 2]> {
        self.input(recording.t(), input)
    }

    /// Free simulation from the recorded input, one state a sample.
    ///
    /// # Errors
    /// A diverging motion, or dynamics without acceleration.
    fn simulate(&self, input: &Input, start: State) -> Result<Vec<State>, SimulateError>;

    /// Simulation of a part of a recording: `input.torque` is the acting input ([`Dynamics::input`]
    /// over the whole recording) and time counts from `origin` \[s\]. The first samples of `input` are
    /// the run-in; the states behind it are returned, the first being `start`.
    ///
    /// # Errors
    /// As [`Dynamics::simulate`].
    fn simulate_part(
        &self,
        input: &Input,
        origin: f64,
        run_in: &RunIn,
        start: State,
    ) -> Result<Vec<State>, SimulateError> {
        let _ = origin;
        let from = run_in.samples;
        self.simulate(
            &Input { t: &input.t[from..], torque: &input.torque[from..], ..*input },
            start,
        )
    }

    /// Whether there is more to the state than angles and speeds of the wheels (a body behind a
    /// coupling), so that a part needs a run-in.
    fn has_more_state(&self) -> bool {
        false
    }

    /// The physical model and its parameter values, where the dynamics is one.
    fn physical(&self) -> Option<(&Model, &[f64])> {
        None
    }

    /// The fuzzy emulator, where the dynamics is one.
    fn fuzzy(&self) -> Option<&FuzzyDynamics> {
        None
    }
}

/// A physical model with parameter values.
#[derive(Clone, Debug)]
pub struct PhysicalDynamics {
    /// Whose equations of motion are solved.
    pub model: Model,
    /// One value a parameter.
    pub p: Vec<f64>,
}

impl Dynamics for PhysicalDynamics {
    fn acceleration(
        &self,
        t: f64,
        state: &State,
        torque: &[f64; 2],
    ) -> Result<[f64; 2], SimulateError> {
        let x = Motion {
            t,
            alpha: state.alpha,
            omega: state.omega,
            variance: [0.0; 4],
            robot: self.model.robot(),
        };
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

    fn simulate_part(
        &self,
        input: &Input,
        origin: f64,
        run_in: &RunIn,
        start: State,
    ) -> Result<Vec<State>, SimulateError> {
        simulate_acting(&self.model, &self.p, input, origin, run_in, start)
    }

    fn has_more_state(&self) -> bool {
        self.model.is_coupled()
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
