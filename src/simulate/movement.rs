//! Movements: reference wheel speeds over time, from smoothly joined segments.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::robot::{Robot, kinematics};

/// A segment of a movement: a transition to a speed and a turn rate, which are then held.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Set-point of the speed v_A [m/s].
    #[serde(default)]
    pub speed_m_s: f64,
    /// Set-point of the turn rate, counter-clockwise positive [rad/s].
    #[serde(default)]
    pub turn_rad_s: f64,
    /// Duration of the transition from the previous segment \[s\].
    #[schemars(range(min = 0.0))]
    pub blend_s: f64,
    /// Duration of the hold \[s\].
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub hold_s: f64,
}

/// A movement: a sequence of segments from standstill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Movement {
    /// The segments, in order.
    pub segments: Vec<Segment>,
}

/// Reference speeds and accelerations of the wheels at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Speeds [rad/s].
    pub omega: [f64; 2],
    /// Accelerations [rad/s^2].
    pub acceleration: [f64; 2],
}

impl Movement {
    /// The paper's movement (section 2): starting, driving straight, driving on a circular curve, braking, at
    /// v_A = 0.2 m/s; one second of rest before and after.
    ///
    /// The paper does not give the times and the radius; here: straight for 6 s, then a circle of 0.5 m
    /// radius for 10 s, 22 s in all.
    #[must_use]
    pub fn paper() -> Self {
        let at = |speed_m_s, turn_rad_s, blend_s, hold_s| Segment {
            speed_m_s,
            turn_rad_s,
            blend_s,
            hold_s,
        };
        Self {
            segments: vec![
                at(0.0, 0.0, 0.0, 1.0),
                at(0.2, 0.0, 1.0, 6.0),
                at(0.2, 0.4, 1.0, 10.0),
                at(0.2, 0.0, 0.5, 0.5),
                at(0.0, 0.0, 1.0, 1.0),
            ],
        }
    }

    /// A movement that excites all parameters: random wheel speeds up to `top` [rad/s] in both directions
    /// with straights, curves, pivots, reversals and rests, for `duration` \[s\].
    #[must_use]
    pub fn rich(robot: &Robot, seed: u64, duration: f64, top: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut segments =
            vec![Segment { speed_m_s: 0.0, turn_rad_s: 0.0, blend_s: 0.0, hold_s: 0.3 }];
        let mut time = 0.3;
        let mut before = [0.0; 2];
        while time < duration - 1.0 {
            let kind: f64 = rng.random();
            let size = top * rng.random_range(0.15_f64..1.0);
            let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
            let w = match kind {
                k if k < 0.12 => [0.0; 2],
                k if k < 0.32 => [side * size; 2],
                k if k < 0.50 => [side * size, -side * size],
                _ => {
                    let other = top * rng.random_range(-1.0..1.0);
                    [side * size, other]
                }
            };
            let change = (w[0] - before[0]).abs().max((w[1] - before[1]).abs());
            // the peak rate of a quintic blend is 1.875 times its mean
            let blend_s = (1.875 * change / rng.random_range(4.0..14.0)).max(0.1);
            let hold_s = rng.random_range(0.2..1.7);
            segments.push(Segment {
                speed_m_s: kinematics::forward_speed(robot, w),
                turn_rad_s: kinematics::turn_rate(robot, w),
                blend_s,
                hold_s,
            });
            time += blend_s + hold_s;
            before = w;
        }
        segments.push(Segment { speed_m_s: 0.0, turn_rad_s: 0.0, blend_s: 0.7, hold_s: 0.3 });
        Self { segments }
    }

    /// Total duration of the segments \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(|s| s.blend_s + s.hold_s).sum()
    }

    /// Reference speeds and accelerations of the wheels at time `t` \[s\].
    #[must_use]
    pub fn reference(&self, robot: &Robot, t: f64) -> Reference {
        let wheels = |s: &Segment| kinematics::wheel_speeds(robot, s.speed_m_s, s.turn_rad_s);
        let mut from = [0.0; 2];
        let mut start = 0.0;
        for segment in &self.segments {
            let to = wheels(segment);
            if t < start + segment.blend_s {
                let x = (t - start) / segment.blend_s;
                let rise = x * x * x * (10.0 + x * (6.0 * x - 15.0));
                let rate = 30.0 * x * x * (1.0 - x) * (1.0 - x) / segment.blend_s;
                return Reference {
                    omega: [0, 1].map(|i| from[i] + rise * (to[i] - from[i])),
                    acceleration: [0, 1].map(|i| rate * (to[i] - from[i])),
                };
            }
            start += segment.blend_s + segment.hold_s;
            from = to;
            if t < start {
                break;
            }
        }
        Reference { omega: from, acceleration: [0.0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_movement_runs_at_the_papers_speed() {
        let (robot, m) = (Robot::amigobot(), Movement::paper());
        let straight = m.reference(&robot, 5.0);
        assert!((straight.omega[0] - 4.0).abs() < 1e-12); // 0.2 m/s on wheels of 0.05 m
        assert_eq!(straight.omega[0], straight.omega[1]);
        let circle = m.reference(&robot, 12.0);
        assert!((circle.omega[0] - 4.96).abs() < 1e-12 && (circle.omega[1] - 3.04).abs() < 1e-12);
        assert_eq!(m.reference(&robot, 0.5).omega, [0.0; 2]);
        assert_eq!(m.reference(&robot, m.duration() + 1.0).omega, [0.0; 2]);
    }

    #[test]
    fn accelerations_are_the_slopes_of_the_speeds() {
        let robot = Robot::amigobot();
        let m = Movement::rich(&robot, 4, 20.0, 12.0);
        let h = 1e-6;
        for k in 0..2000 {
            let t = 0.01 * f64::from(k) + 0.00123;
            let (a, b) = (m.reference(&robot, t - h), m.reference(&robot, t + h));
            let mid = m.reference(&robot, t);
            for i in 0..2 {
                let slope = (b.omega[i] - a.omega[i]) / (2.0 * h);
                assert!((slope - mid.acceleration[i]).abs() < 1e-4, "{t}");
            }
        }
    }
}
