//! Findings as they are printed: what several channels or recordings share once, with the ranges of its numbers.

use super::{Action, Channel, Finding, Kind};
use crate::math::{Span, Statement, joined};

/// Statement of one or several findings.
#[derive(Clone, Debug, PartialEq)]
pub struct Stated {
    /// The channels of which the same was found.
    pub(crate) channels: Vec<Channel>,
    /// What was found, with the ranges of its numbers.
    pub(crate) kind: Kind<Span<usize>, Span<f64>>,
    /// Correction.
    pub(crate) action: Action,
}

impl Stated {
    /// Of one finding.
    #[must_use]
    pub fn of(Finding { channel, kind, action }: &Finding) -> Self {
        Self { channels: vec![*channel], kind: kind.map(Span::of, Span::of), action: *action }
    }

    /// Extends its ranges by the numbers of another finding that is equal otherwise; returns whether it is.
    pub fn join(&mut self, other: &Self) -> bool {
        let is_like = self.channels == other.channels
            && self.action == other.action
            && self.kind.is_like(other.kind);
        if is_like {
            self.kind = joined(self.kind, other.kind);
        }
        is_like
    }
}

/// The findings of a recording; equal findings on several channels are one.
#[must_use]
pub fn stated(findings: &[Finding]) -> Vec<Stated> {
    let mut out: Vec<Stated> = vec![];
    for finding in findings {
        let next = Stated::of(finding);
        match out.iter_mut().find(|s| (s.kind, s.action) == (next.kind, next.action)) {
            Some(same) => same.channels.extend(next.channels),
            None => out.push(next),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(channel: Channel, kind: Kind) -> Finding {
        Finding { channel, kind, action: Action::Noted }
    }

    /// What two findings are together; `None` where they differ by more than numbers.
    fn joined(one: Finding, other: Finding) -> Option<String> {
        let mut all = Stated::of(&one);
        all.join(&Stated::of(&other)).then(|| all.to_string())
    }

    #[test]
    fn findings_of_a_channel_that_differ_in_their_numbers_become_one() {
        let lag = |lag_s, std_error_s| finding(Channel::Speed(0), Kind::Lag { lag_s, std_error_s });
        let expected =
            "dalpha1 lags the angle by 9.05 to 49.50 ms ± 0.20 to 1.30 ms; left as recorded";
        assert_eq!(joined(lag(0.0495, 0.2e-3), lag(9.05e-3, 1.3e-3)).unwrap(), expected);
        let missing = |rows| finding(Channel::Time, Kind::MissingValues { rows, first: 3 });
        let text = joined(missing(1), missing(4)).unwrap();
        assert!(text.starts_with("1 to 4 rows without"), "{text}");
    }

    #[test]
    fn other_channels_units_and_directions_of_a_gear_stay_apart() {
        let unit = |unit, channel| finding(channel, Kind::Unit { factor: 57.3, unit });
        assert!(joined(unit("deg", Channel::Angle(0)), unit("deg", Channel::Angle(1))).is_none());
        assert!(joined(unit("deg", Channel::Angle(0)), unit("rpm", Channel::Angle(0))).is_none());
        let gear = |ratio| finding(Channel::Speed(0), Kind::Gear { ratio });
        assert!(joined(gear(2.0), gear(0.5)).is_none());
        let text = joined(gear(2.0), gear(2.5)).unwrap();
        assert!(text.contains("write scale = 0.40000 to 0.50000 in dalpha1"), "{text}");
    }

    #[test]
    fn channels_with_the_same_finding_share_a_sentence() {
        let quantum = |i| finding(Channel::Speed(i), Kind::Quantum { step: 0.5 });
        let said = stated(&[quantum(0), finding(Channel::Input(0), Kind::Sign), quantum(1)]);
        assert_eq!(said.len(), 2);
        assert!(
            said[0]
                .to_string()
                .starts_with("each of dalpha1 and dalpha2 is quantised in steps of 0.500000")
        );
    }
}
