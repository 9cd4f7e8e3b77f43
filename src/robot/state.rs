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
/// needs the order alpha1, alpha2, omega1, omega2; [`State::to_vector`] uses the latter.
///
/// # Examples
/// ```
/// use amigo_ident::robot::State;
/// let state = State { alpha: [0.1, 0.2], omega: [4.0, 4.5] };
/// assert_eq!(State::from_vector(state.to_vector()), state);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct State {
    /// Wheel angles \[rad\].
    pub alpha: [f64; 2],
    /// Wheel speeds [rad/s].
    pub omega: [f64; 2],
}

impl State {
    /// The state as a vector [alpha1 (rad), alpha2 (rad), omega1 (rad/s), omega2 (rad/s)].
    #[must_use]
    pub const fn to_vector(self) -> [f64; 4] {
        [self.alpha[0], self.alpha[1], self.omega[0], self.omega[1]]
    }

    /// The state from a vector [alpha1 (rad), alpha2 (rad), omega1 (rad/s), omega2 (rad/s)].
    #[must_use]
    pub const fn from_vector(x: [f64; 4]) -> Self {
        Self { alpha: [x[0], x[1]], omega: [x[2], x[3]] }
    }

    /// Whether all four values are finite numbers.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.to_vector().iter().all(|x| x.is_finite())
    }

    /// The state of the mirror-image robot: wheels exchanged.
    #[must_use]
    pub const fn mirrored(self) -> Self {
        Self { alpha: [self.alpha[1], self.alpha[0]], omega: [self.omega[1], self.omega[0]] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vector_holds_the_angles_before_the_speeds_and_right_before_left() {
        let state = State { alpha: [1.0, 2.0], omega: [3.0, 4.0] };
        assert_eq!(state.to_vector(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(state.mirrored().to_vector(), [2.0, 1.0, 4.0, 3.0]);
    }

    #[test]
    fn a_state_with_a_missing_number_is_not_finite() {
        assert!(State::default().is_finite());
        assert!(!State { alpha: [f64::NAN, 0.0], omega: [0.0; 2] }.is_finite());
        assert!(!State { alpha: [0.0; 2], omega: [0.0, f64::INFINITY] }.is_finite());
    }
}
