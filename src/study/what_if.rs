//! The last model of an experiment as a function, with the inputs and the states that it is simulated from.

use crate::export::Obstacle;

/// Where a simulation starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Row of the recording.
    pub row: usize,
    /// State there (alpha1, alpha2, omega1, omega2) [rad, rad/s].
    pub state: [f64; 4],
    /// Whether a recording or its part behind a gap begins there: free simulations start there alone.
    pub is_piece: bool,
}

/// The last model of an experiment, to be simulated with other values of its parameters.
#[derive(Clone, Debug)]
pub struct WhatIfStudy {
    /// The function in JavaScript, as `model.js` holds it, or the effects of which there is none.
    pub script: Result<String, Vec<Obstacle>>,
    /// Input of every recording, shifted by the timing that the diagnosis fitted.
    pub inputs: Vec<Vec<[f64; 2]>>,
    /// Starts of the 2 s simulations of every recording.
    pub starts: Vec<Vec<Start>>,
}
