//! Quality check of a recording before any fit.
//!
//! All checks use only the recording (and, for units of length, the wheel radius): timing, every channel
//! separately, the channels against each other, and the excitation.

mod channel;
mod consistency;
mod excitation;
mod issue;
mod motion;
mod settling;
mod timing;
mod window;

pub use issue::{Issue, Quantity, StatedIssue};
pub(crate) use issue::{RatioUnit, SHORT, SLOW, UnitError, is_full_turn};

pub(crate) use channel::{shows_no_motion, steps_before};
pub(crate) use consistency::{
    counts_backwards, exchanged_input, exchanged_speeds, is_mirrored, opposing_input,
};
pub(crate) use excitation::{Lacking, lacking};
pub(crate) use window::{View, Window, short_windows_of, windows_of};

use super::Recording;
use crate::robot::Robot;
use window::windows;

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// For information; results are not affected.
    Note,
    /// Results may be less accurate, or some parameters may not be identifiable.
    Warning,
    /// Results will be wrong unless it is corrected.
    Problem,
}

/// A finding of the quality check.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Finding {
    /// How much it affects the results.
    pub severity: Severity,
    /// What was found.
    pub issue: Issue,
}

impl Finding {
    fn new(severity: Severity, issue: Issue) -> Self {
        Self { severity, issue }
    }
}

/// Gaps in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Gaps<C = usize, R = f64> {
    /// Number of gaps.
    pub count: C,
    /// The longest \[s\]; zero if there are none.
    pub longest: R,
}

/// Results of the quality check of a recording.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Quality {
    /// Sampling rate: reciprocal of the median step \[Hz\].
    pub rate_hz: f64,
    /// Standard deviation of the step outside gaps, over the median step \[1\].
    pub jitter: f64,
    /// Gaps in time.
    pub gaps: Gaps,
    /// All findings, the most severe first.
    pub findings: Vec<Finding>,
}

impl Quality {
    /// The findings with at least this severity, the most severe first.
    pub fn at_least(&self, severity: Severity) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |f| f.severity >= severity)
    }
}

/// Checks a recording.
///
/// # Examples
/// ```
/// use amigo_ident::recording::{Channels, DriveUnit, Recording, Severity, quality};
/// use amigo_ident::robot::Robot;
/// let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
/// let omega = t.iter().map(|t| [3.0 * t.sin(), 0.0]).collect();
/// let torque = t.iter().map(|t| [0.1 * t.cos() + 0.1 * t.sin().signum(), 0.0]).collect();
/// let channels = Channels { t, alpha: None, omega: Some(omega), torque };
/// let recording = Recording::new("run.csv", channels, DriveUnit::NewtonMetre).unwrap();
/// let found = quality(&recording, &Robot::amigobot());
/// assert!(found.at_least(Severity::Warning).any(|f| f.what().contains("wheel 2 (left) never moves")));
/// ```
#[must_use]
pub fn quality(recording: &Recording, robot: &Robot) -> Quality {
    let (rate_hz, jitter, gaps) = timing::measure(recording);
    let mut findings = timing::findings(recording, jitter, gaps);
    findings.extend(settling::finding(recording));
    findings.extend(channel::findings(recording));
    let windows = windows(recording);
    findings.extend(motion::findings(recording, &windows, robot));
    findings.extend(excitation::findings(recording, &windows));
    // stable sort: within a severity in the order of the checks
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Quality { rate_hz, jitter, gaps, findings }
}

/// The quantile of the absolute values at a share; zero for an empty sample.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    crate::math::quantile(values.map(f64::abs), share)
}

#[cfg(test)]
mod tests;
