//! User-defined formulas, such as `-c*exp(-(w/ws)^2)*tanh(w/0.1)`, with exact derivatives.

mod error;
mod parser;

use std::fmt;
use std::ops::Range;

use super::scalar::Real;
pub use error::ExpressionError;

/// Deepest nesting of a formula; also bounds the values held while one is evaluated.
pub(crate) const MAX_DEPTH: usize = 32;
/// Longest formula \[bytes\].
pub(crate) const MAX_LENGTH: usize = 4096;
/// Values that the small evaluation stack holds; most formulas need no more.
const SMALL_STACK: usize = 6;

/// A function of one variable that formulas may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unary {
    /// -x.
    Negate,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// e to the power.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Square root.
    Sqrt,
    /// Absolute value.
    Abs,
    /// Sign, zero at zero.
    Sgn,
    /// Hyperbolic tangent.
    Tanh,
    /// Error function.
    Erf,
    /// To the nearest whole number; effects use it, formulas have no name for it.
    Round,
}

/// An operator or a function of two variables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Binary {
    /// a + b.
    Add,
    /// a - b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// a to the power b.
    Power,
    /// The smaller.
    Min,
    /// The larger.
    Max,
}

/// One instruction of a stack machine: formulas are kept in postfix order, so that evaluating or
/// dropping one never recurses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Op {
    Constant(f64),
    /// Index into the variables of the expression, or into the slots once bound.
    Variable(usize),
    Unary(Unary),
    Binary(Binary),
    /// To a power that does not vary.
    Power(f64),
}

/// A parsed formula whose variables are not yet bound to values.
///
/// The grammar, from loose to tight: `+ -`, `* /`, sign, `^` (from the right, `-x^2` is `-(x^2)`),
/// then numbers, names, `pi`, parentheses and the functions sin cos tan exp ln sqrt abs sgn tanh
/// erf min max.
///
/// # Examples
/// ```
/// use amigo_ident::math::expression::parse;
/// let stribeck = parse("-c*exp(-(w/ws)^2)*tanh(w/0.1)")?;
/// assert_eq!(stribeck.variables(), ["c", "w", "ws"]);
/// let bound = stribeck.bind(&["w", "c", "ws"])?;
/// let torque: f64 = bound.evaluate(&[0.5, 0.02, 1.0]);
/// assert!((torque + 0.02 * (-0.25_f64).exp() * 5.0_f64.tanh()).abs() < 1e-15);
/// # Ok::<(), amigo_ident::math::expression::ExpressionError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Expression {
    source: String,
    ops: Vec<Op>,
    /// Names in the order of their first appearance, each with its byte range there.
    variables: Vec<(String, Range<usize>)>,
}

/// Parses a formula.
///
/// # Errors
/// If the formula is not well formed, calls an unknown function, or is longer than 4096 bytes or
/// nested deeper than 32; the error holds the bytes that it is about.
pub fn parse(source: &str) -> Result<Expression, ExpressionError> {
    parser::parse(source)
}

impl Expression {
    /// The names of the variables, each once, in the order of their first appearance.
    #[must_use]
    pub fn variables(&self) -> Vec<&str> {
        self.variables.iter().map(|(name, _)| name.as_str()).collect()
    }

    /// Assigns every variable the slot of its name in `names`; names that do not appear are allowed.
    ///
    /// # Errors
    /// If a variable is not among the names.
    pub fn bind(&self, names: &[&str]) -> Result<Bound, ExpressionError> {
        let slot = |(name, span): &(String, Range<usize>)| {
            let found = names.iter().position(|n| n == name);
            found.ok_or_else(|| ExpressionError::unknown_variable(name, span.clone(), names))
        };
        let slots = self.variables.iter().map(slot).collect::<Result<Vec<_>, _>>()?;
        let resolve = |op: &Op| match *op {
            Op::Variable(index) => Op::Variable(slots[index]),
            other => other,
        };
        let ops: Vec<Op> = self.ops.iter().map(resolve).collect();
        Ok(Bound { height: stack_height(&ops), ops, slots: names.len() })
    }
}

impl fmt::Display for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.source)
    }
}

/// A formula whose variables are slots of an array, ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    ops: Vec<Op>,
    /// Most values on the stack at a time.
    height: usize,
    slots: usize,
}

impl Bound {
    /// The value of the formula, with its derivatives if `T` carries them.
    ///
    /// Follows the arithmetic of `f64`: `1/0` is infinite, `ln(-1)` and a negative number to a
    /// fractional power are NaN.
    ///
    /// # Panics
    /// If `slots` is shorter than the list of names the formula was bound to.
    #[must_use]
    pub fn evaluate<T: Real>(&self, slots: &[T]) -> T {
        assert!(slots.len() >= self.slots, "{} slots for {} names", slots.len(), self.slots);
        if self.height <= SMALL_STACK {
            self.run::<T, SMALL_STACK>(slots)
        } else {
            self.run::<T, { MAX_DEPTH + 1 }>(slots)
        }
    }

    fn run<T: Real, const HEIGHT: usize>(&self, slots: &[T]) -> T {
        let mut stack = [T::from(0.0); HEIGHT];
        let mut top = 0;
        for op in &self.ops {
            match *op {
                Op::Constant(value) => {
                    stack[top] = T::from(value);
                    top += 1;
                }
                Op::Variable(slot) => {
                    stack[top] = slots[slot];
                    top += 1;
                }
                Op::Unary(function) => stack[top - 1] = function.apply(stack[top - 1]),
                Op::Power(power) => stack[top - 1] = to_constant_power(stack[top - 1], power),
                Op::Binary(function) => {
                    top -= 1;
                    stack[top - 1] = function.apply(stack[top - 1], stack[top]);
                }
            }
        }
        stack[0]
    }
}

/// Most values a stack machine holds while it runs the instructions.
pub(crate) fn stack_height(ops: &[Op]) -> usize {
    let (mut height, mut most) = (0_usize, 0);
    for op in ops {
        match op {
            Op::Constant(_) | Op::Variable(_) => height += 1,
            Op::Binary(_) => height -= 1,
            Op::Unary(_) | Op::Power(_) => {}
        }
        most = most.max(height);
    }
    most
}

impl Unary {
    pub(crate) fn apply<T: Real>(self, x: T) -> T {
        match self {
            Self::Negate => -x,
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.sin() / x.cos(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            Self::Sgn => x.sgn(),
            Self::Tanh => x.tanh(),
            Self::Erf => x.erf(),
            Self::Round => x.round(),
        }
    }
}

impl Binary {
    pub(crate) fn apply<T: Real>(self, a: T, b: T) -> T {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.pow(b),
            Self::Min => a.min(b),
            Self::Max => a.max(b),
        }
    }
}

fn to_constant_power<T: Real>(base: T, power: f64) -> T {
    if power == 0.0 {
        T::from(1.0) // its derivative by the general rule would be 0 * inf at zero
    } else if power == 1.0 {
        base
    } else if power == 2.0 {
        base.squared()
    } else {
        base.powf(power)
    }
}

#[cfg(test)]
#[path = "expression/tests.rs"]
mod tests;
