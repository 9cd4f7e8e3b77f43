//! The files that WPILib's SysId wrote until 2023: one JSON object with the rows of each test.
//!
//! ```text
//! { "sysid": true, "test": "Drivetrain", "units": "Meters", "unitsPerRotation": 0.4788,
//!   "slow-forward": [[t, left V, right V, left position, right position,
//!                     left velocity, right velocity, heading, heading rate], …], … }
//! ```
//! Positions are in turns of the wheel. Its predecessor frc-characterization (until 2020) wrote no `sysid`, and rows of
//! t, battery voltage, command, left V, right V, left and right position, left and right velocity, and heading in later
//! versions; their unit is that of the robot's program, and is not in the file.
//!
//! A test is a recording of its own, `file.json#slow-forward`;
//! without a name all become one with gaps between them, in the order of time. Of other mechanisms the
//! rows are t, voltage, position, velocity.
//!
//! Source: wpilibsuite/sysid, docs/data-collection.md and TelemetryManager::SaveJSON; wpilibsuite/frc-characterization,
//! drive-characterization/data_analyzer.py.

use std::path::Path;

use serde_json::{Map, Value};

use super::IoError;
use super::bytes::Damage;
use super::error::shown;
use super::json::{fault, parsed};

const DRIVETRAIN: [&str; 9] = [
    "t",
    "left_voltage [V]",
    "right_voltage [V]",
    "left_position [rev]",
    "right_position [rev]",
    "left_velocity [rev/s]",
    "right_velocity [rev/s]",
    "heading [rad]",
    "heading_rate [rad/s]",
];
/// Of frc-characterization; the heading is missing in its first versions.
const CHARACTERIZATION: [&str; 10] = [
    "t",
    "battery [V]",
    "autospeed",
    "left_voltage [V]",
    "right_voltage [V]",
    "left_position",
    "right_position",
    "left_velocity",
    "right_velocity",
    "heading [rad]",
];
/// The tests of frc-characterization.
const TESTS: [&str; 4] = ["slow-forward", "slow-backward", "fast-forward", "fast-backward"];
const MECHANISM: [&str; 4] = ["t", "voltage [V]", "position [rev]", "velocity [rev/s]"];

/// A test with its rows.
type Test = (String, Vec<Vec<f64>>);

/// The columns of all tests, or of the test of that name.
pub(super) fn read(path: &Path, part: Option<&str>) -> Result<Vec<(String, Vec<f64>)>, IoError> {
    let mut object = object(path)?;
    if let Some(part) = part {
        if !object.get(part).is_some_and(Value::is_array) {
            let known = names(&object).join(", ");
            let damage = Damage::new(format!("test `{part}`"), format!("one of {known}"), "none");
            return Err(damage.in_file(path, "SysId JSON"));
        }
        object.retain(|name, value| !value.is_array() || name == part);
    }
    columns(&object).map_err(|damage| damage.in_file(path, "SysId JSON"))
}

/// The names of the tests.
pub(super) fn tests(path: &Path) -> Result<Vec<String>, IoError> {
    Ok(names(&object(path)?))
}

/// The radius of the wheels \[m\] by the way of a turn that the file states, with the text of that.
pub(super) fn radius(path: &Path) -> Option<(f64, String)> {
    let object = object(path).ok()?;
    let unit = object.get("units")?.as_str()?;
    let metres = match unit.to_lowercase().as_str() {
        "meters" => 1.0,
        "feet" => 0.3048,
        "inches" => 0.0254,
        _ => return None,
    };
    // one is the default of the tool: then the unit is the turn, whatever its name
    let is_stated = |turn: &f64| *turn > 0.0 && *turn != 1.0;
    let turn = object.get("unitsPerRotation")?.as_f64().filter(is_stated)?;
    let text = format!("unitsPerRotation = {turn} {}, the way of a turn,", unit.to_lowercase());
    Some((turn * metres / std::f64::consts::TAU, text))
}

fn names(object: &Map<String, Value>) -> Vec<String> {
    let rows = |value: &Value| value.as_array().is_some_and(|rows| !rows.is_empty());
    object.iter().filter(|(_, value)| rows(value)).map(|(name, _)| name.clone()).collect()
}

