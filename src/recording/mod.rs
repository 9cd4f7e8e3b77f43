//! What was measured: checked once, never changed.

mod local;
mod noise;
mod recording;
mod refresh;
mod regime;

pub use local::LocalMotion;
pub use noise::Noise;
pub use recording::{Channels, DriveUnit, Measured, Recording, RecordingError};
pub use regime::Regime;
