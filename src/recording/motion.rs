//! The local motion around a row.

use crate::robot::State;

/// Number of standard errors up to which a speed at the start of a simulation is rest: one wheel in twenty that rests has
/// a larger one by chance.
const REST_ERRORS: f64 = 2.0;

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

impl LocalMotion {
    /// Initial state of a simulation. A speed within its own error is rest: started at a tiny speed, dry friction would
    /// act with a sign that is noise.
    #[must_use]
    pub(crate) fn start(&self) -> State {
        let omega = [0, 1].map(|i| {
            let w = self.omega[i];
            if w * w < REST_ERRORS * REST_ERRORS * self.omega_variance[i] { 0.0 } else { w }
        });
        State { alpha: self.alpha, omega }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simulation_starts_at_rest_where_the_error_of_the_speed_exceeds_half_of_it() {
        // standard errors 0.1: 0.19 rad/s is below two of them, -0.21 rad/s above
        let (omega, omega_variance) = ([0.19, -0.21], [0.01; 2]);
        let motion = LocalMotion { alpha: [1.0, 2.0], omega, omega_variance, ..Default::default() };
        assert_eq!(motion.start(), State { alpha: [1.0, 2.0], omega: [0.0, -0.21] });
    }
}
