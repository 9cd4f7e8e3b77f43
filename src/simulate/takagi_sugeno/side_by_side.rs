//! Several systems in parallel that differ only in their consequents.

use pulp::Simd;

use super::grades::{Grades, LEAST_SUM};
use super::{Defuzzification, TakagiSugeno};
use crate::math::Lanes;

/// Rules with constant consequents of one system per lane; `N` as in [`super::Rules`].
pub(crate) struct RulesSideBySide<S: Simd, const N: usize> {
    range: [(f64, f64); 2],
    grades: [Grades<Lanes<S>, N>; 2],
    average: bool,
    /// Consequents of each rule for f31, then for f41.
    consequents: [[[Lanes<S>; 2]; N]; N],
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
        let mut lanes = vec![0.0; Lanes::<S>::COUNT];
        let zero = Lanes::splat(simd, 0.0);
        let mut consequents = [[[zero; 2]; N]; N];
        for i in 0..count {
            for j in 0..count {
                for o in 0..2 {
                    let place = o * count * count + i * count + j;
                    for (lane, number) in lanes.iter_mut().enumerate() {
                        *number = thetas[lane.min(thetas.len() - 1)][place];
                    }
                    consequents[i][j][o] = Lanes::load(simd, &lanes);
                }
            }
        }
        let inputs = system.inputs();
        let grades = |i: usize| Grades::new([&inputs[i]], average, |[x]| Lanes::splat(simd, x));
        Self { range: system.range(), grades: [grades(0), grades(1)], average, consequents }
    }

    /// [f31, f41] of every system at its own wheel speeds [rad/s²].
    #[inline(always)]
    pub(crate) fn output(&self, omega: &[Lanes<S>; 2]) -> [Lanes<S>; 2] {
        let [(low_a, high_a), (low_b, high_b)] = self.range;
        let a = self.grades[0].at(omega[0].max(low_a).min(high_a));
        let b = self.grades[1].at(omega[1].max(low_b).min(high_b));
        let (mut first, mut second) = along(&a[0], &b, &self.consequents[0]);
        for i in 1..N {
            let (p, q) = along(&a[i], &b, &self.consequents[i]);
            (first, second) = (first + p, second + q);
        }
        if self.average {
            let scale = (sum(&a).max(LEAST_SUM) * sum(&b).max(LEAST_SUM)).recip();
            (first, second) = (first * scale, second * scale);
        }
        [first, second]
    }
}

/// Contribution of the rules of one function of the first input to both outputs.
#[inline(always)]
fn along<S: Simd, const N: usize>(
    a: &Lanes<S>,
    b: &[Lanes<S>; N],
    row: &[[Lanes<S>; 2]; N],
) -> (Lanes<S>, Lanes<S>) {
    let (mut first, mut second) = (b[0] * row[0][0], b[0] * row[0][1]);
    for j in 1..N {
        first = first + b[j] * row[j][0];
        second = second + b[j] * row[j][1];
    }
    (*a * first, *a * second)
}

#[inline(always)]
fn sum<S: Simd, const N: usize>(grades: &[Lanes<S>; N]) -> Lanes<S> {
    let mut sum = grades[0];
    for k in 1..N {
        sum = sum + grades[k];
    }
    sum
}
