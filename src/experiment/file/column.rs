//! `[recordings] columns`: the column and unit of each quantity.

use std::collections::BTreeMap;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::io::Column;

/// A column of a file: its name, or a table with name, unit and conversion.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColumnEntry {
    /// Name in the file.
    #[serde(default)]
    pub name: String,
    /// Unit in the file; default: that of the header, otherwise the SI unit.
    pub unit: Option<String>,
    /// Factor on the value, for example a gear ratio or -1; default 1.
    pub scale: Option<f64>,
    /// Added after the factor, in the unit of the file.
    #[serde(default)]
    pub offset: f64,
    /// Counts of the encoder per turn of the wheel, for the units `ticks` and `ticks/s`.
    pub per_turn: Option<f64>,
    /// Torque per ampere [N m/A], for an input that was recorded as current.
    pub torque_constant: Option<f64>,
    /// Column with the fractional part of a time in whole seconds (`t` only): nanoseconds, unless its name
    /// states `usec` or `ms`.
    pub nanoseconds: Option<String>,
    /// Whether the column contains the time step from row to row, so that the time is its cumulative sum (`t`
    /// only).
    #[serde(default)]
    pub sum: bool,
    /// Sampling period \[s\] of a recording without a time column (`t` only, in place of all other keys).
    pub period: Option<f64>,
    /// Columns that are added to the value: the torques or currents of the other motors of a side (`M1` and `M2` only).
    #[serde(default)]
    pub plus: Vec<String>,
    /// Column by which the value is multiplied, for example the battery voltage if the input is a duty cycle
    /// (`M1` and `M2` only).
    pub times: Option<String>,
    /// Column with the direction of a magnitude, for example `dirL` beside `pwmL` (speeds and inputs only).
    pub sign: Option<String>,
    /// Text in the column `sign` that marks a negative value; default: any negative number.
    pub backward: Option<String>,
}

impl From<ColumnEntry> for Column {
    fn from(entry: ColumnEntry) -> Self {
        Self {
            unit: entry.unit,
            scale: entry.scale.unwrap_or(1.0),
            offset: entry.offset,
            per_turn: entry.per_turn,
            torque_constant: entry.torque_constant,
            nanoseconds: entry.nanoseconds,
            sum: entry.sum,
            period: entry.period,
            plus: entry.plus,
            times: entry.times,
            sign: entry.sign,
            backward: entry.backward,
            ..Self::new(entry.name)
        }
    }
}

/// `M1 = "tau_r"` or `M1 = { name = "tau_r", … }`; unlike an untagged enumeration this keeps the exact errors
/// of the table.
pub(super) fn columns<'de, D: Deserializer<'de>>(
    d: D,
) -> Result<BTreeMap<String, ColumnEntry>, D::Error> {
    struct Entry(ColumnEntry);
    impl<'de> Deserialize<'de> for Entry {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_any(NameOrTable).map(Entry)
        }
    }
    let entries = BTreeMap::<String, Entry>::deserialize(d)?;
    Ok(entries.into_iter().map(|(key, entry)| (key, entry.0)).collect())
}

struct NameOrTable;

impl<'de> Visitor<'de> for NameOrTable {
    type Value = ColumnEntry;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a column name, or { name = \"…\", unit = \"…\", scale = 1.0 }")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<ColumnEntry, E> {
        Ok(ColumnEntry { name: name.into(), ..ColumnEntry::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColumnEntry, A::Error> {
        let entry = ColumnEntry::deserialize(MapAccessDeserializer::new(map))?;
        if entry.name.is_empty() && entry.period.is_none() {
            return Err(serde::de::Error::missing_field("name"));
        }
        Ok(entry)
    }
}
