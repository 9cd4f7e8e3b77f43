//! SIMD vectors of the widest registers that the processor supports, selected at run time.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};
use std::sync::LazyLock;

use pulp::{Simd, WithSimd};

/// A SIMD vector in a register of `S`: 8 numbers with AVX-512, 4 with AVX2, 2 on ARM, 1 elsewhere.
///
/// Products and sums are fused only by [`Lanes::times_plus`], and then always, so that every number is the same to
/// the last bit whatever the other lanes contain and however wide the register is.
///
/// Functions that work on lanes are `#[inline(always)]` and have no closures in their loops: code that is not
/// inlined below [`WithSimd::with_simd`] is compiled without the wide instructions and passes its registers
/// through memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    numbers: S::f64s,
}

macro_rules! operator {
    ($trait:ident, $method:ident, $of_simd:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let numbers = self.simd.$of_simd(self.numbers, other.numbers);
                Self { simd: self.simd, numbers }
            }
        }
        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(Self::splat(self.simd, other))
            }
        }
    };
}
operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);

/// A condition for each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mask<S: Simd> {
    simd: S,
    set: S::m64s,
}

impl<S: Simd> Mask<S> {
    /// `inside` where the condition is true, otherwise `outside`.
    #[inline(always)]
    pub(crate) fn select(self, inside: Lanes<S>, outside: Lanes<S>) -> Lanes<S> {
        let numbers = self.simd.select_f64s(self.set, inside.numbers, outside.numbers);
        Lanes { simd: self.simd, numbers }
    }

    /// Whether the condition is true in any lane.
    #[inline(always)]
    pub(crate) fn any(self) -> bool {
        self.simd.first_true_m64s(self.set) < Lanes::<S>::COUNT
    }

    /// Whether the condition is true in all lanes.
    #[inline(always)]
    pub(crate) fn all(self) -> bool {
        let (zero, one) = (Lanes::splat(self.simd, 0.0), Lanes::splat(self.simd, 1.0));
        !zero.below(self.select(zero, one)).any()
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { simd: self.simd, set: self.simd.and_m64s(self.set, other.set) }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { simd: self.simd, set: self.simd.or_m64s(self.set, other.set) }
    }
}

/// Coefficients 1/k! of the exponential.
const INVERSE_FACTORIALS: [f64; 14] = {
    let mut coefficients = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        coefficients[k] = coefficients[k - 1] / k as f64;
        k += 1;
    }
    coefficients
};
/// Largest size of the argument of [`Lanes::exp`].
const LARGEST_EXPONENT: f64 = 50.0;

impl<S: Simd> Lanes<S> {
    /// Numbers in a register.
    pub(crate) const COUNT: usize = size_of::<S::f64s>() / size_of::<f64>();

    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(simd: S, number: f64) -> Self {
        Self { simd, numbers: simd.splat_f64s(number) }
    }

    /// The first numbers of a slice, one per lane.
    #[inline(always)]
    pub(crate) fn load(simd: S, numbers: &[f64]) -> Self {
        // not a partial load, which is a call
        let (registers, _) = S::as_simd_f64s(&numbers[..Self::COUNT]);
        Self { simd, numbers: registers[0] }
    }

    /// Writes the lanes to the front of a slice.
    #[inline(always)]
    pub(crate) fn store(self, out: &mut [f64]) {
        let (registers, _) = S::as_mut_simd_f64s(&mut out[..Self::COUNT]);
        registers[0] = self.numbers;
    }

    /// `self · factor + more`, rounded once. Slow without [`are_wide`], where the processor has no such instruction.
    #[inline(always)]
    pub(crate) fn times_plus(self, factor: Self, more: Self) -> Self {
        let numbers = self.simd.mul_add_f64s(self.numbers, factor.numbers, more.numbers);
        Self { simd: self.simd, numbers }
    }

    /// The maximum of each number and `least`.
    #[inline(always)]
    pub(crate) fn max(self, least: f64) -> Self {
        let numbers = self.simd.max_f64s(self.numbers, self.simd.splat_f64s(least));
        Self { simd: self.simd, numbers }
    }

