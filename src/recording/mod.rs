//! What was measured: checked once, never changed.

mod noise;
mod recording;

pub use noise::Noise;
pub use recording::{Channels, DriveUnit, Measured, Recording, RecordingError};
