//! Many parameter vectors over one input at once: eight simulations side by side in the lanes of
//! the processor, each reduced to its ISE.

use std::convert::Infallible;

use rayon::prelude::*;
use wide::f64x8;

use super::drive::Drive;
use super::stepper::{SPEED_LIMIT, Stepper, pieces_between};
use super::{Hold, Input, SimulateError, simulate};
use crate::effects::BASE;
use crate::math::runge_kutta_step;
use crate::model::Model;
use crate::robot::State;

/// Simulations side by side.
const LANES: usize = 8;
/// A wheel counts as held only if what holds it is below its level by this share; what is closer
/// to breaking away is decided by the scalar rule.
const CLEARLY: f64 = 1.0 - 1e-9;

/// ISE of free simulations with many parameter vectors over one input.
///
/// ```text
/// ISE_n = ∫ (w1 - w1(θ_n))² + (w2 - w2(θ_n))² dt     [rad²/s], trapezoid
/// ```
/// `measured` are wheel speeds [rad/s], one row a sample of `input`. Nothing of the trajectories
/// is kept.
///
/// Of the base model (a1..a5) eight vectors at a time run through the steps of [`simulate`], in
/// the lanes of the processor. Sliding and sticking that last over a whole step are treated in the
/// lanes; where a wheel stops, reverses or breaks away within a step, that lane alone takes the
/// step by the scalar integrator. So the result is that of [`simulate`] to rounding. Models with
/// further effects are simulated one vector after the other.
///
/// # Errors
/// Each vector has its own result, with the errors of [`simulate`].
///
/// # Panics
/// If `measured` does not have one row a sample, or a vector not one value a parameter.
///
/// # Examples
/// ```
/// use amigo_ident::{model::Model, robot::{Robot, State}};
/// use amigo_ident::simulate::{Hold, Input, ise_of_many, simulate};
/// let model = Model::base(Robot::amigobot());
/// let t: Vec<f64> = (0..201).map(|k| 0.01 * k as f64).collect();
/// let moment = vec![[0.2, 0.15]; 201];
/// let input = Input { t: &t, moment: &moment, hold: Hold::Linear };
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
    let base = model.effects().iter().map(|effect| effect.id()).eq(BASE);
    if !base {
        return parameters
            .par_iter()
            .map(|p| Ok(ise(input.t, measured, &simulate(model, p, input, start)?)))
            .collect();
    }
    parameters
        .par_chunks(LANES)
        .map(|vectors| Batch::new(model, vectors, input, start).run(input, measured))
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
    (1..t.len()).map(|k| 0.5 * (t[k] - t[k - 1]) * (square(k - 1) + square(k))).sum()
}

/// A number in each lane for each wheel.
type Wheels = [f64x8; 2];

/// Up to eight simulations of the base model on their way.
struct Batch<'a> {
    a2: f64x8,
    /// Inverse of the mass matrix (on the diagonal, beside it), and of a1 alone.
    inverse: [f64x8; 2],
    alone: f64x8,
    a3: f64x8,
    /// Friction levels; not below zero.
    level: Wheels,
    omega: Wheels,
    /// Lanes with a positive definite mass matrix; the others are left to the scalar rule, which
    /// refuses them.
    sound: f64x8,
    /// One integrator a vector, for the steps that a lane cannot take.
    scalar: Vec<Stepper<'a>>,
    failed: [Option<SimulateError>; LANES],
}

/// How the wheels move through a step: the signs of friction and the inverse of the mass matrix
/// with the rows of wheels that stick taken out.
struct Motion {
    sign: Wheels,
    /// All bits set where the wheel sticks.
    stuck: Wheels,
    mobility: [f64x8; 3],
}

