//! The local motion around a row.

/// Motion around one sample, from a parabola through the angles and speeds of its neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LocalMotion {
    /// Wheel angles \[rad\].
    pub alpha: [f64; 2],
    /// Wheel speeds [rad/s].
    pub omega: [f64; 2],
    /// Wheel accelerations [rad/s^2].
    pub acceleration: [f64; 2],
    /// Variance of the speeds due to the noise of the channels [rad^2/s^2].
    pub omega_variance: [f64; 2],
    /// Variance of the angles [rad^2].
    pub alpha_variance: [f64; 2],
}
