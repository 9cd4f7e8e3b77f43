//! A scalar that records formulas instead of computing them.

use std::cell::RefCell;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::expression::{Binary, Unary};
use super::formula::{Formula, Node};
use super::scalar::Real;

thread_local! {
    static TAPE: RefCell<Formula> = RefCell::default();
}

/// Records the operations of `f` on symbols of the inputs, whose values are those at one place.
///
/// # Examples
/// ```
/// use amigo_ident::math::{Real, record};
/// let formula = record(&[2.0, 3.0], |x| vec![x[0].sin() * x[1] + x[0].sin()]);
/// assert_eq!(formula.nodes.len(), 5); // two inputs, one sine, product, sum
/// assert_eq!(formula.evaluate(&[0.5, 2.0]), [0.5_f64.sin() * 2.0 + 0.5_f64.sin()]);
/// ```
pub fn record(inputs: &[f64], f: impl FnOnce(&[Symbol]) -> Vec<Symbol>) -> Formula {
    let outer = TAPE.take();
    let symbols: Vec<Symbol> =
        inputs.iter().enumerate().map(|(k, &v)| Symbol::push(Node::Input(k), v)).collect();
    let outputs = f(&symbols).iter().map(|symbol| symbol.node()).collect();
    let formula = TAPE.replace(outer);
    Formula { outputs, ..formula }
}

/// A scalar that records its computation: every operation is written to a tape, so that physics written over
/// [`Real`] can be printed as a formula.
///
/// It also has the value at the place of recording. Reading this value marks the formula ([`Formula::read`]).
/// Symbols are valid only within the call of [`record`] that created them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symbol {
    /// `None` for a constant that is not yet on the tape.
    node: Option<usize>,
    value: f64,
}

impl Symbol {
    /// The index of an operation on the tape; an operation that already exists is not recorded again.
    fn push(node: Node, value: f64) -> Self {
        let place = TAPE.with_borrow_mut(|tape| {
            tape.nodes.iter().position(|n| *n == node).unwrap_or_else(|| {
                tape.nodes.push(node);
                tape.nodes.len() - 1
            })
        });
        Self { node: Some(place), value }
    }

    fn node(self) -> usize {
        self.node.or_else(|| Self::push(Node::Constant(self.value), self.value).node).unwrap_or(0)
    }

    fn is(self, constant: f64) -> bool {
        self.node.is_none() && self.value == constant
    }

    fn unary(self, function: Unary) -> Self {
        let value = function.apply(self.value);
        match self.node {
            None => value.into(),
            Some(a) => Self::push(Node::Unary(function, a), value),
        }
    }

    fn binary(self, function: Binary, other: Self) -> Self {
        let value = function.apply(self.value, other.value);
        if self.node.is_none() && other.node.is_none() {
            return value.into();
        }
        Self::push(Node::Binary(function, self.node(), other.node()), value)
    }
}

impl From<f64> for Symbol {
    fn from(value: f64) -> Self {
        Self { node: None, value }
    }
}

