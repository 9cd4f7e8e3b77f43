//! Limits for inputs.

/// Inputs: magnitudes, offsets and held values.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Inputs {
    /// Share of the top speed above which a wheel turns in one direction (judgement).
    pub turns: f64,
    /// Smallest number of rows in each direction (judgement): a quarter of twelve are three, whose median a single row does
    /// not determine.
    pub both_ways_rows: usize,
    /// Share of the rows in each direction that must be exceeded (judgement).
    pub both_ways: f64,
    /// Share of its range below zero from which on an input has both signs (judgement).
    pub negative: f64,
    /// Share of the rows that are beyond an offset on either side if an input has a sign (judgement): single wrong samples
    /// are fewer.
    pub signed: f64,
    /// Share of the backward rows, those of steepest rise, in which the input must drive the wheel (judgement).
    pub steepest: f64,
    /// Smallest number of rows at rest before the start (judgement).
    pub at_rest_rows: usize,
    /// Number of standard deviations within which a sensor at rest stays: one row in a million by chance.
    pub rest_errors: f64,
    /// Number of standard errors by which an offset at rest must exceed zero: one log in a million by chance.
    pub offset_errors: f64,
    /// Largest offset as a share of the range of the input: what holds a robot at rest against more than half of its
    /// largest input is a stop (judgement).
    pub offset: f64,
    /// Share of the period of a command within which a sample after a row is of the same cycle (judgement): the
    /// command acts this much too early then, and a whole cycle too late otherwise.
    pub same_cycle: f64,
    /// Share of the rows in which both inputs, or neither, must have a new value (judgement).
    pub new_together: f64,
    /// Response between two samples of an input above which it is not held: half way between zero, held, and one, the
    /// line between the samples.
    pub held: f64,
    /// Number of standard errors for a significant response: one in 30 000 by chance.
    pub held_errors: f64,
}

pub(in crate::conditioning) const INPUTS: Inputs = Inputs {
    turns: 0.2,
    both_ways_rows: 12,
    both_ways: 0.02,
    negative: 0.01,
    signed: 0.01,
    steepest: 0.25,
    at_rest_rows: 20,
    rest_errors: 5.0,
    offset_errors: 5.0,
    offset: 0.5,
    same_cycle: 0.1,
    new_together: 0.95,
    held: 0.5,
    held_errors: 4.0,
};
