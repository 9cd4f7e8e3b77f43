//! Checks that the rows of a recording are complete, finite and in order of time.

use super::RecordingError;

/// Smallest number of samples of a recording, as required by fourth differences and a regression line.
pub(super) const MINIMUM_SAMPLES: usize = 10;

/// Refuses a recording that has too few rows, or rows that [`check_rows`] refuses.
pub(super) fn check(
    name: &str,
    t: &[f64],
    alpha: Option<&[[f64; 2]]>,
    omega: Option<&[[f64; 2]]>,
    torque: &[[f64; 2]],
) -> Result<(), RecordingError> {
    if t.len() < MINIMUM_SAMPLES {
        let (samples, needed) = (t.len(), MINIMUM_SAMPLES);
        return Err(RecordingError::TooShort { name: name.into(), samples, needed });
    }
    check_rows(name, t, alpha, omega, torque)
}

/// As [`check`], for any number of rows.
pub(super) fn check_rows(
    name: &str,
    t: &[f64],
    alpha: Option<&[[f64; 2]]>,
    omega: Option<&[[f64; 2]]>,
    torque: &[[f64; 2]],
) -> Result<(), RecordingError> {
    let not_finite = |row: usize, column: &str, value: f64| RecordingError::NotFinite {
        name: name.into(),
        row: row + 1,
        column: column.into(),
        value,
    };
    for (k, &time) in t.iter().enumerate() {
        if !time.is_finite() {
            return Err(not_finite(k, "t", time));
        }
        if k > 0 && time <= t[k - 1] {
            let (row, previous) = (k + 1, t[k - 1]);
            return Err(RecordingError::TimeNotIncreasing {
                name: name.into(),
                row,
                t: time,
                previous,
            });
        }
    }
    for (column, values) in [("alpha", alpha), ("dalpha", omega), ("M", Some(torque))] {
        let Some(values) = values else { continue };
        if values.len() != t.len() {
            return Err(RecordingError::Length {
                name: name.into(),
                column: column.into(),
                found: values.len(),
                expected: t.len(),
            });
        }
        if let Some((k, i)) = first_where(values, |v| !v.is_finite()) {
            return Err(not_finite(k, &format!("{column}{}", i + 1), values[k][i]));
        }
    }
    Ok(())
}

/// The first row, and the wheel in it, whose value is wrong. Blocks of rows without one are passed without a branch for
/// every value.
pub(super) fn first_where(
    values: &[[f64; 2]],
    is_wrong: impl Fn(f64) -> bool,
) -> Option<(usize, usize)> {
    const BLOCK: usize = 256;
    let has_one = |rows: &[[f64; 2]]| {
        rows.as_flattened().iter().fold(false, |found, value| found | is_wrong(*value))
    };
    let (n, rows) = values.chunks(BLOCK).enumerate().find(|(_, rows)| has_one(rows))?;
    let place = rows.as_flattened().iter().position(|value| is_wrong(*value))?;
    Some((n * BLOCK + place / 2, place % 2))
}
