//! The time of the recorded input, and what is stated of it.

use super::scale::logging;
use super::thresholds::THRESHOLDS;
use crate::recording::Recording;
use crate::simulate::Hold;

/// How much later the recorded input acts.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Timing {
    /// Time from the recorded input to the motion, dead time of actuator and sensors together \[s\].
    pub dead_time_s: f64,
    /// Its standard error \[s\], including the interpolation between the rows.
    pub std_error_s: f64,
    /// The part that logging explains and that is removed from the recordings \[s\].
    pub correction_s: f64,
    /// Longest time that logging explains \[s\].
    #[serde(skip)]
    pub logging_s: f64,
    /// Longest time from one row to the next \[s\].
    #[serde(skip)]
    pub step_s: f64,
    /// Whether the model leaves an error above the noise floor: another effect may cause a part of the time.
    #[serde(skip)]
    pub above_floor: bool,
    /// Another input between the rows that is possible too: the motion does not tell a held one from the line between the
    /// rows, and a held one that would act before it is given is none.
    #[serde(skip)]
    pub other: Option<Hold>,
}

impl Timing {
    /// No time yet for these recordings: zero, with the limits of their rows.
    #[must_use]
    pub(crate) fn unknown(recordings: &[Recording]) -> Self {
        let largest =
            |value: fn(&Recording) -> f64| recordings.iter().map(value).fold(0.0, f64::max);
        Self { logging_s: largest(logging), step_s: largest(Recording::step), ..Self::default() }
    }

    /// The dead time \[s\] with the other input between the rows: what is held acts half a row later than the line. `None`
    /// too if a held input would act before it is given, and if half a row is within the uncertainty of the time.
    #[must_use]
    pub fn otherwise(&self) -> Option<(Hold, f64)> {
        let (half, uncertain) = (0.5 * self.step_s, THRESHOLDS.uncertain * self.std_error_s);
        let is_possible = |(hold, time_s): &(Hold, f64)| {
            half > uncertain && (*hold == Hold::Linear || *time_s >= -uncertain)
        };
        let with =
            |hold| (hold, self.dead_time_s + if hold == Hold::Linear { half } else { -half });
        self.other.map(with).filter(is_possible)
    }

    /// Whether the input acts before its time in the log: no dead time, but a shift of the log.
    #[must_use]
    pub fn is_early(&self) -> bool {
        self.dead_time_s < -THRESHOLDS.uncertain * self.std_error_s
    }

    /// Whether the motion is later than logging explains and no part of the time is removed: a logger that holds
    /// its input explains half a row, one that differentiates an encoder another half.
    #[must_use]
    pub fn is_late(&self) -> bool {
        let earliest = self.dead_time_s - THRESHOLDS.uncertain * self.std_error_s;
        self.correction_s == 0.0 && earliest > self.logging_s
    }

    /// Whether another estimate of the dead time, with its standard error \[s\], agrees with this one; one without a
    /// finite error agrees within that of this one.
    #[must_use]
    pub fn agrees_with(&self, other_s: f64, std_error_s: f64) -> bool {
        let own = if std_error_s.is_finite() { std_error_s } else { 0.0 };
        agree((self.dead_time_s, self.std_error_s), (other_s, own))
    }
}

/// Whether two values differ by no more than the uncertainty of their difference, each with its standard error.
pub(super) fn agree((one, its_error): (f64, f64), (other, other_error): (f64, f64)) -> bool {
    (one - other).abs() <= THRESHOLDS.uncertain * its_error.hypot(other_error)
}
