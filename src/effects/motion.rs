//! The motion at which effects are evaluated, and the terms that they return.

use crate::math::Real;
use crate::robot::{Robot, kinematics};

/// The four directions in which dry friction can hold the two wheels: wheel 1, wheel 2,
/// turning (w1 - w2) and forward (w1 + w2).
pub const DIRECTIONS: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0], [1.0, 1.0]];

/// The speed of the wheels along one of the [`DIRECTIONS`] [rad/s].
#[must_use]
pub fn along<T: Real>(direction: usize, omega: &[T; 2]) -> T {
    match direction {
        0 => omega[0],
        1 => omega[1],
        2 => omega[0] - omega[1],
        _ => omega[0] + omega[1],
    }
}

/// Resisting torques on the wheels plus dry friction with levels and signs along the [`DIRECTIONS`]: `torque
/// + Σ_j d_j level_j s_j` [N m].
#[inline]
#[must_use]
pub fn with_friction([first, second]: [f64; 2], level: &[f64; 4], sign: &[f64; 4]) -> [f64; 2] {
    let [f1, f2, turning, forward] = [0, 1, 2, 3].map(|j| level[j] * sign[j]);
    [first + f1 + turning + forward, second + f2 - turning + forward]
}

/// The instant at which an effect is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a, T> {
    /// Time since the start of the recording \[s\].
    pub t: T,
    /// Wheel angles \[rad\]; wheel 1 (right) first.
    pub alpha: [T; 2],
    /// Wheel speeds [rad/s].
    pub omega: [T; 2],
    /// Variance of (alpha1, alpha2, omega1, omega2) if the motion is an estimate: a filter requires the mean
    /// of a non-smooth or fast function over it. Zero in simulation.
    pub variance: [f64; 4],
    /// Construction data of the robot.
    pub robot: &'a Robot,
}

impl<'a, T> Motion<'a, T> {
    /// An exactly known motion: at time `t` \[s\], with the angles `alpha` \[rad\] and the speeds `omega`
    /// [rad/s] of the wheels.
    #[inline]
    #[must_use]
    pub fn at(t: T, alpha: [T; 2], omega: [T; 2], robot: &'a Robot) -> Self {
        Self { t, alpha, omega, variance: [0.0; 4], robot }
    }
}

impl<T: Real> Motion<'_, T> {
    /// Speed of the axle's centre, v_A = r/2 (w1 + w2) [m/s].  eq. (11)
    #[must_use]
    pub fn forward_speed(&self) -> T {
        kinematics::forward_speed(self.robot, self.omega)
    }

    /// Turn rate, beta_dot = r/(2 l1) (w1 - w2) [rad/s].  eq. (11)
    #[must_use]
    pub fn turn_rate(&self) -> T {
        kinematics::turn_rate(self.robot, self.omega)
    }

    /// Heading from the wheel angles, beta = r/(2 l1) (alpha1 - alpha2) \[rad\].
    #[must_use]
    pub fn heading(&self) -> T {
        kinematics::heading(self.robot, self.alpha)
    }
}

/// Contributions of effects to the equation of motion `mass dω + torque + Σ_j d_j level_j sgn(d_j·ω) = M`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Terms<T> {
    /// Symmetric mass matrix as (m11, m12, m22) [kg m^2].
    pub mass: [T; 3],
    /// Resisting torque on each wheel [N m].
    pub torque: [T; 2],
    /// Dry-friction level along each of the [`DIRECTIONS`], non-negative [N m].
    pub level: [T; 4],
}

impl<T: Real> Terms<T> {
    /// No contribution.
    #[must_use]
    pub fn zero() -> Self {
        let zero = T::from(0.0);
        Self { mass: [zero; 3], torque: [zero; 2], level: [zero; 4] }
    }

    /// Adds another contribution.
    pub fn add(&mut self, other: &Self) {
        for i in 0..3 {
            self.mass[i] += other.mass[i];
        }
        for i in 0..2 {
            self.torque[i] += other.torque[i];
        }
        for i in 0..4 {
            self.level[i] += other.level[i];
        }
    }

    /// The torque required for acceleration `a` [rad/s^2] if dry friction acts with signs `s`: `mass a +
    /// torque + Σ_j d_j level_j s_j` [N m].
    #[must_use]
    pub fn total_torque(&self, a: &[f64; 2], s: &[f64; 4]) -> [T; 2] {
        let [m11, m12, m22] = self.mass;
        let mut out =
            [m11 * a[0] + m12 * a[1] + self.torque[0], m12 * a[0] + m22 * a[1] + self.torque[1]];
        for (j, d) in DIRECTIONS.iter().enumerate() {
            for i in 0..2 {
                // most directions have no friction; this saves their derivatives
                let share = d[i] * s[j];
                if share != 0.0 {
                    out[i] += self.level[j] * share;
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_torque_of_friction_is_the_sum_along_the_directions() {
        let (torque, level, sign) = ([0.5, -0.25], [1.0, 2.0, 4.0, 8.0], [1.0, -1.0, -0.5, 0.25]);
        let along = |i: usize| (0..4).map(|j| DIRECTIONS[j][i] * level[j] * sign[j]).sum::<f64>();
        assert_eq!(with_friction(torque, &level, &sign), [0.5 + along(0), -0.25 + along(1)]);
    }
}
