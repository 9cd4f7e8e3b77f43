//! What a ratio of speed to slope of the angle other than one means.

use std::f64::consts::{PI, TAU};

/// Greatest relative distance of a ratio from the factor of its unit (taste).
const TOLERANCE: f64 = 0.03;

/// The unit of a column that makes a ratio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
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
pub(super) struct UnitError {
    /// `None` where the ratio is the factor of no unit.
    unit: Option<Unit>,
    opposite: bool,
}

impl UnitError {
    /// Of a ratio of speed to slope of the angle on wheels of a radius \[m\].
    pub(super) fn of(ratio: f64, radius: f64) -> Self {
        let (degrees, minute) = (180.0 / PI, 60.0 / TAU);
        let known = [
            (1.0, Unit::Right),
            (minute, Unit::Speed("rpm")),
            (degrees, Unit::DegreesPerSecond),
            (1.0 / TAU, Unit::Speed("rev/s")),
            (radius, Unit::Speed("m/s")),
            (1.0 / degrees, Unit::Angle("deg")),
            (TAU, Unit::Angle("rev")),
            (1.0 / radius, Unit::Angle("m")),
            (1e3, Unit::Time("ms")),
            (1e6, Unit::Time("us")),
            (1e9, Unit::Time("ns")),
        ];
        let is_near = |factor: f64| (ratio.abs() / factor - 1.0).abs() < TOLERANCE;
        let unit = known.into_iter().find(|(factor, _)| is_near(*factor)).map(|(_, unit)| unit);
        Self { unit, opposite: ratio < 0.0 }
    }

    /// What is wrong in the columns of a wheel, and the remedy.
    pub(super) fn words(self, wheel: usize) -> String {
        let (speed, angle) = (format!("dalpha{}", wheel + 1), format!("alpha{}", wheel + 1));
        let sign = self.opposite.then(|| {
            format!(
                "the sign of one of them is wrong (forward is positive for both wheels): scale = -1 on {speed} or {angle}"
            )
        });
        let state = |words: String| Some(format!("{words}; say so in `columns`"));
        let unit = match self.unit {
            Some(Unit::Right) => None,
            Some(Unit::Speed(unit)) => state(format!("{speed} is in {unit}")),
            Some(Unit::DegreesPerSecond) => {
                state(format!("{speed} is in deg/s, or t in a wrong unit"))
            }
            Some(Unit::Angle(unit)) => state(format!("{angle} is in {unit}")),
            Some(Unit::Time(unit)) => state(format!("t is in {unit}")),
            None => Some(
                "a unit, a gear ratio or the counts per turn are wrong; correct it with unit or scale in `columns`"
                    .into(),
            ),
        };
        [sign, unit].into_iter().flatten().collect::<Vec<_>>().join(", and ")
    }
}
