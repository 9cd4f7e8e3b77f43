//! A system arranged for many evaluations: both inputs, and both outputs, in one register each.

use wide::f64x2;

use super::grades::{Grades, LEAST_SUM, Premises, Progression, polynomial};
use super::{Consequents, Defuzzification, MOST_MEMBERSHIPS, TakagiSugeno};

/// The rules of a system with at most `N` membership functions an input.
///
/// A pair of grades holds (mu_i(w1), nu_i(w2)), a pair of consequents (p_ij, q_ij), so that
/// Σ_i mu_i Σ_j nu_j (p_ij, q_ij) is both outputs.
pub(crate) struct Rules<const N: usize> {
    low: f64x2,
    high: f64x2,
    grades: Grades<f64x2, N>,
    pub(super) average: bool,
    centre: [f64x2; N],
    /// 1/s² of each function.
    steep: [f64x2; N],
    constant: [[f64x2; N]; N],
    /// Slopes of the consequents in w1 and w2, where they have any.
    affine: Option<Box<[[[f64x2; 2]; N]; N]>>,
    /// The outputs as quotients of polynomials, if the grades are powers and the consequents constant.
    powers: Option<Box<Powers<N>>>,
}

/// Grades that are powers of one number per input, and the consequents times the quotients of their functions.
struct Powers<const N: usize> {
    progression: Progression<f64x2, N>,
    consequents: [[f64x2; N]; N],
}

impl<const N: usize> Powers<N> {
    /// Both outputs: Σ_i Σ_j c_ij r1^i r2^j over the sums of the grades of both inputs.
    #[inline(always)]
    fn output(&self, x: f64x2) -> f64x2 {
        let r = self.progression.ratio(x);
        let [first, second] = r.to_array().map(f64x2::splat);
        let totals = polynomial(r, &self.progression.quotient).to_array();
        let mut rows = [f64x2::ZERO; N];
        for i in 0..N {
            rows[i] = polynomial(second, &self.consequents[i]);
        }
        // the reciprocal is computed while the outputs are summed up
        polynomial(first, &rows) * f64x2::splat(1.0 / (totals[0] * totals[1]))
    }
}

/// An operation on the rules of a system with any number of rules.
pub(crate) trait WithRules {
    /// Result of the operation.
    type Output;
    /// Performs the operation.
    fn run<const N: usize>(self, rules: &Rules<N>) -> Self::Output;
}

/// Strengths along both inputs (adding up to one in the weighted average) at given speeds, with the outputs
/// and their derivatives.
pub(crate) struct Slopes<const N: usize> {
    /// (mu_i(w1), nu_i(w2)).
    pub(crate) strength: [f64x2; N],
    /// [f31, f41] [rad/s²].
    pub(crate) value: f64x2,
    /// Their derivatives with respect to w1 and w2 [1/s].
    pub(crate) by: [f64x2; 2],
}

impl TakagiSugeno {
    /// Arranges the rules and performs `work` on them.
    pub(crate) fn with_rules<W: WithRules>(&self, work: W) -> W::Output {
        match self.memberships(0).len() {
            0..=4 => work.run(&Rules::<4>::new(self)),
            5..=6 => work.run(&Rules::<6>::new(self)),
            7..=9 => work.run(&Rules::<9>::new(self)),
            _ => work.run(&Rules::<MOST_MEMBERSHIPS>::new(self)),
        }
    }

    pub(super) fn inputs(&self) -> [Premises; 2] {
        [0, 1].map(|input| Premises {
            centre: self.memberships(input).iter().map(|m| m.centre).collect(),
            width: self.memberships(input).iter().map(|m| m.width).collect(),
        })
    }
}

