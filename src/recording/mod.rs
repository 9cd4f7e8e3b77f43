//! Recordings: checked once, immutable afterwards.

mod channels;
mod check;
mod derived;
mod drive_unit;
mod error;
mod gaps;
mod half_rate;
mod interpolated;
mod kept;
mod limits;
mod lines;
mod local;
mod long;
mod motion;
mod noise;
mod one_step;
mod quality;
mod recording;
mod refresh;
mod regime;
mod response;
mod sensing;
mod standstill;

pub use channels::{Channels, Factor, Measured, MotionNoise, Noise, Sensing, SlowNoise};
pub(crate) use derived::{RESOLVED, differentiate, slopes};
pub use drive_unit::DriveUnit;
pub use error::RecordingError;
pub(crate) use gaps::{is_gap, pieces};
pub use long::{LongRecording, Rows, RowsError, Survey};
pub use motion::{LocalMotion, Start};
pub(crate) use noise::FEW_LEVELS;
pub use noise::share_noise;
pub use quality::{Finding, Gaps, Issue, Quality, Quantity, Severity, StatedIssue, quality};
pub(crate) use quality::{
    Lacking, RatioUnit, SHORT, SLOW, UnitError, View, Window, counts_backwards, exchanged_input,
    exchanged_speeds, is_full_turn, is_mirrored, lacking, opposing_input, short_windows_of,
    shows_no_motion, steps_before, windows_of,
};
pub use recording::Recording;
pub(crate) use refresh::REGULAR;
pub use refresh::refreshed;
pub use regime::Regime;
pub(crate) use standstill::never_moves;
