//! Numbers only: no robot, no file.

pub mod scalar;

pub use scalar::{Dual, Real, sgn};
