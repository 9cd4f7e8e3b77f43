//! What was measured: checked once, never changed.

mod local;
mod noise;
mod quality;
mod recording;
mod refresh;
mod regime;

pub use local::LocalMotion;
pub use noise::Noise;
pub use quality::{Finding, Gaps, Quality, Severity, quality};
pub use recording::{Channels, DriveUnit, Measured, Recording, RecordingError};
pub use regime::Regime;
