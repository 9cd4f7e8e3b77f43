//! Several systems in parallel that differ only in their consequents.

use pulp::Simd;

use super::grades::{Grades, LEAST_SUM, Progression, polynomial};
use super::{Defuzzification, TakagiSugeno};
use crate::math::Lanes;

/// Rules with constant consequents of one system per lane; `N` as in [`super::Rules`].
pub(crate) struct RulesSideBySide<S: Simd, const N: usize> {
    range: [(f64, f64); 2],
    grades: [Grades<Lanes<S>, N>; 2],
    average: bool,
    /// The grades if they are powers.
    powers: Option<[Progression<Lanes<S>, N>; 2]>,
    /// Consequents of each rule of the first input for f31, and for f41; of powers times the quotients of the
    /// functions.
    consequents: [[[Lanes<S>; N]; 2]; N],
}

impl<S: Simd, const N: usize> RulesSideBySide<S, N> {
    /// Systems like `system`, with constant consequents from each of `thetas`; the last one fills the unused
    /// lanes.
    ///
    /// # Panics
    /// If `thetas` is empty.
    pub(crate) fn new(simd: S, system: &TakagiSugeno, thetas: &[Vec<f64>]) -> Self {
        let count = system.memberships(0).len();
        let average = system.defuzzification() == Defuzzification::WeightedAverage;
        let inputs = system.inputs();
        let grades = |i: usize| Grades::new([&inputs[i]], average, |[x]| Lanes::splat(simd, x));
        let grades: [Grades<Lanes<S>, N>; 2] = [grades(0), grades(1)];
        let powers = grades[0].progression().zip(grades[1].progression()).map(|(a, b)| [a, b]);
        let mut lanes = vec![0.0; Lanes::<S>::COUNT];
        let mut consequents = [[[Lanes::splat(simd, 0.0); N]; 2]; N];
        for i in 0..count {
            for j in 0..count {
                for o in 0..2 {
                    let place = o * count * count + i * count + j;
                    for (lane, number) in lanes.iter_mut().enumerate() {
                        *number = thetas[lane.min(thetas.len() - 1)][place];
                    }
                    let consequent = Lanes::load(simd, &lanes);
                    consequents[i][o][j] = match &powers {
                        Some([a, b]) => consequent * a.quotient[i] * b.quotient[j],
                        None => consequent,
                    };
                }
            }
        }
        Self { range: system.range(), grades, average, powers, consequents }
    }

    /// [f31, f41] of every system at its own wheel speeds [rad/s²].
    #[inline(always)]
    pub(crate) fn output(&self, omega: &[Lanes<S>; 2]) -> [Lanes<S>; 2] {
        let [(low_a, high_a), (low_b, high_b)] = self.range;
        let x = [omega[0].max(low_a).min(high_a), omega[1].max(low_b).min(high_b)];
        if let Some(powers) = &self.powers {
            return self.quotient(powers, &x);
        }
        let (a, b) = (self.grades[0].at(x[0]), self.grades[1].at(x[1]));
        let mut out = [
            a[0] * sum_of(&b, &self.consequents[0][0]),
            a[0] * sum_of(&b, &self.consequents[0][1]),
        ];
        for i in 1..N {
            for o in 0..2 {
                out[o] = a[i].times_plus(sum_of(&b, &self.consequents[i][o]), out[o]);
            }
        }
        if self.average {
            let scale = (sum(&a).max(LEAST_SUM) * sum(&b).max(LEAST_SUM)).recip();
            out = [out[0] * scale, out[1] * scale];
        }
        out
    }

    /// Σ_i Σ_j c_ij r1^i r2^j over the sums of the grades of both inputs.
    #[inline(always)]
    fn quotient(&self, powers: &[Progression<Lanes<S>, N>; 2], x: &[Lanes<S>; 2]) -> [Lanes<S>; 2] {
        let [a, b] = powers;
        let r = [a.ratio(x[0]), b.ratio(x[1])];
        let total = polynomial(r[0], &a.quotient) * polynomial(r[1], &b.quotient);
        let scale = total.recip();
        let mut rows = [a.quotient; 2];
        for i in 0..N {
            rows[0][i] = polynomial(r[1], &self.consequents[i][0]);
            rows[1][i] = polynomial(r[1], &self.consequents[i][1]);
        }
        [polynomial(r[0], &rows[0]) * scale, polynomial(r[0], &rows[1]) * scale]
    }
}

/// Σ weight · value.
#[inline(always)]
fn sum_of<S: Simd, const N: usize>(weights: &[Lanes<S>; N], values: &[Lanes<S>; N]) -> Lanes<S> {
    let mut sum = weights[0] * values[0];
    for k in 1..N {
        sum = weights[k].times_plus(values[k], sum);
    }
    sum
}

#[inline(always)]
fn sum<S: Simd, const N: usize>(grades: &[Lanes<S>; N]) -> Lanes<S> {
    let mut sum = grades[0];
    for k in 1..N {
        sum = sum + grades[k];
    }
    sum
}
