//! Simulations with many parameter vectors and one input in the lanes of the processor; each is reduced to
//! its ISE.

mod base_model;
mod realisations;

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

pub(crate) use self::base_model::has_lanes;
use self::base_model::{Batch, Part, stored};
pub(crate) use self::realisations::{Realisation, Speeds, speeds_of_realisations};
use super::input_line::InputLine;
use super::stepper::{edge, pieces_between};
use super::{Hold, Input, SimulateError, simulate};
use crate::math::{Lanes, in_lanes, trapezoid};
use crate::model::Model;
use crate::robot::State;

/// Number of simulations in parallel: two of the widest registers, because the operations of a single step
/// depend on each other.
const TOGETHER: usize = 16;
/// ISE of free simulations with many parameter vectors over one input.
///
/// ```text
/// ISE_n = ∫ (w1 - w1(θ_n))² + (w2 - w2(θ_n))² dt     [rad²/s], trapezoid
/// ```
/// `measured` are wheel speeds [rad/s], one row per sample of `input`. Trajectories are not stored.
///
/// For the base model (a1..a5) sixteen vectors at a time are integrated with the steps of [`simulate`] in the
/// widest registers of the processor. Sliding or sticking throughout a step is computed in the lanes; if a
/// wheel stops, reverses or breaks away within a step, that lane is integrated by the scalar integrator. The
/// result therefore equals that of [`simulate`] to rounding, and is identical to the last bit for every width
/// of the registers. Models with further effects, and processors without wide registers, simulate sequentially.
///
/// # Errors
/// Each vector has its own result, with the errors of [`simulate`].
///
/// # Panics
/// If `measured` does not have one row per sample, or a vector not one value per parameter.
///
/// # Examples
/// ```
/// use amigo_ident::{model::Model, robot::{Robot, State}};
/// use amigo_ident::simulate::{Hold, Input, ise_of_many, simulate};
/// let model = Model::base(Robot::amigobot());
/// let t: Vec<f64> = (0..201).map(|k| 0.01 * k as f64).collect();
/// let torque = vec![[0.2, 0.15]; 201];
/// let input = Input { t: &t, torque: &torque, hold: Hold::Linear };
/// let truth = model.initial();
/// let motion = simulate(&model, &truth, &input, State::default()).unwrap();
/// let measured: Vec<_> = motion.iter().map(|s| s.omega).collect();
/// let heavier: Vec<f64> = truth.iter().map(|a| 1.1 * a).collect();
/// let ise = ise_of_many(&model, &[truth, heavier], &input, State::default(), &measured);
/// assert!(*ise[0].as_ref().unwrap() < 1e-20 && *ise[1].as_ref().unwrap() > 0.1);
/// ```
#[must_use]
pub fn ise_of_many(
    model: &Model,
    parameters: &[Vec<f64>],
    input: &Input,
    start: State,
    measured: &[[f64; 2]],
) -> Vec<Result<f64, SimulateError>> {
    assert_eq!(measured.len(), input.t.len(), "one row of speeds a sample");
    if !has_lanes(model) {
        return parameters
            .par_iter()
            .map(|p| Ok(ise(input.t, measured, &simulate(model, p, input, start)?)))
            .collect();
    }
    parameters
        .par_chunks(TOGETHER)
        .map(|vectors| in_lanes(Together { model, vectors, input, start, measured }))
        .collect::<Vec<_>>()
        .into_iter()
        .flatten()
        .collect()
}

/// The ISE of one simulation.
fn ise(t: &[f64], measured: &[[f64; 2]], motion: &[State]) -> f64 {
    let square = |k: usize| {
        let e = [0, 1].map(|i| measured[k][i] - motion[k].omega[i]);
        e[0] * e[0] + e[1] * e[1]
    };
    trapezoid(t, std::slice::from_ref(&(0..t.len())), square)
}

/// Up to [`TOGETHER`] simulations.
struct Together<'a> {
    model: &'a Model,
    vectors: &'a [Vec<f64>],
    input: &'a Input<'a>,
    start: State,
    measured: &'a [[f64; 2]],
}

impl<'a> WithSimd for Together<'a> {
    type Output = Vec<Result<f64, SimulateError>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { model, vectors, input, start, measured } = self;
        let some = vectors.chunks(Lanes::<S>::COUNT);
        let scored = |vectors: &'a [Vec<f64>]| {
            let simulations: Vec<_> = vectors.iter().map(|p| (&p[..], start)).collect();
            Scored::new(simd, Batch::new(simd, model, input.t[0], &simulations), &measured[0])
        };
        let mut batches: Vec<Scored<S>> = some.map(scored).collect();
        for k in 1..input.t.len() {
            let (from, to) = (input.t[k - 1], input.t[k]);
            let last = if input.hold == Hold::Linear { k } else { k - 1 };
            let input = InputLine::new(from, to, &input.torque[k - 1], &input.torque[last]);
            let pieces = pieces_between(from, to);
            for piece in 0..pieces {
                let edge = |piece: usize| edge(from, to, (piece, pieces));
                let part = alike(simd, (edge(piece), edge(piece + 1)), &input);
                for scored in &mut batches {
                    scored.batch.advance(&part, |_| input);
                }
            }
            for scored in &mut batches {
                scored.add(&measured[k], from, to);
            }
        }
        batches.into_iter().flat_map(Scored::finished).collect()
    }
}

/// An internal step with the same input in all lanes.
#[inline(always)]
fn alike<S: Simd>(simd: S, (from, to): (f64, f64), input: &InputLine) -> Part<S> {
    let [start, middle, end] = [input.at(from), input.at(from + 0.5 * (to - from)), input.at(to)];
    let torque = [
        [Lanes::splat(simd, start[0]), Lanes::splat(simd, start[1])],
        [Lanes::splat(simd, middle[0]), Lanes::splat(simd, middle[1])],
        [Lanes::splat(simd, end[0]), Lanes::splat(simd, end[1])],
    ];
    Part { from, to, torque }
}

/// Simulations, and the ISE of each.
struct Scored<'a, S: Simd> {
    batch: Batch<'a, S>,
    /// ISE so far, and the squared error of the previous row.
    sum: Lanes<S>,
    before: Lanes<S>,
}

impl<'a, S: Simd> Scored<'a, S> {
    fn new(simd: S, batch: Batch<'a, S>, measured: &[f64; 2]) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let mut scored = Self { batch, sum: zero, before: zero };
        scored.before = scored.square(measured);
        scored
    }

    /// Adds the errors of the present row.
    #[inline(always)]
    fn add(&mut self, measured: &[f64; 2], from: f64, to: f64) {
        self.batch.limit(to);
        let after = self.square(measured);
        self.sum = self.sum + (self.before + after) * (0.5 * (to - from));
        self.before = after;
    }

    #[inline(always)]
    fn square(&self, measured: &[f64; 2]) -> Lanes<S> {
        let omega = &self.batch.omega;
        let (first, second) = (omega[0] - measured[0], omega[1] - measured[1]);
        first * first + second * second
    }

    fn finished(self) -> Vec<Result<f64, SimulateError>> {
        let sums = stored(self.sum);
        let outcomes = self.batch.failures().into_iter().zip(sums);
        outcomes.map(|(failed, sum)| failed.map_or(Ok(sum), Err)).collect()
    }
}

#[cfg(test)]
mod tests;
