//! The lag of a speed, and what the recordings of a log show of it together.

use super::super::finding::{Finding, Kind};
use crate::conditioning::thresholds::SPEEDS;

/// How much later than the angle a speed is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Lag \[s\].
    pub value: f64,
    /// Its standard error \[s\].
    pub std_error: f64,
}

/// The lag of the speeds that several recordings of one log have in common, from the findings of each;
/// `None` where no recording shows one. One logger reads one sensor in one way.
#[must_use]
pub fn common_lag<'a>(recordings: impl Iterator<Item = &'a [Finding]>) -> Option<Lag> {
    let shown = |findings: &[Finding]| {
        findings.iter().find_map(|f| match f.kind {
            Kind::Lag { lag_s, std_error_s } | Kind::Filtered { lag_s, std_error_s } => {
                Some(Lag { value: lag_s, std_error: std_error_s })
            }
            _ => None,
        })
    };
    pooled(&recordings.filter_map(shown).collect::<Vec<_>>())
}

/// What the recordings of one log show of the lag of their speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpeedLag {
    /// Not determined: each recording is analysed separately.
    #[default]
    Unknown,
    /// The lag, for recordings that are too short or too slow to determine it.
    Known(Lag),
    /// The recordings contradict each other.
    Disputed,
}

/// Whether recordings of one log, each with the refresh interval of its sensors \[s\], show lags of the speeds that
/// differ by more than their errors and the unknown instant within that interval.
#[must_use]
pub fn lags_differ<'a>(recordings: impl Iterator<Item = (&'a [Finding], f64)>) -> bool {
    let shown = |(findings, step): (&[Finding], f64)| {
        findings.iter().find_map(|f| match f.kind {
            Kind::Lag { lag_s: value, std_error_s: std_error } => {
                Some((Lag { value, std_error }, step))
            }
            _ => None,
        })
    };
    let lags: Vec<(Lag, f64)> = recordings.filter_map(shown).collect();
    let differ = |(a, step): &(Lag, f64), (b, other): &(Lag, f64)| {
        let apart = (a.value - b.value).abs();
        apart > SPEEDS.lag_errors * a.std_error.hypot(b.std_error)
            && apart > SPEEDS.lag_rows * step.max(*other)
    };
    lags.iter().enumerate().any(|(k, a)| lags[..k].iter().any(|b| differ(a, b)))
}

impl Lag {
    pub(super) fn is_sure(&self, step: f64) -> bool {
        self.value.abs() >= SPEEDS.lag_errors * self.std_error
            && self.value.abs() >= SPEEDS.lag_rows * step
    }
}

/// Mean of the wheels' lags by their accuracy, with a standard error that their scatter widens.
pub(super) fn pooled(lags: &[Lag]) -> Option<Lag> {
    let weight = |l: &Lag| 1.0 / (l.std_error * l.std_error).max(1e-18);
    let total: f64 = lags.iter().map(weight).sum();
    let value = lags.iter().map(|l| weight(l) * l.value).sum::<f64>() / total;
    let spread: f64 = lags.iter().map(|l| weight(l) * (l.value - value).powi(2)).sum();
    let ratio = spread / (lags.len() as f64 - 1.0).max(1.0);
    let std_error = (ratio.max(1.0) / total).sqrt();
    (!lags.is_empty()).then_some(Lag { value, std_error })
}
