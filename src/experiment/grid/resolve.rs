//! From `[grid]` to plans: of the whole grid, and of each combination.

use std::path::Path;
use std::sync::Arc;

use toml::{Table, Value};

use crate::experiment::combinations::GridPlan;
use crate::experiment::drives::Drives;
use crate::experiment::error::ExperimentError;
use crate::experiment::file::{ExperimentFile, FileError, GridAxis, axes, set_value};
use crate::experiment::plan::Plan;
use crate::experiment::resolve::resolve_with;
use crate::experiment::source::Source;

/// Checks the grid of a file and resolves its first valid combination; the plan is that of this combination,
/// with the grid.
///
/// # Errors
/// Wrong keys and types, and a file that is not valid for any combination.
pub(in crate::experiment) fn resolve_grid(
    path: &Path,
    text: &str,
    mut table: Table,
    grid: &Table,
) -> Result<Plan, ExperimentError> {
    table.remove("grid");
    let axes = checked_axes(path, &table, grid)?;
    let one_source = !axes.iter().any(|axis| changes_source(&axis.key));
    let (path, drives) = (path.to_path_buf(), Arc::default());
    let mut grid = GridPlan { axes, table, path, source: None, drives };
    let mut first = None;
    for cell in 0..grid.cells() {
        let mut source = None;
        match resolve_from(&grid, cell, &mut source, None) {
            Ok(plan) => {
                grid.source = source.filter(|_| one_source).map(Arc::new);
                return Ok(Plan { grid: Some(grid), file: text.to_string(), ..plan });
            }
            Err(e) => first = first.or(Some(e)),
        }
    }
    // a grid has at least one cell, so there is a first error
    Err(first.unwrap_or_else(|| wrong(&grid.path, "", "has no combination".into()).into()))
}

/// Whether a key affects how recordings are read, conditioned or simulated.
fn changes_source(key: &str) -> bool {
    let parts = ["recordings", "conditioning", "simulation", "robot", "model.custom"];
    parts
        .iter()
        .any(|part| key.strip_prefix(part).is_some_and(|r| r.is_empty() || r.starts_with('.')))
}

/// The axes of a grid, with all values checked for the type of their key.
fn checked_axes(path: &Path, table: &Table, grid: &Table) -> Result<Vec<GridAxis>, FileError> {
    let axes = axes(grid).map_err(|e| wrong(path, &e.key, e.message))?;
    for axis in &axes {
        if axis.key.starts_with("simulation.") && !table.contains_key("simulation") {
            let message = "varies synthetic data, and the file has no [simulation]".to_string();
            return Err(wrong(path, &axis.name, message));
        }
        for value in &axis.values {
            let mut one = table.clone();
            set_value(&mut one, &axis.key, value.clone())
                .and_then(|()| ExperimentFile::from_table(&one).map(|_| ()))
                .map_err(|e| wrong(path, &axis.name, format!("= {value}: {e}")))?;
        }
    }
    Ok(axes)
}

fn wrong(path: &Path, key: &str, message: String) -> FileError {
    FileError::Value { file: path.display().to_string(), key: format!("grid.{key}"), message }
}

/// The experiment of a cell.
///
/// # Errors
/// Inconsistent values.
pub(super) fn resolve_cell(grid: &GridPlan, cell: usize) -> Result<Plan, ExperimentError> {
    // recordings are aligned with the model of each cell
    resolve_from(grid, cell, &mut grid.source.as_deref().cloned(), Some(&grid.drives))
}

fn resolve_from(
    grid: &GridPlan,
    cell: usize,
    source: &mut Option<Source>,
    drives: Option<&Drives>,
) -> Result<Plan, ExperimentError> {
    let shown = grid.path.display().to_string();
    let wrong = |message: String| ExperimentError::Meaning { file: shown.clone(), message };
    let mut table = grid.table.clone();
    for (axis, place) in grid.axes.iter().zip(grid.places(cell)) {
        let value: Value = axis.values[place].clone();
        set_value(&mut table, &axis.key, value).map_err(wrong)?;
    }
    let file = ExperimentFile::from_table(&table).map_err(wrong)?;
    file.check(&shown)?;
    resolve_with(&grid.path, "", &file, source, drives)
}
