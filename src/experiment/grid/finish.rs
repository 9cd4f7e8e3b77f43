//! Runs all cells, keeping a journal, and writes the result folder.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;
use serde_json::json;

use super::cell::{Cell, run_cell};
use super::summary::{self, Summary};
use super::{GridPlan, page, table};
use crate::experiment::error::ExperimentError;
use crate::experiment::execute::{Done, RunOptions};
use crate::experiment::plan::Plan;
use crate::io::{
    IoError, Journal, ResultFolder, sha256_text, write_csv_table, write_parquet_table,
};
use crate::study::SCHEMA;

/// Runs a grid and writes its folder.
///
/// # Errors
/// A folder that cannot be written and figures that cannot be drawn; cells do not fail.
pub(in crate::experiment) fn finish(
    plan: &Plan,
    grid: &GridPlan,
    options: &RunOptions,
) -> Result<Done, ExperimentError> {
    let mut folder = ResultFolder::new(&options.out, &plan.name);
    let cells = run_cells(plan, grid, folder.path(), options)?;
    let columns = table::columns(grid, &cells);
    let summaries = summary::summaries(grid, &cells)?;
    let rendered = page::render(plan, grid, &cells, &summaries)?;
    folder.add("experiment.toml", plan.file.clone());
    for (file, png) in rendered.figures {
        folder.add(file, png);
    }
    let parquet = write_parquet_table(Path::new("estimates.parquet"), &columns)?;
    folder.add("estimates.parquet", parquet);
    folder.add("summary.csv", write_csv_table(&summary::columns(grid, &summaries))?);
    folder.add("report.html", rendered.html);
    let results = results(plan, grid, &cells, &summaries);
    folder.add("results.json", serde_json::to_string_pretty(&results).unwrap_or_default());
    let path = folder.write()?;
    let verdict = page::verdict(grid, &cells, &summaries);
    Ok(Done { verdict, report: path.join("report.html"), window_rms: (f64::NAN, f64::NAN) })
}

/// Finished cells of the journal, and the others run, sorted by number.
fn run_cells(
    plan: &Plan,
    grid: &GridPlan,
    folder: &Path,
    options: &RunOptions,
) -> Result<Vec<Cell>, IoError> {
    let base = base_key(plan);
    let key = |cell: usize| sha256_text(&format!("{base} {cell}"));
    let path = folder.join("grid.journal.jsonl");
    let mut finished: HashMap<usize, (Cell, String)> = HashMap::new();
    if options.resume {
        for line in Journal::lines(&path) {
            let Ok(cell) = serde_json::from_str::<Cell>(&line) else { continue };
            if cell.cell < grid.cells() && cell.key == key(cell.cell) {
                finished.insert(cell.cell, (cell, line));
            }
        }
    }
    let kept: Vec<String> = finished.values().map(|(_, line)| line.clone()).collect();
    let journal = Journal::start(&path, &kept)?;
    let bar = progress(grid.cells(), finished.len(), options.progress);
    let methods: Vec<String> = plan.methods.iter().map(|m| m.name.clone()).collect();
    let missing: Vec<usize> = (0..grid.cells()).filter(|c| !finished.contains_key(c)).collect();
    let run = |cell: usize| -> Result<Cell, IoError> {
        let done = run_cell(grid, cell, key(cell), &methods);
        journal.append(&serde_json::to_string(&done).unwrap_or_default())?;
        bar.inc(1);
        Ok(done)
    };
    // one by one: cells differ in length, and an interrupted run has then finished the first ones
    let mut cells =
        missing.into_par_iter().with_max_len(1).map(run).collect::<Result<Vec<Cell>, IoError>>()?;
    bar.finish_and_clear();
    cells.extend(finished.into_values().map(|(cell, _)| cell));
    cells.sort_by_key(|cell| cell.cell);
    Ok(cells)
}

/// What the results depend on, besides the number of the cell: program, file as run, recordings.
fn base_key(plan: &Plan) -> String {
    let mut text = format!("{} {}\n", env!("CARGO_PKG_VERSION"), plan.file);
    for measured in &plan.recordings {
        let _ = writeln!(text, "{}", measured.sha256.as_deref().unwrap_or("made"));
    }
    sha256_text(&text)
}

fn progress(cells: usize, finished: usize, shown: bool) -> ProgressBar {
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(cells as u64), target);
    let style =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} combinations, {per_sec}, {eta} left");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar.set_position(finished as u64);
    bar.reset_eta();
    bar
}

/// `results.json` of a grid.
fn results(
    plan: &Plan,
    grid: &GridPlan,
    cells: &[Cell],
    summaries: &[Summary],
) -> serde_json::Value {
    let axes: Vec<_> = grid
        .axes
        .iter()
        .map(|axis| json!({ "key": axis.name, "path": axis.key, "values": axis.values }))
        .collect();
    let failures: Vec<_> = cells
        .iter()
        .flat_map(|cell| cell.rows.iter().map(move |row| (cell, row)))
        .filter(|(_, row)| row.status == "failed")
        .map(|(cell, row)| json!({ "cell": cell.cell, "method": row.method, "reason": row.reason }))
        .collect();
    json!({
        "schema": SCHEMA,
        "experiment": plan.name,
        "title": plan.title,
        "program": { "name": env!("CARGO_PKG_NAME"), "version": env!("CARGO_PKG_VERSION") },
        "grid": axes,
        "cells": cells.len(),
        "failures": failures,
        "summary": summaries.iter().map(|s| summary::json(grid, s)).collect::<Vec<_>>(),
    })
}
