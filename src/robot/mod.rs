//! The robot itself: state, construction data, equations of motion.

pub mod construction;
pub mod dynamics;
pub mod error;
pub mod robot;
pub mod state;

pub use construction::Construction;
pub use dynamics::BaseParameters;
pub use error::RobotError;
pub use robot::Robot;
pub use state::State;