    /// The minimum of each number and `most`.
    #[inline(always)]
    pub(crate) fn min(self, most: f64) -> Self {
        let numbers = self.simd.min_f64s(self.numbers, self.simd.splat_f64s(most));
        Self { simd: self.simd, numbers }
    }

    /// Reciprocal of each number.
    #[inline(always)]
    pub(crate) fn recip(self) -> Self {
        Self::splat(self.simd, 1.0) / self
    }

    /// Absolute value of each number.
    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self { simd: self.simd, numbers: self.simd.abs_f64s(self.numbers) }
    }

    /// Where it is below the other.
    #[inline(always)]
    pub(crate) fn below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, set: self.simd.less_than_f64s(self.numbers, other.numbers) }
    }

    /// Where it equals the other.
    #[inline(always)]
    pub(crate) fn equals(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, set: self.simd.equal_f64s(self.numbers, other.numbers) }
    }

    /// The exponential of each number, those beyond ±50 taken as ±50; relative error below 1e-13.
    ///
    /// ```text
    /// e^x = (e^(x/128))^128,   e^r by its Taylor polynomial of degree 13 (|r| < 0.4: 3e-17)
    /// ```
    /// The seven squarings carry the rounding of the polynomial 128 times.
    #[inline(always)]
    pub(crate) fn exp(self) -> Self {
        const C: [f64; 14] = INVERSE_FACTORIALS;
        let c = |k: usize| Self::splat(self.simd, C[k]);
        let r = self.max(-LARGEST_EXPONENT).min(LARGEST_EXPONENT) * (1.0 / 128.0);
        let square = r * r;
        let fourth = square * square;
        // in an order in which the operations are independent
        let first = r.times_plus(c(3), c(2)).times_plus(square, r.times_plus(c(1), c(0)));
        let second = r.times_plus(c(7), c(6)).times_plus(square, r.times_plus(c(5), c(4)));
        let third = r.times_plus(c(11), c(10)).times_plus(square, r.times_plus(c(9), c(8)));
        let last = r.times_plus(c(13), c(12)).times_plus(fourth, third);
        let mut power = last.times_plus(fourth, second).times_plus(fourth, first);
        for _ in 0..7 {
            power = power * power;
        }
        power
    }
}

/// The widest registers of this processor; queried once, because the query takes as long as a short computation.
static WIDEST: LazyLock<pulp::Arch> = LazyLock::new(pulp::Arch::new);

/// Runs `work` with the widest registers of this processor.
#[inline]
pub(crate) fn in_lanes<W: WithSimd>(work: W) -> W::Output {
    WIDEST.dispatch(work)
}

/// Whether this processor has registers of several numbers, and instructions that fuse products and sums.
pub(crate) fn are_wide() -> bool {
    !matches!(*WIDEST, pulp::Arch::Scalar)
}

/// Every width of registers that this processor has, the narrowest first.
#[cfg(test)]
pub(crate) fn every_width() -> Vec<pulp::Arch> {
    let mut all = vec![pulp::Arch::Scalar];
    #[cfg(target_arch = "x86_64")]
    all.extend(pulp::x86::V3::try_new().map(pulp::Arch::V3));
    all.push(pulp::Arch::new());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Exponentials<'a>(&'a [f64]);
    impl WithSimd for Exponentials<'_> {
        type Output = Vec<f64>;
        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
            let mut out = self.0.to_vec();
            for some in out.chunks_exact_mut(Lanes::<S>::COUNT) {
                Lanes::load(simd, some).exp().store(some);
            }
            out
        }
    }

    #[test]
    fn the_exponential_is_that_of_the_library_and_the_same_at_every_width() {
        let x: Vec<f64> = (0..8000).map(|k| -50.0 + 0.0125 * f64::from(k)).collect();
        let wide = in_lanes(Exponentials(&x));
        for arch in every_width() {
            assert_eq!(wide, arch.dispatch(Exponentials(&x)));
        }
        for (x, e) in x.iter().zip(wide) {
            assert!((e / x.exp() - 1.0).abs() < 1e-13, "{x} {e}");
        }
        let ends = in_lanes(Exponentials(&[-900.0, 900.0].repeat(8)));
        assert!(ends[0] < 2e-22 && ends[1] > 5e21);
    }
}
