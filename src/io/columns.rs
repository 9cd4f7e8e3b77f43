//! The column and unit of each quantity in a file.

mod spelling;

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

pub use self::spelling::spellings;
use self::spelling::{SPELLINGS, plain, synonym};
use super::IoError;
use crate::catalogue::nearest;
use crate::recording::DriveUnit;

/// Names of the contract, in order.
pub(super) const CONTRACT: [&str; 7] = ["t", "alpha1", "alpha2", "dalpha1", "dalpha2", "M1", "M2"];

/// A column of a file and the conversion of its values.
///
/// ```text
/// value [SI] = factor of the unit * (scale * (value in the file + values of `plus`) + offset) * value of `times`
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name in the file.
    pub name: String,
    /// Unit in the file; default: the unit after the name in the header, else SI.
    pub unit: Option<String>,
    /// Factor on the value in the file, for example a gear ratio or -1.
    pub scale: f64,
    /// Offset added after the factor, in the unit of the file.
    pub offset: f64,
    /// Counts of the encoder per turn of the wheel, for the units `ticks` and `ticks/s`.
    pub per_turn: Option<f64>,
    /// Torque at the wheel per ampere [N m/A], for an input that was recorded as current.
    pub torque_constant: Option<f64>,
    /// Column with the fractional part of a time in whole seconds: nanoseconds, unless its name states
    /// another unit.
    pub nanoseconds: Option<String>,
    /// Whether the column holds the step from row to row, and the time is the sum of the steps.
    pub sum: bool,
    /// Sampling period \[s\] of a recording without a time column; not combined with other keys.
    pub period: Option<f64>,
    /// Columns that are added to the value: the torques or currents of other motors on the same side.
    pub plus: Vec<String>,
    /// Column by which the value is multiplied.
    pub times: Option<String>,
    /// Column with the direction of a magnitude.
    pub sign: Option<String>,
    /// Text in that column where the value is negative; default: any negative number.
    pub backward: Option<String>,
    /// Whether the experiment file names it; a named column must be there.
    pub named: bool,
}

impl Column {
    /// A column with this name and values in standard units.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: None,
            scale: 1.0,
            offset: 0.0,
            per_turn: None,
            torque_constant: None,
            nanoseconds: None,
            sum: false,
            period: None,
            plus: vec![],
            times: None,
            sign: None,
            backward: None,
            named: true,
        }
    }
}

/// Column of each quantity in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnMap {
    columns: BTreeMap<&'static str, Column>,
    drive_unit: DriveUnit,
    wheel_radius: Option<f64>,
}

impl Default for ColumnMap {
    fn default() -> Self {
        let plain = |name: &'static str| (name, Column { named: false, ..Column::new(name) });
        Self {
            columns: CONTRACT.into_iter().map(plain).collect(),
            drive_unit: DriveUnit::default(),
            wheel_radius: None,
        }
    }
}

impl ColumnMap {
    /// The columns of the contract for an input in this unit and wheels of this radius \[m\], which
    /// turns metres into radians.
    #[must_use]
    pub fn new(drive_unit: DriveUnit, wheel_radius: Option<f64>) -> Self {
        Self { drive_unit, wheel_radius, ..Self::default() }
    }

    /// Sets the column of a quantity: `scale` multiplies the value.
    ///
    /// # Errors
    /// Unknown quantities and unknown units.
    pub fn set(
        &mut self,
        key: &str,
        name: &str,
        unit: Option<&str>,
        scale: f64,
    ) -> Result<(), IoError> {
        self.put(key, Column { unit: unit.map(Into::into), scale, ..Column::new(name) })
    }

    /// Sets the column of a quantity with its conversion.
    ///
    /// # Errors
    /// Unknown quantities, unknown units, units that require a number which is
    /// missing, and factors that are zero or not finite.
    pub fn put(&mut self, key: &str, column: Column) -> Result<(), IoError> {
        let contract = CONTRACT.into_iter().find(|c| *c == key).ok_or_else(|| {
            let near = nearest(key, CONTRACT).map(Into::into);
            IoError::UnknownColumn { column: key.into(), near }
        })?;
        if let Some(period) = column.period {
            let is_alone = column == Column { period: column.period, ..Column::new("") };
            if key != "t" || !is_alone || !(period > 0.0 && period.is_finite()) {
                return Err(IoError::Period { column: key.into(), period });
            }
        }
        let is_signed = key.starts_with('d') || key.starts_with('M');
        if (column.sign.is_some() && !is_signed)
            || (column.backward.is_some() && column.sign.is_none())
        {
            return Err(IoError::Direction { column: key.into() });
        }
        self.check_sum(contract, &column)?;
        if column.torque_constant.is_some() && self.drive_unit != DriveUnit::NewtonMetre {
            let need = "drive_unit = \"N m\" (the default) beside torque_constant".into();
            return Err(IoError::UnitNeeds { column: key.into(), unit: "A".into(), need });
        }
        let (factor, offset) = self.conversion(contract, &column, None)?;
        if factor == 0.0 || !factor.is_finite() || !offset.is_finite() {
            return Err(IoError::Scale { column: key.into(), factor, offset });
        }
        self.columns.insert(contract, column);
        Ok(())
    }