impl<'a> Batch<'a> {
    fn new(model: &'a Model, vectors: &'a [Vec<f64>], input: &Input, start: State) -> Self {
        // lanes that are left over repeat the last vector
        let column = |j: usize| {
            f64x8::new(std::array::from_fn(|lane| vectors[lane.min(vectors.len() - 1)][j]))
        };
        let zero = f64x8::ZERO;
        let (a1, a2) = (column(0), column(1));
        let determinant = a1 * a1 - a2 * a2;
        let scalar = vectors.iter().map(|p| Stepper::new(model, p, input.t[0], start)).collect();
        Self {
            a2,
            inverse: [a1 / determinant, -a2 / determinant],
            alone: f64x8::ONE / a1,
            a3: column(2),
            level: [column(3).max(zero), column(4).max(zero)],
            omega: start.omega.map(f64x8::splat),
            sound: a1.simd_gt(zero) & determinant.simd_gt(zero),
            scalar,
            failed: std::array::from_fn(|_| None),
        }
    }

    fn run(mut self, input: &Input, measured: &[[f64; 2]]) -> Vec<Result<f64, SimulateError>> {
        let mut sum = f64x8::ZERO;
        let mut before = self.square(&measured[0]);
        for k in 1..input.t.len() {
            let (from, to) = (input.t[k - 1], input.t[k]);
            let last = if input.hold == Hold::Linear { k } else { k - 1 };
            let drive = Drive::new(from, to, &input.moment[k - 1], &input.moment[last]);
            self.sample(from, to, &drive);
            let after = self.square(&measured[k]);
            sum += (before + after) * (0.5 * (to - from));
            before = after;
        }
        let sums = sum.to_array();
        let count = self.scalar.len();
        let outcomes = self.failed.into_iter().zip(sums).take(count);
        outcomes.map(|(failed, sum)| failed.map_or(Ok(sum), Err)).collect()
    }

    fn square(&self, measured: &[f64; 2]) -> f64x8 {
        let e = |i: usize| f64x8::splat(measured[i]) - self.omega[i];
        let (first, second) = (e(0), e(1));
        first * first + second * second
    }

    /// All lanes from one sample to the next.
    fn sample(&mut self, from: f64, to: f64, drive: &Drive) {
        let pieces = pieces_between(from, to);
        for piece in 0..pieces {
            let edge = |k: usize| from + (to - from) * k as f64 / pieces as f64;
            let (from, to) = (edge(piece), edge(piece + 1));
            let (after, smooth) = self.step(from, to, drive);
            let omega = self.omega;
            self.omega = [smooth.select(after[0], omega[0]), smooth.select(after[1], omega[1])];
            if !smooth.all() {
                self.one_by_one(!smooth.to_bitmask(), from, to, drive);
            }
        }
        let limit = f64x8::splat(SPEED_LIMIT);
        let slow = self.omega[0].abs().simd_lt(limit) & self.omega[1].abs().simd_lt(limit);
        if !slow.all() {
            let beyond = !slow.to_bitmask();
            for lane in (0..LANES).filter(|lane| beyond >> lane & 1 == 1) {
                let error = SimulateError::Diverged { t: to, limit: SPEED_LIMIT };
                self.failed[lane].get_or_insert(error);
            }
        }
    }

    /// The lanes whose bit is set take the step by the scalar rule.
    fn one_by_one(&mut self, lanes: u32, from: f64, to: f64, drive: &Drive) {
        let mut omega = self.omega.map(|w| w.to_array());
        for (lane, scalar) in self.scalar.iter_mut().enumerate() {
            if lanes >> lane & 1 == 0 || self.failed[lane].is_some() {
                continue;
            }
            // nothing in the base model depends on the angles
            scalar.place(State { alpha: [0.0; 2], omega: [omega[0][lane], omega[1][lane]] });
            match scalar.piece(from, to, drive, &mut ()) {
                Ok(()) => [omega[0][lane], omega[1][lane]] = scalar.state().omega,
                Err(error) => self.failed[lane] = Some(error),
            }
        }
        self.omega = omega.map(f64x8::new);
    }

