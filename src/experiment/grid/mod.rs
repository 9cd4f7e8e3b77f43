//! `[grid]`: an experiment repeated over all combinations of values of its keys.
//!
//! Keys are taken in alphabetical order of their names as written; combinations (cells) are counted
//! with the last key varying fastest. A cell sets its values in the experiment file, makes or reads
//! its recordings, runs the methods and keeps one [`cell::Row`] per method and parameter, no
//! series. What is wrong with a key or a type is an error before anything runs; what goes wrong in
//! a cell is a row with its reason.

mod axes;
mod cell;
mod combinations;
mod curves;
mod figures;
mod finish;
mod page;
mod part;
mod run;
mod shell;
mod summary;
mod table;
mod winner;
mod word;

pub use axes::GridAxis;
pub(super) use axes::{Range, SIMULATION_KEYS, TABLES};
pub use combinations::GridPlan;
pub(super) use finish::{finish, merge, run_part};
pub use part::{Shard, ShardError};

use std::path::Path;

use toml::{Table, Value};

use super::error::ExperimentError;
use super::file::{ExperimentFile, FileError, set_value};
use super::plan::Plan;
use super::resolve::resolve;

impl GridPlan {
    /// Checks the grid of a file and resolves its first combination that makes sense; the plan is
    /// that of this combination, with the grid.
    ///
    /// # Errors
    /// Wrong keys and types, and a file that makes no sense in any combination.
    pub(super) fn load(
        path: &Path,
        text: &str,
        mut table: Table,
        grid: &Table,
    ) -> Result<Plan, ExperimentError> {
        let wrong = |key: &str, message: String| FileError::Value {
            file: path.display().to_string(),
            key: format!("grid.{key}"),
            message,
        };
        table.remove("grid");
        let axes = axes::axes(grid).map_err(|e| wrong(&e.key, e.message))?;
        for axis in &axes {
            if axis.key.starts_with("simulation.") && !table.contains_key("simulation") {
                let message = "varies synthetic data, and the file has no [simulation]".to_string();
                return Err(wrong(&axis.name, message).into());
            }
            for value in &axis.values {
                let mut one = table.clone();
                set_value(&mut one, &axis.key, value.clone())
                    .and_then(|()| ExperimentFile::from_table(&one).map(|_| ()))
                    .map_err(|e| wrong(&axis.name, format!("= {value}: {e}")))?;
            }
        }
        let grid = Self { axes, table, path: path.to_path_buf() };
        let mut first = None;
        for cell in 0..grid.cells() {
            match grid.plan(cell) {
                Ok(plan) => return Ok(Plan { grid: Some(grid), file: text.to_string(), ..plan }),
                Err(e) => first = first.or(Some(e)),
            }
        }
        // a grid has at least one cell, so there is a first error
        Err(first.unwrap_or_else(|| wrong("", "has no combination".into()).into()))
    }

    /// The experiment of a cell.
    ///
    /// # Errors
    /// Values that make no sense.
    fn plan(&self, cell: usize) -> Result<Plan, ExperimentError> {
        let shown = self.path.display().to_string();
        let wrong = |message: String| ExperimentError::Meaning { file: shown.clone(), message };
        let mut table = self.table.clone();
        for (axis, place) in self.axes.iter().zip(self.places(cell)) {
            let value: Value = axis.values[place].clone();
            set_value(&mut table, &axis.key, value).map_err(wrong)?;
        }
        let file = ExperimentFile::from_table(&table).map_err(wrong)?;
        file.check(&shown)?;
        resolve(&self.path, "", &file)
    }
}

#[cfg(test)]
mod tests;
