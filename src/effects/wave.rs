//! Torques that are periodic in an angle, and their transformation for another initial angle.

/// The angle in which a torque is periodic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycle {
    /// The heading of the robot.
    Heading,
    /// The angle of a wheel, 0 the right one.
    Wheel(usize),
}

/// A sine and a cosine component of the torque of an effect. A shift of the initial angle is equivalent to a
/// rotation of the two amplitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// The angle.
    pub of: Cycle,
    /// Number of periods per turn.
    pub order: f64,
    /// Index of the sine amplitude among the parameters of the effect.
    pub sine: usize,
    /// Index of the cosine amplitude.
    pub cosine: usize,
}

impl Wave {
    /// Transforms the parameters `p` of the effect so that the torque is unchanged if the angle starts
    /// `later` \[rad\] in the recording.
    ///
    /// ```text
    /// s sin(n (φ + δ)) + c cos(n (φ + δ)) = s' sin(n φ) + c' cos(n φ)
    /// s' = s cos(n δ) - c sin(n δ),   c' = s sin(n δ) + c cos(n δ)
    /// ```
    pub fn turn(&self, p: &mut [f64], later: f64) {
        let (sin, cos) = (self.order * later).sin_cos();
        let (s, c) = (p[self.sine], p[self.cosine]);
        (p[self.sine], p[self.cosine]) = (s * cos - c * sin, s * sin + c * cos);
    }
}

/// The waves of one order.
pub(super) fn wheel_waves(order: f64) -> Vec<Wave> {
    let wave = |i: usize| Wave { of: Cycle::Wheel(i), order, sine: 2 * i, cosine: 2 * i + 1 };
    vec![wave(0), wave(1)]
}

#[cfg(test)]
mod tests {
    use crate::effects::{Cycle, Motion, all};
    use crate::robot::Robot;

    #[test]
    fn an_effect_with_turned_waves_acts_as_it_does_at_the_later_angle() {
        let robot = Robot::amigobot();
        let mut waves = 0;
        for effect in all() {
            let typical: Vec<f64> = effect.parameters().iter().map(|s| s.typical).collect();
            let p: Vec<f64> =
                typical.iter().enumerate().map(|(j, v)| v * (1.0 + 0.1 * j as f64)).collect();
            for wave in effect.waves(&p) {
                waves += 1;
                let at = |alpha: [f64; 2], p: &[f64]| {
                    let omega = [3.0, -2.0];
                    let x = Motion { t: 0.0, alpha, omega, variance: [0.0; 4], robot: &robot };
                    effect.terms(&x, p).torque
                };
                let later = 0.7;
                let mut turned = p.clone();
                wave.turn(&mut turned, later);
                let mut alpha = [1.1, -0.4];
                let here = at(alpha, &turned);
                match wave.of {
                    Cycle::Wheel(i) => alpha[i] += later,
                    Cycle::Heading => {
                        let turn = later * robot.l1() / robot.r();
                        alpha = [alpha[0] + turn, alpha[1] - turn];
                    }
                }
                let there = at(alpha, &p);
                let near = |i: usize| (here[i] - there[i]).abs() < 1e-13; // rounding of sines
                assert!(near(0) && near(1), "{}: {here:?} {there:?}", effect.id());
            }
        }
        assert_eq!(waves, 5, "a heading, and two wheels of an eccentric one and of a ripple");
    }
}
