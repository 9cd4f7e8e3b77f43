//! What is wrong with columns.

/// Why columns do not make a recording. Rows count from 1, the first row of data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Too short to say anything.
    #[error("{name}: {samples} samples; at least {needed} are needed to see a motion")]
    TooShort {
        /// Recording.
        name: String,
        /// Found.
        samples: usize,
        /// Expected at least.
        needed: usize,
    },
    /// Time stands still or goes backwards.
    #[error(
        "{name}, row {row}: t = {t} s does not exceed {previous} s of the row before; sort the rows or remove the repeated one"
    )]
    TimeNotIncreasing {
        /// Recording.
        name: String,
        /// Row, from 1.
        row: usize,
        /// Time of that row [s].
        t: f64,
        /// Time of the row before [s].
        previous: f64,
    },
    /// NaN or infinity.
    #[error(
        "{name}, row {row}: {column} is {value}; every value must be a finite number (remove the row: gaps in time are allowed)"
    )]
    NotFinite {
        /// Recording.
        name: String,
        /// Row, from 1.
        row: usize,
        /// Column of the contract.
        column: String,
        /// Found.
        value: f64,
    },
    /// Columns of different length.
    #[error("{name}: column {column} has {found} rows and t has {expected}")]
    Length {
        /// Recording.
        name: String,
        /// Column group.
        column: String,
        /// Found.
        found: usize,
        /// Expected.
        expected: usize,
    },
    /// Neither angles nor speeds.
    #[error(
        "{name}: neither wheel angles (alpha1, alpha2) nor wheel speeds (dalpha1, dalpha2) are there; one of the two is needed"
    )]
    NoMotion {
        /// Recording.
        name: String,
    },
}
