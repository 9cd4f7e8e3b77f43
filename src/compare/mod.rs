//! Measured against simulated: the error, its floor, and where it exceeds the floor.

mod error;
mod floor;
mod missing_moment;
mod regime;

pub use error::{Simulated, ise, simulate_recording, window_errors, window_rms};
pub use floor::{Floor, noise_floor};
pub use missing_moment::{
    Bin, Dependence, MissingMoment, Variable, log_significance, missing_moment, project,
    score_statistic,
};
pub use regime::{Failure, failures};