    /// One Runge-Kutta step of all lanes, and the lanes in which its contact state holds
    /// throughout.
    #[inline]
    fn step(&self, from: f64, to: f64, drive: &Drive) -> (Wheels, f64x8) {
        let h = to - from;
        let middle = drive.at(from + 0.5 * h);
        let lanes = |[first, second]: [f64; 2]| [f64x8::splat(first), f64x8::splat(second)];
        let (start, middle, end) = (lanes(drive.at(from)), lanes(middle), lanes(drive.at(to)));
        let zero = f64x8::ZERO;
        let motion = self.motion();
        let w = self.omega;
        let Ok(after) = runge_kutta_step(&w, h, |c, w| {
            let drive = if c == 0.0 {
                &start
            } else if c < 1.0 {
                &middle
            } else {
                &end
            };
            Ok::<_, Infallible>(self.acceleration(w, drive, &motion))
        });
        let reversed =
            (motion.sign[0] * after[0]).simd_lt(zero) | (motion.sign[1] * after[1]).simd_lt(zero);
        let mut smooth = self.sound & !reversed;
        if (motion.stuck[0] | motion.stuck[1]).any() {
            smooth &= self.holds(&w, &start, &motion) & self.holds(&after, &end, &motion);
        }
        (after, smooth)
    }

    /// Wheels that turn slide; those that do not, stick.
    #[inline]
    fn motion(&self) -> Motion {
        let (zero, one) = (f64x8::ZERO, f64x8::ONE);
        let rough = [self.level[0].simd_gt(zero), self.level[1].simd_gt(zero)];
        let sign = |i: usize| {
            let w = self.omega[i];
            let side = w.simd_gt(zero).select(one, w.simd_lt(zero).select(-one, zero));
            rough[i] & side
        };
        let sign = [sign(0), sign(1)];
        let stuck = |i: usize| rough[i] & self.omega[i].simd_eq(zero);
        let stuck = [stuck(0), stuck(1)];
        let [diagonal, beside] = self.inverse;
        let mut mobility = [diagonal, beside, diagonal];
        if (stuck[0] | stuck[1]).any() {
            mobility = [
                stuck[0].select(zero, stuck[1].select(self.alone, diagonal)),
                (stuck[0] | stuck[1]).select(zero, beside),
                stuck[1].select(zero, stuck[0].select(self.alone, diagonal)),
            ];
        }
        Motion { sign, stuck, mobility }
    }

    /// What drives each wheel beside the inertia: torque less centrifugal torque and friction.
    #[inline]
    fn force(&self, w: &Wheels, moment: &Wheels, motion: &Motion) -> Wheels {
        let turn = self.a3 * (w[1] - w[0]); // eq. (14)
        [
            moment[0] - turn * w[1] - self.level[0] * motion.sign[0],
            moment[1] + turn * w[0] - self.level[1] * motion.sign[1],
        ]
    }

    #[inline]
    fn acceleration(&self, w: &Wheels, moment: &Wheels, motion: &Motion) -> Wheels {
        let b = self.force(w, moment, motion);
        let [m11, m12, m22] = motion.mobility;
        [m11 * b[0] + m12 * b[1], m12 * b[0] + m22 * b[1]]
    }

