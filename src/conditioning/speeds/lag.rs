//! The lag of a speed, and what the recordings of a log show of it together.

use super::super::finding::{Channel, Finding, Kind};
use crate::conditioning::thresholds::SPEEDS;

/// How much later than the angle a speed is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lag {
    /// Lag \[s\].
    pub value: f64,
    /// Its standard error \[s\].
    pub std_error: f64,
}

/// The lag of each wheel's speed that several recordings of one log have in common, from the findings of each; `None`
/// where no recording shows one. One logger reads one sensor in one way.
#[must_use]
pub fn common_lag<'a>(recordings: impl Iterator<Item = &'a [Finding]>) -> Option<[Lag; 2]> {
    let shown: Vec<[Option<Lag>; 2]> =
        recordings.map(|found| [0, 1].map(|i| shown(found, i))).collect();
    let of = |i: usize| pooled(&shown.iter().filter_map(|lags| lags[i]).collect::<Vec<_>>());
    match [of(0), of(1)] {
        [None, None] => None,
        // the speed of the other wheel is in time
        lags => Some(lags.map(|lag| lag.unwrap_or_default())),
    }
}

/// The lag of the speed of wheel `i` among findings.
fn shown(findings: &[Finding], i: usize) -> Option<Lag> {
    let mut of_wheel = findings.iter().filter(|f| f.channel == Channel::Speed(i));
    of_wheel.find_map(|f| match f.kind {
        Kind::Lag { lag_s, std_error_s } | Kind::Filtered { lag_s, std_error_s } => {
            Some(Lag { value: lag_s, std_error: std_error_s })
        }
        _ => None,
    })
}

/// What the recordings of one log show of the lag of their speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpeedLag {
    /// Not determined: each recording is analysed separately.
    #[default]
    Unknown,
    /// The lag of each wheel, for recordings that are too short or too slow to determine it.
    Known([Lag; 2]),
    /// The recordings contradict each other.
    Disputed,
}

/// Whether recordings of one log, each with the refresh interval of its sensors \[s\], show lags of the speeds that
/// differ by more than their errors and the unknown instant within that interval.
#[must_use]
pub fn lags_differ<'a>(recordings: impl Iterator<Item = (&'a [Finding], f64)>) -> bool {
    let recordings: Vec<(&[Finding], f64)> = recordings.collect();
    let delayed = |i: usize| {
        let delays = recordings.iter().filter_map(move |(found, step)| {
            let is_delay =
                |f: &Finding| f.channel == Channel::Speed(i) && matches!(f.kind, Kind::Lag { .. });
            let lag = shown(found, i)?;
            found.iter().any(is_delay).then_some((lag, *step))
        });
        delays.collect::<Vec<(Lag, f64)>>()
    };
    let differ = |lags: &[(Lag, f64)]| {
        let pairs = lags.iter().enumerate();
        let mut pairs = pairs.flat_map(|(k, a)| lags[..k].iter().map(move |b| (a, b)));
        pairs.any(|(a, b)| a.0.differs_from(&b.0, a.1.max(b.1)))
    };
    differ(&delayed(0)) || differ(&delayed(1))
}

impl Lag {
    /// Whether two lags differ by more than their errors and the unknown instant within a `step` \[s\].
    pub(super) fn differs_from(&self, other: &Self, step: f64) -> bool {
        let apart = (self.value - other.value).abs();
        apart > SPEEDS.lag_errors * self.std_error.hypot(other.std_error)
            && apart > SPEEDS.lag_rows * step
    }

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
