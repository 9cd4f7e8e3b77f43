//! What conditioning found: typed, with the words made in one place.

use serde_json::{Value, json};

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
            Self::Sensors => "sensors".into(),
        }
    }
}

/// What was done about a finding.
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

/// What was found. Rows count from 1, the first row of data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Rows in which a column has no number; left out.
    MissingValues {
        /// How many rows.
        rows: usize,
        /// The first of them.
        first: usize,
    },
    /// A column that has its own, slower rows; held in between.
    SparseColumn {
        /// Part of the rows that have a value [1].
        share: f64,
    },
    /// Rows whose time repeats or precedes that of others; left out.
    TimeRows {
        /// How many rows.
        rows: usize,
        /// The first of them.
        first: usize,
    },
    /// The clock went back [s] and on from there: the rows go on behind a gap.
    ClockRestart {
        /// The row.
        row: usize,
        /// By how much [s].
        back_s: f64,
    },
    /// An angle that wraps at so many radians.
    Wrapped {
        /// Period [rad].
        period_rad: f64,
        /// How often.
        turns: usize,
    },
    /// An angle whose counter was reset by so many radians.
    Reset {
        /// The row.
        row: usize,
        /// Size of the jump [rad].
        step_rad: f64,
    },
    /// Isolated wrong samples.
    Spikes {
        /// How many.
        count: usize,
        /// The first of them.
        first: usize,
        /// The largest one, from the line between its neighbours.
        largest: f64,
    },
    /// A channel that is this many times what the other one says.
    Unit {
        /// Ratio of speed to slope of the angle.
        factor: f64,
        /// The unit it is in.
        unit: &'static str,
    },
    /// A channel whose sign contradicts the others.
    Sign,
    /// Speeds that are recorded so much later than the angles [s].
    Lag {
        /// Lag [s].
        lag_s: f64,
        /// Its standard error [s].
        std_error_s: f64,
    },
    /// Speeds that a filter made late; the angles alone are used.
    Filtered {
        /// Lag [s].
        lag_s: f64,
        /// Its standard error [s].
        std_error_s: f64,
    },
    /// Speeds that are differences of the angles over so many samples; the angles alone are used.
    Differences {
        /// Over how many samples.
        samples: usize,
        /// Lag [s].
        lag_s: f64,
    },
    /// An input of a few levels: commands without noise.
    FewLevels {
        /// How many.
        levels: usize,
    },
    /// An input without sign, though the wheel turns both ways.
    Magnitude,
    /// An input that is not zero while the robot stands before it starts.
    RestOffset {
        /// Mean at rest, in the unit of the input.
        mean: f64,
        /// Its standard error.
        std_error: f64,
    },
    /// Sensors that give a new value only every so often [s].
    Refresh {
        /// Time between new values [s].
        period_s: f64,
    },
    /// A channel that comes in steps.
    Quantum {
        /// The step, in the unit of the channel.
        step: f64,
    },
    /// A sensor that does not move although its wheel is driven.
    Dead,
}

/// Something that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// Where.
    pub channel: Channel,
    /// What.
    pub kind: Kind,
    /// What was done.
    pub action: Action,
}

impl Finding {
    pub(super) fn corrected(channel: Channel, kind: Kind, key: &'static str, on: bool) -> Self {
        let action = if on { Action::Corrected(key) } else { Action::Noted };
        Self { channel, kind, action }
    }

    /// As in `results.json`: `{ channel, finding, action, value, unit }`.
    #[must_use]
    pub fn json(&self) -> Value {
        let (finding, value, unit) = self.kind.parts();
        json!({
            "channel": self.channel.name(), "finding": finding, "action": self.action.name(),
            "value": value, "unit": unit, "words": self.to_string(),
        })
    }

    /// Whether the channels are no longer those of the file, or should not be used as they are.
    #[must_use]
    pub fn is_remarkable(&self) -> bool {
        !matches!(self.action, Action::Used)
    }
}

