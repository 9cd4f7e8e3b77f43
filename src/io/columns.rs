//! Which column of a file is which quantity, in which unit.

use std::collections::BTreeMap;

use super::IoError;

/// Names of the contract, in order.
pub(super) const CONTRACT: [&str; 7] = ["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "M1", "M2"];

/// A column of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the file.
    pub name: String,
    /// Factor from the file's value to SI.
    pub factor: f64,
    /// Whether the experiment file names it; a named column must be there.
    pub named: bool,
}

/// Where each quantity of the contract stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap(BTreeMap<&'static str, Column>);

/// Units that are known, as (name, factor to SI).
pub struct Unit;

const TIME: &[(&str, f64)] = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
const DEGREE: f64 = std::f64::consts::PI / 180.0;
const ANGLE: &[(&str, f64)] = &[("rad", 1.0), ("deg", DEGREE), ("rev", std::f64::consts::TAU)];
const SPEED: &[(&str, f64)] = &[
    ("rad/s", 1.0),
    ("deg/s", DEGREE),
    ("rpm", std::f64::consts::TAU / 60.0),
    ("rev/s", std::f64::consts::TAU),
];
const DRIVE: &[(&str, f64)] = &[
    ("N m", 1.0),
    ("mN m", 1e-3),
    ("N cm", 1e-2),
    ("V", 1.0),
    ("mV", 1e-3),
    ("A", 1.0),
    ("mA", 1e-3),
];

impl Unit {
    /// Factor from a unit to that of the contract.
    ///
    /// # Errors
    /// Units that are not known for the quantity.
    pub fn factor(column: &str, unit: &str) -> Result<f64, IoError> {
        let (quantity, known) = match column {
            "t" => ("time", TIME),
            "alpha1" | "alpha2" => ("an angle", ANGLE),
            "dalpha1" | "dalpha2" => ("a speed", SPEED),
            _ => ("a drive", DRIVE),
        };
        let plain = |u: &str| u.replace(['·', '*', ' '], "").to_lowercase();
        known.iter().find(|(name, _)| plain(name) == plain(unit)).map(|(_, f)| *f).ok_or_else(
            || {
                let known: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
                IoError::Unit {
                    column: column.into(),
                    unit: unit.into(),
                    quantity: quantity.into(),
                    known: known.join(", "),
                }
            },
        )
    }
}

impl Default for ColumnMap {
    fn default() -> Self {
        let plain =
            |name: &'static str| (name, Column { name: name.into(), factor: 1.0, named: false });
        Self(CONTRACT.into_iter().map(plain).collect())
    }
}

impl ColumnMap {
    /// Says where a quantity stands: `scale` multiplies the value after its unit.
    ///
    /// # Errors
    /// Keys that are no column of the contract, and unknown units.
    pub fn set(
        &mut self,
        key: &str,
        name: &str,
        unit: Option<&str>,
        scale: f64,
    ) -> Result<(), IoError> {
        let contract = CONTRACT
            .into_iter()
            .find(|c| *c == key)
            .ok_or_else(|| IoError::UnknownColumn { column: key.into() })?;
        let factor = match unit {
            Some(unit) => Unit::factor(contract, unit)?,
            None => 1.0,
        };
        let column = Column { name: name.into(), factor: factor * scale, named: true };
        self.0.insert(contract, column);
        Ok(())
    }

    /// The column of a quantity of the contract.
    #[must_use]
    pub fn get(&self, key: &str) -> &Column {
        &self.0[key]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_become_si() {
        assert!(
            (Unit::factor("dalpha1", "rpm").unwrap() * 60.0 - std::f64::consts::TAU).abs() < 1e-12
        );
        assert_eq!(Unit::factor("M1", "Nm").unwrap(), 1.0);
        let e = Unit::factor("dalpha1", "knots").unwrap_err().to_string();
        assert!(e.contains("`knots` is not known for a speed") && e.contains("rpm"), "{e}");
    }
}
