//! Simulations with many parameter vectors and one input in the lanes of the processor; each is reduced to
//! its ISE.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::forces::CLEARLY;
use super::input_line::InputLine;
use super::stepper::{SPEED_LIMIT, Stepper, edge, pieces_between};
use super::{Hold, Input, SimulateError, simulate};
use crate::effects::BASE;
use crate::math::{Lanes, Mask, are_wide, in_lanes, trapezoid};
use crate::model::{Model, base};
use crate::robot::{BaseParameters, State, centrifugal_torques};

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
    if !are_wide() || !model.effects().iter().map(|effect| effect.id()).eq(BASE) {
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

impl WithSimd for Together<'_> {
    type Output = Vec<Result<f64, SimulateError>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { model, vectors, input, start, measured } = self;
        let some = vectors.chunks(Lanes::<S>::COUNT);
        let mut batches: Vec<Batch<S>> =
            some.map(|vectors| Batch::new(simd, model, vectors, input, start)).collect();
        for batch in &mut batches {
            batch.before = batch.square(&measured[0]);
        }
        for k in 1..input.t.len() {
            let (from, to) = (input.t[k - 1], input.t[k]);
            let last = if input.hold == Hold::Linear { k } else { k - 1 };
            let input = InputLine::new(from, to, &input.torque[k - 1], &input.torque[last]);
            let pieces = pieces_between(from, to);
            for piece in 0..pieces {
                let part = Part::of(piece, pieces, (from, to), &input);
                for batch in &mut batches {
                    batch.advance(&part, &input);
                }
            }
            for batch in &mut batches {
                batch.add(&measured[k], from, to);
            }
        }
        batches.into_iter().flat_map(Batch::finished).collect()
    }
}

/// One internal step, with the input at its start, middle and end [N m].
struct Part {
    from: f64,
    to: f64,
    torque: [[f64; 2]; 3],
}

impl Part {
    fn of(piece: usize, pieces: usize, (from, to): (f64, f64), input: &InputLine) -> Self {
        let edge = |piece: usize| edge(from, to, (piece, pieces));
        let (from, to) = (edge(piece), edge(piece + 1));
        let torque = [input.at(from), input.at(from + 0.5 * (to - from)), input.at(to)];
        Self { from, to, torque }
    }
}

/// A number in each lane for each wheel.
type Wheels<S> = [Lanes<S>; 2];

/// Simulations of the base model, one per lane of a register.
struct Batch<'a, S: Simd> {
    simd: S,
    a2: Lanes<S>,
    /// Inverse of the mass matrix (diagonal and off-diagonal entry), and reciprocal of a1.
    inverse: [Lanes<S>; 2],
    alone: Lanes<S>,
    a3: Lanes<S>,
    /// Friction levels, non-negative.
    level: Wheels<S>,
    omega: Wheels<S>,
    /// Lanes without a positive definite mass matrix, for which the scalar integrator returns the error.
    refused: Mask<S>,
    /// ISE so far, and the squared error of the previous row.
    sum: Lanes<S>,
    before: Lanes<S>,
    /// One integrator per vector, for steps with a change of the contact state.
    scalar: Vec<Stepper<'a>>,
    failed: Vec<Option<SimulateError>>,
}

/// Motion during a step: friction, and the inverse of the mass matrix without the rows of sticking wheels.
struct Motion<S: Simd> {
    friction: Wheels<S>,
    stuck: [Mask<S>; 2],
    any_stuck: bool,
    mobility: [Lanes<S>; 3],
}

impl<'a, S: Simd> Batch<'a, S> {
    fn new(
        simd: S,
        model: &'a Model,
        vectors: &'a [Vec<f64>],
        input: &Input,
        start: State,
    ) -> Self {
        // unused lanes repeat the last vector
        let lanes = |of: &dyn Fn(BaseParameters) -> f64| {
            let one = |lane: usize| of(base::of(&vectors[lane.min(vectors.len() - 1)]));
            Lanes::load(simd, &(0..Lanes::<S>::COUNT).map(one).collect::<Vec<f64>>())
        };
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let sound = |a: BaseParameters| f64::from(u8::from(a.has_positive_mass()));
        Self {
            simd,
            a2: lanes(&|a| a.a2),
            inverse: [lanes(&|a| a.a1 / a.determinant()), lanes(&|a| -a.a2 / a.determinant())],
            alone: lanes(&|a| 1.0 / a.a1),
            a3: lanes(&|a| a.a3),
            level: [lanes(&|a| a.a4.max(0.0)), lanes(&|a| a.a5.max(0.0))],
            omega: start.omega.map(|w| Lanes::splat(simd, w)),
            refused: lanes(&sound).below(one),
            sum: zero,
            before: zero,
            scalar: vectors.iter().map(|p| Stepper::new(model, p, input.t[0], start)).collect(),
            failed: vectors.iter().map(|_| None).collect(),
        }
    }

