//! What a ratio of speed to slope of the angle other than one means.

use std::f64::consts::{PI, TAU};

/// Greatest relative distance of a ratio from the factor of its unit (taste).
const TOLERANCE: f64 = 0.03;

/// The unit of a column that makes a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RatioUnit {
    /// None is wrong.
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

/// Which unit and which sign are wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UnitError {
    /// `None` where the ratio is the factor of no unit.
    pub(crate) unit: Option<RatioUnit>,
    /// Whether the sign of one of the two is wrong.
    pub(crate) opposite: bool,
}

impl UnitError {
    /// Of a ratio of speed to slope of the angle on wheels of a radius \[m\].
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
