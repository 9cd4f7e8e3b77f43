//! Kinematics without slip: wheel speeds to the motion of the frame, and inverse.

use super::Robot;
use crate::math::Real;

/// Forward speed of the middle of the axle [m/s] for wheel speeds [rad/s].
///
/// ```text
/// v_A = r/2 (w1 + w2)
/// ```
///
/// Source: the paper, eq. (11).
#[inline]
#[must_use]
pub fn forward_speed<T: Real>(robot: &Robot, omega: [T; 2]) -> T {
    (omega[0] + omega[1]) * (robot.r() / 2.0)
}

/// Turn rate of the frame [rad/s] for wheel speeds [rad/s]; positive is counter-clockwise.
///
/// ```text
/// beta_dot = r/(2 l1) (w1 - w2)
/// ```
///
/// Source: the paper, eq. (11).
///
/// Deviation: the transcription lost the minus sign; wheel 1 is the right wheel.
///
/// # Examples
/// ```
/// use amigo_ident::robot::{Robot, kinematics};
/// // the right wheel alone turns the robot to the left
/// assert!(kinematics::turn_rate(&Robot::amigobot(), [2.0, 0.0]) > 0.0);
/// ```
#[inline]
#[must_use]
pub fn turn_rate<T: Real>(robot: &Robot, omega: [T; 2]) -> T {
    (omega[0] - omega[1]) * (robot.r() / (2.0 * robot.l1()))
}

/// Heading of the frame \[rad\] for wheel angles \[rad\], not wrapped.
///
/// ```text
/// beta = r/(2 l1) (alpha1 - alpha2)
/// ```
///
/// Source: the paper, eq. (11) integrated, with beta = 0 where both angles are equal.
#[inline]
#[must_use]
pub fn heading<T: Real>(robot: &Robot, alpha: [T; 2]) -> T {
    turn_rate(robot, alpha)
}

/// Wheel speeds [rad/s] for a forward speed [m/s] and a turn rate [rad/s].
///
/// ```text
/// w1 = (v_A + l1 beta_dot) / r,  w2 = (v_A - l1 beta_dot) / r
/// ```
///
/// Source: the paper, eq. (11) inverted.
///
/// # Examples
/// ```
/// use amigo_ident::robot::{Robot, kinematics};
/// // the paper's v_A = 0.2 m/s straight ahead is 4 rad/s of the 5 cm wheels
/// let [w1, w2] = kinematics::wheel_speeds(&Robot::amigobot(), 0.2, 0.0);
/// assert!((w1 - 4.0).abs() < 1e-15 && (w2 - 4.0).abs() < 1e-15);
/// ```
#[inline]
#[must_use]
pub fn wheel_speeds<T: Real>(robot: &Robot, forward_speed: T, turn_rate: T) -> [T; 2] {
    let rim = turn_rate * robot.l1();
    [(forward_speed + rim) / robot.r(), (forward_speed - rim) / robot.r()]
}

/// Path of the middle of the axle through wheel angles \[rad\]: one [x (m), y (m), beta (rad)] for
/// each pair of angles.
///
/// Starts at x = y = 0 with beta = [`heading`] of the first pair. Each step is one circular arc
/// of length s and angle g, which is exact if the ratio of the wheel speeds is constant in it:
///
/// ```text
/// s = r/2 (d_alpha1 + d_alpha2),  g = r/(2 l1) (d_alpha1 - d_alpha2)
/// chord = s sin(g/2) / (g/2) in the direction beta + g/2
/// ```
///
/// # Examples
/// ```
/// use amigo_ident::robot::{Robot, kinematics};
/// let path = kinematics::path(&Robot::amigobot(), &[[0.0, 0.0], [10.0, 10.0]]);
/// assert!((path[1][0] - 0.5).abs() < 1e-15); // 10 rad of a 5 cm wheel
/// assert_eq!(path[1][1..], [0.0, 0.0]);
/// ```
#[must_use]
pub fn path(robot: &Robot, alpha: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let mut points = Vec::with_capacity(alpha.len());
    let Some(&first) = alpha.first() else { return points };
    let (mut x, mut y) = (0.0, 0.0);
    points.push([x, y, heading(robot, first)]);
    for step in alpha.windows(2) {
        let turned = [step[1][0] - step[0][0], step[1][1] - step[0][1]];
        let half_angle = turn_rate(robot, turned) / 2.0;
        let chord = forward_speed(robot, turned) * sinc(half_angle);
        let (sin, cos) = (heading(robot, step[0]) + half_angle).sin_cos();
        x += chord * cos;
        y += chord * sin;
        // from the angles themselves: no rounding error piles up in beta
        points.push([x, y, heading(robot, step[1])]);
    }
    points
}

