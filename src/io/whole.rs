//! Formats whose files are read as a whole.

use std::path::Path;

use super::IoError;
use super::signals::Signals;

/// A format that is identified by its extension and first bytes and read as a whole.
pub(super) struct WholeFormat {
    /// Extension of its files.
    pub(super) extension: &'static str,
    /// First bytes of its files; empty if they are not characteristic.
    pub(super) magic: &'static [u8],
    /// Reads a file.
    pub(super) read: fn(&Path) -> Result<Content, IoError>,
}

/// Content of a file.
pub(super) enum Content {
    /// Named columns of equal length.
    Columns(Vec<(String, Vec<f64>)>),
    /// Named signals, each with its own stamps.
    Signals(Signals),
}

/// Declares one module per format and lists what they read.
macro_rules! formats {
    ($($module:ident),+ $(,)?) => {
        $(mod $module;)+

        /// Every format that is read at once.
        static WHOLE: &[whole::WholeFormat] = &[$($module::FORMAT),+];
    };
}
pub(super) use formats;
