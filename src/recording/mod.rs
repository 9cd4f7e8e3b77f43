//! What was measured: checked once, never changed.

mod drive_unit;
mod error;
mod limits;
mod local;
mod noise;
mod quality;
mod recording;
mod refresh;
mod regime;

pub use drive_unit::DriveUnit;
pub use error::RecordingError;
pub use local::LocalMotion;
pub use noise::Noise;
pub use quality::{Finding, Gaps, Quality, Severity, quality};
pub use recording::{Channels, Measured, Recording};
pub use regime::Regime;
