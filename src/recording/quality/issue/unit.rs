//! Interpretation of a ratio of speed to derivative of the angle other than one.

use std::f64::consts::{PI, TAU};

/// Largest relative deviation of a ratio from the factor of a unit (judgement).
const TOLERANCE: f64 = 0.03;

/// The wrong unit that explains a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RatioUnit {
    /// No wrong unit.
    Right,
    /// Of the speed.
    Speed(&'static str),
    /// Of the speed or of the time.
    DegreesPerSecond,
    /// Of the angle.
    Angle(&'static str),
    /// Of the time.
    Time(&'static str),
}

/// The wrong unit and sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UnitError {
    /// `None` if the ratio is not the factor of a unit.
    pub(crate) unit: Option<RatioUnit>,
    /// Whether one of the two has the wrong sign.
    pub(crate) opposite: bool,
}

impl UnitError {
    /// Interprets a ratio of speed to derivative of the angle, for wheels of this radius \[m\].
    pub(crate) fn of(ratio: f64, radius: f64) -> Self {
        let (degrees, minute) = (180.0 / PI, 60.0 / TAU);
        let known = [
            (1.0, RatioUnit::Right),
            (minute, RatioUnit::Speed("rpm")),
            (degrees, RatioUnit::DegreesPerSecond),
            (1.0 / TAU, RatioUnit::Speed("rev/s")),
            (radius, RatioUnit::Speed("m/s")),
            (1.0 / degrees, RatioUnit::Angle("deg")),
            (TAU, RatioUnit::Angle("rev")),
            (1.0 / radius, RatioUnit::Angle("m")),
            (1e3, RatioUnit::Time("ms")),
            (1e6, RatioUnit::Time("us")),
            (1e9, RatioUnit::Time("ns")),
        ];
        let is_near = |factor: f64| (ratio.abs() / factor - 1.0).abs() < TOLERANCE;
        let unit = known.into_iter().find(|(factor, _)| is_near(*factor)).map(|(_, unit)| unit);
        Self { unit, opposite: ratio < 0.0 }
    }
}
