//! The Takagi-Sugeno fuzzy systems f31 and f41 of the paper.

mod grades;
mod rules;
mod side_by_side;

pub(crate) use rules::{Rules, WithRules};
pub(crate) use side_by_side::RulesSideBySide;

use serde::{Deserialize, Serialize};

use crate::math::Real;

/// Largest number of membership functions per input.
pub const MOST_MEMBERSHIPS: usize = 16;

/// A Gaussian membership function.
///
/// ```text
/// mu(x) = exp(-(x - c)² / (2 s²))
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gaussian {
    /// Centre c [rad/s].
    pub centre: f64,
    /// Width s, the standard deviation [rad/s].
    pub width: f64,
}

impl Gaussian {
    /// Membership of `x` [rad/s], in [0, 1].
    #[must_use]
    pub fn membership(&self, x: f64) -> f64 {
        let z = (x - self.centre) / self.width;
        (-0.5 * z * z).exp()
    }
}

/// Combination of the consequents of the rules.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Defuzzification {
    /// Σ strength × consequent / Σ strength.
    #[default]
    WeightedAverage,
    /// Σ strength × consequent.
    WeightedSum,
}

/// Consequent of a rule.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Consequents {
    /// A constant p0.
    #[default]
    Constant,
    /// p0 + p1 (w1 - c1) + p2 (w2 - c2) about the centre (c1, c2) of the rule.
    Affine,
}

impl Consequents {
    /// Number of coefficients of a rule for one output.
    #[must_use]
    pub const fn terms(self) -> usize {
        match self {
            Self::Constant => 1,
            Self::Affine => 3,
        }
    }
}

/// Two Takagi-Sugeno systems over the same inputs, membership functions and rules: f31 and f41.
///
/// ```text
/// rule (i, j): if w1 is mu_i and w2 is nu_j then f31 = p_ij, f41 = q_ij
/// strength     h_ij = mu_i(w1) nu_j(w2)
/// f31 = Σ h_ij p_ij / Σ h_ij      (weighted average; without the division: weighted sum)
/// ```
/// The rules are all combinations of the membership functions of both inputs: 6 and 6 make 36
/// rules, numbered r = i m2 + j. The inputs are clamped to their ranges, so that outside (with the
/// paper's range [0, 30] rad/s: below zero) the outputs are those at the edge.
///
/// Source: the paper, section 3, Fig. 6-11; Takagi and Sugeno, IEEE Trans. SMC 15 (1985).
///
/// # Examples
/// ```
/// use amigo_ident::simulate::{Consequents, Defuzzification, TakagiSugeno};
/// let mut system = TakagiSugeno::uniform(
///     6, [(0.0, 30.0); 2], Consequents::Constant, Defuzzification::WeightedAverage);
/// assert_eq!(system.rules(), 36);
/// system.set_parameters(&[-4.0; 72]);
/// assert!((system.output(&[3.0, 7.0])[1] + 4.0).abs() < 1e-12); // a mean of equal numbers
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TakagiSugeno {
    memberships: [Vec<Gaussian>; 2],
    range: [(f64, f64); 2],
    consequents: Consequents,
    defuzzification: Defuzzification,
    /// All consequents of f31, rule by rule, then all of f41.
    parameters: Vec<f64>,
}

impl TakagiSugeno {
    /// Membership functions evenly spaced over each range [rad/s], of half-height width equal to
    /// their spacing (s = spacing / 2.355), and consequents of zero.
    ///
    /// # Panics
    /// If `count` is not in 2..=16 or a range is empty.
    #[must_use]
    pub fn uniform(
        count: usize,
        range: [(f64, f64); 2],
        consequents: Consequents,
        defuzzification: Defuzzification,
    ) -> Self {
        assert!((2..=MOST_MEMBERSHIPS).contains(&count), "2 to 16 membership functions");
        let memberships = range.map(|(low, high)| {
            assert!(high > low, "a range from low to high");
            let spacing = (high - low) / (count - 1) as f64;
            // full width at half height of a Gaussian: 2 sqrt(2 ln 2) s
            let width = spacing / (8.0 * std::f64::consts::LN_2).sqrt();
            (0..count).map(|i| Gaussian { centre: low + spacing * i as f64, width }).collect()
        });
        let parameters = vec![0.0; 2 * count * count * consequents.terms()];
        Self { memberships, range, consequents, defuzzification, parameters }
    }

