//! One simulation of the emulator over a piece of a recording: wheel speeds only, Runge-Kutta 4, both wheels
//! in one register.

use std::convert::Infallible;

use wide::f64x2;

use super::piece::Piece;
use crate::math::runge_kutta_step;
use crate::simulate::{Rules, Structure, TakagiSugeno, WithRules};

/// Wheel speed beyond which a simulation has diverged [rad/s].
pub(super) const LIMIT: f64 = 1e3;

/// The emulator of eq. (19) with its rules.
#[derive(Clone, Copy)]
pub(super) struct Emulator {
    /// Source of the rules' argument: simulated or measured speeds.
    pub(super) structure: Structure,
    /// K on both wheel speeds [1/s].
    pub(super) gain: f64,
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
        let Self { piece, emulator: Emulator { structure, gain } } = self;
        let mut w = f64x2::new(piece.omega[0]);
        let mut sum = f64x2::ZERO;
        for k in 1..piece.t.len() {
            let interval = piece.interval(k);
            for step in 0..interval.steps {
                let rate = |c: f64, [w]: &[f64x2; 1]| {
                    let (y, u) = interval.at(step, c);
                    let (y, u) = (f64x2::new(y), f64x2::new(u));
                    let f = rules.output(if structure == Structure::Parallel { *w } else { y });
                    Ok::<_, Infallible>([f + u + (y - *w) * gain])
                };
                let Ok([after]) = runge_kutta_step(&[w], interval.h, rate);
                w = after;
            }
            if !w.abs().simd_lt(f64x2::splat(LIMIT)).all() {
                return None;
            }
            let e = f64x2::new(piece.omega[k]) - w;
            sum += e * e * piece.weight(k);
        }
        Some(sum.reduce_add())
    }
}
