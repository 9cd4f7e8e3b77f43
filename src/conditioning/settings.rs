//! Corrections that can be disabled: the keys of `[conditioning]`.

use serde::{Deserialize, Serialize};

/// The keys of `[conditioning]`; `false` leaves the channels as they were recorded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Rows without a value, with a repeated or an earlier time are left out; after a restart of the clock
    /// the rows continue behind a gap; scattered times are made even; recordings whose rows are at different
    /// phases of the controller cycle are shifted to one phase.
    pub rows: bool,
    /// Angles that wrap, or whose counter was reset, become continuous.
    pub unwrap: bool,
    /// Isolated wrong samples are replaced by linear interpolation.
    pub spikes: bool,
    /// Speeds in another unit than the angles, by a known factor, are converted.
    pub units: bool,
    /// The sign of a speed or angle that contradicts its counterpart, or of an input that acts against the motion, is
    /// reversed.
    pub signs: bool,
    /// Columns that belong to the other wheel are exchanged.
    pub exchanged: bool,
    /// Speeds that lag the angles are advanced, or discarded if they were computed by a filter. Speeds, or else angles,
    /// of a dead sensor are discarded.
    /// Speeds recorded without angles that are quantised encoder counts are replaced by the
    /// accumulated angle.
    pub speeds: bool,
    /// The initial heading and wheel angles of the recordings are aligned if a torque that is periodic
    /// in the angle determines their offset.
    pub starts: bool,
    /// Sensors that never move and inputs without a sign are refused.
    pub refuse: bool,
    /// An input without a sign takes that of the speed.
    pub sign_from_speed: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rows: true,
            unwrap: true,
            spikes: true,
            units: true,
            signs: true,
            exchanged: true,
            speeds: true,
            starts: true,
            refuse: true,
            sign_from_speed: false,
        }
    }
}
