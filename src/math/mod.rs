//! Numbers only: no robot, no file.

pub mod descent;
pub mod distribution;
mod error;
pub mod filter;
pub mod integrate;
pub mod least_squares;
pub mod membership;
pub mod noise;
pub mod robust;
pub mod savitzky_golay;
pub mod scalar;
mod singular_values;
pub mod symmetric;

pub use error::MathError;
pub use least_squares::{LinearFit, fit};
pub use robust::{RobustFit, fit_huber};
pub use savitzky_golay::SavitzkyGolay;
pub use scalar::{Dual, Real, sgn};
pub use symmetric::{Identified, information_to_covariance};
