//! The scalar type of physical effects: `f64`, or dual numbers with exact derivatives.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number, optionally with derivatives; every physical effect is implemented once over this trait.
///
/// `f64` gives values, [`Dual`] gives values and exact partial derivatives (forward-mode
/// automatic differentiation).
pub trait Real:
    Copy
    + std::fmt::Debug
    + Send
    + Sync
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + 'static
{
    /// The value without derivatives.
    fn value(self) -> f64;

    /// Applies a function with given value and first derivative at `self.value()`.
    #[must_use]
    fn chain(self, value: f64, derivative: f64) -> Self;

    /// e to the power of `self`.
    #[must_use]
    fn exp(self) -> Self {
        let e = self.value().exp();
        self.chain(e, e)
    }
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self {
        let x = self.value();
        self.chain(x.ln(), 1.0 / x)
    }
    /// Sine of an angle \[rad\].
    #[must_use]
    fn sin(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(s, c)
    }
    /// Cosine of an angle \[rad\].
    #[must_use]
    fn cos(self) -> Self {
        let (s, c) = self.value().sin_cos();
        self.chain(c, -s)
    }
    /// Sine and cosine of an angle \[rad\].
    #[must_use]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value().sin_cos();
        (self.chain(s, c), self.chain(c, -s))
    }
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self {
        let r = self.value().sqrt();
        self.chain(r, 0.5 / r)
    }
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self {
        let h = self.value().tanh();
        self.chain(h, 1.0 - h * h)
    }
    /// Error function, erf(x) = 2/sqrt(pi) int_0^x exp(-s^2) ds.
    #[must_use]
    fn erf(self) -> Self {
        let x = self.value();
        self.chain(libm::erf(x), std::f64::consts::FRAC_2_SQRT_PI * (-x * x).exp())
    }
    /// Absolute value; the derivative is [`sgn`], so zero at zero.
    #[must_use]
    fn abs(self) -> Self {
        let x = self.value();
        self.chain(x.abs(), sgn(x))
    }
    /// `self` to a real power; `self` must be positive unless the power is an integer.
    #[must_use]
    fn powf(self, power: f64) -> Self {
        let x = self.value();
        self.chain(x.powf(power), power * x.powf(power - 1.0))
    }
    /// The number times itself, with one product.
    #[must_use]
    fn squared(self) -> Self {
        self * self
    }
    /// The sign, [`sgn`]; its derivative is zero.
    #[must_use]
    fn sgn(self) -> Self {
        Self::from(sgn(self.value()))
    }
    /// The nearest integer; its derivative is zero.
    #[must_use]
    fn round(self) -> Self {
        Self::from(self.value().round())
    }
    /// The smaller of two; `self` if they are equal, NaN if either is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self {
        let (a, b) = (self.value(), other.value());
        if b < a || b.is_nan() { other } else { self }
    }
    /// The larger of two; `self` if they are equal, NaN if either is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self {
        let (a, b) = (self.value(), other.value());
        if b > a || b.is_nan() { other } else { self }
    }
    /// `one` if `self` is one, `zero` if it is zero, and the weighted mean in between: `self one + (1 - self)
    /// zero`. For 0 and 1 only the selected branch is evaluated.
    #[must_use]
    fn choose(self, one: impl FnOnce() -> Self, zero: impl FnOnce() -> Self) -> Self {
        self * one() + (Self::from(1.0) - self) * zero()
    }
    /// `self` to a variable power.
    #[must_use]
    fn pow(self, power: Self) -> Self {
        let (a, p) = (self.value(), power.value());
        if a > 0.0 {
            // d(a^p) = p a^(p-1) da + a^p ln(a) dp; the second term carries a derivative only
            self.powf(p) + power.chain(0.0, a.powf(p) * a.ln())
        } else if p == 0.0 {
            Self::from(1.0) // its derivative by the general rule would be 0 * inf at zero
        } else if p == 1.0 {
            self
        } else if p == 2.0 {
            self.squared()
        } else {
            // no real derivative with respect to the power exists here, except zero at base zero
            self.powf(p)
        }
    }
}

/// The sign with sgn(0) = 0, as the paper's friction term needs it (`f64::signum(0.0)` is 1).
///
/// # Examples
/// ```
/// use amigo_ident::math::sgn;
/// assert_eq!((sgn(-2.0), sgn(0.0), sgn(3.0)), (-1.0, 0.0, 1.0));
/// ```
#[must_use]
pub fn sgn(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

impl Real for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn chain(self, value: f64, _derivative: f64) -> Self {
        value
    }
    #[inline]
    fn choose(self, one: impl FnOnce() -> Self, zero: impl FnOnce() -> Self) -> Self {
        match self {
            1.0 => one(),
            0.0 => zero(),
            _ => self * one() + (1.0 - self) * zero(),
        }
    }
}

