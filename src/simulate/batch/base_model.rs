//! Simulations of the base model in the lanes of the processor.

use pulp::Simd;

use super::super::SimulateError;
use super::super::forces::CLEARLY;
use super::super::input_line::InputLine;
use super::super::stepper::{SPEED_LIMIT, Stepper};
use crate::effects::BASE;
use crate::math::{Lanes, Mask, are_wide};
use crate::model::{Model, base};
use crate::robot::{BaseParameters, State, centrifugal_torques};

/// Numbers in the widest register.
pub(super) const LARGEST: usize = 8;

/// Whether a model is simulated in lanes: the base model, where the registers are wide.
pub(crate) fn has_lanes(model: &Model) -> bool {
    are_wide() && model.effects().iter().map(|effect| effect.id()).eq(BASE)
}

/// One internal step, with the input at its start, middle and end [N m].
pub(super) struct Part<S: Simd> {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) torque: [Wheels<S>; 3],
}

/// Parameters and initial state of a simulation.
pub(super) type Simulation<'a> = (&'a [f64], State);

/// A number in each lane for each wheel.
pub(super) type Wheels<S> = [Lanes<S>; 2];

/// Simulations of the base model, one per lane of a register.
pub(super) struct Batch<'a, S: Simd> {
    simd: S,
    a2: Lanes<S>,
    /// Inverse of the mass matrix (diagonal and off-diagonal entry), and reciprocal of a1.
    inverse: [Lanes<S>; 2],
    alone: Lanes<S>,
    a3: Lanes<S>,
    /// Friction levels, non-negative.
    level: Wheels<S>,
    pub(super) omega: Wheels<S>,
    /// Lanes without a positive definite mass matrix, for which the scalar integrator returns the error.
    refused: Mask<S>,
    /// One integrator per simulation, for steps with a change of the contact state.
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
    /// Simulations from their parameters and initial states, with times relative to `origin` \[s\].
    pub(super) fn new(
        simd: S,
        model: &'a Model,
        origin: f64,
        simulations: &[Simulation<'a>],
    ) -> Self {
        let states = |of: &dyn Fn(&Simulation) -> f64| {
            let one = |lane: usize| of(&simulations[lane.min(simulations.len() - 1)]);
            Lanes::load(simd, &(0..Lanes::<S>::COUNT).map(one).collect::<Vec<f64>>())
        };
        // unused lanes repeat the last simulation
        let lanes = |of: &dyn Fn(BaseParameters) -> f64| states(&|(p, _)| of(base::of(p)));
        let one = Lanes::splat(simd, 1.0);
        let sound = |a: BaseParameters| f64::from(u8::from(a.has_positive_mass()));
        Self {
            simd,
            a2: lanes(&|a| a.a2),
            inverse: [lanes(&|a| a.a1 / a.determinant()), lanes(&|a| -a.a2 / a.determinant())],
            alone: lanes(&|a| 1.0 / a.a1),
            a3: lanes(&|a| a.a3),
            level: [lanes(&|a| a.a4.max(0.0)), lanes(&|a| a.a5.max(0.0))],
            omega: [states(&|(_, start)| start.omega[0]), states(&|(_, start)| start.omega[1])],
            refused: lanes(&sound).below(one),
            scalar: simulations.iter().map(|(p, s)| Stepper::new(model, p, origin, *s)).collect(),
            failed: simulations.iter().map(|_| None).collect(),
        }
    }

    /// One internal step of all lanes; `input` gives that of a lane.
    #[inline(always)]
    pub(super) fn advance(&mut self, part: &Part<S>, input: impl Fn(usize) -> InputLine) {
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
    fn one_by_one(&mut self, flag: Lanes<S>, part: &Part<S>, input: impl Fn(usize) -> InputLine) {
        let (flags, omega) = (stored(flag), self.omega.map(stored));
        let [mut first, mut second] = omega;
        for (lane, scalar) in self.scalar.iter_mut().enumerate() {
            if flags[lane] == 0.0 || self.failed[lane].is_some() {
                continue;
            }
            // the base model does not depend on the angles
            scalar.place(State { alpha: [0.0; 2], omega: [first[lane], second[lane]] });
            match scalar.piece(part.from, part.to, &input(lane), &mut ()) {
                Ok(()) => [first[lane], second[lane]] = scalar.state().omega,
                Err(error) => self.failed[lane] = Some(error),
            }
        }
        self.omega = [Lanes::load(self.simd, &first), Lanes::load(self.simd, &second)];
    }

    /// Lanes beyond the speed limit at `t` have failed.
    #[inline(always)]
    pub(super) fn limit(&mut self, t: f64) {
        let limit = Lanes::splat(self.simd, SPEED_LIMIT);
        let [first, second] = self.omega;
        // NaN is not below the limit either
        let slow = first.abs().below(limit) & second.abs().below(limit);
        if !slow.all() {
            self.too_fast(t);
        }
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

    /// The error of every simulation that failed.
    pub(super) fn failures(self) -> Vec<Option<SimulateError>> {
        self.failed
    }

    /// One Runge-Kutta step of all lanes, and the lanes in which the contact state changes during the step.
    #[inline(always)]
    fn step(&self, h: f64, [start, middle, end]: &[Wheels<S>; 3]) -> (Wheels<S>, Mask<S>) {
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
    fn driven(&self, torque: &Wheels<S>, motion: &Motion<S>) -> Wheels<S> {
        let first = torque[0] - motion.friction[0];
        let second = torque[1] - motion.friction[1];
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
    fn loose(&self, w: &Wheels<S>, torque: &Wheels<S>, motion: &Motion<S>) -> Mask<S> {
        let turning = centrifugal_torques(self.a3, *w);
        let a = self.acceleration(w, &self.driven(torque, motion), motion);
        let (zero, one) = (Lanes::splat(self.simd, 0.0), Lanes::splat(self.simd, 1.0));
        let mut held = [one; 2];
        for i in 0..2 {
            // a sticking wheel has no friction yet
            let b = torque[i] - turning[i];
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
pub(super) fn stored<S: Simd>(lanes: Lanes<S>) -> [f64; LARGEST] {
    let mut out = [0.0; LARGEST];
    lanes.store(&mut out);
    out
}
