//! `[recordings] columns`: where a quantity stands in a recording, and in which unit.

use std::collections::BTreeMap;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::io::Column;

/// A column of a file: its name, or name, unit and what the unit needs.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColumnEntry {
    /// Name in the file.
    #[serde(default)]
    pub name: String,
    /// Unit in the file; that of the header, or the SI unit, unless given.
    pub unit: Option<String>,
    /// Factor on the value, for example a gear ratio or -1; 1 unless given.
    pub scale: Option<f64>,
    /// Added after the factor, in the unit of the file.
    #[serde(default)]
    pub offset: f64,
    /// Counts of the encoder per turn of the wheel, for the units `ticks` and `ticks/s`.
    pub per_turn: Option<f64>,
    /// Torque per ampere [N m/A], for an input that was recorded as current.
    pub torque_constant: Option<f64>,
    /// Column with the part of a second of a time in whole seconds (`t` only): nanoseconds, unless its name states `usec` or `ms`.
    pub nanoseconds: Option<String>,
    /// Whether the column holds the step from row to row, and the time is the sum of the steps (`t` only).
    #[serde(default)]
    pub sum: bool,
    /// Time between two rows \[s\] of a recording without a column of the time (`t` only, in place of all other keys).
    pub period: Option<f64>,
    /// Columns that are added to the value: the torques or currents of the other motors of a side (`M1` and `M2` only).
    #[serde(default)]
    pub plus: Vec<String>,
    /// Column that multiplies the value, for example the voltage of the battery where the input is a
    /// duty cycle (`M1` and `M2` only).
    pub times: Option<String>,
    /// Column that says the direction of a magnitude, for example `dirL` beside `pwmL` (speeds and inputs only).
    pub sign: Option<String>,
    /// Text in the column `sign` that marks a negative value; a negative number unless given.
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

/// `M1 = "tau_r"` or `M1 = { name = "tau_r", … }`; the errors of the table stay exact, which an
/// untagged enumeration would hide.
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
