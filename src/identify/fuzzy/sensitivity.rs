//! A run of the emulator with the derivative of its integrator by all consequents (and premises).

use wide::f64x2;

use super::pass::{Emulator, LIMIT};
use super::piece::{Interval, Piece};
use super::rows::Rows;
use crate::simulate::{Rules, Structure, TakagiSugeno, WithRules};

/// A matrix of two rows and columns, by columns.
type Square = [f64x2; 2];

const IDENTITY: Square = [f64x2::new([1.0, 0.0]), f64x2::new([0.0, 1.0])];

fn product(a: &Square, b: &Square) -> Square {
    b.map(|column| applied(a, column))
}

#[inline(always)]
fn applied(a: &Square, x: f64x2) -> f64x2 {
    let [first, second] = x.to_array();
    a[0] * f64x2::splat(first) + a[1] * f64x2::splat(second)
}

/// Share of the step at which a stage of Runge-Kutta 4 is evaluated, and its weight in sixths.
const STAGES: [(f64, f64); 4] = [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)];

/// Normal equations of one piece, as [`super::pass::pass`] runs through it; false where the emulator
/// diverges.
///
/// ```text
/// S' = J S + Phi,   J = ∂fhat/∂what - K   (serial-parallel: -K),   Phi = ∂fhat/∂theta
/// S+ = F S + Σ_s L_s Phi_s,   L_s = ∂w+/∂k_s = h/6 b_s + c_(s+1) h L_(s+1) J_(s+1)
/// ```
/// over the consequents `free` of either output,
/// with the stages k_s of Runge-Kutta 4, their weights b_s/6 and places c_s: the derivative of the very
/// scheme. Derived here, by the chain rule.
pub(super) fn pass_with_sensitivities(
    system: &TakagiSugeno,
    piece: &Piece,
    emulator: Emulator,
    free: &[usize],
    premises: bool,
    rows: &mut Rows,
) -> bool {
    system.with_rules(Sensitive { system, piece, emulator, free, premises, rows })
}

struct Sensitive<'a> {
    system: &'a TakagiSugeno,
    piece: &'a Piece,
    emulator: Emulator,
    free: &'a [usize],
    premises: bool,
    rows: &'a mut Rows,
}

/// A step of the speeds, linearised.
struct Step<const N: usize> {
    /// The speeds after it [rad/s].
    after: f64x2,
    /// F, their derivative to those before it.
    transition: Square,
    /// L_s, per stage s of the Runge-Kutta step.
    reach: [Square; 4],
    /// Where each stage evaluates the rules [rad/s].
    at: [f64x2; 4],
    /// Strengths along both inputs there.
    strength: [[f64x2; N]; 4],
}

impl WithRules for Sensitive<'_> {
    type Output = bool;

    fn run<const N: usize>(self, rules: &Rules<N>) -> bool {
        let Self { system, piece, emulator, free, premises, rows } = self;
        let p = rows.columns();
        let places: Vec<_> = free.iter().map(|&k| system.place(k)).collect();
        let mut w = f64x2::new(piece.omega[0]);
        let mut s = [vec![0.0; p], vec![0.0; p]];
        let mut bases = [0; 4].map(|_| vec![0.0; free.len()]);
        for k in 1..piece.t.len() {
            let interval = piece.interval(k);
            for number in 0..interval.steps {
                let step = step(rules, emulator, &interval, number, w);
                for (s, basis) in bases.iter_mut().enumerate() {
                    rules.basis(&step.strength[s], step.at[s], &places, basis);
                }
                move_consequents(&step, &bases, &mut s);
                if premises {
                    move_premises(system, &step, 2 * free.len(), &mut s);
                }
                w = step.after;
            }
            if !w.abs().simd_lt(f64x2::splat(LIMIT)).all() {
                return false;
            }
            let e = f64x2::new(piece.omega[k]) - w;
            for (row, e) in s.iter().zip(e.to_array()) {
                rows.push(row, &[e], piece.weight(k));
            }
        }
        true
    }
}

