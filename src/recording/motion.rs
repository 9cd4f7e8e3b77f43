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

/// Initial state of a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// The state. A speed within its own error by noise is rest: started at a tiny speed, dry friction would act with a
    /// sign that is noise.
    pub state: State,
    /// Mean square error of the speeds, by noise and by the shape of the motion [rad^2/s^2].
    pub omega_square_error: [f64; 2],
}

impl LocalMotion {
    /// Initial state of a simulation, with the mean square error of the speeds of moving wheels by the shape of the motion.
    pub(super) fn start(&self, curvature: [f64; 2]) -> Start {
        let moving = |i: usize, value: f64| if self.moves(i) { value } else { 0.0 };
        let omega = [0, 1].map(|i| moving(i, self.omega[i]));
        let error = [0, 1].map(|i| self.omega_variance[i] + moving(i, curvature[i]));
        Start { state: State { alpha: self.alpha, omega }, omega_square_error: error }
    }

    /// Whether the speed of wheel `i` is beyond its error by noise.
    pub(super) fn moves(&self, i: usize) -> bool {
        self.omega[i].powi(2) >= REST_ERRORS.powi(2) * self.omega_variance[i]
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
        let Start { state, omega_square_error } = motion.start([0.02; 2]);
        assert_eq!(state, State { alpha: [1.0, 2.0], omega: [0.0, -0.21] });
        assert_eq!(omega_square_error, [0.01, 0.03]);
    }
}