    /// Membership functions of input 0 (w1) or 1 (w2), Fig. 8 and 9.
    ///
    /// # Panics
    /// If `input` is not 0 or 1.
    #[must_use]
    pub fn memberships(&self, input: usize) -> &[Gaussian] {
        &self.memberships[input]
    }

    /// Range of each input [rad/s].
    #[must_use]
    pub const fn range(&self) -> [(f64, f64); 2] {
        self.range
    }

    /// Form of the consequents.
    #[must_use]
    pub const fn consequents(&self) -> Consequents {
        self.consequents
    }

    /// Weighting of the rules.
    #[must_use]
    pub const fn defuzzification(&self) -> Defuzzification {
        self.defuzzification
    }

    /// Number of rules.
    #[must_use]
    pub fn rules(&self) -> usize {
        self.memberships[0].len() * self.memberships[1].len()
    }

    /// The membership functions (i, j) of rule `rule`.
    #[must_use]
    pub fn rule(&self, rule: usize) -> (usize, usize) {
        (rule / self.memberships[1].len(), rule % self.memberships[1].len())
    }

    /// The rule of consequent `k` of an output, as its membership functions (i, j), and the term of the rule.
    pub(crate) fn place(&self, k: usize) -> ((usize, usize), usize) {
        let terms = self.consequents.terms();
        (self.rule(k / terms), k % terms)
    }

    /// Speeds at which rule `rule` has its maximum strength [rad/s].
    ///
    /// # Panics
    /// If there is no such rule.
    #[must_use]
    pub fn centre(&self, rule: usize) -> [f64; 2] {
        let (i, j) = self.rule(rule);
        [self.memberships[0][i].centre, self.memberships[1][j].centre]
    }

    /// Consequent of a rule for output 0 (f31) or 1 (f41): one number [rad/s²], or three
    /// [rad/s², 1/s, 1/s].
    ///
    /// # Panics
    /// If there is no such output or rule.
    #[must_use]
    pub fn consequent(&self, output: usize, rule: usize) -> &[f64] {
        let terms = self.consequents.terms();
        let from = (output * self.rules() + rule) * terms;
        &self.parameters[from..from + terms]
    }

    /// All consequents: those of f31 rule by rule, then those of f41.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Replaces all consequents.
    ///
    /// # Panics
    /// If the number differs from that of [`Self::parameters`].
    pub fn set_parameters(&mut self, parameters: &[f64]) {
        self.parameters.copy_from_slice(parameters);
    }

    /// Centres and widths: input 1 centres, input 1 widths, input 2 centres, input 2 widths
    /// [rad/s].
    #[must_use]
    pub fn premises(&self) -> Vec<f64> {
        let mut out = Vec::new();
        for input in &self.memberships {
            out.extend(input.iter().map(|m| m.centre));
            out.extend(input.iter().map(|m| m.width));
        }
        out
    }

    /// Replaces centres and widths, in the order of [`Self::premises`].
    ///
    /// # Panics
    /// If there are too few.
    pub fn set_premises(&mut self, premises: &[f64]) {
        let mut rest = premises;
        for input in &mut self.memberships {
            let (own, after) = rest.split_at(2 * input.len());
            let (centres, widths) = own.split_at(input.len());
            for ((m, &centre), &width) in input.iter_mut().zip(centres).zip(widths) {
                *m = Gaussian { centre, width };
            }
            rest = after;
        }
    }

    /// Strength of every rule at wheel speeds `omega` [rad/s]; in the weighted average they add up to one.
    #[must_use]
    pub fn firing(&self, omega: &[f64; 2]) -> Vec<f64> {
        let x = self.clamped(omega);
        let [a, b] = [0, 1].map(|input| self.strengths(input, x[input]));
        (0..self.rules()).map(|r| self.rule(r)).map(|(i, j)| a[i] * b[j]).collect()
    }