fn object(path: &Path) -> Result<Map<String, Value>, IoError> {
    let bytes = std::fs::read(path).map_err(|e| IoError::system(path, &e))?;
    let text = String::from_utf8_lossy(&bytes);
    // a file of another program is not called one of SysId
    let is_named = ["sysid"].iter().chain(&TESTS).any(|key| text.contains(&format!("\"{key}\"")));
    let format = if is_named { "SysId JSON" } else { "JSON" };
    let wrong =
        |reason: String| IoError::Format { file: shown(path), format: format.into(), reason };
    match parsed(&text).map_err(|e| wrong(fault(&text, &e)))? {
        Value::Object(object) if is_of_sysid(&object) || has_all_tests(&object) => Ok(object),
        _ => Err(wrong(
            "it has neither a `sysid` that is true nor the four tests of frc-characterization, so another program wrote \
             it. Save its rows as CSV with a header, or as lists of numbers by their names: {\"t\": [0, 0.01], \
             \"left_volts\": [1, 2], …}"
                .into(),
        )),
    }
}

fn has_all_tests(object: &Map<String, Value>) -> bool {
    TESTS.iter().all(|test| object.contains_key(*test))
}

fn is_of_sysid(object: &Map<String, Value>) -> bool {
    object.get("sysid") == Some(&Value::Bool(true))
}

fn columns(object: &Map<String, Value>) -> Result<Vec<(String, Vec<f64>)>, Damage> {
    let mut tests = Vec::new();
    for (name, value) in object {
        if let Value::Array(rows) = value
            && !rows.is_empty()
        {
            tests.push(test(name, rows)?);
        }
    }
    let Some((_, first)) = tests.first() else {
        return Err(Damage::new("the object", "tests such as slow-forward with rows", "none"));
    };
    let width = first[0].len();
    let names: &[&str] = match (is_of_sysid(object), width) {
        (true, 9) => &DRIVETRAIN,
        (true, 4) => &MECHANISM,
        (false, 9 | 10) => &CHARACTERIZATION[..width],
        (of_sysid, _) => {
            let expected = match of_sysid {
                true => "rows of 9 numbers (a drivetrain) or 4",
                false => "rows of 9 or 10 numbers (a drivetrain)",
            };
            return Err(Damage::new("the tests", expected, width.to_string()));
        }
    };
    in_order(&mut tests)?;
    let rows: Vec<&Vec<f64>> = tests.iter().flat_map(|(_, rows)| rows).collect();
    if let Some(other) = rows.iter().find(|r| r.len() != width) {
        let found = other.len().to_string();
        return Err(Damage::new("the tests", format!("{width} numbers in every row"), found));
    }
    let column =
        |(j, name): (usize, &&str)| (name.to_string(), rows.iter().map(|row| row[j]).collect());
    Ok(names.iter().enumerate().map(column).collect())
}

fn test(name: &str, rows: &[Value]) -> Result<Test, Damage> {
    let row = |(k, row): (usize, &Value)| {
        // a value that is missing, but in no time
        let number = |(k, x): (usize, &Value)| {
            x.as_f64().or_else(|| (k > 0 && x.is_null()).then_some(f64::NAN))
        };
        let numbers = row.as_array().and_then(|r| r.iter().enumerate().map(number).collect());
        numbers.filter(|r: &Vec<f64>| !r.is_empty()).ok_or_else(|| {
            let found: String = row.to_string().chars().take(40).collect();
            Damage::new(format!("{name}, row {}", k + 1), "a list of numbers", found)
        })
    };
    Ok((name.into(), rows.iter().enumerate().map(row).collect::<Result<_, _>>()?))
}

/// Tests in the order of time; the robot's clock must have run on from one to the next.
fn in_order(tests: &mut [Test]) -> Result<(), Damage> {
    tests.sort_by(|(_, a), (_, b)| a[0][0].total_cmp(&b[0][0]));
    for pair in tests.windows(2) {
        let [(before, rows), (after, next)] = pair else { continue };
        let (end, start) = (rows[rows.len() - 1][0], next[0][0]);
        if !(end < start) {
            let expected = format!("a start after {before}, which ends at {end} s");
            let found = format!("{start} s (was the robot restarted? keep one of them)");
            return Err(Damage::new(after.as_str(), expected, found));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