impl<const N: usize> Rules<N> {
    fn new(system: &TakagiSugeno) -> Self {
        let count = system.memberships(0).len();
        let inputs = system.inputs();
        let average = system.defuzzification() == Defuzzification::WeightedAverage;
        let pair = |f: &dyn Fn(&Premises, usize) -> f64| {
            std::array::from_fn(|k| {
                let of = |input: usize| if k < count { f(&inputs[input], k) } else { 0.0 };
                f64x2::new([of(0), of(1)])
            })
        };
        let consequent = |i: usize, j: usize, term: usize| {
            let of = |o: usize| system.consequent(o, i * count + j)[term];
            let there = i < count && j < count;
            if there { f64x2::new([of(0), of(1)]) } else { f64x2::ZERO }
        };
        let affine = (system.consequents() == Consequents::Affine).then(|| {
            let slopes = |i, j| [consequent(i, j, 1), consequent(i, j, 2)];
            Box::new(std::array::from_fn(|i| std::array::from_fn(|j| slopes(i, j))))
        });
        let range = system.range();
        let grades = Grades::new([&inputs[0], &inputs[1]], average, f64x2::new);
        let constant = std::array::from_fn(|i| std::array::from_fn(|j| consequent(i, j, 0)));
        let times_quotients = |progression: Progression<f64x2, N>| {
            let [a, b] = split(&progression.quotient);
            let one = |i: usize, j: usize| consequent(i, j, 0) * a[i] * b[j];
            let consequents = std::array::from_fn(|i| std::array::from_fn(|j| one(i, j)));
            Box::new(Powers { progression, consequents })
        };
        let powers = grades.progression().filter(|_| affine.is_none()).map(times_quotients);
        Self {
            low: f64x2::new(range.map(|r| r.0)),
            high: f64x2::new(range.map(|r| r.1)),
            grades,
            average,
            centre: pair(&|p, k| p.centre[k]),
            steep: pair(&|p, k| p.width[k].powi(-2)),
            constant,
            affine,
            powers,
        }
    }

    /// The speeds within their ranges.
    #[inline(always)]
    pub(crate) fn clamped(&self, omega: f64x2) -> f64x2 {
        omega.fast_max(self.low).fast_min(self.high)
    }

    /// The regressor of one output at `omega` from the strengths there: output = basis · consequents of that
    /// output. `places` contains, for each required consequent, the functions of its rule and its term.
    #[inline]
    pub(crate) fn basis(
        &self,
        strength: &[f64x2; N],
        omega: f64x2,
        places: &[((usize, usize), usize)],
        basis: &mut [f64],
    ) {
        if self.affine.is_some() {
            for (at, &(rule, term)) in basis.iter_mut().zip(places) {
                *at = self.one(strength, omega, rule, term);
            }
            return;
        }
        let pairs = strength.map(f64x2::to_array);
        for (at, &((i, j), _)) in basis.iter_mut().zip(places) {
            *at = pairs[i][0] * pairs[j][1];
        }
    }

    /// One element of [`Self::basis`].
    #[inline]
    pub(crate) fn one(
        &self,
        strength: &[f64x2; N],
        omega: f64x2,
        (i, j): (usize, usize),
        term: usize,
    ) -> f64 {
        let together = strength[i].to_array()[0] * strength[j].to_array()[1];
        let [x1, x2] = self.clamped(omega).to_array();
        match term {
            0 => together,
            1 => together * (x1 - self.centre[i].to_array()[0]),
            _ => together * (x2 - self.centre[j].to_array()[1]),
        }
    }

    /// [f31, f41] at wheel speeds `omega` [rad/s²].
    #[inline]
    pub(crate) fn output(&self, omega: f64x2) -> f64x2 {
        let x = self.clamped(omega);
        if let Some(powers) = &self.powers {
            return powers.output(x);
        }
        let grades = self.grades.at(x);
        let sum = self.weighed(&grades, x);
        if self.average { sum / f64x2::splat(total(&grades)) } else { sum }
    }

    /// The same from strengths computed by [`Self::slopes`] or [`Self::strengths`].
    #[inline]
    fn weighed(&self, grades: &[f64x2; N], x: f64x2) -> f64x2 {
        let [a, b] = split(grades);
        let mut rows = [f64x2::ZERO; N];
        for i in 0..N {
            rows[i] = match &self.affine {
                None => mean(&b, &self.constant[i]),
                Some(affine) => {
                    let mut row = self.constant[i];
                    for j in 0..N {
                        row[j] += self.beside(&affine[i][j], i, j, x);
                    }
                    mean(&b, &row)
                }
            };
        }
        mean(&a, &rows)
    }