/// One step from `w`.
#[inline]
fn step<const N: usize>(
    rules: &Rules<N>,
    emulator: Emulator,
    interval: &Interval,
    number: usize,
    w: f64x2,
) -> Step<N> {
    let h = interval.h;
    let gain = f64x2::splat(emulator.gain);
    let (mut rate, mut sum, mut at) = (f64x2::ZERO, f64x2::ZERO, [f64x2::ZERO; 4]);
    let mut strength = [[f64x2::ZERO; N]; 4];
    // derivative of the stage's rate to its own argument, and to the speeds before the step
    let (mut own, mut by_start, mut total) = ([IDENTITY; 4], [f64x2::ZERO; 2], [f64x2::ZERO; 2]);
    for (s, (c, weight)) in STAGES.into_iter().enumerate() {
        let (y, u) = interval.at(number, c);
        let (y, u) = (f64x2::new(y), f64x2::new(u));
        let x = w + rate * (c * h);
        at[s] = if emulator.structure == Structure::Parallel { x } else { y };
        let f = rules.slopes(at[s]);
        strength[s] = f.strength;
        rate = f.value + u + (y - x) * gain;
        sum += rate * weight;
        let by = if emulator.structure == Structure::Parallel { f.by } else { [f64x2::ZERO; 2] };
        own[s] = [0, 1].map(|i| by[i] - IDENTITY[i] * gain);
        let argument = [0, 1].map(|i| IDENTITY[i] + by_start[i] * (c * h));
        by_start = product(&own[s], &argument);
        total = [0, 1].map(|i| total[i] + by_start[i] * weight);
    }
    let mut reach = STAGES.map(|(_, weight)| IDENTITY.map(|column| column * (weight * h / 6.0)));
    for s in (0..3).rev() {
        let through = product(&reach[s + 1], &own[s + 1]);
        reach[s] = [0, 1].map(|i| reach[s][i] + through[i] * (STAGES[s + 1].0 * h));
    }
    Step {
        after: w + sum * (h / 6.0),
        transition: [0, 1].map(|i| IDENTITY[i] + total[i] * (h / 6.0)),
        reach,
        at,
        strength,
    }
}

/// S over one step: the columns of f31, then those of f41.
#[inline]
fn move_consequents<const N: usize>(step: &Step<N>, bases: &[Vec<f64>; 4], s: &mut [Vec<f64>; 2]) {
    let n = bases[0].len();
    let [f1, f2] = step.transition.map(f64x2::to_array);
    let [first, second] = s;
    for o in 0..2 {
        let reach = step.reach.map(|reach| reach[o].to_array());
        let [b0, b1, b2, b3] = bases;
        let columns = first[o * n..].iter_mut().zip(&mut second[o * n..]);
        let bases = b0.iter().zip(b1).zip(b2.iter().zip(b3));
        for ((s1, s2), ((b0, b1), (b2, b3))) in columns.zip(bases) {
            let (x, y) = (*s1, *s2);
            let forced = |i: usize| {
                reach[0][i] * b0 + reach[1][i] * b1 + reach[2][i] * b2 + reach[3][i] * b3
            };
            *s1 = f1[0] * x + f2[0] * y + forced(0);
            *s2 = f1[1] * x + f2[1] * y + forced(1);
        }
    }
}

/// The columns of the premises, which follow after `from` others.
fn move_premises<const N: usize>(
    system: &TakagiSugeno,
    step: &Step<N>,
    from: usize,
    s: &mut [Vec<f64>; 2],
) {
    let slopes = step.at.map(|at| system.premise_gradient(&at.to_array()));
    for j in 0..slopes[0].len() {
        let before = f64x2::new([s[0][from + j], s[1][from + j]]);
        let mut after = applied(&step.transition, before);
        for (reach, slopes) in step.reach.iter().zip(&slopes) {
            after += applied(reach, f64x2::new(slopes[j]));
        }
        [s[0][from + j], s[1][from + j]] = after.to_array();
    }
}

/// Cost of one piece with its slope and curvature along one consequent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Along {
    /// ISE [rad²/s].
    pub(super) cost: f64,
    /// ∫ S'e dt: minus half the slope of the ISE.
    pub(super) g: f64,
    /// ∫ S'S dt: half the curvature, without that of the rules.
    pub(super) h: f64,
}

