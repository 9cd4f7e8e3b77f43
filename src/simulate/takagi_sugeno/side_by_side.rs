//! Several systems that differ in their consequents alone, side by side.

use wide::f64x4;

use super::grades::{Grades, LEAST_SUM};
use super::{Consequents, Defuzzification, TakagiSugeno};

/// Systems in a register.
pub(crate) const SIDE_BY_SIDE: usize = 4;

/// Rules with constant consequents of [`SIDE_BY_SIDE`] systems; `N` as in [`super::Rules`].
pub(crate) struct RulesSideBySide<const N: usize> {
    range: [(f64x4, f64x4); 2],
    grades: [Grades<f64x4, N>; 2],
    average: bool,
    /// Of each rule those of f31, then those of f41.
    consequents: [[[f64x4; 2]; N]; N],
}

impl<const N: usize> RulesSideBySide<N> {
    /// Systems as `system` with the consequents of each of `thetas`; the last fills the places that are
    /// left over. `None` if consequents are not constant.
    pub(crate) fn new(system: &TakagiSugeno, thetas: &[Vec<f64>]) -> Option<Self> {
        if system.consequents() != Consequents::Constant || thetas.is_empty() {
            return None;
        }
        let count = system.memberships(0).len();
        let average = system.defuzzification() == Defuzzification::WeightedAverage;
        let lanes = |place: usize| {
            f64x4::new(std::array::from_fn(|lane| thetas[lane.min(thetas.len() - 1)][place]))
        };
        let consequent = |i: usize, j: usize| match i < count && j < count {
            true => [0, 1].map(|o| lanes(o * count * count + i * count + j)),
            false => [f64x4::ZERO; 2],
        };
        let inputs = system.inputs();
        Some(Self {
            range: system.range().map(|(low, high)| (f64x4::splat(low), f64x4::splat(high))),
            grades: [0, 1].map(|i| Grades::new([&inputs[i]], average, |[x]| f64x4::splat(x))),
            average,
            consequents: std::array::from_fn(|i| std::array::from_fn(|j| consequent(i, j))),
        })
    }

    /// [f31, f41] of every system at its own wheel speeds [rad/s²].
    #[inline]
    pub(crate) fn output(&self, omega: &[f64x4; 2]) -> [f64x4; 2] {
        let [a, b] = [0, 1].map(|i| {
            let (low, high) = self.range[i];
            self.grades[i].at(omega[i].fast_max(low).fast_min(high))
        });
        let mut out = [f64x4::ZERO; 2];
        for (a, row) in a.iter().zip(&self.consequents) {
            let mut along = [f64x4::ZERO; 2];
            for (b, [p, q]) in b.iter().zip(row) {
                along[0] += *b * *p;
                along[1] += *b * *q;
            }
            out[0] += *a * along[0];
            out[1] += *a * along[1];
        }
        if self.average {
            let least = f64x4::splat(LEAST_SUM);
            let sum = |grades: &[f64x4; N]| {
                grades.iter().fold(f64x4::ZERO, |sum, g| sum + *g).fast_max(least)
            };
            let scale = f64x4::ONE / (sum(&a) * sum(&b));
            out = out.map(|f| f * scale);
        }
        out
    }
}
