//! Numerical methods, without reference to robots or files.

mod banded;
mod correlation;
mod covariance;
mod damped;
pub mod descent;
pub mod distribution;
#[cfg(test)]
pub(crate) mod dormand_prince;
mod error;
pub mod expression;
pub mod filter;
mod formula;
mod information;
mod integral;
mod interpolation;
mod lanes;
pub mod least_squares;
mod log_product;
mod moments;
pub mod noise;
mod nonnegative;
mod normal_equations;
mod order;
mod products;
pub mod robust;
mod rounding;
mod runge_kutta;
mod runs;
pub mod scalar;
mod singular_values;
mod span;
mod symbol;
mod wide_filter;

pub use banded::BandedCholesky;
pub(crate) use correlation::correlation;
pub use covariance::{clustered_covariance, correlations, raise_errors, sandwich};
pub(crate) use damped::{Attempt, DampedSearch, Proposal, take_steps};
pub use descent::{MinimiseOptions, Minimum, MinimumStatus, Quadratic, minimise};
pub use error::MathError;
pub use expression::{Expression, ExpressionError};
pub use formula::{Formula, Node};
pub use information::{Information, eliminate};
pub use integral::{cumulative_trapezoid, trapezoid};
pub use interpolation::{interpolate, interpolate_wheels};
#[cfg(test)]
pub(crate) use lanes::every_width;
pub(crate) use lanes::{Lanes, Mask, are_wide, in_lanes};
pub use least_squares::{LinearFit, fit};
pub(crate) use log_product::LogProduct;
pub(crate) use moments::{Line, Moments, mean, rms};
pub use nonnegative::nonnegative;
pub(crate) use normal_equations::{FewCoefficients, NormalEquations};
pub(crate) use order::trimmed_mean_square;
pub use order::{median, median_high, median_step, quantile, quantile_of_sorted, robust_deviation};
pub(crate) use products::{FILLED, add_own_products, add_products};
pub use robust::{RobustFit, fit_huber};
pub use rounding::{round_decimals, round_significant};
pub use runge_kutta::{runge_kutta_from, runge_kutta_motion, runge_kutta_step};
pub(crate) use runs::runs;

pub use scalar::{Dual, Real, sgn};
pub(crate) use singular_values::{orthonormal, pseudo_inverse};
pub use span::Span;
pub(crate) use span::{Statement, joined};
pub use symbol::{Symbol, record};
pub(crate) use wide_filter::filter_columns;