/// The same along consequent `j` alone; `None` where the emulator diverges.
pub(super) fn pass_along(
    system: &TakagiSugeno,
    piece: &Piece,
    emulator: Emulator,
    j: usize,
) -> Option<Along> {
    system.with_rules(OneColumn { system, piece, emulator, j })
}

struct OneColumn<'a> {
    system: &'a TakagiSugeno,
    piece: &'a Piece,
    emulator: Emulator,
    j: usize,
}

impl WithRules for OneColumn<'_> {
    type Output = Option<Along>;

    fn run<const N: usize>(self, rules: &Rules<N>) -> Option<Along> {
        let Self { system, piece, emulator, j } = self;
        let n = system.parameters().len() / 2;
        let (output, (rule, term)) = (j / n, system.place(j % n));
        let (mut w, mut s) = (f64x2::new(piece.omega[0]), f64x2::ZERO);
        let (mut cost, mut g, mut h) = (f64x2::ZERO, f64x2::ZERO, f64x2::ZERO);
        for k in 1..piece.t.len() {
            let interval = piece.interval(k);
            for number in 0..interval.steps {
                let step = step(rules, emulator, &interval, number, w);
                s = applied(&step.transition, s);
                for (stage, reach) in step.reach.iter().enumerate() {
                    let basis = rules.one(&step.strength[stage], step.at[stage], rule, term);
                    s += reach[output] * basis;
                }
                w = step.after;
            }
            if !w.abs().simd_lt(f64x2::splat(LIMIT)).all() {
                return None;
            }
            let (e, weight) = (f64x2::new(piece.omega[k]) - w, piece.weight(k));
            cost += e * e * weight;
            g += s * e * weight;
            h += s * s * weight;
        }
        let [cost, g, h] = [cost, g, h].map(f64x2::reduce_add);
        Some(Along { cost, g, h })
    }
}

/// The serial-parallel structure, linear in the consequents: Psi of one output is that of the
/// other, so one row serves the two errors.
pub(super) fn pass_closed(
    system: &TakagiSugeno,
    piece: &Piece,
    gain: f64,
    free: &[usize],
    rows: &mut Rows,
) {
    system.with_rules(Closed { system, free, piece, gain, rows });
}

struct Closed<'a> {
    system: &'a TakagiSugeno,
    free: &'a [usize],
    piece: &'a Piece,
    gain: f64,
    rows: &'a mut Rows,
}

impl WithRules for Closed<'_> {
    type Output = ();

    fn run<const N: usize>(self, rules: &Rules<N>) {
        let Self { system, free, piece, gain, rows } = self;
        let places: Vec<_> = free.iter().map(|&k| system.place(k)).collect();
        let mut w = f64x2::new(piece.omega[0]);
        let mut psi = vec![0.0; free.len()];
        let mut basis = [0; 3].map(|_| vec![0.0; free.len()]);
        for k in 1..piece.t.len() {
            let interval = piece.interval(k);
            // Runge-Kutta 4 of x' = -K x + b(t): x(1 - z + z²/2 - z³/6 + z⁴/24) + weights of b
            let (h, z) = (interval.h, gain * interval.h);
            let decay = 1.0 - z + z * z / 2.0 - z * z * z / 6.0 + z * z * z * z / 24.0;
            let weights = [
                h / 6.0 * (1.0 - z + z * z / 2.0 - z * z * z / 4.0),
                h / 6.0 * (4.0 - 2.0 * z + z * z / 2.0),
                h / 6.0,
            ];
            for step in 0..interval.steps {
                w *= f64x2::splat(decay);
                for (s, c) in [0.0, 0.5, 1.0].into_iter().enumerate() {
                    let (y, u) = interval.at(step, c);
                    let (y, u) = (f64x2::new(y), f64x2::new(u));
                    let f = rules.output(y) + u + y * gain;
                    w += f * weights[s];
                    rules.basis(&rules.strengths(y), y, &places, &mut basis[s]);
                }
                for (j, psi) in psi.iter_mut().enumerate() {
                    *psi = decay * *psi
                        + weights[0] * basis[0][j]
                        + weights[1] * basis[1][j]
                        + weights[2] * basis[2][j];
                }
            }
            let e = f64x2::new(piece.omega[k]) - w;
            rows.push(&psi, &e.to_array(), piece.weight(k));
        }
    }
}