    /// The affine part of a rule at `x`.
    #[inline]
    fn beside(&self, slopes: &[f64x2; 2], i: usize, j: usize, x: f64x2) -> f64x2 {
        let ([x1, x2], [c, _], [_, d]) =
            (x.to_array(), self.centre[i].to_array(), self.centre[j].to_array());
        slopes[0] * f64x2::splat(x1 - c) + slopes[1] * f64x2::splat(x2 - d)
    }

    /// Strengths along both inputs.
    #[inline]
    pub(crate) fn strengths(&self, omega: f64x2) -> [f64x2; N] {
        let mut grades = self.grades.at(self.clamped(omega));
        if self.average {
            let scale = f64x2::ONE / sum(&grades);
            grades.iter_mut().for_each(|grade| *grade *= scale);
        }
        grades
    }

    /// Strengths, outputs and derivatives.
    #[inline]
    pub(crate) fn slopes(&self, omega: f64x2) -> Slopes<N> {
        let x = self.clamped(omega);
        let inside = x.simd_eq(omega).select(f64x2::ONE, f64x2::ZERO);
        let strength = self.strengths(omega);
        // derivative of the logarithm of each grade; in the weighted average their mean is subtracted
        let mut rise = self.steep;
        for k in 0..N {
            rise[k] *= (self.centre[k] - x) * inside;
        }
        if self.average {
            let mut mean = f64x2::ZERO;
            for k in 0..N {
                mean += strength[k] * rise[k];
            }
            rise.iter_mut().for_each(|rise| *rise -= mean);
        }
        for k in 0..N {
            rise[k] *= strength[k];
        }
        let ([a, b], [da, db]) = (split(&strength), split(&rise));
        let (mut value, mut by) = (f64x2::ZERO, [f64x2::ZERO; 2]);
        for i in 0..N {
            let mut row = self.constant[i];
            if let Some(affine) = &self.affine {
                let slopes: [[f64x2; 2]; N] = affine[i];
                for j in 0..N {
                    row[j] += self.beside(&slopes[j], i, j, x);
                }
                let [first, second] = inside.to_array().map(f64x2::splat);
                by[0] += a[i] * mean(&b, &slopes.map(|s| s[0])) * first;
                by[1] += a[i] * mean(&b, &slopes.map(|s| s[1])) * second;
            }
            let along = mean(&b, &row);
            value += a[i] * along;
            by[0] += da[i] * along;
            by[1] += a[i] * mean(&db, &row);
        }
        Slopes { strength, value, by }
    }
}

/// The numbers of the first input, and those of the second, each in both places.
#[inline(always)]
fn split<const N: usize>(pairs: &[f64x2; N]) -> [[f64x2; N]; 2] {
    let mut out = [*pairs; 2];
    for k in 0..N {
        let [first, second] = pairs[k].to_array();
        out[0][k] = f64x2::splat(first);
        out[1][k] = f64x2::splat(second);
    }
    out
}

/// Σ weight · value, in two sums, each of which waits for its last product only.
#[inline(always)]
fn mean<const N: usize>(weights: &[f64x2; N], values: &[f64x2; N]) -> f64x2 {
    let (mut even, mut odd) = (weights[0] * values[0], weights[1] * values[1]);
    for k in (2..N).step_by(2) {
        even += weights[k] * values[k];
        if k + 1 < N {
            odd += weights[k + 1] * values[k + 1];
        }
    }
    even + odd
}

#[inline(always)]
fn sum<const N: usize>(grades: &[f64x2; N]) -> f64x2 {
    let sum = grades.iter().fold(f64x2::ZERO, |sum, grade| sum + *grade);
    sum.fast_max(f64x2::splat(LEAST_SUM))
}

/// Sum of the strengths of all rules: the product of the sums along the inputs.
#[inline(always)]
fn total<const N: usize>(grades: &[f64x2; N]) -> f64 {
    let [first, second] = sum(grades).to_array();
    first * second
}
