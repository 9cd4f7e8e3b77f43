//! Simulation of a model by the reader with other parameter values.

use super::figure::Figure;
use crate::study::Start;

/// Recordings simulated on the page by a function in JavaScript.
#[derive(Clone, Debug, PartialEq)]
pub struct WhatIf {
    /// The function `model(changed)`, as in `model.js`.
    pub script: String,
    /// The parameters that can be changed.
    pub sliders: Vec<Slider>,
    /// In the order of the [`Explorer`](super::block::Block::Explorer) beside it.
    pub recordings: Vec<Driven>,
    /// One panel per wheel with the layers "measured", "identified" and "with these values", without points.
    pub figure: Figure,
}

/// A parameter that can be changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Slider {
    /// Name in the function.
    pub name: String,
    /// Symbol, as in print.
    pub symbol: String,
    /// What it means.
    pub meaning: String,
    /// Unit, as in print.
    pub unit: String,
    /// Estimate, in the middle of the slider.
    pub value: f64,
    /// Distance from the middle to the upper end.
    pub half: f64,
    /// Lower end in units of `half`, at least -1.
    pub least: f64,
}

/// A recording to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// Description of the recording.
    pub name: String,
    /// Time \[s\].
    pub t: Vec<f64>,
    /// Input, in the unit of the recordings.
    pub input: Vec<[f64; 2]>,
    /// Measured speeds [rad/s].
    pub omega: Vec<[f64; 2]>,
    /// Initial states of the simulations.
    pub starts: Vec<Start>,
    /// 2 s simulation error of the noise floor [rad/s]; NaN if only a part is simulated.
    pub floor: f64,
}