    /// Lanes in which every wheel that sticks is clearly held, against the pull of the other one
    /// through a2, and every other one moves.
    #[inline]
    fn holds(&self, w: &Wheels, moment: &Wheels, motion: &Motion) -> f64x8 {
        let b = self.force(w, moment, motion);
        let a = self.acceleration(w, moment, motion);
        let held = [0, 1].map(|i| {
            let need = (b[i] - self.a2 * a[1 - i]).abs();
            let moves = !w[i].simd_eq(f64x8::ZERO);
            motion.stuck[i].select(need.simd_lt(self.level[i] * CLEARLY), moves)
        });
        held[0] & held[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use rand::{Rng, SeedableRng};

    /// Torques that start, reverse and stop both wheels, and rest between.
    fn lively(t: &[f64]) -> Vec<[f64; 2]> {
        let push = |t: f64| if t % 7.0 < 5.0 { 1.0 } else { 0.2 };
        let one = |t: f64| [0.35 * (2.1 * t).sin() + 0.05, 0.3 * (1.7 * t + 0.4).sin()];
        t.iter().map(|&t| one(t).map(|m| push(t) * m)).collect()
    }

    /// Times with steps between 1 ms and 50 ms, which are cut into pieces of 20 ms.
    fn uneven(count: usize, rng: &mut impl Rng) -> Vec<f64> {
        let mut t = vec![3.0];
        for k in 1..count {
            let step = if k % 50 == 0 { 0.05 } else { rng.random_range(0.001..0.015) };
            t.push(t[k - 1] + step);
        }
        t
    }

    fn compare(model: &Model, parameters: &[Vec<f64>], input: &Input, start: State) {
        let measured: Vec<_> = input.t.iter().map(|&t| [3.0 * t.sin(), 2.0 * t.cos()]).collect();
        let many = ise_of_many(model, parameters, input, start, &measured);
        assert_eq!(many.len(), parameters.len());
        for (n, (p, lane)) in parameters.iter().zip(many).enumerate() {
            let one = simulate(model, p, input, start).map(|m| ise(input.t, &measured, &m));
            match (one, lane) {
                // rounding: 4000 steps of 1e-16 each, carried on by free wheels
                (Ok(a), Ok(b)) => assert!((a - b).abs() <= 1e-9 * a, "{n} {p:?}: {a} {b}"),
                (a, b) => assert_eq!(a.unwrap_err(), b.unwrap_err(), "{n} {p:?}"),
            }
        }
    }

    #[test]
    fn lanes_equal_single_simulations_through_stops_reversals_and_rest() {
        let model = Model::base(Robot::amigobot());
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let t = uneven(4000, &mut rng);
        let moment = lively(&t);
        let mut parameters: Vec<Vec<f64>> = (0..29)
            .map(|_| model.initial().iter().map(|a| a * rng.random_range(0.5..1.6)).collect())
            .collect();
        parameters[1][3] = 0.0; // no friction: never sticks
        parameters[2][4] = -0.1; // counts as none
        parameters[3][3] = 1.0; // never moves
        parameters[4][1] = 2.0 * parameters[4][0]; // no acceleration
        let start = State { alpha: [0.3, -1.0], omega: [0.0, 2.0] };
        for hold in [Hold::Linear, Hold::Constant] {
            compare(&model, &parameters, &Input { t: &t, moment: &moment, hold }, start);
        }
        // nothing pushes: both wheels coast to rest and stay
        let none = vec![[0.0; 2]; t.len()];
        compare(&model, &parameters, &Input { t: &t, moment: &none, hold: Hold::Linear }, start);
    }

    #[test]
    fn a_lane_that_diverges_says_so_and_leaves_the_others_alone() {
        let model = Model::base(Robot::amigobot());
        let t: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
        let moment = vec![[40.0, -3.0]; 500];
        let mut parameters = vec![model.initial(); 3];
        parameters[1][0] = 5e-5;
        parameters[1][1] = 0.0;
        parameters[1][2] = 0.0;
        let input = Input { t: &t, moment: &moment, hold: Hold::Linear };
        let found = ise_of_many(&model, &parameters, &input, State::default(), &moment);
        assert!(matches!(found[1], Err(SimulateError::Diverged { .. })), "{:?}", found[1]);
        compare(&model, &parameters, &input, State::default());
    }

    #[test]
    fn models_with_further_effects_are_simulated_one_by_one() {
        let model = Model::base(Robot::amigobot()).add("viscous_friction").unwrap();
        let t: Vec<f64> = (0..300).map(|k| 0.01 * f64::from(k)).collect();
        let moment = lively(&t);
        let parameters = vec![model.initial(); 3];
        let input = Input { t: &t, moment: &moment, hold: Hold::Linear };
        compare(&model, &parameters, &input, State::default());
    }
}
