//! Models: the sum of effects (mass, torque, dry friction, input) and their named, bounded parameters.

pub mod base;
mod linearise;
mod model;
mod recorded;
mod speed_polynomial;
mod variation;

pub(crate) use linearise::cramer;
pub use linearise::{Linearisation, inverse_mass, solve_mass, times};
pub use model::{Model, ModelError, Parameter};
pub(crate) use speed_polynomial::SpeedPolynomial;
pub use variation::{Variation, Variations};
