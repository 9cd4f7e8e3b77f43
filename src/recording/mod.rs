//! What was measured: checked once, never changed.

mod recording;

pub use recording::{Channels, DriveUnit, Measured, Recording, RecordingError};
