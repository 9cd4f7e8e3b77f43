//! What conditioning found, typed.

mod kind;
mod mapped;
mod stated;

pub use self::kind::Kind;
pub use self::stated::{Stated, stated};

/// Names of the wheels.
pub(super) const WHEELS: [&str; 2] = ["right", "left"];

/// The channel of a finding; wheels count from 0, the right one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The rows and their time.
    Time,
    /// Angle of a wheel.
    Angle(usize),
    /// Speed of a wheel.
    Speed(usize),
    /// Input of a wheel.
    Input(usize),
    /// The column by which the input of a wheel is multiplied.
    Factor(usize),
    /// Both wheels' angles and speeds.
    Sensors,
}

impl Channel {
    /// Name in files.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Time => "t".into(),
            Self::Angle(i) => format!("alpha{}", i + 1),
            Self::Speed(i) => format!("dalpha{}", i + 1),
            Self::Input(i) => format!("M{}", i + 1),
            Self::Factor(i) => format!("M{}.times", i + 1),
            Self::Sensors => "sensors".into(),
        }
    }
}

/// Where in its row the one sample of an input is taken that changes at the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampled {
    /// The value of the row, at which the input is simulated as held.
    Held,
    /// At the start of its row: the motion follows the line between the samples half a row late.
    First,
    /// At the end of its row: the motion follows that line half a row early.
    Last,
}

/// Correction of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Corrected, unless this key of `[conditioning]` is false.
    Corrected(&'static str),
    /// Counted as noise or timing by the estimators.
    Used,
    /// Left as it is.
    Noted,
}

impl Action {
    /// In a word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Corrected(_) => "corrected",
            Self::Used => "used",
            Self::Noted => "noted",
        }
    }
}

/// Something that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Where.
    pub channel: Channel,
    /// What.
    pub kind: Kind,
    /// Correction.
    pub action: Action,
}

impl Finding {
    /// A finding that was corrected where `on`, the switch `key` of `[conditioning]`.
    pub(crate) fn corrected(channel: Channel, kind: Kind, key: &'static str, on: bool) -> Self {
        let action = if on { Action::Corrected(key) } else { Action::Noted };
        Self { channel, kind, action }
    }

    /// Whether the channels are no longer those of the file, or should not be used as they are.
    #[must_use]
    pub fn is_remarkable(&self) -> bool {
        !matches!(self.action, Action::Used)
    }
}
