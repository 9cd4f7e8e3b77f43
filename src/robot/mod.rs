//! The robot itself: state, construction data, kinematics, equations of motion.
//!
//! The robot stands on two driven wheels and a self-adjusting caster. Wheel 1 is the RIGHT wheel
//! and has index 0, wheel 2 is the LEFT wheel and has index 1. The origin A of the frame is the
//! middle of the axle; the centre of mass S of the frame lies BEHIND the axle, toward the caster,
//! at the distance `l2`.
//!
//! | file | holds | equations of the paper |
//! |---|---|---|
//! | [`state`] | [`State`]: wheel angles and speeds | (16) |
//! | [`construction`] | [`Construction`]: lengths, masses, inertias; a1..a5 from them | (15), Tables 1, 2 |
//! | [`presets()`] | real robots with sourced data | |
//! | [`robot`] | [`Robot`]: a name and its construction, with cheap accessors | |
//! | [`kinematics`] | wheel speeds to the motion of the frame, and back | (11) |
//! | [`dynamics`] | [`BaseParameters`]: inverse and forward dynamics in closed form | (14) |
//! | [`state_space`] | G, f3, f4 | (16)-(18) |
//! | `maggi`, for tests | the derivation of the closed form, done in numbers | (1)-(13) |
//!
//! Source of all equations: Giergiel and Buratowski, "Dynamics Modeling and Identification of the
//! Amigobot Robot", Mechanics and Mechanical Engineering 14(1), 2010, pages 65-79; called "the
//! paper" here. The copy at hand is a text transcription that lost minus signs; every sign that
//! was put back is marked `Deviation:` where it stands.

pub mod construction;
pub mod dynamics;
pub mod error;
pub mod kinematics;
#[cfg(test)]
mod maggi;
pub mod presets;
pub mod robot;
pub mod state;
pub mod state_space;

pub use construction::Construction;
pub use dynamics::BaseParameters;
pub(crate) use dynamics::centrifugal_torques;
pub use error::RobotError;
pub use presets::{Preset, preset, presets};
pub use robot::Robot;
pub use state::State;
pub use state_space::StateSpace;
