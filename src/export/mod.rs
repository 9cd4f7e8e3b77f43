//! Export of the identified model: as data and as a function in five languages.
//!
//! No equation is written twice. The effects are evaluated once with [`Symbol`](crate::math::Symbol)s, which
//! record their formulas as a graph; each language prints this graph into a template (`frame/`), which
//! contains the treatment of rest and the integrator.

mod body;
mod document;
mod feedforward;
mod fill;
mod fuzzy;
mod gain_errors;
mod gains;
mod language;
mod loop_margins;
mod mechanics;
mod print;
mod simulator;
mod traced;

pub use document::{Identified, ModelFiles, SCHEMA, files, javascript, reasons};
pub use feedforward::gains_files;
pub use fuzzy::{FuzzyIdentified, fuzzy_files};
pub use gain_errors::GainErrors;
pub use gains::{Control, Feedforward, Gains, Operation};
pub use loop_margins::Margins;
pub use mechanics::{LeftOut, Mechanics};
pub use simulator::{Simulator, mjcf, urdf_sdf};
pub use traced::{Obstacle, Traced, trace};