    /// One internal step of all lanes.
    #[inline(always)]
    fn advance(&mut self, part: &Part, input: &InputLine) {
        let before = self.omega;
        let (after, event) = self.step(part.to - part.from, &part.torque);
        self.omega = after;
        if event.any() {
            self.omega = [event.select(before[0], after[0]), event.select(before[1], after[1])];
            let (zero, one) = (Lanes::splat(self.simd, 0.0), Lanes::splat(self.simd, 1.0));
            self.one_by_one(event.select(one, zero), part, input);
        }
    }

    /// Integrates the lanes with a `flag` by the scalar integrator.
    #[inline(never)]
    fn one_by_one(&mut self, flag: Lanes<S>, part: &Part, input: &InputLine) {
        let (flags, omega) = (stored(flag), self.omega.map(stored));
        let [mut first, mut second] = omega;
        for (lane, scalar) in self.scalar.iter_mut().enumerate() {
            if flags[lane] == 0.0 || self.failed[lane].is_some() {
                continue;
            }
            // the base model does not depend on the angles
            scalar.place(State { alpha: [0.0; 2], omega: [first[lane], second[lane]] });
            match scalar.piece(part.from, part.to, input, &mut ()) {
                Ok(()) => [first[lane], second[lane]] = scalar.state().omega,
                Err(error) => self.failed[lane] = Some(error),
            }
        }
        self.omega = [Lanes::load(self.simd, &first), Lanes::load(self.simd, &second)];
    }

    /// Adds the errors of the present row; lanes beyond the speed limit have failed.
    #[inline(always)]
    fn add(&mut self, measured: &[f64; 2], from: f64, to: f64) {
        let limit = Lanes::splat(self.simd, SPEED_LIMIT);
        let [first, second] = self.omega;
        // NaN is not below the limit either
        let slow = first.abs().below(limit) & second.abs().below(limit);
        if !slow.all() {
            self.too_fast(to);
        }
        let after = self.square(measured);
        self.sum = self.sum + (self.before + after) * (0.5 * (to - from));
        self.before = after;
    }

    #[inline(never)]
    fn too_fast(&mut self, t: f64) {
        let omega = self.omega.map(stored);
        for (lane, failed) in self.failed.iter_mut().enumerate() {
            if !omega.iter().all(|w| w[lane].abs() < SPEED_LIMIT) {
                failed.get_or_insert(SimulateError::Diverged { t, limit: SPEED_LIMIT });
            }
        }
    }

    #[inline(always)]
    fn square(&self, measured: &[f64; 2]) -> Lanes<S> {
        let (first, second) = (self.omega[0] - measured[0], self.omega[1] - measured[1]);
        first * first + second * second
    }

    fn finished(self) -> Vec<Result<f64, SimulateError>> {
        let sums = stored(self.sum);
        let outcomes = self.failed.into_iter().zip(sums);
        outcomes.map(|(failed, sum)| failed.map_or(Ok(sum), Err)).collect()
    }

    /// One Runge-Kutta step of all lanes, and the lanes in which the contact state changes during the step.
    #[inline(always)]
    fn step(&self, h: f64, [start, middle, end]: &[[f64; 2]; 3]) -> (Wheels<S>, Mask<S>) {
        let motion = self.motion();
        let w = self.omega;
        let (half, whole) = (Lanes::splat(self.simd, 0.5 * h), Lanes::splat(self.simd, h));
        let in_middle = self.driven(middle, &motion);
        let first = self.acceleration(&w, &self.driven(start, &motion), &motion);
        let second = self.acceleration(&along(&w, half, &first), &in_middle, &motion);
        let third = self.acceleration(&along(&w, half, &second), &in_middle, &motion);
        let at_end = self.driven(end, &motion);
        let fourth = self.acceleration(&along(&w, whole, &third), &at_end, &motion);
        let (two, sixth) = (Lanes::splat(self.simd, 2.0), Lanes::splat(self.simd, h / 6.0));
        let mut mean = w;
        for i in 0..2 {
            mean[i] = (second[i] + third[i]).times_plus(two, first[i] + fourth[i]);
        }
        let after = along(&w, sixth, &mean);
        let zero = Lanes::splat(self.simd, 0.0);
        let reversed = (motion.friction[0] * after[0]).below(zero)
            | (motion.friction[1] * after[1]).below(zero);
        let mut event = self.refused | reversed;
        if motion.any_stuck {
            event = event | self.loose(&w, start, &motion) | self.loose(&after, end, &motion);
        }
        (after, event)
    }

