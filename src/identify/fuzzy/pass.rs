//! One run of the emulator over a piece of a recording: wheel speeds alone, Runge-Kutta 4. Numbers
//! stand side by side: both wheels of one emulator, or several emulators.

use std::convert::Infallible;
use std::ops::{Add, BitAnd, Mul, Sub};

use wide::{f64x2, f64x4};

use super::piece::Piece;
use crate::math::runge_kutta_step;
use crate::simulate::{Rules, RulesSideBySide, SIDE_BY_SIDE, Structure, TakagiSugeno, WithRules};

/// A wheel speed beyond which a trial has left all bounds [rad/s].
pub(super) const LIMIT: f64 = 1e3;

/// The emulator of eq. (19) around the rules.
#[derive(Clone, Copy)]
pub(super) struct Emulator {
    /// Where the rules take their argument from.
    pub(super) structure: Structure,
    /// K on both wheel speeds [1/s].
    pub(super) gain: f64,
}

/// Numbers side by side in a register.
trait Numbers:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + BitAnd<Output = Self>
{
    const ZERO: Self;
    /// All bits set where the number is within ± `limit`; not where it is none.
    fn within(self, limit: f64) -> Self;
    /// Whether the bits of any place are set.
    fn any(self) -> bool;
}

impl Numbers for f64x2 {
    const ZERO: Self = Self::ZERO;
    #[inline(always)]
    fn within(self, limit: f64) -> Self {
        self.abs().simd_lt(Self::splat(limit))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.to_bitmask() != 0
    }
}

impl Numbers for f64x4 {
    const ZERO: Self = Self::ZERO;
    #[inline(always)]
    fn within(self, limit: f64) -> Self {
        self.abs().simd_lt(Self::splat(limit))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.to_bitmask() != 0
    }
}

/// ∫ e² dt of every place, with the bits of places that stayed within [`LIMIT`].
#[inline(always)]
fn walk<T: Numbers, const M: usize>(
    piece: &Piece,
    emulator: Emulator,
    spread: impl Fn([f64; 2]) -> [T; M],
    output: impl Fn(&[T; M]) -> [T; M],
) -> [(T, T); M] {
    let Emulator { structure, gain } = emulator;
    let mut w = spread(piece.omega[0]);
    let mut sums = w.map(|w| (T::ZERO, w.within(LIMIT)));
    for k in 1..piece.t.len() {
        let interval = piece.interval(k);
        for step in 0..interval.steps {
            let rate = |c: f64, w: &[T; M]| {
                let (y, u) = interval.at(step, c);
                let (y, u) = (spread(y), spread(u));
                let mut rate = output(if structure == Structure::Parallel { w } else { &y });
                for i in 0..M {
                    rate[i] = rate[i] + u[i] + (y[i] - w[i]) * gain;
                }
                Ok::<_, Infallible>(rate)
            };
            let Ok(after) = runge_kutta_step(&w, interval.h, rate);
            w = after;
        }
        let (y, weight) = (spread(piece.omega[k]), piece.weight(k));
        let mut any = false;
        for i in 0..M {
            let e = y[i] - w[i];
            let (sum, inside) = sums[i];
            sums[i] = (sum + e * e * weight, inside & w[i].within(LIMIT));
            any |= sums[i].1.any();
        }
        if !any {
            break;
        }
    }
    sums
}

/// ISE of one piece; `None` where the emulator diverges.
pub(super) fn pass(system: &TakagiSugeno, piece: &Piece, emulator: Emulator) -> Option<f64> {
    system.with_rules(One { piece, emulator })
}

struct One<'a> {
    piece: &'a Piece,
    emulator: Emulator,
}

impl WithRules for One<'_> {
    type Output = Option<f64>;

    fn run<const N: usize>(self, rules: &Rules<N>) -> Option<f64> {
        let spread = |pair| [f64x2::new(pair)];
        let [(sum, inside)] = walk(self.piece, self.emulator, spread, |[w]| [rules.output(*w)]);
        let [first, second] = sum.to_array();
        inside.all().then_some(first + second)
    }
}

/// ISE of one piece with each of at most [`SIDE_BY_SIDE`] vectors of consequents.
pub(super) fn passes(
    system: &TakagiSugeno,
    thetas: &[Vec<f64>],
    piece: &Piece,
    emulator: Emulator,
) -> Vec<Option<f64>> {
    system.with_rules(Several { system, thetas, piece, emulator })
}

struct Several<'a> {
    system: &'a TakagiSugeno,
    thetas: &'a [Vec<f64>],
    piece: &'a Piece,
    emulator: Emulator,
}

impl WithRules for Several<'_> {
    type Output = Vec<Option<f64>>;

    fn run<const N: usize>(self, _: &Rules<N>) -> Self::Output {
        let Self { system, thetas, piece, emulator } = self;
        let Some(rules) = RulesSideBySide::<N>::new(system, thetas) else {
            let with = |theta: &Vec<f64>| {
                let mut system = system.clone();
                system.set_parameters(theta);
                pass(&system, piece, emulator)
            };
            return thetas.iter().map(with).collect();
        };
        let spread = |pair: [f64; 2]| pair.map(f64x4::splat);
        let [first, second] = walk(piece, emulator, spread, |w| rules.output(w));
        let inside = (first.1 & second.1).to_bitmask();
        let sums: [f64; SIDE_BY_SIDE] = (first.0 + second.0).to_array();
        let ise = |(lane, sum)| (inside >> lane & 1 == 1).then_some(sum);
        sums.into_iter().enumerate().map(ise).take(thetas.len()).collect()
    }
}