impl Kind {
    /// Name, value and unit in `results.json`.
    fn parts(&self) -> (&'static str, f64, &'static str) {
        match *self {
            Self::MissingValues { rows, .. } => ("missing_values", rows as f64, "rows"),
            Self::SparseColumn { share } => ("sparse_column", share, "1"),
            Self::TimeRows { rows, .. } => ("time_not_increasing", rows as f64, "rows"),
            Self::ClockRestart { back_s, .. } => ("clock_restart", back_s, "s"),
            Self::Wrapped { period_rad, .. } => ("wrapped", period_rad, "rad"),
            Self::Reset { step_rad, .. } => ("reset", step_rad, "rad"),
            Self::Spikes { count, .. } => ("spikes", count as f64, "samples"),
            Self::Unit { factor, .. } => ("unit", factor, "1"),
            Self::Sign => ("sign", -1.0, "1"),
            Self::Lag { lag_s, .. } => ("lag", lag_s, "s"),
            Self::Filtered { lag_s, .. } => ("filtered", lag_s, "s"),
            Self::Differences { lag_s, .. } => ("differences_of_angle", lag_s, "s"),
            Self::FewLevels { levels } => ("few_levels", levels as f64, "levels"),
            Self::Magnitude => ("magnitude", 1.0, "1"),
            Self::RestOffset { mean, .. } => ("rest_offset", mean, "input"),
            Self::Refresh { period_s } => ("refresh", period_s, "s"),
            Self::Quantum { step } => ("quantum", step, "SI"),
            Self::Dead => ("dead", 0.0, "1"),
        }
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = self.channel.name();
        let (what, done) = words(&name, &self.kind, self.channel);
        match self.action {
            Action::Corrected(key) => {
                write!(f, "{what}; {done} ([conditioning] {key} = false leaves it)")
            }
            Action::Used => write!(f, "{what}; {done}"),
            Action::Noted => write!(f, "{what}; left as recorded"),
        }
    }
}

/// What was found, and what is done about it unless it is switched off.
fn words(name: &str, kind: &Kind, channel: Channel) -> (String, String) {
    let ms = |s: f64| format!("{:.2} ms", 1e3 * s);
    let one = |count: usize, what: &str| {
        if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
    };
    match *kind {
        Kind::MissingValues { rows, first } => (
            format!("{} without a number in some column (first: row {first})", one(rows, "row")),
            "left out".into(),
        ),
        Kind::SparseColumn { share } => (
            format!("{name} has a value in {:.1} % of the rows", 100.0 * share),
            "the last value is held between them".into(),
        ),
        Kind::TimeRows { rows, first } => (
            format!(
                "{} whose time does not exceed that before (first: row {first})",
                one(rows, "row")
            ),
            "left out".into(),
        ),
        Kind::ClockRestart { row, back_s } => (
            format!("the time goes back by {back_s:.3} s at row {row} and on from there"),
            "a restarted clock: what follows stands behind a gap".into(),
        ),
        Kind::Wrapped { period_rad, turns } => {
            (format!("{name} wraps at {period_rad:.6} rad, {turns} times"), "unwrapped".into())
        }
        Kind::Reset { row, step_rad } => (
            format!("{name} jumps by {step_rad:+.4} rad at row {row} and stays there"),
            "a reset counter: what follows is shifted back".into(),
        ),
        Kind::Spikes { count, first, largest } => (
            format!(
                "{name} has {} (first: row {first}; the largest stands out by {})",
                one(count, "isolated wrong sample"),
                if largest.abs() < 1e6 { format!("{largest:.4}") } else { format!("{largest:e}") }
            ),
            "replaced by the line between the neighbours".into(),
        ),
        Kind::Unit { factor, unit } => {
            let other =
                if matches!(channel, Channel::Speed(_)) { "the slope of" } else { "that of" };
            (
                format!("{name} is {factor:.4} times {other} its counterpart: it is in {unit}"),
                "converted".into(),
            )
        }
        Kind::Sign => (
            format!("{name} has the opposite sign of its counterpart and of the input"),
            "turned".into(),
        ),
        Kind::Lag { lag_s, std_error_s } => (
            format!("{name} lags the angle by {} ± {}", ms(lag_s), ms(std_error_s)),
            "advanced by that".into(),
        ),
        Kind::Filtered { lag_s, std_error_s } => (
            format!(
                "{name} lags the angle by {} ± {}, more than a sample, and is smoothed",
                ms(lag_s),
                ms(std_error_s)
            ),
            "left out: speeds are those of the angles".into(),
        ),
        Kind::Differences { samples, lag_s } => (
            format!(
                "{name} is the difference of the angle over {} ({} late)",
                one(samples, "sample"),
                ms(lag_s)
            ),
            "left out: it holds nothing beside the angle".into(),
        ),
        Kind::FewLevels { levels } => (
            format!("{name} has {} only", one(levels, "level")),
            "taken as a command without noise".into(),
        ),
        Kind::Magnitude => (
            format!("{name} is never negative although its wheel is driven both ways"),
            "takes the sign of the speed".into(),
        ),
        Kind::RestOffset { mean, std_error } => (
            format!("{name} is {mean:.5} ± {std_error:.5} while the robot stands before it starts"),
            format!("an offset of the sensor? `offset` of the column {name} takes it out"),
        ),
        Kind::Refresh { period_s } => (
            format!(
                "the sensors give a new value every {}, the rows come more often",
                ms(period_s)
            ),
            "rows that repeat a value do not count as measurements".into(),
        ),
        Kind::Quantum { step } => (
            format!("{name} comes in steps of {step:.6}"),
            "counted as noise of step/sqrt(12)".into(),
        ),
        Kind::Dead => (
            format!("{name} does not move although its wheel is driven"),
            "its wheel is identified from nothing".into(),
        ),
    }
}