    /// Rejects sums of quantities that do not add up (angles, speeds, voltages), and columns that occur
    /// twice.
    fn check_sum(&self, key: &str, column: &Column) -> Result<(), IoError> {
        let all: Vec<&String> = std::iter::once(&column.name).chain(&column.plus).collect();
        let twice = (1..all.len()).find(|k| all[..*k].contains(&all[*k]));
        let reason = if column.plus.is_empty() {
            return Ok(());
        } else if !key.starts_with('M') {
            "only torques and currents of M1 and M2 add up; name the angle or speed of one wheel"
                .into()
        } else if self.drive_unit == DriveUnit::Volt {
            "voltages do not add up: motors of one side have the same; leave `plus` out".into()
        } else if let Some(k) = twice {
            format!("column `{}` is listed twice; name each once", all[k])
        } else {
            return Ok(());
        };
        Err(IoError::Sum { column: key.into(), reason })
    }

    /// The column of a quantity of the contract.
    ///
    /// # Panics
    /// If `key` is none.
    #[must_use]
    pub fn get(&self, key: &str) -> &Column {
        &self.columns[key]
    }

    /// Factor and offset that turn the values of a column into those of the contract;
    /// `header_unit` is the unit that the header states.
    pub(super) fn conversion(
        &self,
        key: &str,
        column: &Column,
        header_unit: Option<&str>,
    ) -> Result<(f64, f64), IoError> {
        let implied = if column.per_turn.is_some() && key.starts_with("alpha") {
            Some("ticks")
        } else if column.per_turn.is_some() && key.starts_with("dalpha") {
            Some("ticks/s")
        } else if column.torque_constant.is_some() {
            Some("A")
        } else {
            None
        };
        let unit = column.unit.as_deref().or(implied).or(header_unit);
        let factor = unit.map_or(Ok(1.0), |unit| self.factor(key, column, unit))?;
        Ok((factor * column.scale, factor * column.offset))
    }