impl Real for Symbol {
    fn value(self) -> f64 {
        if self.node.is_some() {
            TAPE.with_borrow_mut(|tape| tape.read = true);
        }
        self.value
    }
    fn chain(self, value: f64, _derivative: f64) -> Self {
        let _ = self.value(); // a function without a node
        value.into()
    }
    fn exp(self) -> Self {
        self.unary(Unary::Exp)
    }
    fn ln(self) -> Self {
        self.unary(Unary::Ln)
    }
    fn sin(self) -> Self {
        self.unary(Unary::Sin)
    }
    fn cos(self) -> Self {
        self.unary(Unary::Cos)
    }
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn tanh(self) -> Self {
        self.unary(Unary::Tanh)
    }
    fn erf(self) -> Self {
        self.unary(Unary::Erf)
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn sgn(self) -> Self {
        self.unary(Unary::Sgn)
    }
    fn round(self) -> Self {
        self.unary(Unary::Round)
    }
    fn powf(self, power: f64) -> Self {
        self.binary(Binary::Power, power.into())
    }
    fn pow(self, power: Self) -> Self {
        self.binary(Binary::Power, power)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
}

// neutral operations are omitted: x + 0, 1 x, 0 x, x/1, x/x
impl Add for Symbol {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        if self.is(0.0) {
            o
        } else if o.is(0.0) {
            self
        } else {
            self.binary(Binary::Add, o)
        }
    }
}
impl Sub for Symbol {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        if self.is(0.0) {
            -o
        } else if o.is(0.0) {
            self
        } else {
            self.binary(Binary::Subtract, o)
        }
    }
}
impl Mul for Symbol {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        if self.is(0.0) || o.is(0.0) {
            Self::from(0.0)
        } else if self.is(1.0) {
            o
        } else if o.is(1.0) {
            self
        } else {
            self.binary(Binary::Multiply, o)
        }
    }
}
impl Div for Symbol {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        if self.is(0.0) || o.is(1.0) {
            self
        } else if self.node.is_some() && self.node == o.node {
            Self::from(1.0)
        } else {
            self.binary(Binary::Divide, o)
        }
    }
}
impl Neg for Symbol {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Negate)
    }
}
impl Add<f64> for Symbol {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        self + Self::from(o)
    }
}
impl Sub<f64> for Symbol {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        self - Self::from(o)
    }
}
impl Mul<f64> for Symbol {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        self * Self::from(o)
    }
}
impl Div<f64> for Symbol {
    type Output = Self;
    fn div(self, o: f64) -> Self {
        self / Self::from(o)
    }
}
impl AddAssign for Symbol {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl SubAssign for Symbol {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}
impl MulAssign for Symbol {
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<T: Real>(x: &[T]) -> T {
        let clipped = x[0].max(-x[1]).min(x[1]);
        (x[0] * x[1]).exp() / (x[0].squared() + 1.0).sqrt() - (x[1] * 2.0).sin() * x[0].cos()
            + x[0].tanh() * x[1].abs() / 3.0
            + x[0].erf()
            + (x[0] + 2.0).ln()
            + x[1].pow(x[0])
            + x[1].powf(1.5)
            + (x[0] * 10.0).round() * x[0].sgn()
            - clipped
    }

    #[test]
    fn a_recorded_formula_gives_the_same_bits_as_the_formula_itself_elsewhere() {
        let recorded = record(&[0.7, 0.4], |x| vec![formula(x)]);
        assert!(!recorded.read);
        for x in [[0.7, 0.4], [-0.3, 0.9], [-1.9, 0.1], [0.0, 2.5]] {
            assert_eq!(recorded.evaluate(&x), [formula(&x)]);
        }
    }

    #[test]
    fn what_is_computed_twice_is_recorded_once_and_what_adds_nothing_not_at_all() {
        let recorded = record(&[2.0], |x| {
            let zero = Symbol::from(0.0);
            let ratio = x[0] / x[0];
            vec![(x[0].exp() + zero) * ratio, x[0].exp() - 0.0, x[0] * zero]
        });
        let expected = [Node::Input(0), Node::Unary(Unary::Exp, 0), Node::Constant(0.0)];
        assert_eq!((recorded.nodes, recorded.outputs), (expected.to_vec(), vec![1, 1, 2]));
    }

    #[test]
    fn a_branch_on_a_value_is_noticed_and_one_on_a_constant_is_none() {
        let branch = record(&[2.0], |x| vec![if x[0].value() > 0.0 { x[0] } else { -x[0] }]);
        assert!(branch.read);
        let none = record(&[2.0], |x| {
            let two = Symbol::from(2.0);
            vec![if two.value() > 0.0 { x[0] } else { -x[0] }]
        });
        assert!(!none.read);
    }
}
