//! Errors in an experiment file.

/// An error in an experiment file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileError {
    /// Invalid TOML, an unknown key or a wrong type; the message shows the line.
    #[error("{file}: {message}")]
    Syntax {
        /// Name of the experiment file, as typed.
        file: String,
        /// Line, excerpt and what was expected.
        message: String,
    },
    /// An override of the command line.
    #[error("--set {entry}: {message}")]
    Override {
        /// As typed.
        entry: String,
        /// What was expected.
        message: String,
    },
    /// A value that is out of range or inconsistent.
    #[error("{file}: {key} {message}")]
    Value {
        /// Name of the experiment file, as typed.
        file: String,
        /// Dotted key.
        key: String,
        /// The error, and the expected value.
        message: String,
    },
}