    /// [f31, f41] [rad/s²] at wheel speeds `omega` [rad/s].
    #[must_use]
    pub fn output<T: Real>(&self, omega: &[T; 2]) -> [T; 2] {
        let x = self.clamped(omega);
        let [a, b] = [0, 1].map(|input| self.strengths(input, x[input]));
        let zero = T::from(0.0);
        [0, 1].map(|output| {
            let mut sum = zero;
            for i in 0..self.memberships[0].len() {
                let mut row = zero;
                for j in 0..self.memberships[1].len() {
                    row += b[j] * self.concluded(output, (i, j), &x);
                }
                sum += a[i] * row;
            }
            sum
        })
    }

    /// The speeds within the range of the functions.
    fn clamped<T: Real>(&self, omega: &[T; 2]) -> [T; 2] {
        [0, 1].map(|i| {
            let (low, high) = self.range[i];
            omega[i].max(low.into()).min(high.into())
        })
    }

    /// Strengths along one input at `x` within its range, normalised for the weighted average.
    fn strengths<T: Real>(&self, input: usize, x: T) -> [T; MOST_MEMBERSHIPS] {
        let mut out = [T::from(0.0); MOST_MEMBERSHIPS];
        let own = &mut out[..self.memberships[input].len()];
        let mut sum = T::from(0.0);
        for (strength, m) in own.iter_mut().zip(&self.memberships[input]) {
            *strength = (((x - m.centre) / m.width).squared() * -0.5).exp();
            sum += *strength;
        }
        if self.defuzzification == Defuzzification::WeightedAverage {
            let sum = sum.max(1e-300.into());
            own.iter_mut().for_each(|strength| *strength = *strength / sum);
        }
        out
    }

    /// Derivatives of [f31, f41] with respect to the centres and widths, in the order of [`Self::premises`].
    #[must_use]
    pub fn premise_gradient(&self, omega: &[f64; 2]) -> Vec<[f64; 2]> {
        let x = self.clamped(omega);
        let strengths = [0, 1].map(|input| self.strengths(input, x[input]));
        let value = self.output(omega);
        let mut out = Vec::new();
        for input in 0..2 {
            let count = self.memberships[input].len();
            let mut widths = Vec::with_capacity(count);
            for i in 0..count {
                let m = self.memberships[input][i];
                let z = (x[input] - m.centre) / m.width;
                // mean of the consequents and of their slopes over the rules that use m
                let (mut row, mut slope) = ([0.0; 2], [0.0; 2]);
                for k in 0..self.memberships[1 - input].len() {
                    let rule = if input == 0 { (i, k) } else { (k, i) };
                    let strength = strengths[1 - input][k];
                    for o in 0..2 {
                        row[o] += strength * self.concluded(o, rule, &x);
                        slope[o] += strength * self.slope(o, rule, input);
                    }
                }
                let strength = strengths[input][i];
                let factor = [0, 1].map(|o| match self.defuzzification {
                    Defuzzification::WeightedAverage => strength * (row[o] - value[o]),
                    Defuzzification::WeightedSum => strength * row[o],
                });
                out.push([0, 1].map(|o| factor[o] * z / m.width - strength * slope[o]));
                widths.push(factor.map(|p| p * z * z / m.width));
            }
            out.extend(widths);
        }
        out
    }

    /// Slope of the consequent of a rule along an input.
    fn slope(&self, output: usize, (i, j): (usize, usize), input: usize) -> f64 {
        let own = self.consequent(output, i * self.memberships[1].len() + j);
        own.get(1 + input).copied().unwrap_or(0.0)
    }

    /// Consequent of a rule for an output at `x`.
    fn concluded<T: Real>(&self, output: usize, (i, j): (usize, usize), x: &[T; 2]) -> T {
        let p = self.consequent(output, i * self.memberships[1].len() + j);
        let constant = T::from(p[0]);
        match self.consequents {
            Consequents::Constant => constant,
            Consequents::Affine => {
                let (m, n) = (self.memberships[0][i], self.memberships[1][j]);
                constant + (x[0] - m.centre) * p[1] + (x[1] - n.centre) * p[2]
            }
        }
    }
}

#[cfg(test)]
mod tests;
