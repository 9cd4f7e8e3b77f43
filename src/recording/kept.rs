//! What is computed once of a recording and shared by its copies with another input.

use std::sync::OnceLock;

use super::LocalMotion;
use super::channels::{MostNoise, MotionNoise, Sensing};
use super::response::Response;

/// Results that depend on the angles, the speeds and the noise of their sensors only.
#[derive(Debug, Default)]
pub(super) struct Kept {
    /// [`Recording::local_motion`].
    pub(super) local_motion: OnceLock<Vec<LocalMotion>>,
    /// [`Recording::response`], with the input of the first copy.
    pub(super) response: OnceLock<Response>,
    /// [`Recording::motion_noise`].
    pub(super) motion_noise: OnceLock<MotionNoise>,
    /// `one_step::most_noise` with the input of the first copy for which it is computed.
    pub(super) most_noise: OnceLock<MostNoise>,
    /// [`Recording::sensing`].
    pub(super) sensing: OnceLock<Sensing>,
    /// [`Recording::top_speed`].
    pub(super) top_speed: OnceLock<f64>,
}