    /// Unit of the contract: of times, angles, speeds, and of the inputs that of the experiment.
    pub(super) fn unit_of(&self, key: &str) -> &'static str {
        match key {
            "t" => "s",
            "alpha1" | "alpha2" => "rad",
            "dalpha1" | "dalpha2" => "rad/s",
            _ => self.drive_unit.symbol(),
        }
    }

    /// Factor from a unit to that of the contract.
    fn factor(&self, key: &str, column: &Column, unit: &str) -> Result<f64, IoError> {
        let units = self.units(key, column);
        let known =
            |name: &str| units.iter().find(|(n, _)| plain(n) == plain(name)).map(|(_, f)| f);
        match known(synonym(unit)) {
            Some(Ok(factor)) => Ok(*factor),
            Some(Err(need)) => Err(IoError::UnitNeeds {
                column: key.into(),
                unit: unit.into(),
                need: (*need).into(),
            }),
            None => {
                let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
                Err(IoError::Unit {
                    column: key.into(),
                    unit: unit.into(),
                    quantity: quantity(key).into(),
                    known: names.join(", "),
                })
            }
        }
    }

    /// The units of a quantity: name, and factor to the contract's or what is needed for one.
    fn units(&self, key: &str, column: &Column) -> Vec<(&'static str, Result<f64, &'static str>)> {
        let count = column.per_turn.map(|n| TAU / n).ok_or("per_turn, the counts per wheel turn");
        let metre = self.wheel_radius.map(|r| 1.0 / r).ok_or("the wheel radius of [robot]");
        let part = |of_metre: f64| metre.map(|factor| of_metre * factor);
        let degree = Ok(PI / 180.0);
        match key {
            "t" => vec![
                ("s", Ok(1.0)),
                ("ms", Ok(1e-3)),
                ("us", Ok(1e-6)),
                ("ns", Ok(1e-9)),
                ("min", Ok(60.0)),
                ("h", Ok(3600.0)),
                ("d", Ok(86_400.0)),
            ],
            "alpha1" | "alpha2" => vec![
                ("rad", Ok(1.0)),
                ("mrad", Ok(1e-3)),
                ("deg", degree),
                ("rev", Ok(TAU)),
                ("ticks", count),
                ("m", metre),
                ("cm", part(1e-2)),
                ("mm", part(1e-3)),
                ("ft", part(12.0 * INCH)),
                ("in", part(INCH)),
            ],
            "dalpha1" | "dalpha2" => vec![
                ("rad/s", Ok(1.0)),
                ("mrad/s", Ok(1e-3)),
                ("deg/s", degree),
                ("rpm", Ok(TAU / 60.0)),
                ("rev/s", Ok(TAU)),
                ("ticks/s", count),
                ("m/s", metre),
                ("cm/s", part(1e-2)),
                ("mm/s", part(1e-3)),
                ("km/h", part(1.0 / 3.6)),
                ("ft/s", part(12.0 * INCH)),
                ("in/s", part(INCH)),
            ],
            _ => self.inputs(column),
        }
    }

    fn inputs(&self, column: &Column) -> Vec<(&'static str, Result<f64, &'static str>)> {
        match self.drive_unit {
            DriveUnit::NewtonMetre => {
                let need = "torque_constant [N m/A], or drive_unit = \"A\"";
                let ampere = column.torque_constant.ok_or(need);
                let volt = Err("drive_unit = \"V\"");
                vec![
                    ("N m", Ok(1.0)),
                    ("mN m", Ok(1e-3)),
                    ("N mm", Ok(1e-3)),
                    ("N cm", Ok(1e-2)),
                    ("kgf cm", Ok(1e-2 * KILOGRAM_FORCE)),
                    ("oz in", Ok(POUND_FORCE / 16.0 * INCH)),
                    ("lb in", Ok(POUND_FORCE * INCH)),
                    ("lb ft", Ok(12.0 * POUND_FORCE * INCH)),
                    ("A", ampere),
                    ("mA", ampere.map(|k| 1e-3 * k)),
                    ("V", volt),
                    ("mV", volt),
                ]
            }
            DriveUnit::Volt => {
                // units of a command, of which `scale` and `times` say how many volts it is
                let command = ["%", "-", "us", "pwm"].map(|unit| (unit, Ok(1.0)));
                [("V", Ok(1.0)), ("mV", Ok(1e-3))].into_iter().chain(command).collect()
            }
            DriveUnit::Ampere => vec![("A", Ok(1.0)), ("mA", Ok(1e-3))],
        }
    }
}

/// Weight of a kilogram \[N\], of a pound \[N\], and an inch \[m\]. Source: ISO 80000, by definition.
const KILOGRAM_FORCE: f64 = 9.806_65;
const POUND_FORCE: f64 = 0.453_592_37 * KILOGRAM_FORCE;
const INCH: f64 = 0.0254;

fn quantity(key: &str) -> &'static str {
    match key {
        "t" => "time",
        "alpha1" | "alpha2" => "an angle",
        "dalpha1" | "dalpha2" => "a speed",
        _ => "an input",
    }
}

/// Every quantity of the contract, and the units in which it may be recorded: as messages name
/// them first, then other spellings.
#[must_use]
pub fn contract_units() -> Vec<(&'static str, Vec<String>)> {
    let map = ColumnMap::default();
    let column = Column::new("");
    let all = |key: &'static str| {
        let names: Vec<&str> = map.units(key, &column).into_iter().map(|(name, _)| name).collect();
        let others = SPELLINGS.iter().filter(|(name, _)| names.contains(name));
        let others = others.flat_map(|(_, others)| others.iter().map(|o| (*o).to_string()));
        let closed = names.iter().filter(|n| n.contains(' ')).map(|n| n.replace(' ', ""));
        let listed = names.iter().map(|n| (*n).to_string());
        (key, listed.chain(others).chain(closed).collect())
    };
    CONTRACT.into_iter().map(all).collect()
}

/// Whether a text is a unit of some quantity of the contract.
pub(super) fn is_unit(text: &str) -> bool {
    static ALL: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
        contract_units().iter().flat_map(|(_, units)| units.iter().map(|u| plain(u))).collect()
    });
    ALL.contains(&plain(synonym(text)))
}

#[cfg(test)]
mod tests;
