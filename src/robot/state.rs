//! The state of the robot: wheel angles and wheel speeds.

use serde::Serialize;

/// Wheel angles and wheel speeds at one instant.
///
/// Index 0 is wheel 1, the RIGHT wheel; index 1 is wheel 2, the LEFT wheel. Both turn in the
/// positive sense when the robot drives forward.
///
/// Source: the paper, eq. (16).
///
/// Deviation: eq. (16) names x1..x4 = alpha1, omega1, alpha2, omega2, but the matrix A of eq. (18)
/// needs the order alpha1, alpha2, omega1, omega2, which stands here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// Wheel angles \[rad\].
    pub alpha: [f64; 2],
    /// Wheel speeds [rad/s].
    pub omega: [f64; 2],
}
