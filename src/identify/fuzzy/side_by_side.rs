//! Simulations of many emulators over a piece of a recording, in the SIMD lanes of the processor.

use pulp::{Simd, WithSimd};

use super::pass::{Emulator, LIMIT, pass};
use super::piece::Piece;
use crate::math::{Lanes, are_wide, in_lanes};
use crate::simulate::{Consequents, Rules, RulesSideBySide, Structure, TakagiSugeno, WithRules};

/// Number of registers processed alternately, because the steps of one depend on each other.
const TOGETHER: usize = 2;
/// Largest number of emulators simulated at once, with the widest registers.
pub(super) const SIDE_BY_SIDE: usize = 8 * TOGETHER;

/// ISE of one piece with each vector of consequents, `None` where the emulator diverges: that of
/// [`pass`] up to rounding, and identical for every width of the registers. Processors without wide registers
/// compute [`pass`].
pub(super) fn passes(
    system: &TakagiSugeno,
    thetas: &[Vec<f64>],
    piece: &Piece,
    emulator: Emulator,
) -> Vec<Option<f64>> {
    if system.consequents() == Consequents::Constant && are_wide() {
        return system.with_rules(Several { system, thetas, piece, emulator });
    }
    let with = |theta: &Vec<f64>| {
        let mut system = system.clone();
        system.set_parameters(theta);
        pass(&system, piece, emulator)
    };
    thetas.iter().map(with).collect()
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
        in_lanes(Sized::<N>(self))
    }
}

/// The same for at most `N` membership functions an input.
struct Sized<'a, const N: usize>(Several<'a>);

impl<const N: usize> WithSimd for Sized<'_, N> {
    type Output = Vec<Option<f64>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Several { system, thetas, piece, emulator } = self.0;
        let count = Lanes::<S>::COUNT;
        let mut out = Vec::with_capacity(thetas.len());
        for thetas in thetas.chunks(TOGETHER * count) {
            let (first, second) = thetas.split_at(thetas.len().min(count));
            let mut ise = [0.0; SIDE_BY_SIDE];
            if second.is_empty() {
                let rules = [RulesSideBySide::new(simd, system, first)];
                walk::<S, N, 1>(simd, &rules, piece, emulator)[0].store(&mut ise);
            } else {
                let rules = [first, second].map(|some| RulesSideBySide::new(simd, system, some));
                let sums = walk::<S, N, TOGETHER>(simd, &rules, piece, emulator);
                sums[0].store(&mut ise);
                sums[1].store(&mut ise[count..]);
            }
            for ise in &ise[..thetas.len()] {
                out.push(ise.is_finite().then_some(*ise));
            }
        }
        out
    }
}

/// ∫ e1² + e2² dt of all lanes [rad²/s]; not finite where a speed left [`LIMIT`].
#[inline(always)]
fn walk<S: Simd, const N: usize, const M: usize>(
    simd: S,
    rules: &[RulesSideBySide<S, N>; M],
    piece: &Piece,
    emulator: Emulator,
) -> [Lanes<S>; M] {
    let zero = Lanes::splat(simd, 0.0);
    let (limit, beyond) = (Lanes::splat(simd, LIMIT), Lanes::splat(simd, f64::INFINITY));
    let [first, second] = piece.omega[0];
    let mut w = [[Lanes::splat(simd, first), Lanes::splat(simd, second)]; M];
    let mut sums = [zero; M];
    for k in 1..piece.t.len() {
        let interval = piece.interval(k);
        let h = interval.h;
        for step in 0..interval.steps {
            let (mut at, mut slopes) = (w, [[zero; 2]; M]);
            // place of a stage and of the next one, and its weight in sixths: the steps of `runge_kutta_step`, of
            // several batches stage by stage, since those of one wait for each other
            for (c, next, weight) in
                [(0.0, 0.5, 1.0), (0.5, 0.5, 2.0), (0.5, 1.0, 2.0), (1.0, 0.0, 1.0)]
            {
                let (y, u) = interval.at(step, c);
                for m in 0..M {
                    let f = if emulator.structure == Structure::Parallel {
                        rules[m].output(&at[m])
                    } else {
                        rules[m].output(&[Lanes::splat(simd, y[0]), Lanes::splat(simd, y[1])])
                    };
                    for i in 0..2 {
                        let forced = u[i] + emulator.gain * y[i];
                        let rate = f[i] + forced - at[m][i] * emulator.gain;
                        slopes[m][i] = slopes[m][i] + rate * weight;
                        at[m][i] = w[m][i] + rate * (next * h);
                    }
                }
            }
            for m in 0..M {
                for i in 0..2 {
                    w[m][i] = w[m][i] + slopes[m][i] * (h / 6.0);
                }
            }
        }
        let weight = piece.weight(k);
        for m in 0..M {
            for i in 0..2 {
                let e = w[m][i] - piece.omega[k][i];
                // NaN is not within the limit either
                let inside = w[m][i].abs().below(limit);
                sums[m] = inside.select(sums[m] + e * e * weight, beyond);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::super::tests::made;
    use super::*;
    use crate::math::every_width;
    use crate::simulate::{Defuzzification, Hold, Movement};

    #[test]
    fn costs_are_the_same_to_the_last_bit_at_every_width_of_the_registers() {
        let recording = made(&Movement::paper(), 1);
        let piece = &Piece::all(&recording, &[[30.0, 2.0], [2.0, 30.0]], Hold::Linear)[0];
        let (constant, average) = (Consequents::Constant, Defuzzification::WeightedAverage);
        let system = &TakagiSugeno::uniform(6, [(-1.0, 6.0); 2], constant, average);
        let one = |v: usize| (0..72).map(|k| -4.0 + ((k + v) as f64).sin()).collect();
        let thetas: &Vec<Vec<f64>> = &(0..19).map(one).collect();
        for structure in [Structure::Parallel, Structure::SerialParallel] {
            let emulator = Emulator { structure, gain: 1.0 };
            let several = || Sized::<6>(Several { system, thetas, piece, emulator });
            let widest = in_lanes(several());
            assert!(widest.len() == 19 && widest.iter().all(Option::is_some));
            for arch in every_width() {
                assert_eq!(widest, arch.dispatch(several()));
            }
        }
    }
}
