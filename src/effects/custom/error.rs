//! Errors in the definition of a custom effect.

use crate::effects::DIFFERENTIATED;
use crate::math::ExpressionError;

/// Why a definition is not a valid effect.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CustomError {
    /// The id is not a new name.
    #[error("the custom effect cannot be called `{id}`: {reason}; take another name")]
    Id {
        /// As written.
        id: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Too many parameters.
    #[error(
        "the custom effect `{id}` has {found} parameters; at most {DIFFERENTIATED} are possible"
    )]
    Parameters {
        /// The effect.
        id: String,
        /// Number of parameters.
        found: usize,
    },
    /// A symbol that cannot be used.
    #[error("the custom effect `{id}` cannot have a parameter `{symbol}`: {reason}; rename it")]
    Symbol {
        /// The effect.
        id: String,
        /// As written.
        symbol: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A range without width, or a typical value outside it.
    #[error(
        "parameter `{symbol}` of the custom effect `{id}`: expected range low < high with the \
         typical value inside, found {low} to {high} and {typical}"
    )]
    Range {
        /// The effect.
        id: String,
        /// The parameter.
        symbol: String,
        /// Low end.
        low: f64,
        /// High end.
        high: f64,
        /// Typical value.
        typical: f64,
    },
    /// A formula that cannot be read.
    #[error("{key} of the custom effect `{id}`: {source}")]
    Formula {
        /// The effect.
        id: String,
        /// `torque1` or `torque2`.
        key: &'static str,
        /// Error of the formula parser.
        source: Box<ExpressionError>,
    },
    /// A parameter that is declared linear but is not.
    #[error(
        "the torque of the custom effect `{id}` is not proportional to its linear parameters \
         (see `{symbol}`); give it the kind \"shape\""
    )]
    NotLinear {
        /// The effect.
        id: String,
        /// The parameter.
        symbol: String,
    },
}
