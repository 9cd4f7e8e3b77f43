//! Dry friction of a caster that slides.

use std::f64::consts::FRAC_PI_2;

use super::{Description, Energy, Motion, ParameterSpec, Physics, Scale, Terms};
use crate::math::Real;

/// Wheel speed below which the friction decreases to zero instead of changing its direction abruptly [rad/s]:
/// a few millimetres per second at the rim of common wheels.
const SLOW: f64 = 0.05;
/// Distances from the axle relative to half the track at which a search starts, and their limits: outside it
/// resembles `caster_drag` and `turning_scrub`.
const RATIOS: [f64; 5] = [0.35, 0.6, 1.0, 1.6, 2.6];
const LIMITS: (f64, f64) = (0.2, 4.0);

/// Coulomb friction of a ball or skid that slides over the floor at a distance d from the axle, opposite to
/// its own velocity.
///
/// ```text
/// f_k (x + d_k² y)/s  on wheel 1,   f_k (x - d_k² y)/s  on wheel 2
/// x = w1 + w2,   y = w1 - w2,   s = sqrt(x² + d_k² y²),   d_k = d/l1
/// ```
/// Derived here: the contact moves at (v_A, d β_dot) = r/2 (x, d_k y), so a force F opposite to it dissipates the power
/// F r/2 s, and f_k = F r/2. Driving straight it equals `caster_drag`, turning on the spot `turning_scrub`; in a curve
/// there is a single force with one direction, which is smaller than the sum of both.
///
/// For estimated speeds with variance P, s² is increased by π/2 (1 + d_k²) P, which gives the slope of the
/// mean at rest for either direction alone.
///
/// Deviation: no stiction; at rest only the friction of the wheels acts.
#[derive(Clone, Debug, Default)]
pub struct SlidingCaster;

impl Physics for SlidingCaster {
    fn description(&self) -> Description {
        Description {
            id: "sliding_caster".into(),
            title: "Sliding caster".into(),
            equation:
                "f_k (x +- d_k^2 y)/sqrt(x^2 + d_k^2 y^2) on wheel 1, 2, x = w1 + w2, y = w1 - w2"
                    .into(),
            cause: "a ball or skid slides over the floor away from the axle".into(),
            signature: "residual torque with the direction in which the caster moves, of the same \
                        size in curves and on straights"
                .into(),
            excitation: "straights, pivots and curves of different radius".into(),
            equivalent: vec![],
        }
    }

    fn parameters(&self) -> Vec<ParameterSpec> {
        vec![
            ParameterSpec::linear("f_k", "sliding friction at each wheel", "N m", (0.0, 1e3), 0.02),
            ParameterSpec::shape(
                "d_k",
                "distance from the axle over half the track",
                "",
                LIMITS,
                1.0,
            ),
        ]
    }

    fn shapes(&self, _scale: &Scale) -> Vec<Vec<f64>> {
        RATIOS.map(|ratio| vec![ratio]).to_vec()
    }

    fn energy(&self) -> Energy {
        Energy::Dissipates
    }

    fn terms<T: Real>(&self, x: &Motion<T>, p: &[T]) -> Terms<T> {
        let square = p[1].squared();
        let (along, across) = (x.omega[0] + x.omega[1], x.omega[0] - x.omega[1]);
        let variance = FRAC_PI_2 * (x.variance[2] + x.variance[3]) / 2.0;
        let slow = (square + 1.0) * variance + SLOW * SLOW;
        let speed = (along.squared() + square * across.squared() + slow).sqrt();
        let (same, opposite) = (p[0] * along / speed, p[0] * square * across / speed);
        Terms { torque: [same + opposite, same - opposite], ..Terms::zero() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effect;
    use crate::robot::Robot;

    /// Torques at speeds of the wheels.
    fn torque(omega: [f64; 2], p: &[f64]) -> [f64; 2] {
        let robot = Robot::amigobot();
        let x = Motion::at(0.0, [0.0; 2], omega, &robot);
        Effect::terms(&SlidingCaster, &x, p).torque
    }

    #[test]
    fn the_torques_are_those_of_a_force_against_the_velocity_of_the_contact() {
        let robot = Robot::amigobot();
        let (r, l1) = (robot.r(), robot.l1());
        let (force, distance) = (0.7, 0.09);
        for omega in [[6.0, 6.0], [5.0, -5.0], [8.0, 3.0], [-2.0, 7.0]] {
            // virtual power: the force against (v, d β_dot), and the velocities that one wheel alone makes
            let velocity =
                |w: [f64; 2]| [r / 2.0 * (w[0] + w[1]), distance * r / (2.0 * l1) * (w[0] - w[1])];
            let v = velocity(omega);
            let speed = v[0].hypot(v[1]);
            let expected = [[1.0, 0.0], [0.0, 1.0]].map(|wheel| {
                let by = velocity(wheel);
                force * (v[0] * by[0] + v[1] * by[1]) / speed
            });
            let found = torque(omega, &[force * r / 2.0, distance / l1]);
            for i in 0..2 {
                // (SLOW/s)²/2 at s of 7 rad/s and more
                assert!((found[i] - expected[i]).abs() < 3e-5 * force, "{omega:?}");
            }
        }
    }

    #[test]
    fn straight_on_and_on_the_spot_it_is_a_step_and_at_rest_nothing() {
        let near = |found: [f64; 2], expected: [f64; 2]| {
            (0..2).for_each(|i| assert!((found[i] - expected[i]).abs() < 1e-5, "{found:?}"));
        };
        near(torque([9.0, 9.0], &[0.02, 1.5]), [0.02, 0.02]);
        near(torque([-9.0, 9.0], &[0.02, 1.5]), [-0.03, 0.03]);
        near(torque([0.0, 0.0], &[0.02, 1.5]), [0.0, 0.0]);
    }
}
