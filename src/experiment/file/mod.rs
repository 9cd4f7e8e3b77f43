//! The experiment file, checked before anything is run.

mod check;
mod column;
mod error;
mod grid;
mod json_schema;
mod key_schema;
mod meant;
mod open;
mod schema;

pub use column::ColumnEntry;
pub use error::FileError;
pub use grid::GridAxis;
pub(super) use grid::axes;
pub use json_schema::json_schema;
pub(super) use schema::hold_rows;
pub use schema::{
    AllCandidates, CandidatesEntry, ConstructionWord, CustomEntry, CustomParameter, DiagnosisEntry,
    EmulatorEntry, ExperimentFile, FixedEntry, ModelEntry, MovementEntry, NamedMovement,
    RecordingsEntry, SimulationEntry,
};

use std::collections::BTreeMap;

use toml::{Table, Value};

impl ExperimentFile {
    /// Parses the text of an experiment file. `name` is used in messages; `overrides` are
    /// `key=value` in TOML syntax with dotted keys, applied in order.
    ///
    /// # Errors
    /// Unknown keys, wrong types and values out of range, with the line and, if one is similar, the key
    /// that was probably meant.
    ///
    /// # Examples
    /// ```
    /// use amigo_ident::experiment::ExperimentFile;
    /// let text = "[simulation]\nmovement = \"paper\"\nsede = 1\n";
    /// let error = ExperimentFile::parse("a.toml", text, &[]).unwrap_err().to_string();
    /// assert!(error.contains("line 3") && error.contains("did you mean `seed`?"), "{error}");
    /// ```
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, FileError> {
        let table = Self::table(name, text, overrides)?;
        open::refuse_open(name, &table)?;
        let typed = || toml::from_str(text).map_err(|e| meant::refused(name, text, &e));
        let file = if overrides.is_empty() {
            typed()?
        } else {
            // errors in the text itself have a line number
            if open::refuse_open(name, &Self::table(name, text, &[])?).is_ok() {
                let _: Self = typed()?;
            }
            Self::from_table(&table)
                .map_err(|message| FileError::Override { entry: overrides.join(" "), message })?
        };
        file.check(name)?;
        Ok(file)
    }

    /// The keys and values of the text with the overrides applied, unchecked.
    pub(super) fn table(name: &str, text: &str, overrides: &[String]) -> Result<Table, FileError> {
        let mut table = toml::from_str(text).map_err(|e| meant::refused(name, text, &e))?;
        for entry in overrides {
            set(&mut table, entry)?;
        }
        Ok(table)
    }

    /// Parses keys and values without checking ranges. The error is text.
    pub(super) fn from_table(table: &Table) -> Result<Self, String> {
        Value::Table(table.clone()).try_into().map_err(|e| meant::refused_table(&[], table, &e))
    }
}

/// Parses the entries of a table of columns, as in `recordings.columns`; the error is text.
pub(super) fn column_entries(table: &Table) -> Result<BTreeMap<String, ColumnEntry>, String> {
    column::columns(Value::Table(table.clone()))
        .map_err(|e| meant::refused_table(&["recordings", "columns"], table, &e))
}

/// Table in which a name stands for a table with this name.
const COLUMNS: &str = "recordings.columns.";

/// Applies one `a.b.c=value`.
fn set(table: &mut Table, entry: &str) -> Result<(), FileError> {
    let wrong = |message: String| FileError::Override { entry: entry.into(), message };
    let (key, value) = entry
        .split_once('=')
        .ok_or_else(|| wrong("expected KEY=VALUE, for example simulation.seed=7".into()))?;
    let parsed: Table = toml::from_str(&format!("value = {value}"))
        .or_else(|_| toml::from_str(&format!("value = {:?}", value.trim())))
        .map_err(|e: toml::de::Error| wrong(e.message().to_string()))?;
    set_value(table, key.trim(), parsed["value"].clone()).map_err(wrong)
}

/// Sets a value at a dotted key, creating tables as needed; a column given by its name becomes a table with
/// this name.
///
/// # Errors
/// If a part of the key is not a table.
pub(super) fn set_value(table: &mut Table, key: &str, value: Value) -> Result<(), String> {
    let mut parts: Vec<&str> = key.split('.').collect();
    let last = parts.pop().unwrap_or_default();
    let mut place = table;
    for part in parts {
        let next = place.entry(part).or_insert_with(|| Value::Table(Table::new()));
        if let Value::String(name) = &*next
            && key.starts_with(COLUMNS)
        {
            // a period replaces a column
            let named = (last != "period").then(|| ("name".to_string(), name.clone().into()));
            *next = Value::Table(named.into_iter().collect());
        }
        place = next.as_table_mut().ok_or_else(|| format!("`{part}` of `{key}` is not a table"))?;
    }
    place.insert(last.to_string(), value);
    Ok(())
}

#[cfg(test)]
mod tests;