/// A value with its `N` partial derivatives.
///
/// # Examples
/// ```
/// use amigo_ident::math::{Dual, Real};
/// let x = Dual::<2>::variable(3.0, 0);
/// let y = Dual::<2>::variable(2.0, 1);
/// let f = x * y + x.sin();
/// assert!((f.partial[0] - (2.0 + 3.0_f64.cos())).abs() < 1e-15); // df/dx = y + cos x
/// assert_eq!(f.partial[1], 3.0); // df/dy = x
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// Value without derivatives.
    pub value: f64,
    /// The partial derivatives with respect to the `N` variables.
    pub partial: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A constant: all partial derivatives are zero.
    #[must_use]
    pub const fn constant(value: f64) -> Self {
        Self { value, partial: [0.0; N] }
    }

    /// Variable number `index`: its own partial derivative is one.
    ///
    /// # Panics
    /// If `index >= N`.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut partial = [0.0; N];
        partial[index] = 1.0;
        Self { value, partial }
    }

    #[inline]
    fn combine(self, other: Self, value: f64, by_self: f64, by_other: f64) -> Self {
        let mut partial = [0.0; N];
        for i in 0..N {
            partial[i] = by_self * self.partial[i] + by_other * other.partial[i];
        }
        Self { value, partial }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl<const N: usize> Real for Dual<N> {
    #[inline]
    fn value(self) -> f64 {
        self.value
    }
    #[inline]
    fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, partial: self.partial.map(|d| derivative * d) }
    }
    #[inline]
    fn choose(self, one: impl FnOnce() -> Self, zero: impl FnOnce() -> Self) -> Self {
        // a choice that moves needs both for its derivative
        match self.value {
            1.0 if self.partial == [0.0; N] => one(),
            0.0 if self.partial == [0.0; N] => zero(),
            _ => self * one() + (Self::from(1.0) - self) * zero(),
        }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        self.combine(o, self.value + o.value, 1.0, 1.0)
    }
}
impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self.combine(o, self.value - o.value, 1.0, -1.0)
    }
}
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        self.combine(o, self.value * o.value, o.value, self.value)
    }
}
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: Self) -> Self {
        let q = self.value / o.value;
        self.combine(o, q, 1.0 / o.value, -q / o.value)
    }
}
impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}
impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}
impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}
impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, o: f64) -> Self {
        self.chain(self.value * o, o)
    }
}
impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, o: f64) -> Self {
        self.chain(self.value / o, 1.0 / o)
    }
}
impl<const N: usize> AddAssign for Dual<N> {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<const N: usize> SubAssign for Dual<N> {
    #[inline]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl<const N: usize> MulAssign for Dual<N> {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A formula that uses every function of the trait.
    fn formula<T: Real>(x: T, y: T) -> T {
        (x * y).exp() / (x.squared() + 1.0).sqrt() - (y * 2.0).sin() * x.cos()
            + x.tanh() * y.abs() / 3.0
            + x.erf()
            + (x + 2.0).ln()
            + x.powf(1.5)
            - y
    }

    #[test]
    fn a_choice_is_the_mean_with_its_weight_and_evaluates_what_was_chosen_alone() {
        let (x, y) = (Dual::<2>::variable(0.7, 0), Dual::<2>::constant(-0.4));
        for share in [0.0, 0.3, 1.0_f64] {
            assert_eq!(share.choose(|| 0.7, || -0.4), share * 0.7 + (1.0 - share) * -0.4);
            for moving in [Dual::constant(share), Dual::variable(share, 1)] {
                let mean = moving * x + (Dual::constant(1.0) - moving) * y;
                assert_eq!(moving.choose(|| x, || y), mean);
            }
        }
        let never = || -> f64 { unreachable!("it was not chosen") };
        assert_eq!((1.0_f64.choose(|| 0.7, never), 0.0_f64.choose(never, || -0.4)), (0.7, -0.4));
    }

    #[test]
    fn derivatives_of_every_function_equal_central_differences() {
        let (x, y, h) = (0.7, -0.4, 1e-6);
        let d = formula(Dual::<2>::variable(x, 0), Dual::<2>::variable(y, 1));
        let dx = (formula(x + h, y) - formula(x - h, y)) / (2.0 * h);
        let dy = (formula(x, y + h) - formula(x, y - h)) / (2.0 * h);
        assert_eq!(d.value, formula(x, y));
        // central differences: truncation h^2 ~ 1e-12, rounding eps/h ~ 1e-10
        assert!((d.partial[0] - dx).abs() < 1e-9, "{} {dx}", d.partial[0]);
        assert!((d.partial[1] - dy).abs() < 1e-9, "{} {dy}", d.partial[1]);
    }
}