/// sin(x) / x, with 1 at 0.
fn sinc(x: f64) -> f64 {
    // below 1e-4 the next term of the series, x⁴/120, is under rounding
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Dual;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    proptest! {
        #[test]
        fn wheel_speeds_inverts_forward_speed_and_turn_rate(v in -2.0..2.0_f64, g in -5.0..5.0_f64) {
            let robot = Robot::amigobot();
            let omega = wheel_speeds(&robot, v, g);
            // two roundings of numbers up to 50
            prop_assert!((forward_speed(&robot, omega) - v).abs() < 1e-14);
            prop_assert!((turn_rate(&robot, omega) - g).abs() < 1e-13);
        }

        #[test]
        fn one_long_arc_equals_many_short_ones(w1 in -20.0..20.0_f64, w2 in -20.0..20.0_f64) {
            let robot = Robot::amigobot();
            let short: Vec<_> =
                (0..=100).map(|k| [w1 * f64::from(k) / 100.0, w2 * f64::from(k) / 100.0]).collect();
            let a = path(&robot, &[[0.0, 0.0], [w1, w2]])[1];
            let b = path(&robot, &short)[100];
            for i in 0..3 {
                // 100 roundings of numbers of size 1
                prop_assert!((a[i] - b[i]).abs() < 1e-13, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_full_circle_ends_where_it_began() {
        let robot = Robot::amigobot();
        // radius 0.5 m about a centre on the left: the wheels run on 0.62 m and 0.38 m
        let steps = 360;
        let alpha: Vec<_> = (0..=steps)
            .map(|k| {
                let g = TAU * f64::from(k) / f64::from(steps);
                [0.62 * g / 0.05, 0.38 * g / 0.05]
            })
            .collect();
        let points = path(&robot, &alpha);
        let quarter = points[90];
        // counter-clockwise from the origin toward +x: after a quarter at (0.5, 0.5); rounding
        assert!((quarter[0] - 0.5).abs() < 1e-13 && (quarter[1] - 0.5).abs() < 1e-13);
        assert!((quarter[2] - TAU / 4.0).abs() < 1e-13);
        let end = points[360];
        assert!(end[0].abs() < 1e-13 && end[1].abs() < 1e-13 && (end[2] - TAU).abs() < 1e-13);
    }

    #[test]
    fn a_turn_on_the_spot_moves_nothing_and_no_angles_give_no_path() {
        let robot = Robot::amigobot();
        let points = path(&robot, &[[0.3, 0.1], [5.3, -4.9]]);
        // the first heading comes from the angles, r/(2 l1) 0.2 = 0.05/0.24 · 0.2
        assert!((points[0][2] - 0.05 / 0.24 * 0.2).abs() < 1e-16);
        // the wheel angles cancel up to their rounding
        assert!(points[1][0].abs() < 1e-15 && points[1][1].abs() < 1e-15);
        assert!(path(&robot, &[]).is_empty());
    }

    #[test]
    fn the_derivatives_are_those_of_eq_11() {
        let robot = Robot::amigobot();
        let omega = [Dual::<2>::variable(3.0, 0), Dual::<2>::variable(5.0, 1)];
        assert_eq!(forward_speed(&robot, omega).partial, [0.025, 0.025]);
        let g = 0.05 / (2.0 * 0.12);
        assert_eq!(turn_rate(&robot, omega).partial, [g, -g]);
    }
}
