//! A two-mass drivetrain: the coupling between the measured wheels and the rest of the robot.

use super::{Motion, Terms};
use crate::math::Real;

/// A two-mass drivetrain: the wheel (rotor) of inertia `rotor` is connected to the rest of the robot by a
/// spring and a damper, which adds two speeds and two twists to the state.
///
/// Effects that store energy or do no work act on the body, at its own speeds and angles; all others act on
/// the measured wheel. The body has the mass matrix of the model minus `rotor` on the diagonal. This is
/// positive definite only if `rotor` is below the smallest eigenvalue of the mass matrix (a1 - |a2| in the
/// base model), so a simulation limits it to the share [`MOST_OF_INERTIA`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling<T> {
    /// Inertia on the measured side, part of a1 [kg m^2].
    pub rotor: T,
    /// Torsional stiffness [N m/rad]; zero for a pure slip law.
    pub stiffness: T,
    /// Torsional damping or slip stiffness [N m s/rad].
    pub damping: T,
}

/// The additional state of a second body, one number per wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState<T> {
    /// Speeds u that the wheels would have if the coupling were rigid [rad/s].
    pub speed: [T; 2],
    /// Twists phi of the coupling \[rad\].
    pub twist: [T; 2],
}

/// Largest share of the inertia on the measured side of a [`Coupling`]: the rest then moves at a rate fifty
/// times higher, which recordings do not resolve.
pub const MOST_OF_INERTIA: f64 = 0.98;

impl<T: Real> Coupling<T> {
    /// The rotor inertia, limited to [`MOST_OF_INERTIA`] of the smallest eigenvalue of the robot's mass
    /// matrix (m11, m12, m22) [kg m^2].
    #[must_use]
    pub fn rotor_within(&self, mass: &[T; 3]) -> T {
        self.rotor.min(smallest_inertia(mass) * MOST_OF_INERTIA)
    }

    /// The torque transmitted by each wheel to the body, `kt phi + dt (w - u)` [N m]; `omega` [rad/s].
    #[must_use]
    pub fn passed(&self, omega: &[T; 2], body: &BodyState<T>) -> [T; 2] {
        let torque =
            |i: usize| self.stiffness * body.twist[i] + self.damping * (omega[i] - body.speed[i]);
        [torque(0), torque(1)]
    }

    /// Moves the rotor inertias from the body, whose terms contain the mass of the whole robot, to the
    /// wheels.
    pub fn separate(&self, wheel: &mut Terms<T>, body: &mut Terms<T>) {
        let rotor = self.rotor_within(&body.mass);
        wheel.mass = [rotor, T::from(0.0), rotor];
        body.mass = [body.mass[0] - rotor, body.mass[1], body.mass[2] - rotor];
    }

    /// The fastest rate of the coupling [1/s], determined by the lighter of rotor and body; `mass` is that of
    /// the whole robot (m11, m12, m22) [kg m^2].
    #[must_use]
    pub fn fastest_rate(&self, mass: &[T; 3]) -> T {
        let (rotor, smallest) = (self.rotor_within(mass), smallest_inertia(mass));
        let one = T::from(1.0);
        let mobility = one / rotor + one / (smallest - rotor);
        (self.damping * mobility).max((self.stiffness * mobility).sqrt())
    }
}

impl<'r, T: Real> Motion<'r, T> {
    /// The motion of the second body, at which its effects are evaluated.
    #[must_use]
    pub fn of_body(&self, body: &BodyState<T>) -> Motion<'r, T> {
        let alpha = [self.alpha[0] - body.twist[0], self.alpha[1] - body.twist[1]];
        Motion { alpha, omega: body.speed, ..*self }
    }
}

/// The smaller eigenvalue of a mass matrix (m11, m12, m22) [kg m^2].
#[must_use]
pub fn smallest_inertia<T: Real>(mass: &[T; 3]) -> T {
    let [m11, m12, m22] = *mass;
    let difference = (m11 - m22) * 0.5;
    (m11 + m22) * 0.5 - (difference.squared() + m12.squared()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_inertia_is_the_smaller_eigenvalue() {
        for [m11, m12, m22] in [[3.0, 1.0, 3.0], [2.0, -0.7, 5.0], [1.0, 0.0, 4.0]] {
            let matrix = nalgebra::Matrix2::new(m11, m12, m12, m22);
            let expected = matrix.symmetric_eigenvalues().min();
            assert!((smallest_inertia(&[m11, m12, m22]) - expected).abs() < 1e-14);
        }
    }
}
