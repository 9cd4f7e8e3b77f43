//! Physical limits of the values of a recording. Values beyond them come from a wrong column, a wrong unit or
//! a faulty logger, and prevent convergence of the methods.

use super::RecordingError;
use super::check::first_where;

/// Largest absolute value of an angle, a speed or an input, in standard units.
const LARGEST: f64 = 1e9;
/// Longest time after the first row \[s\].
const LONGEST: f64 = 1e9;
/// Shortest time between two rows \[s\].
const SMALLEST_STEP: f64 = 1e-12;
/// Range of the median time step \[s\]: a million rows per second to one per minute. A step that merely
/// suggests a wrong unit is a finding of the quality check.
const STEP: (f64, f64) = (1e-6, 60.0);

/// Checks finite rows with median time step `step`.
pub(super) fn check(
    name: &str,
    t: &[f64],
    step: f64,
    columns: [(&str, &[[f64; 2]]); 3],
) -> Result<(), RecordingError> {
    let beyond = |row: usize, column: String, value: f64, limit: f64| RecordingError::Beyond {
        name: name.into(),
        row: row + 1,
        column,
        value,
        limit,
    };
    if let Some(k) = t.iter().position(|time| !((time - t[0]).abs() <= LONGEST)) {
        return Err(beyond(k, "t".into(), t[k], LONGEST));
    }
    for (column, values) in columns {
        if let Some((k, i)) = first_where(values, |v| !(v.abs() <= LARGEST)) {
            return Err(beyond(k, format!("{column}{}", i + 1), values[k][i], LARGEST));
        }
    }
    let smallest = t.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    if smallest < SMALLEST_STEP || !(step >= STEP.0 && step <= STEP.1) {
        let step = if smallest < SMALLEST_STEP { smallest } else { step };
        return Err(RecordingError::Step {
            name: name.into(),
            step,
            least: STEP.0,
            most: STEP.1,
            column: "t".into(),
            unit_s: 1.0,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::recording::{Channels, DriveUnit, Recording};

    fn made(change: impl FnOnce(&mut Channels)) -> Result<Recording, String> {
        let t: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
        let row = vec![[1.0, 2.0]; 50];
        let mut channels = Channels { t, alpha: None, omega: Some(row.clone()), torque: row };
        change(&mut channels);
        Recording::new("a.csv", channels, DriveUnit::Volt).map_err(|e| e.to_string())
    }

    #[test]
    fn values_that_no_robot_reaches_are_refused_with_their_row() {
        assert!(made(|_| ()).is_ok());
        let e = made(|c| c.torque[6][1] = -1e300).unwrap_err();
        assert!(e.contains("a.csv, row 7: M2 is -1e300") && e.contains("1e9"), "{e}");
        let e = made(|c| c.t[49] = 1e12).unwrap_err();
        assert!(e.contains("row 50: t is 1e12"), "{e}");
        // a jump of the angle within a short step gives a speed beyond all bounds
        let jump = |c: &mut Channels| {
            c.alpha = Some((0..50).map(|k| [1e8 * f64::from(k % 2), 0.0]).collect());
            c.omega = None;
        };
        let e = made(jump).unwrap_err();
        assert!(e.contains("dalpha1 is"), "{e}");
    }

    #[test]
    fn steps_that_say_a_wrong_unit_are_refused_with_the_remedy() {
        let scaled =
            |factor: f64| move |c: &mut Channels| c.t.iter_mut().for_each(|t| *t *= factor);
        assert!(made(scaled(100.0)).is_ok());
        let e = made(scaled(1e5)).unwrap_err();
        assert!(e.contains("1000 s from row to row") && e.contains("unit = \"us\""), "{e}");
        let e = made(scaled(2e4)).unwrap_err();
        assert!(e.contains("200 s from row to row") && e.contains("unit = \"ms\""), "{e}");
        assert!(made(scaled(1e-300)).unwrap_err().contains("from row to row"));
        assert!(made(|c| c.t[1] = 1e-200).unwrap_err().contains("1e-200 s from row to row"));
    }
}
