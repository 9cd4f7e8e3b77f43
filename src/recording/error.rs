//! What is wrong with columns.

/// Why columns do not make a recording. Rows count from 1, the first row of data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Too short to say anything.
    #[error("{name}: {samples} samples; at least {needed} are needed to see a motion")]
    TooShort {
        /// Recording.
        name: String,
        /// Rows that it has.
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
        /// Counted from 1.
        row: usize,
        /// Time of that row \[s\].
        t: f64,
        /// Time of the row before \[s\].
        previous: f64,
    },
    /// NaN or infinity.
    #[error(
        "{name}, row {row}: {column} is {value}; every value must be a finite number (remove the row: gaps in time are allowed)"
    )]
    NotFinite {
        /// Recording.
        name: String,
        /// Counted from 1.
        row: usize,
        /// Column of the contract.
        column: String,
        /// Rows that it has.
        value: f64,
    },
    /// Finite, and more than any robot does.
    #[error(
        "{name}, row {row}: {column} is {value:e}; no robot goes beyond {limit:e} (a wrong column or unit? a broken logger? remove the row: gaps in time are allowed)"
    )]
    Beyond {
        /// Recording.
        name: String,
        /// Counted from 1.
        row: usize,
        /// Column of the contract.
        column: String,
        /// Found, in the unit of the contract.
        value: f64,
        /// Largest size, or longest time after the first row.
        limit: f64,
    },
    /// Rows too close or too far from each other in time.
    #[error(
        "{name}: t rises by {} s from row to row; expected {least:e} to {most} s. If its unit is another, say so: columns = {{ t = {{ name = \"t\", unit = \"ms\" }} }}", short(*step)
    )]
    Step {
        /// Recording.
        name: String,
        /// Found \[s\].
        step: f64,
        /// Expected at least \[s\].
        least: f64,
        /// Expected at most \[s\].
        most: f64,
    },
    /// Columns of different length.
    #[error("{name}: column {column} has {found} rows and t has {expected}")]
    Length {
        /// Recording.
        name: String,
        /// Column group.
        column: String,
        /// Rows that it has.
        found: usize,
        /// Rows of the time.
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

impl RecordingError {
    /// The row that is wrong, from 1, where it is one.
    #[must_use]
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::TimeNotIncreasing { row, .. }
            | Self::NotFinite { row, .. }
            | Self::Beyond { row, .. } => Some(*row),
            _ => None,
        }
    }
}

/// A number of ordinary size as it is, others with an exponent.
fn short(x: f64) -> String {
    if (1e-3..1e6).contains(&x) { format!("{}", (x * 1e4).round() / 1e4) } else { format!("{x:e}") }
}
