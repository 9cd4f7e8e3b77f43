//! Numbers only: no robot, no file.

pub mod distribution;
mod error;
pub mod least_squares;
pub mod robust;
pub mod scalar;
mod singular_values;

pub use error::MathError;
pub use least_squares::{LinearFit, fit};
pub use robust::{RobustFit, fit_huber};
pub use scalar::{Dual, Real, sgn};
