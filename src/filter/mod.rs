//! The extended Kalman filter that whitens the data: one pass gives the likelihood, its score and
//! its information for parameters and for any further torque columns.
//!
//! State: (alpha1, alpha2, omega1, omega2, d1, d2), d a slow unknown torque on each wheel
//! (Ornstein-Uhlenbeck: standard deviation `sigma_d`, time constant `tau_d`). A two-mass drivetrain
//! adds its speeds and twists (u1, u2, phi1, phi2).

mod accumulate;
mod correction;
mod coupled;
mod dynamics;
mod exact;
mod friction;
mod horizon;
mod input_noise;
mod jumps;
mod likelihood;
mod noise_search;
mod pass;
mod prepare;
mod push;
mod rest_noise;
mod rigid;
mod run;
mod sample;
mod step;
mod totals;

pub use accumulate::ScoreSums;
pub use friction::clarity;
pub(crate) use horizon::{HorizonFilter, Reading, pieces};
pub use jumps::{SURE, likelihood_of_steps, noise_of_jumps};
pub use likelihood::{Likelihood, Maximum};
pub use pass::{Columns, Instant, NoColumns, Pass, PassSettings, filter_pass};
pub use prepare::{Prepared, prepare};
pub use rest_noise::rest_noise;
pub use run::Innovation;
pub(crate) use run::Sums;

use crate::model::ModelError;

#[cfg(test)]
mod tests;

/// Why a likelihood cannot be maximised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The model cannot be evaluated.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// It is not finite at the start.
    #[error("the likelihood is not finite")]
    NotFinite,
}

/// Process noise: motion that the recorded input does not explain.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ProcessNoise {
    /// White noise of the recorded input, independent from sample to sample [N m].
    pub sigma_m: f64,
    /// Standard deviation of a slow unknown torque [N m].
    pub sigma_d: f64,
    /// Its time constant \[s\].
    pub tau_d: f64,
    /// Weight of the later of two recorded inputs in the mean input between them: 0.5 for a linear
    /// input, 0 for a held one, between for one held over parts of a sample (0.4 for five steps per
    /// sample), other values if rows are stamped early or late.
    pub later: f64,
}
