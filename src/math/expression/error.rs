//! Errors in formulas.

use std::ops::Range;

use thiserror::Error;

/// A formula that cannot be used; every variant contains the byte range concerned.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// A character no formula contains.
    #[error("byte {}: `{found}` has no meaning in a formula; remove it", span.start)]
    UnexpectedCharacter {
        /// Its bytes in the formula.
        span: Range<usize>,
        /// The character.
        found: char,
    },
    /// A piece in a place where another kind of piece belongs.
    #[error("byte {}: found {found}, expected {expected}", span.start)]
    UnexpectedToken {
        /// Its bytes in the formula.
        span: Range<usize>,
        /// The piece, or `the end of the formula`.
        found: String,
        /// What is expected in its place.
        expected: &'static str,
    },
    /// A number that does not fit.
    #[error("byte {}: the number `{found}` is too large for double precision", span.start)]
    NumberTooLarge {
        /// Its bytes in the formula.
        span: Range<usize>,
        /// The number as written.
        found: String,
    },
    /// A call of a function that does not exist.
    #[error("byte {}: unknown function `{name}`{}", span.start, hint(suggestion, known))]
    UnknownFunction {
        /// The bytes of the name.
        span: Range<usize>,
        /// As written in the formula.
        name: String,
        /// A function of a similar name.
        suggestion: Option<String>,
        /// All functions.
        known: Vec<String>,
    },
    /// A variable that is not defined where the formula is used.
    #[error("byte {}: unknown variable `{name}`{}", span.start, hint(suggestion, known))]
    UnknownVariable {
        /// The bytes of the name where it first appears.
        span: Range<usize>,
        /// As written in the formula.
        name: String,
        /// A variable of a similar name.
        suggestion: Option<String>,
        /// All variables.
        known: Vec<String>,
    },
    /// A function called with too few or too many arguments.
    #[error("byte {}: `{function}` got {found} arguments, takes {expected}", span.start)]
    WrongArgumentCount {
        /// The bytes of the name.
        span: Range<usize>,
        /// As written in the formula.
        function: String,
        /// The number of arguments given.
        found: usize,
        /// The number it takes.
        expected: usize,
    },
    /// Parentheses, powers or signs nested too deep.
    #[error("byte {}: nested deeper than {limit}; split the formula into several effects", span.start)]
    TooDeep {
        /// Where the limit was passed.
        span: Range<usize>,
        /// Deepest nesting that is read.
        limit: usize,
    },
    /// A formula that is too long.
    #[error("the formula has {} bytes, at most {limit} are allowed; split it", span.end)]
    TooLong {
        /// The whole formula.
        span: Range<usize>,
        /// The limit \[bytes\].
        limit: usize,
    },
}

impl ExpressionError {
    /// The bytes of the formula at which the error was found; empty at the end of the formula.
    #[cfg(test)]
    pub(super) fn span(&self) -> Range<usize> {
        match self {
            Self::UnexpectedCharacter { span, .. }
            | Self::UnexpectedToken { span, .. }
            | Self::NumberTooLarge { span, .. }
            | Self::UnknownFunction { span, .. }
            | Self::UnknownVariable { span, .. }
            | Self::WrongArgumentCount { span, .. }
            | Self::TooDeep { span, .. }
            | Self::TooLong { span, .. } => span.clone(),
        }
    }

    pub(super) fn unknown_function(name: &str, span: Range<usize>, known: &[&str]) -> Self {
        let suggestion = nearest(name, known);
        Self::UnknownFunction { span, name: name.to_owned(), suggestion, known: owned(known) }
    }

    pub(super) fn unknown_variable(name: &str, span: Range<usize>, known: &[&str]) -> Self {
        let suggestion = nearest(name, known);
        Self::UnknownVariable { span, name: name.to_owned(), suggestion, known: owned(known) }
    }
}

fn nearest(name: &str, known: &[&str]) -> Option<String> {
    crate::catalogue::nearest(name, known.iter().copied()).map(str::to_owned)
}

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|&n| n.to_owned()).collect()
}

fn hint(suggestion: &Option<String>, known: &[String]) -> String {
    match suggestion {
        Some(name) => format!(", did you mean `{name}`?"),
        None if known.is_empty() => String::new(),
        None => format!("; known are {}", known.join(", ")),
    }
}
