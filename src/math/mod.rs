//! Numbers only: no robot, no file.

pub mod descent;
pub mod distribution;
mod error;
pub mod expression;
pub mod filter;
pub mod integrate;
pub mod least_squares;
pub mod membership;
pub mod noise;
pub mod robust;
pub mod savitzky_golay;
pub mod scalar;
mod singular_values;
pub mod spectrum;
mod symbol;
pub mod symmetric;

pub use descent::{MinimiseOptions, Minimum, MinimumStatus, Quadratic, minimise};
pub use error::MathError;
pub use expression::{Expression, ExpressionError};
pub use integrate::{DormandPrince, Trajectory, runge_kutta_step};
pub use least_squares::{LinearFit, fit};
pub use membership::Gaussian;
pub use noise::{NoiseEstimate, white_noise};
pub use robust::{RobustFit, fit_huber};
pub use savitzky_golay::SavitzkyGolay;
pub use scalar::{Dual, Real, sgn};
pub use spectrum::{Oscillation, oscillations};
pub use symbol::{Formula, Node, Symbol, record};
pub use symmetric::{Identified, information_to_covariance};
