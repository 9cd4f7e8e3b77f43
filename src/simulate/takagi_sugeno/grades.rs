//! Grades of all membership functions of an input at once, for several inputs in parallel.

use std::ops::{Add, Mul, Sub};

use pulp::Simd;
use wide::f64x2;

use crate::math::Lanes;

/// SIMD numbers.
pub(super) trait Numbers:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// The exponential of each.
    fn exponential(self) -> Self;
    /// One over each.
    fn reciprocal(self) -> Self;
    /// `self · factor + more`, rounded once or twice.
    fn times_plus(self, factor: Self, more: Self) -> Self;
}

impl Numbers for f64x2 {
    /// The library function for each: for two numbers it is faster than a series in lanes.
    #[inline]
    fn exponential(self) -> Self {
        Self::new(self.to_array().map(f64::exp))
    }
    #[inline]
    fn reciprocal(self) -> Self {
        Self::ONE / self
    }
    #[inline]
    fn times_plus(self, factor: Self, more: Self) -> Self {
        self * factor + more
    }
}

impl<S: Simd> Numbers for Lanes<S> {
    #[inline(always)]
    fn exponential(self) -> Self {
        self.exp()
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.recip()
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, more: Self) -> Self {
        self.times_plus(factor, more)
    }
}

/// `Σ_k c_k r^k`, in pairs: the operations of a pair do not depend on those of the others.
#[inline(always)]
pub(super) fn polynomial<V: Numbers, const N: usize>(r: V, c: &[V; N]) -> V {
    let square = r * r;
    let mut first = (N - 1) / 2 * 2;
    let mut sum = c[first];
    if first + 1 < N {
        sum = r.times_plus(c[first + 1], sum);
    }
    while first > 0 {
        first -= 2;
        sum = sum.times_plus(square, r.times_plus(c[first + 1], c[first]));
    }
    sum
}

/// Centres and widths of the membership functions of one input.
pub(super) struct Premises {
    pub(super) centre: Vec<f64>,
    pub(super) width: Vec<f64>,
}

/// Smallest sum of the grades of an input: between adapted functions there may be a gap in which all
/// underflow.
pub(super) const LEAST_SUM: f64 = 1e-150;
/// Relative differences of spacings and widths up to which they count as equal: rounding.
const EVEN: f64 = 1e-12;
/// Largest square of spacing over width for which the powers below do not overflow.
const NARROWEST: f64 = 6.0;

impl Premises {
    /// Common spacing and width of all functions, if they have any.
    fn even(&self) -> Option<(f64, f64)> {
        let (spacing, width) = (self.centre[1] - self.centre[0], self.width[0]);
        let spaced =
            |w: &[f64]| (w[1] - w[0] - spacing).abs() <= EVEN * self.centre.len() as f64 * spacing;
        let even = self.centre.windows(2).all(spaced)
            && self.width.iter().all(|s| (s - width).abs() <= EVEN * width)
            && spacing > 0.0
            && (spacing / width).powi(2) < NARROWEST;
        even.then_some((spacing, width))
    }
}

/// Largest number of functions for which the powers, including products of both inputs, do not overflow:
/// exp(2 · 8 · 4 · 6) = 1e167.
const ONE_SIDED: usize = 9;

/// Grades `quotient_k r^k` up to a common factor, with `r = exp((x - centre) rate)`.
#[derive(Clone, Copy)]
pub(super) struct Progression<V, const N: usize> {
    centre: V,
    rate: V,
    pub(super) quotient: [V; N],
}

impl<V: Numbers, const N: usize> Progression<V, N> {
    /// r at `x`.
    #[inline(always)]
    pub(super) fn ratio(&self, x: V) -> V {
        ((x - self.centre) * self.rate).exponential()
    }
}

/// The membership functions of the inputs that are combined in a `V`; of the `N` entries those beyond the
/// functions have a grade of zero.
pub(super) enum Grades<V, const N: usize> {
    /// Functions of equal width on a uniform grid, up to a factor common to all grades.
    ///
    /// ```text
    /// mu_(m+k)(x) / mu_m(x) = r^k q_k,   r = exp((x - c_m) d/s²),   q_k = exp(-k² d²/(2 s²))
    /// ```
    /// with the spacing d: a single exponential for all grades, if only their ratios are needed. m is the
    /// middle entry, so that loops have a constant length. Up to [`ONE_SIDED`] entries all grades are
    /// multiplied by r^m, which avoids the division.
    Even(Progression<V, N>),
    /// Any functions: exp(factor (x - c)²).
    Any { centre: [V; N], factor: [V; N], present: [V; N] },
}

impl<V: Numbers, const N: usize> Grades<V, N> {
    /// Combines the functions of the inputs with `join`; grades are only relative if `relative`.
    pub(super) fn new<const I: usize>(
        inputs: [&Premises; I],
        relative: bool,
        join: impl Fn([f64; I]) -> V,
    ) -> Self {
        let count = inputs[0].centre.len();
        let even = inputs.map(Premises::even);
        if relative && even.iter().all(Option::is_some) {
            let even = even.map(|e| e.unwrap_or((1.0, 1.0)));
            let quotient = |k: usize| {
                let steps = k as f64 - (N / 2) as f64;
                let one = |(d, s): (f64, f64)| (-0.5 * (steps * d / s).powi(2)).exp();
                join(even.map(|e| if k < count { one(e) } else { 0.0 }))
            };
            return Self::Even(Progression {
                centre: join(
                    inputs.map(|p| p.centre[0] + (N / 2) as f64 * (p.centre[1] - p.centre[0])),
                ),
                rate: join(even.map(|(d, s)| d / (s * s))),
                quotient: std::array::from_fn(quotient),
            });
        }
        let column = |f: &dyn Fn(&Premises, usize) -> f64| {
            std::array::from_fn(|k| join(inputs.map(|p| if k < count { f(p, k) } else { 0.0 })))
        };
        Self::Any {
            centre: column(&|p, k| p.centre[k]),
            factor: column(&|p, k| -0.5 / p.width[k].powi(2)),
            present: column(&|_, _| 1.0),
        }
    }

    /// The progression, if all grades are one-sided powers.
    pub(super) fn progression(&self) -> Option<Progression<V, N>> {
        match self {
            Self::Even(progression) if N <= ONE_SIDED => Some(*progression),
            _ => None,
        }
    }

    /// Grades at `x`.
    #[inline(always)]
    pub(super) fn at(&self, x: V) -> [V; N] {
        match self {
            Self::Even(progression) => {
                let r = progression.ratio(x);
                let mut out = progression.quotient;
                if N <= ONE_SIDED {
                    let mut powers = [r; N];
                    for k in 2..N {
                        powers[k] = powers[k / 2] * powers[k - k / 2];
                    }
                    for k in 1..N {
                        out[k] = out[k] * powers[k];
                    }
                    return out;
                }
                let mut power = r;
                for k in N / 2 + 1..N {
                    out[k] = out[k] * power;
                    power = power * r;
                }
                let inverse = r.reciprocal();
                let mut power = inverse;
                for k in (0..N / 2).rev() {
                    out[k] = out[k] * power;
                    power = power * inverse;
                }
                out
            }
            Self::Any { centre, factor, present } => {
                let mut out = *present;
                for k in 0..N {
                    let z = x - centre[k];
                    out[k] = out[k] * (z * z * factor[k]).exponential();
                }
                out
            }
        }
    }
}
