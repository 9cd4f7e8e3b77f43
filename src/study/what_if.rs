//! The last model of an experiment as a function, with inputs and initial states for simulations.

use crate::export::Obstacle;

/// Start of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Row of the recording.
    pub row: usize,
    /// Initial state (alpha1, alpha2, omega1, omega2) [rad, rad/s].
    pub state: [f64; 4],
    /// Whether a recording, or its part after a gap, begins there: free simulations start only there.
    pub is_piece: bool,
}

/// The last model of an experiment, for simulation with other values of its parameters.
#[derive(Clone, Debug)]
pub struct WhatIfStudy {
    /// The function in JavaScript, as in `model.js`, or the effects that prevent it.
    pub script: Result<String, Vec<Obstacle>>,
    /// Input of every recording, shifted by the timing that the diagnosis fitted.
    pub inputs: Vec<Vec<[f64; 2]>>,
    /// Starts of the 2 s simulations of every recording.
    pub starts: Vec<Vec<Start>>,
}
