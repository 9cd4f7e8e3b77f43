//! Driving regimes at each sample.

use super::{LocalMotion, Recording};

/// The driving regime at one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Regime {
    /// Both wheels are at rest.
    Standstill,
    /// Both wheels are slower than an eighth of the top speed and gain kinetic energy: the robot leaves rest.
    Starting,
    /// As slow, while they lose it: the robot comes to rest.
    Stopping,
    /// A wheel reverses without stopping.
    Reversal,
    /// Turning on the spot to the left.
    PivotLeft,
    /// Turning on the spot to the right.
    PivotRight,
    /// Forward curve to the left.
    CurveLeft,
    /// Forward curve to the right.
    CurveRight,
    /// Backward curve whose heading turns left.
    CurveLeftBackward,
    /// Backward curve whose heading turns right.
    CurveRightBackward,
    /// Straight forward, accelerating.
    StraightAccelerating,
    /// Straight forward at constant speed.
    StraightSteady,
    /// Straight forward, braking.
    StraightBraking,
    /// Straight backward, accelerating.
    BackwardAccelerating,
    /// Straight backward at constant speed.
    BackwardSteady,
    /// Straight backward, braking.
    BackwardBraking,
}

impl Regime {
    /// All regimes, in the order of the declaration.
    pub const ALL: [Self; 16] = [
        Self::Standstill,
        Self::Starting,
        Self::Stopping,
        Self::Reversal,
        Self::PivotLeft,
        Self::PivotRight,
        Self::CurveLeft,
        Self::CurveRight,
        Self::CurveLeftBackward,
        Self::CurveRightBackward,
        Self::StraightAccelerating,
        Self::StraightSteady,
        Self::StraightBraking,
        Self::BackwardAccelerating,
        Self::BackwardSteady,
        Self::BackwardBraking,
    ];

    /// The name in results: `pivot_left`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Standstill => "standstill",
            Self::Starting => "starting",
            Self::Stopping => "stopping",
            Self::Reversal => "reversal",
            Self::PivotLeft => "pivot_left",
            Self::PivotRight => "pivot_right",
            Self::CurveLeft => "curve_left",
            Self::CurveRight => "curve_right",
            Self::CurveLeftBackward => "curve_left_backward",
            Self::CurveRightBackward => "curve_right_backward",
            Self::StraightAccelerating => "straight_accelerating",
            Self::StraightSteady => "straight_steady",
            Self::StraightBraking => "straight_braking",
            Self::BackwardAccelerating => "backward_accelerating",
            Self::BackwardSteady => "backward_steady",
            Self::BackwardBraking => "backward_braking",
        }
    }
}

/// Lower speeds are rest, as a share of the highest wheel speed of the recording; for the AmigoBot (12 rad/s)
/// the limits are 0.3 and 1.5 rad/s and 1.5 rad/s^2.
const REST: f64 = 0.025;
const SLOW: f64 = 0.125;
/// Constant speed: |dw| below this share of the highest speed, per second.
const STEADY: f64 = 0.125;
/// A pivot has |v| below this share of the turning speed, a straight |turning| below this of |v|.
const PIVOT: f64 = 0.35;
const STRAIGHT: f64 = 0.08;

impl Recording {
    /// The regime at every sample, from the local motion.
    #[must_use]
    pub fn regimes(&self) -> Vec<Regime> {
        let motion = self.local_motion();
        let fastest =
            motion.iter().flat_map(|m| m.omega).map(f64::abs).fold(0.0, f64::max).max(1e-9);
        motion.iter().map(|m| regime(m, fastest)).collect()
    }
}

fn regime(m: &LocalMotion, fastest: f64) -> Regime {
    let [w1, w2] = m.omega;
    let [a1, a2] = m.acceleration;
    let (v, d) = (0.5 * (w1 + w2), 0.5 * (w1 - w2));
    let rate = 0.5 * (a1 + a2) * v.signum();
    let quickest = w1.abs().max(w2.abs());
    let changing = a1.abs().max(a2.abs()) > STEADY * fastest;
    if quickest < REST * fastest && !changing {
        return Regime::Standstill;
    }
    if quickest < SLOW * fastest && changing {
        let energy_rate = w1 * a1 + w2 * a2;
        return if energy_rate >= 0.0 { Regime::Starting } else { Regime::Stopping };
    }
    let reversing = |w: f64, a: f64| w.abs() < REST * fastest && a.abs() > STEADY * fastest;
    if reversing(w1, a1) || reversing(w2, a2) {
        return Regime::Reversal;
    }
    if v.abs() < PIVOT * d.abs() {
        return if d > 0.0 { Regime::PivotLeft } else { Regime::PivotRight };
    }
    if d.abs() > STRAIGHT * v.abs() {
        return match (v > 0.0, d > 0.0) {
            (true, true) => Regime::CurveLeft,
            (true, false) => Regime::CurveRight,
            (false, true) => Regime::CurveLeftBackward,
            (false, false) => Regime::CurveRightBackward,
        };
    }
    let faster = rate > STEADY * fastest;
    let slower = rate < -STEADY * fastest;
    match (v > 0.0, faster, slower) {
        (true, true, _) => Regime::StraightAccelerating,
        (true, _, true) => Regime::StraightBraking,
        (true, ..) => Regime::StraightSteady,
        (false, true, _) => Regime::BackwardAccelerating,
        (false, _, true) => Regime::BackwardBraking,
        (false, ..) => Regime::BackwardSteady,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(omega: [f64; 2], acceleration: [f64; 2]) -> Regime {
        regime(&LocalMotion { omega, acceleration, ..LocalMotion::default() }, 12.0)
    }

    #[test]
    fn driving_is_named_as_a_driver_would() {
        assert_eq!(at([0.0, 0.01], [0.0; 2]), Regime::Standstill);
        assert_eq!(at([1.0, 1.0], [5.0; 2]), Regime::Starting);
        assert_eq!(at([1.0, 1.0], [-5.0; 2]), Regime::Stopping);
        assert_eq!(at([6.0, 6.1], [0.0; 2]), Regime::StraightSteady);
        assert_eq!(at([6.0, 6.1], [4.0; 2]), Regime::StraightAccelerating);
        assert_eq!(at([-6.0, -6.1], [4.0; 2]), Regime::BackwardBraking);
        assert_eq!(at([6.0, -6.0], [0.0; 2]), Regime::PivotLeft); // right wheel forward
        assert_eq!(at([6.0, 3.0], [0.0; 2]), Regime::CurveLeft);
        assert_eq!(at([0.1, 8.0], [5.0, 0.0]), Regime::Reversal);
    }
}
