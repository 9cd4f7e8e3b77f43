//! Motion from a model: an integrator with exact stick and slip, and what is built on it.

mod batch;
mod drive;
pub mod dynamics;
mod emulator;
mod event;
mod forces;
mod friction;
mod fuzzy_dynamics;
mod made;
mod movement;
mod sensitivity;
mod simulation;
mod stepper;
mod takagi_sugeno;

pub use batch::ise_of_many;
pub use dynamics::{Dynamics, PhysicalDynamics, RunIn};
pub use emulator::{Gain, GainError, Structure, emulate};
pub use friction::{Contact, contact};
pub use fuzzy_dynamics::FuzzyDynamics;
pub use made::{NoiseLevel, Recorder, record, record_disturbed};
pub use movement::{Movement, Reference, Segment};
pub(crate) use sensitivity::{LANES, follow};
pub use sensitivity::{Sensitivities, simulate_with_sensitivities};
pub use simulation::{Hold, Input, SimulateError, simulate, simulate_acting};
pub use takagi_sugeno::{Consequents, Defuzzification, Gaussian, MOST_MEMBERSHIPS, TakagiSugeno};

#[cfg(test)]
mod independent;
#[cfg(test)]
mod tests;
