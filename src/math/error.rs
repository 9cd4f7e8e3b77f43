//! Errors of numerical input.

use thiserror::Error;

/// Input that a numerical method of this module cannot work with.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MathError {
    /// Two inputs that must have the same number of rows do not.
    #[error("{quantity} has {found} rows, expected {expected}; give one value per row")]
    LengthMismatch {
        /// The input of the wrong length.
        quantity: &'static str,
        /// Its number of rows.
        found: usize,
        /// The required number of rows.
        expected: usize,
    },
    /// A value is NaN or infinite.
    #[error("{quantity}, row {row}: the value is not finite; remove or interpolate this sample")]
    NotFinite {
        /// The input that holds the value.
        quantity: &'static str,
        /// Row of the value, counted from zero.
        row: usize,
    },
    /// There are too few samples for the method.
    #[error("{method} got {found} samples, needs at least {required}; use a longer recording")]
    TooFewSamples {
        /// Method that requires them.
        method: &'static str,
        /// The number of samples given.
        found: usize,
        /// The smallest number that is sufficient.
        required: usize,
    },
    /// A setting lies outside its range.
    #[error("{setting} = {found}, expected {expected}")]
    OutOfRange {
        /// Name of the argument.
        setting: &'static str,
        /// Its value.
        found: f64,
        /// The range in words.
        expected: &'static str,
    },
}

/// Refuses the first value that is not finite.
pub(crate) fn check_finite<'a>(
    quantity: &'static str,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), MathError> {
    match values.into_iter().position(|v| !v.is_finite()) {
        Some(row) => Err(MathError::NotFinite { quantity, row }),
        None => Ok(()),
    }
}

/// Refuses an input whose length is not the expected one.
pub(crate) fn check_length(
    quantity: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), MathError> {
    if found == expected {
        Ok(())
    } else {
        Err(MathError::LengthMismatch { quantity, found, expected })
    }
}
