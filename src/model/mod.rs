//! Effects added up: mass, torque, dry friction, drive, and named bounded parameters.

mod linearise;
mod model;
mod variation;

pub(crate) use linearise::cramer;
pub use linearise::{Linearisation, solve_mass};
pub use model::{Model, ModelError, Parameter};
pub use variation::{Variation, Variations};