    /// Moving wheels slide, wheels at rest stick.
    #[inline(always)]
    fn motion(&self) -> Motion<S> {
        let zero = Lanes::splat(self.simd, 0.0);
        let (w, level) = (self.omega, self.level);
        let mut friction = [zero; 2];
        for i in 0..2 {
            let backward = w[i].below(zero).select(zero - level[i], zero);
            friction[i] = zero.below(w[i]).select(level[i], backward);
        }
        let stuck =
            [zero.below(level[0]) & w[0].equals(zero), zero.below(level[1]) & w[1].equals(zero)];
        let any_stuck = (stuck[0] | stuck[1]).any();
        let [diagonal, beside] = self.inverse;
        let mut mobility = [diagonal, beside, diagonal];
        if any_stuck {
            mobility = [
                stuck[0].select(zero, stuck[1].select(self.alone, diagonal)),
                (stuck[0] | stuck[1]).select(zero, beside),
                stuck[1].select(zero, stuck[0].select(self.alone, diagonal)),
            ];
        }
        Motion { friction, stuck, any_stuck, mobility }
    }

    /// Accelerations due to input and friction.
    #[inline(always)]
    fn driven(&self, torque: &[f64; 2], motion: &Motion<S>) -> Wheels<S> {
        let first = Lanes::splat(self.simd, torque[0]) - motion.friction[0];
        let second = Lanes::splat(self.simd, torque[1]) - motion.friction[1];
        let [m11, m12, m22] = motion.mobility;
        [m11.times_plus(first, m12 * second), m22.times_plus(second, m12 * first)]
    }

    /// Accelerations at the speeds `w`: `driven`, and those due to the centrifugal torques a3 w2 (w2 - w1) and
    /// a3 w1 (w1 - w2).
    #[inline(always)]
    fn acceleration(&self, w: &Wheels<S>, driven: &Wheels<S>, motion: &Motion<S>) -> Wheels<S> {
        let turn = self.a3 * (w[1] - w[0]);
        let [m11, m12, m22] = motion.mobility;
        [
            turn.times_plus(m12 * w[0] - m11 * w[1], driven[0]),
            turn.times_plus(m22 * w[0] - m12 * w[1], driven[1]),
        ]
    }

    /// Lanes in which a sticking wheel is not clearly held against the torque that the other wheel transmits
    /// through a2, or another wheel is at rest.
    #[inline(always)]
    fn loose(&self, w: &Wheels<S>, torque: &[f64; 2], motion: &Motion<S>) -> Mask<S> {
        let turning = centrifugal_torques(self.a3, *w);
        let a = self.acceleration(w, &self.driven(torque, motion), motion);
        let (zero, one) = (Lanes::splat(self.simd, 0.0), Lanes::splat(self.simd, 1.0));
        let mut held = [one; 2];
        for i in 0..2 {
            // a sticking wheel has no friction yet
            let b = Lanes::splat(self.simd, torque[i]) - turning[i];
            let need = (b - self.a2 * a[1 - i]).abs();
            let enough = need.below(self.level[i] * CLEARLY).select(one, zero);
            let moves = w[i].equals(zero).select(zero, one);
            held[i] = motion.stuck[i].select(enough, moves);
        }
        (held[0] * held[1]).below(one)
    }
}

/// `w + h k`.
#[inline(always)]
fn along<S: Simd>(w: &Wheels<S>, h: Lanes<S>, k: &Wheels<S>) -> Wheels<S> {
    [k[0].times_plus(h, w[0]), k[1].times_plus(h, w[1])]
}

/// The number of each lane; zeros beyond the width of the register.
fn stored<S: Simd>(lanes: Lanes<S>) -> [f64; TOGETHER] {
    let mut out = [0.0; TOGETHER];
    lanes.store(&mut out);
    out
}

#[cfg(test)]
mod tests;
