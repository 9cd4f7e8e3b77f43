use pulp::{Simd, WithSimd};

use super::*;
use crate::math::{Dual, Lanes, every_width, in_lanes};

fn system(consequents: Consequents, defuzzification: Defuzzification) -> TakagiSugeno {
    let range = [(-2.0, 5.0), (0.0, 4.0)];
    let mut system = TakagiSugeno::uniform(4, range, consequents, defuzzification);
    let p: Vec<f64> = (0..system.parameters().len()).map(|k| (k as f64).sin()).collect();
    system.set_parameters(&p);
    system
}

fn all() -> impl Iterator<Item = TakagiSugeno> {
    [Consequents::Constant, Consequents::Affine].into_iter().flat_map(|c| {
        [Defuzzification::WeightedAverage, Defuzzification::WeightedSum].map(|d| system(c, d))
    })
}

#[test]
fn the_papers_system_is_the_weighted_average_written_out() {
    let mut system = TakagiSugeno::uniform(
        6,
        [(0.0, 30.0); 2],
        Consequents::Constant,
        Defuzzification::WeightedAverage,
    );
    let p: Vec<f64> = (0..72).map(|k| f64::from(k % 7) - 3.0).collect();
    system.set_parameters(&p);
    let w = [7.3, 21.9];
    let (mut above, mut below) = ([0.0; 2], 0.0);
    for i in 0..6 {
        for j in 0..6 {
            // centres 0, 6, ..., 30; width 6 / 2.3548
            let s = 6.0 / 2.354_820_045_030_949;
            let mu = |x: f64, c: usize| (-(x - 6.0 * c as f64).powi(2) / (2.0 * s * s)).exp();
            let h = mu(w[0], i) * mu(w[1], j);
            below += h;
            above[0] += h * p[i * 6 + j];
            above[1] += h * p[36 + i * 6 + j];
        }
    }
    let out = system.output(&w);
    // rounding of 36 terms of size 3
    assert!((out[0] - above[0] / below).abs() < 1e-13);
    assert!((out[1] - above[1] / below).abs() < 1e-13);
    assert!((system.firing(&w).iter().sum::<f64>() - 1.0).abs() < 1e-14);
}

/// Output and its derivatives [output]\[input\] by the speeds.
fn with_gradient(system: &TakagiSugeno, w: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
    let out = system.output(&[Dual::<2>::variable(w[0], 0), Dual::variable(w[1], 1)]);
    (out.map(|v| v.value), out.map(|v| v.partial))
}

/// What one consequent of one adds to its output, each in turn.
fn by_consequents(system: &TakagiSugeno, w: [f64; 2]) -> Vec<f64> {
    let one = |k: usize| {
        let mut unit = vec![0.0; system.parameters().len()];
        unit[k] = 1.0;
        let mut alone = system.clone();
        alone.set_parameters(&unit);
        alone.output(&w)[0]
    };
    (0..system.parameters().len() / 2).map(one).collect()
}

#[test]
fn gradients_to_speeds_centres_and_widths_equal_differences() {
    let h = 1e-6;
    for system in all() {
        for w in [[1.3, 2.2], [-1.1, 3.9], [4.0, -1.0]] {
            let (_, gradient) = with_gradient(&system, w);
            for input in 0..2 {
                let (mut up, mut down) = (w, w);
                up[input] += h;
                down[input] -= h;
                let (up, down) = (system.output(&up), system.output(&down));
                for o in 0..2 {
                    // rounding 1e-16 / h and truncation h²
                    let slope = (up[o] - down[o]) / (2.0 * h);
                    assert!((slope - gradient[o][input]).abs() < 1e-8, "{w:?}");
                }
            }
            let premises = system.premises();
            for (k, exact) in system.premise_gradient(&w).iter().enumerate() {
                let at = |h: f64| {
                    let mut moved = system.clone();
                    let mut p = premises.clone();
                    p[k] += h;
                    moved.set_premises(&p);
                    moved.output(&w)
                };
                let (up, down) = (at(h), at(-h));
                for o in 0..2 {
                    let slope = (up[o] - down[o]) / (2.0 * h);
                    assert!((slope - exact[o]).abs() < 1e-8, "{k} {slope} {exact:?}");
                }
            }
        }
    }
}

#[test]
fn outside_the_range_the_output_is_that_of_the_edge() {
    for system in all() {
        assert_eq!(system.output(&[-2.0, 4.0]), system.output(&[-30.0, 90.0]));
        assert_eq!(with_gradient(&system, [-30.0, 90.0]).1, [[0.0; 2]; 2]);
    }
}

/// Systems of many sizes: on even grids, with learnt premises, and next to their ranges' ends.
fn of_all_sizes() -> impl Iterator<Item = TakagiSugeno> {
    let with = |count: usize, c, d| {
        let mut system = TakagiSugeno::uniform(count, [(-2.0, 5.0), (0.0, 30.0)], c, d);
        let p: Vec<f64> = (0..system.parameters().len()).map(|k| (k as f64).sin()).collect();
        system.set_parameters(&p);
        system
    };
    let learnt = |mut system: TakagiSugeno| {
        let moved: Vec<f64> = system
            .premises()
            .iter()
            .enumerate()
            .map(|(k, x)| x + 0.03 * (k as f64).cos())
            .collect();
        system.set_premises(&moved);
        system
    };
    let sizes = [2, 4, 5, 6, 9, 11, 16].into_iter();
    sizes.flat_map(move |count| {
        [Consequents::Constant, Consequents::Affine].into_iter().flat_map(move |c| {
            [Defuzzification::WeightedAverage, Defuzzification::WeightedSum]
                .into_iter()
                .flat_map(move |d| [with(count, c, d), learnt(with(count, c, d))])
        })
    })
}

