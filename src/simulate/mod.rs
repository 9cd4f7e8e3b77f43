//! Simulation of models: an integrator with exact stick-slip transitions, movements, and simulated
//! recordings.

mod batch;
mod carry;
mod coupled_glide;
pub mod dynamics;
mod emulator;
mod event;
mod forces;
mod forcing;
mod friction;
mod fuzzy_dynamics;
mod glide;
mod input;
mod input_line;
mod movement;
mod recorder;
mod sensitivity;
mod simulation;
mod steady;
mod stepper;
mod sum;
mod takagi_sugeno;
mod variation;
mod walk;

pub use batch::ise_of_many;
pub(crate) use batch::{Realisation, Speeds, has_lanes, speeds_of_realisations};
pub use dynamics::{Dynamics, PhysicalDynamics};
pub use emulator::{Gain, GainError, emulate};
pub(crate) use forcing::LANES;
pub use friction::{Contact, contact};
pub use fuzzy_dynamics::FuzzyDynamics;
pub use input::{BETWEEN_ROWS, Hold, Input, SimulateError, Structure};
pub(crate) use input::{at_rows, halved, held_later, impulse, mean_later};
pub use movement::{Movement, Reference, Segment};
pub(crate) use recorder::Drive;
pub use recorder::{NoiseLevel, Recorder, record, record_disturbed};
pub(crate) use sensitivity::{ActingInput, Asked, Follower, follow};
pub use sensitivity::{Sensitivities, simulate_with_sensitivities};
pub use simulation::simulate;
pub(crate) use simulation::{WINDOW, simulate_windows};
pub use takagi_sugeno::{Consequents, Defuzzification, Gaussian, MOST_MEMBERSHIPS, TakagiSugeno};
pub(crate) use takagi_sugeno::{Rules, RulesSideBySide, WithRules};
pub(crate) use variation::column_of_start;
pub(crate) use walk::{Ends, Walk};

#[cfg(test)]
mod independent;
#[cfg(test)]
mod tests;
