//! Errors in the columns of a recording.

/// Why columns are not a valid recording. Rows are counted from 1, the first row of data.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Too few rows.
    #[error("{name}: {samples} samples; at least {needed} are needed to see a motion")]
    TooShort {
        /// Recording.
        name: String,
        /// Number of rows.
        samples: usize,
        /// Smallest number of rows.
        needed: usize,
    },
    /// Time is constant or decreases.
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
        /// Time of the previous row \[s\].
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
        /// Column, by its standard name.
        column: String,
        /// NaN or infinity, as found.
        value: f64,
    },
    /// Finite, but beyond any physical value.
    #[error(
        "{name}, row {row}: {column} is {value:e}; values beyond {limit:e} are not physical (a wrong column or unit? a faulty logger? remove the row: gaps in time are allowed)"
    )]
    Beyond {
        /// Recording.
        name: String,
        /// Counted from 1.
        row: usize,
        /// Column, by its standard name.
        column: String,
        /// Value, in the standard unit.
        value: f64,
        /// Largest absolute value, or longest time after the first row.
        limit: f64,
    },
    /// Time steps that are too small or too large.
    #[error(
        "{name}: t rises by {} s from row to row; expected {least:e} to {most} s. If its unit is another, declare it: columns = {{ t = {{ name = \"{column}\", unit = \"{}\" }} }}", short(*step), likely_unit(step / unit_s)
    )]
    Step {
        /// Recording.
        name: String,
        /// Median step \[s\].
        step: f64,
        /// Smallest allowed step \[s\].
        least: f64,
        /// Largest allowed step \[s\].
        most: f64,
        /// Name of the column of the time in its file.
        column: String,
        /// Its unit, as it was read \[s\].
        unit_s: f64,
    },
    /// Columns of different length.
    #[error("{name}: column {column} has {found} rows and t has {expected}")]
    Length {
        /// Recording.
        name: String,
        /// Column group.
        column: String,
        /// Number of rows.
        found: usize,
        /// Number of rows of the time.
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
    /// The row concerned, from 1, if any.
    #[must_use]
    pub fn row(&self) -> Option<usize> {
        match self {
            Self::TimeNotIncreasing { row, .. }
            | Self::NotFinite { row, .. }
            | Self::Beyond { row, .. } => Some(*row),
            _ => None,
        }
    }

    /// The same about a time that is called `name` in its file and was read in this unit \[s\].
    #[must_use]
    pub(crate) fn of_time(mut self, name: &str, seconds: f64) -> Self {
        if let Self::Step { column, unit_s, .. } = &mut self {
            (*column, *unit_s) = (name.into(), seconds);
        }
        self
    }
}

/// Steps of a log \[s\]: 20 kHz to 2 Hz.
const STEPS: std::ops::Range<f64> = 5e-5..0.5;

/// The unit of time in which steps, as they are in the file, are those of a log.
fn likely_unit(step: f64) -> &'static str {
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    units.into_iter().find(|(_, factor)| STEPS.contains(&(step * factor))).map_or("ms", |(u, _)| u)
}

/// A number of ordinary magnitude in decimal notation, others with an exponent.
fn short(x: f64) -> String {
    if (1e-3..1e6).contains(&x) { format!("{}", (x * 1e4).round() / 1e4) } else { format!("{x:e}") }
}