const SPEEDS: [[f64; 2]; 5] = [[1.3, 2.2], [-1.9, 29.0], [4.9, 0.1], [-30.0, 90.0], [0.5, 15.0]];

/// Sizes of the terms whose rounding the results share.
fn size(system: &TakagiSugeno) -> f64 {
    // affine consequents reach slopes of one times distances of 30; a power of the progression has a
    // relative error of 1e-16 times its exponent, of 40 at most
    if system.consequents() == Consequents::Affine { 1e-12 } else { 3e-14 }
}

#[test]
fn rules_laid_out_for_many_evaluations_give_outputs_slopes_and_bases_of_the_system() {
    struct Check<'a>(&'a TakagiSugeno);
    impl WithRules for Check<'_> {
        type Output = ();
        fn run<const N: usize>(self, rules: &Rules<N>) {
            let Self(system) = self;
            for w in SPEEDS {
                let pair = wide::f64x2::new(w);
                let (value, gradient) = with_gradient(system, w);
                let (found, slopes) = (rules.output(pair).to_array(), rules.slopes(pair));
                for o in 0..2 {
                    assert!(
                        (found[o] - value[o]).abs() < size(system),
                        "{w:?} {found:?} {value:?}"
                    );
                    assert!((slopes.value.to_array()[o] - value[o]).abs() < size(system));
                    for input in 0..2 {
                        let slope = slopes.by[input].to_array()[o];
                        // slopes of narrow functions are up to a hundred times the values
                        let difference = (slope - gradient[o][input]).abs();
                        assert!(difference < 100.0 * size(system), "{w:?} {difference}");
                    }
                }
                let alone = by_consequents(system, w);
                let mut basis = vec![0.0; alone.len()];
                let places: Vec<_> = (0..alone.len()).map(|k| system.place(k)).collect();
                rules.basis(&slopes.strength, pair, &places, &mut basis);
                for (k, (a, b)) in alone.iter().zip(&basis).enumerate() {
                    let (rule, term) = system.place(k);
                    let one = rules.one(&slopes.strength, pair, rule, term);
                    assert!((a - b).abs() < size(system) && (a - one).abs() < size(system));
                }
            }
        }
    }
    for system in of_all_sizes() {
        system.with_rules(Check(&system));
    }
}

/// Outputs of three systems with other consequents, each at speeds of its own.
struct SideBySide<'a, const N: usize>(&'a TakagiSugeno, &'a [Vec<f64>]);

impl<const N: usize> WithSimd for SideBySide<'_, N> {
    type Output = Vec<[f64; 2]>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self(system, thetas) = self;
        let mut found = vec![];
        for (block, thetas) in thetas.chunks(Lanes::<S>::COUNT).enumerate() {
            let rules = RulesSideBySide::<S, N>::new(simd, system, thetas);
            let speed = |v: usize| SPEEDS[(block * Lanes::<S>::COUNT + v + 1) % SPEEDS.len()];
            let lanes = |i: usize| {
                let speeds: Vec<f64> = (0..Lanes::<S>::COUNT).map(|v| speed(v)[i]).collect();
                Lanes::load(simd, &speeds)
            };
            let mut out = [[0.0; 16]; 2];
            for (lanes, out) in rules.output(&[lanes(0), lanes(1)]).iter().zip(&mut out) {
                lanes.store(out);
            }
            found.extend((0..thetas.len()).map(|v| [out[0][v], out[1][v]]));
        }
        found
    }
}

#[test]
fn systems_side_by_side_give_the_output_of_each_and_the_same_at_every_width() {
    struct Check<'a>(&'a TakagiSugeno);
    impl WithRules for Check<'_> {
        type Output = ();
        fn run<const N: usize>(self, _: &Rules<N>) {
            let Self(system) = self;
            let n = system.parameters().len();
            let thetas: Vec<Vec<f64>> = (0..3_usize)
                .map(|v| (0..n).map(|k| ((k + 7 * v) as f64).cos()).collect())
                .collect();
            let found = in_lanes(SideBySide::<N>(system, &thetas));
            for arch in every_width() {
                assert_eq!(found, arch.dispatch(SideBySide::<N>(system, &thetas)));
            }
            for (v, theta) in thetas.iter().enumerate() {
                let mut one = system.clone();
                one.set_parameters(theta);
                let value = one.output(&SPEEDS[(v + 1) % SPEEDS.len()]);
                for o in 0..2 {
                    // the exponential of lanes has 1e-13, which ratios of grades share
                    let tolerance = 20.0 * size(system);
                    assert!((found[v][o] - value[o]).abs() < tolerance, "{found:?} {value:?}");
                }
            }
        }
    }
    for system in of_all_sizes().filter(|s| s.consequents() == Consequents::Constant) {
        system.with_rules(Check(&system));
    }
}
